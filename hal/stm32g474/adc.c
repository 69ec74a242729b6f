#include "hal/stm32g474/adc.h"

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/wait.h"
#include "hal/stm32g474/board.h"

enum {
    REGULATOR_START = CORE_Hz / 1000000 * 20, /* cycles; 20 us (data sheet) */
    CALIBRATION_WAIT = 20000,                 /* passes, > 470 us; it takes 116 ADC clocks */
    READY_WAIT = 20000,
    /* ADEN may follow the end of a calibration after four ADC clocks (RM0440). */
    AFTER_CALIBRATION = 4 * 4 + 16,
};

/* Bits of CR that are set by software and act by being set; writing 1 to one sets it again. */
#define CR_STATE (ADC_CR_ADVREGEN)

void adc_clock(struct adc_common_registers *common, uint32_t enable)
{
    RCC->ahb2enr |= enable;
    (void)RCC->ahb2enr;
    common->ccr = ADC_CCR_CKMODE(ADC_CLOCK_HCLK_DIV4);
}

void adc_power_up(struct adc_registers *adc)
{
    adc->cr = 0; /* leaves deep power-down */
    adc->cr = CR_STATE;
    wait_cycles(REGULATOR_START);

    adc->difsel = 0;
    adc->cr = CR_STATE | ADC_CR_ADCAL; /* ADCALDIF clear: single-ended */
    if (!wait_until(&adc->cr, ADC_CR_ADCAL, 0, CALIBRATION_WAIT)) {
        board_fault(BOARD_FAULT_ADC_CALIBRATION);
    }
    wait_cycles(AFTER_CALIBRATION);

    adc->isr = ADC_ISR_ADRDY;
    adc->cr = CR_STATE | ADC_CR_ADEN;
    if (!wait_until(&adc->isr, ADC_ISR_ADRDY, ADC_ISR_ADRDY, READY_WAIT)) {
        board_fault(BOARD_FAULT_ADC_READY);
    }
}
