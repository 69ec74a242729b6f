#include "hal/stm32g071/control_interrupt.h"

#include "hal/cortex_m/port.h"
#include "hal/stm32g071/bridge.h"
#include "hal/stm32g071/clock.h"
#include "hal/stm32g071/converter.h"
#include "hal/stm32g071/device.h"

/* The interrupt begins 3 us behind the peak; this is 7 us behind it. */
enum { CONTROL_BEGINS_ABOVE = BRIDGE_HALF_PERIOD_COUNTS - 7 * CORE_CYCLES_PER_us };

static struct {
    uint32_t period; /* index of the present or last control interrupt */
    struct leg_voltage_mean leg_voltages;
    /* what the last control interrupt took */
    uint32_t counter_at_start; /* of TIM1 */
    uint32_t start, end;       /* cycles */
} control = {.period = PORT_NOT_STARTED};

uint32_t port_control_period(void)
{
    return *(const volatile uint32_t *)&control.period;
}

/* Low from the start, by pins_connect, and after a reset, by what pulls it down. */
static inline void switch_brake(const struct hal_samples *samples)
{
#if HAS_BRAKE
    if (!application_brake_idles(&application, samples)) {
        const bool on = application_brake(&application, samples);

        BRAKE_PORT->bsrr = on ? BIT(BRAKE_PIN) : BIT(BRAKE_PIN + 16);
    }
#else
    (void)samples;
#endif
}

/* The control interrupt: the group that was taken at S(k) is complete. */
IN_RAM(control_interrupt) void control_interrupt(void)
{
    const struct converter_group *peak = &converter_groups[LEG_VOLTAGE_SAMPLES - 1];
    struct hal_samples samples;

    control.start = clock_cycles();
    control.counter_at_start = TIM1->cnt;
    DMA1->ifcr = DMA_IFCR_TCIF1;
    control.period++;

    const struct leg_voltages legs = converter_leg_voltages();
    const struct phase_voltage_codes voltage = leg_voltage_mean_step(&control.leg_voltages, &legs);
    samples.current_a = peak->current_a;
    samples.current_b = peak->current_b;
    samples.bus_voltage = peak->bus;
    samples.phase_voltage_a = voltage.a;
    samples.phase_voltage_b = voltage.b;
    samples.encoder_count = 0;
    samples.flags = bridge_begin_period();
    if (control.counter_at_start < CONTROL_BEGINS_ABOVE) {
        samples.flags |= HAL_FLAG_DEADLINE_MISSED; /* began too late, or not at the peak */
    }

    bridge_end_period(application_control_interrupt(&application, &samples));
    switch_brake(&samples);
    const uint32_t end = clock_cycles();
    bridge_deadline_met(end);
    control.end = end;
    SCB->ICSR = SCB_ICSR_PENDSVSET_Msk;
}

/*
 * Right behind it, and preempted by the next: what it took.
 */
void pend_sv_handler(void)
{
    const uint32_t before = BRIDGE_HALF_PERIOD_COUNTS - control.counter_at_start;

    control_cycles_count(&application.cycles, before + control.end - control.start);
}
