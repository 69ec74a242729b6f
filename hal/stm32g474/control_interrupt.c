#include "hal/stm32g474/control_interrupt.h"

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/port.h"
#include "hal/stm32g474/current_sampling.h"
#include "hal/stm32g474/cycle_counter.h"
#include "hal/stm32g474/deadline_guard.h"
#include "hal/stm32g474/encoder.h"
#include "hal/stm32g474/phase_voltage_sampling.h"
#include "hal/stm32g474/pwm.h"

static struct application *application;
static volatile uint32_t period = PORT_NOT_STARTED;
static volatile bool allowed; /* between bridge_enable and bridge_disable */
static bool wanted;           /* by the outputs of the last control interrupt */

void control_set_application(struct application *instance)
{
    application = instance;
}

IN_CCM(port_control_period)
uint32_t port_control_period(void)
{
    return period;
}

bool control_allow_bridge(void)
{
    allowed = !pwm_break_latched();
    return allowed;
}

IN_CCM(control_forbid_bridge)
void control_forbid_bridge(void)
{
    allowed = false; /* first: a control interrupt in between must not close it again */
    pwm_open_bridge();
    pwm_clear_break();
}

static inline void sample(struct hal_samples *samples, uint32_t since_peak)
{
    if (!current_sampling_read(samples)) {
        board_fault(BOARD_FAULT_CURRENT_SAMPLES);
    }
    if (!phase_voltage_sampling_read(samples, since_peak)) {
        board_fault(BOARD_FAULT_LEG_SAMPLES);
    }
    samples->encoder_count = encoder_count();
    samples->flags = 0;
    if (pwm_break_latched()) {
        samples->flags |= HAL_FLAG_OVERCURRENT_TRIP;
        allowed = false;
    }
    if (deadline_guard_take_missed()) {
        samples->flags |= HAL_FLAG_DEADLINE_MISSED;
    }
}

/*
 * Off acts at once. On acts a period later: these duties load at the next peak, and only behind it,
 * if the bridge is to be on still, may the gates follow them. The guards, which open the bridge,
 * must not do so between the question and the write.
 */
static inline void actuate(const struct hal_outputs *outputs)
{
    const bool on = outputs->bridge_on && allowed;

    pwm_write(outputs->high_counts);
    if (!on) {
        pwm_open_bridge();
    } else if (wanted && !pwm_bridge_closed()) {
        __disable_irq();
        if (!deadline_guard_has_missed()) {
            pwm_close_bridge();
        }
        __enable_irq();
    }
    wanted = on;
}

IN_CCM(control_interrupt)
void control_interrupt(void)
{
    const uint32_t begin = cycle_counter_read();
    const uint32_t latency = pwm_cycles_since_peak();
    struct hal_samples samples;
    struct control_cycles_of_period cycles;

    period++;
    sample(&samples, latency);

    const uint32_t sampled = cycle_counter_read();
    const struct hal_outputs outputs = application_control_interrupt(application, &samples);
    const uint32_t controlled = cycle_counter_read();

    actuate(&outputs);
    deadline_guard_met();

    cycles.stage[CONTROL_STAGE_LATENCY] = latency;
    cycles.stage[CONTROL_STAGE_READ] = sampled - begin;
    cycles.stage[CONTROL_STAGE_CONTROL] = controlled - sampled;
    cycles.stage[CONTROL_STAGE_WRITE] = cycle_counter_read() - controlled;
    application_count_cycles(application, &cycles);
}
