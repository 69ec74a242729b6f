#include "hal/stm32g474/overcurrent_trip.h"

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/wait.h"
#include "hal/stm32g474/board.h"
#include "hal/stm32g474/registers.h"

#if OVERCURRENT_INPUTS > 0

enum {
    READY_WAIT = 20000,                        /* passes, > 470 us; it takes 8 us */
    COMPARATOR_START = CORE_Hz / 1000000 * 10, /* cycles; 10 us, data sheet: 5 us */
};

struct comparator {
    struct comp_registers *registers;
    uint32_t input; /* INP0 or INP1 */
};

#define COMPARATOR_ENTRY(number, input) {COMP##number, input},
#define OF_DAC3(number, input)          +((number) <= 4)
#define OF_DAC4(number, input)          +((number) >= 5)

static const struct comparator comparators[OVERCURRENT_INPUTS] = {
    OVERCURRENT_COMPARATORS(COMPARATOR_ENTRY)};

/* Both channels of a converter without pins give the threshold. */
static void start_threshold(struct dac_registers *dac, uint32_t clock)
{
    RCC->ahb2enr |= clock;
    (void)RCC->ahb2enr;
    dac->mcr = DAC_MCR_HFSEL(DAC_HFSEL_ABOVE_160_MHZ) | DAC_MCR_MODE1(DAC_MODE_ON_CHIP) |
               DAC_MCR_MODE2(DAC_MODE_ON_CHIP);
    dac->cr = DAC_CR_EN1 | DAC_CR_EN2;
    if (!wait_until(&dac->sr, DAC_SR_DAC1RDY | DAC_SR_DAC2RDY, DAC_SR_DAC1RDY | DAC_SR_DAC2RDY,
                    READY_WAIT)) {
        board_fault(BOARD_FAULT_DAC_READY);
    }
    dac->dhr12r1 = OVERCURRENT_CODE;
    dac->dhr12r2 = OVERCURRENT_CODE;
}

static uint32_t setting(const struct comparator *comparator)
{
    return COMP_CSR_INMSEL(COMP_MINUS_DAC3_OR_4) | COMP_CSR_HYST(COMP_HYSTERESIS_10_MV) |
           (comparator->input == 1 ? COMP_CSR_INPSEL : 0) | COMP_CSR_EN;
}

void overcurrent_trip_configure(void)
{
    if ((0 OVERCURRENT_COMPARATORS(OF_DAC3)) > 0) {
        start_threshold(DAC3, RCC_AHB2ENR_DAC3EN);
    }
    if ((0 OVERCURRENT_COMPARATORS(OF_DAC4)) > 0) {
        start_threshold(DAC4, RCC_AHB2ENR_DAC4EN);
    }
    RCC->apb2enr |= RCC_APB2ENR_SYSCFGEN; /* clocks the comparators */
    (void)RCC->apb2enr;
    for (int i = 0; i < OVERCURRENT_INPUTS; i++) {
        comparators[i].registers->csr = setting(&comparators[i]);
    }
    wait_cycles(COMPARATOR_START);
    for (int i = 0; i < OVERCURRENT_INPUTS; i++) { /* until the next reset */
        comparators[i].registers->csr = setting(&comparators[i]) | COMP_CSR_LOCK;
    }
}

#else

void overcurrent_trip_configure(void)
{
}

#endif
