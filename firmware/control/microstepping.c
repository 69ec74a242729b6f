#include "firmware/control/microstepping.h"

#include "firmware/control/voltage_limit.h"
#include "firmware/design/loop_bandwidth.h"

enum { CURRENT, VOLTAGE, GAINS };

static const struct law_gain gains[GAINS] = {
    [CURRENT] = {"current_A", 0.0, 100.0},
    [VOLTAGE] = {"voltage_V", 0.0, 1000.0},
};

const struct law_gain_list microstepping_law_gains = {gains, GAINS};

bool microstepping_law_design(struct microstepping_law_params *params,
                              const struct position_law_task *task, char error[DESIGN_ERROR_TEXT])
{
    const struct per_unit *base = task->base;

    if (!current_bandwidth_check(task->motor, task->period_s, task->current_bandwidth_rad_s,
                                 error)) {
        return false;
    }
    params->current_control =
        current_control_design(task->motor, base, task->period_s, task->current_bandwidth_rad_s);
    params->current =
        num_from_double(law_gain_or(task, CURRENT, task->current_limit_A) / base->current_A);
    params->voltage = num_from_double(law_gain_or(task, VOLTAGE, 0.0) / base->voltage_V);
    return true;
}

struct voltage_demand microstepping_law_step(struct microstepping_law_state *state,
                                             const struct microstepping_law_params *params,
                                             const struct voltage_law_input *input)
{
    const struct sincos ahead = sincos_of(input->reference_angle - input->angle);
    const struct phases current = {input->current.d, input->current.q};
    const struct dq wanted = {params->current, NUM(0.0)};
    struct dq voltage = {params->voltage, NUM(0.0)};

    if (params->voltage > NUM(0.0)) {
        voltage = limit_voltage(voltage, input->voltage_limit);
    } else {
        /* The reference's frame turns with the reference. */
        const struct rotation speed = {input->motion.reference_speed,
                                       input->motion.reference_speed};

        voltage = current_control_step(&state->current_control, &params->current_control, wanted,
                                       park(current, ahead), speed, input->voltage_limit);
    }
    const struct phases in_rotor_frame = inverse_park(voltage, ahead);

    return (struct voltage_demand){{in_rotor_frame.a, in_rotor_frame.b}, NUM(0.0)};
}
