#include "hal/stm32g474/overcurrent_trip.h"

#include "hal/stm32g474/board.h"
#include "hal/stm32g474/crash.h"
#include "hal/stm32g474/registers.h"
#include "hal/stm32g474/wait.h"

enum {
    READY_WAIT = 20000,                        /* passes, > 470 us; it takes 8 us */
    COMPARATOR_START = CORE_Hz / 1000000 * 10, /* cycles; 10 us, data sheet: 5 us */
};

/* Both channels of DAC3, which has no pins, give the threshold. */
static void start_threshold(void)
{
    RCC->ahb2enr |= RCC_AHB2ENR_DAC3EN;
    (void)RCC->ahb2enr;
    DAC3->mcr = DAC_MCR_HFSEL(DAC_HFSEL_ABOVE_160_MHZ) | DAC_MCR_MODE1(DAC_MODE_ON_CHIP) |
                DAC_MCR_MODE2(DAC_MODE_ON_CHIP);
    DAC3->cr = DAC_CR_EN1 | DAC_CR_EN2;
    if (!wait_until(&DAC3->sr, DAC_SR_DAC1RDY | DAC_SR_DAC2RDY, DAC_SR_DAC1RDY | DAC_SR_DAC2RDY,
                    READY_WAIT)) {
        board_fault(BOARD_FAULT_DAC_READY);
    }
    DAC3->dhr12r1 = OVERCURRENT_CODE;
    DAC3->dhr12r2 = OVERCURRENT_CODE;
}

void overcurrent_trip_configure(void)
{
    /* A+ is COMP3, B+ is COMP4, A- is COMP1, B- is COMP2; first pin of each. */
    struct comp_registers *const comparators[] = {COMP1, COMP2, COMP3, COMP4};
    const uint32_t csr = COMP_CSR_INMSEL(COMP_MINUS_DAC3) | COMP_CSR_HYST(COMP_HYSTERESIS_10_MV);

    start_threshold();
    RCC->apb2enr |= RCC_APB2ENR_SYSCFGEN; /* clocks the comparators */
    (void)RCC->apb2enr;
    for (int i = 0; i < 4; i++) {
        comparators[i]->csr = csr | COMP_CSR_EN;
    }
    wait_cycles(COMPARATOR_START);
    for (int i = 0; i < 4; i++) {
        comparators[i]->csr = csr | COMP_CSR_EN | COMP_CSR_LOCK; /* until the next reset */
    }
}
