#include "hal/stm32g474/current_sampling.h"

#include "hal/cortex_m/wait.h"
#include "hal/stm32g474/adc.h"
#include "hal/stm32g474/board.h"

enum { AMPLIFIER_START = CORE_Hz / 1000000 * 10 }; /* cycles; 10 us, data sheet: 6 us */

/* Internal gain, output to the converter alone. */
static inline void start_amplifier(struct opamp_registers *amplifier, uint32_t input)
{
    const uint32_t gain = OPAMP_PGA_GAIN_2 + (uint32_t)__builtin_ctz(AMPLIFIER_GAIN) - 1u;
    const uint32_t csr = OPAMP_CSR_VP_SEL(OPAMP_VP_VINP0 + input) | OPAMP_CSR_VM_SEL(OPAMP_VM_PGA) |
                         OPAMP_CSR_PGA_GAIN(gain) | OPAMP_CSR_OPAHSM | OPAMP_CSR_OPAINTOEN;

    amplifier->csr = csr;
    amplifier->csr = csr | OPAMP_CSR_OPAMPEN;
}

/*
 * A current takes 24.5 + 12.5 ADC clocks, as the amplifier asks for 0.4 us of sampling; what is
 * slow and has 10 nF at its pin 2.5 + 12.5: 1.22 us in all.
 */
static void set_sequence(struct adc_registers *adc, uint32_t current, uint32_t slow)
{
    struct {
        uint32_t low, high; /* channels 0...9, 10...18 */
    } times = {0, 0};

    if (current < 10) {
        times.low = ADC_SMPR_SMP(current, ADC_SAMPLE_24_5); /* of all others ADC_SAMPLE_2_5 */
    } else {
        times.high = ADC_SMPR_SMP(current - 10, ADC_SAMPLE_24_5);
    }
    adc->smpr = times.low;
    adc->smpr2 = times.high;
    adc->cfgr = ADC_CFGR_JQDIS; /* the sequence stays as it is */
    adc->jsqr = ADC_JSQR_JL(2 - 1) | ADC_JSQR_JEXTSEL(ADC_TRIGGER_TIM1_TRGO2) |
                ADC_JSQR_JEXTEN(ADC_TRIGGER_RISING) | ADC_JSQR_JSQ1(current) | ADC_JSQR_JSQ2(slow);
}

void current_sampling_configure(void)
{
    RCC->apb2enr |= RCC_APB2ENR_SYSCFGEN; /* clocks the amplifiers */
    (void)RCC->apb2enr;
#if AMPLIFIER_A != 0
    start_amplifier(PERIPHERAL(OPAMP, AMPLIFIER_A), AMPLIFIER_A_INPUT);
#endif
#if AMPLIFIER_B != 0
    start_amplifier(PERIPHERAL(OPAMP, AMPLIFIER_B), AMPLIFIER_B_INPUT);
#endif
    wait_cycles(AMPLIFIER_START);

    adc_clock(ADC12_COMMON, RCC_AHB2ENR_ADC12EN);
    adc_power_up(ADC1);
    adc_power_up(ADC2);
    set_sequence(ADC1, CURRENT_A_CHANNEL, BUS_CHANNEL);
    set_sequence(ADC2, CURRENT_B_CHANNEL, TEMPERATURE_CHANNEL);
}

void current_sampling_start(void)
{
    ADC1->isr = ADC_ISR_JEOS | ADC_ISR_JEOC;
    ADC2->isr = ADC_ISR_JEOS | ADC_ISR_JEOC;
    ADC2->cr = ADC_CR_ADVREGEN | ADC_CR_JADSTART;
    ADC1->cr = ADC_CR_ADVREGEN | ADC_CR_JADSTART;
}
