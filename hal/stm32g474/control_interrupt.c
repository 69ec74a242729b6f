#include "hal/stm32g474/control_interrupt.h"

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/port.h"
#include "hal/stm32g474/current_sampling.h"
#include "hal/stm32g474/deadline_guard.h"
#include "hal/stm32g474/encoder.h"
#include "hal/stm32g474/phase_voltage_sampling.h"
#include "hal/stm32g474/pwm.h"

static struct {
    volatile uint32_t period;
    volatile bool allowed; /* between bridge_enable and bridge_disable */
    bool wanted;           /* by the outputs of the last control interrupt */
    struct hal_samples samples;
    volatile uint16_t bridge_temperature; /* code of the last S(k) */
} control = {.period = PORT_NOT_STARTED};

IN_FAULT_MEMORY(port_control_period)
uint32_t port_control_period(void)
{
    return control.period;
}

uint16_t control_bridge_temperature(void)
{
    return control.bridge_temperature;
}

int32_t control_encoder_count(void)
{
    return control.samples.encoder_count;
}

bool control_allow_bridge(void)
{
    control.allowed = !pwm_break_latched();
    return control.allowed;
}

IN_CCM(control_forbid_bridge)
void control_forbid_bridge(void)
{
    control.allowed = false; /* first: a control interrupt in between must not close it again */
    pwm_open_bridge();
    pwm_clear_break();
}

/* The converters take 0.7 us from the peak: what they give is read last. */
static inline void take_samples(struct hal_samples *samples)
{
    uint32_t flags = 0;

    if (__builtin_expect(pwm_begin_period(), false)) {
        if (PWR->sr2 & PWR_SR2_PVDO) {
            board_fault(BOARD_FAULT_SUPPLY);
        }
        flags = HAL_FLAG_OVERCURRENT_TRIP;
        control.allowed = false;
    }
    if (!phase_voltage_sampling_read(samples)) {
        board_fault(BOARD_FAULT_LEG_SAMPLES);
    }
    samples->encoder_count = encoder_count(samples->encoder_count);
    if (__builtin_expect((current_sampling_missing() | deadline_guard.missed) != 0u, false)) {
        if (deadline_guard_take_missed()) {
            flags |= HAL_FLAG_DEADLINE_MISSED;
        }
        if (!current_sampling_wait()) {
            board_fault(BOARD_FAULT_CURRENT_SAMPLES);
        }
    }
    samples->flags = flags;
    current_sampling_read(samples, &control.bridge_temperature);
}

/*
 * Off acts at once. On acts a period later: these duties load at the next peak, and only behind it,
 * if the bridge is to be on still, may the gates follow them. The guards, which open the bridge,
 * must not do so between the question and the write.
 */
static inline void actuate(const struct hal_outputs *outputs)
{
    const bool on = outputs->bridge_on && control.allowed;

    pwm_write(outputs->high_counts);
    if (!on) {
        pwm_open_bridge();
    } else if (control.wanted && !pwm_bridge_closed()) {
        __disable_irq();
        if (!deadline_guard.missed) {
            pwm_close_bridge();
        }
        __enable_irq();
    }
    control.wanted = on;
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

static inline void have_actuated(uint32_t peak)
{
    deadline_guard_met();
    control_cycles_count(&application.cycles, deadline_guard_now() - peak);
}

IN_CCM(control_interrupt)
void control_interrupt(void)
{
    control.period++;
    take_samples(&control.samples);

    const uint32_t peak = deadline_guard_sampling_instant();

    actuate(application_control_interrupt(&application, &control.samples));
    switch_brake(&control.samples);
    have_actuated(peak);
}

/* From flash: only while something is captured. */
void control_interrupt_followed(void)
{
    control_interrupt();
    application_follow_control(&application);
}
