#include "firmware/control/foc.h"

#include "firmware/control/voltage_limit.h"
#include "firmware/design/loop_bandwidth.h"

enum { RHO = TORQUE_DEMAND_GAINS, INDUCTANCE_FEED_FORWARD, GAINS };

static const struct law_gain gains[GAINS] = {
    TORQUE_DEMAND_GAIN_LIST,
    [RHO] = {"rho_per_s", 0.0, 1e6},
    [INDUCTANCE_FEED_FORWARD] = {"inductance_feed_forward", 0.0, 1.0},
};

const struct law_gain_list foc_law_gains = {gains, GAINS};

bool foc_law_design(struct foc_law_params *params, const struct position_law_task *task,
                    char error[DESIGN_ERROR_TEXT])
{
    const double rho = law_gain_or(task, RHO, task->current_bandwidth_rad_s);
    const double tracking = rho * task->motor->inductance_H / task->base->resistance_ohm;
    const double tracking_max = 10.0; /* per-unit voltage, a third of the number range */

    /* Derived together they are a cascade; each alone is held to its own limit. */
    if (!law_gain_is_given(task, RHO) &&
        !(torque_demand_needs_design(task)
              ? loop_bandwidth_check(task->motor, task->period_s, task->bandwidth_rad_s, rho, error)
              : current_bandwidth_check(task->motor, task->period_s, rho, error))) {
        return false;
    }
    params->inductive =
        inductive_voltage_design(task, law_gain_or(task, INDUCTANCE_FEED_FORWARD, 1.0));
    params->tracking = coef_from_double(tracking);
    params->current_error_limit =
        num_from_double(tracking > 1.0 ? tracking_max / tracking : tracking_max);
    return torque_demand_design(&params->demand, task, error);
}

static num_t track(const struct foc_law_params *params, num_t reference, num_t current)
{
    return num_mul_coef(num_headroom(reference - current, params->current_error_limit),
                        params->tracking);
}

struct voltage_demand foc_law_step(struct foc_law_state *state, const struct foc_law_params *params,
                                   const struct voltage_law_input *input)
{
    const num_t speed = input->motion.speed;
    const struct dq current = input->current;
    const struct dq reference = {
        input->current_d_reference,
        torque_demand_step(&state->demand, &params->demand, &input->motion)};
    const struct dq inductive =
        inductive_voltage(&params->inductive, reference, reference.q - state->current, speed);
    const struct dq wanted = {
        num_mul(input->resistance, current.d) + inductive.d + track(params, reference.d, current.d),
        num_mul(input->resistance, current.q) + speed + inductive.q +
            track(params, reference.q, current.q),
    };
    const struct dq voltage = limit_voltage(wanted, input->voltage_limit);

    state->current = reference.q;
    state->demand.shortfall = wanted.q - voltage.q;
    return (struct voltage_demand){voltage, reference.q};
}
