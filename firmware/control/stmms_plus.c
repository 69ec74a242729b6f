#include "firmware/control/stmms_plus.h"

#include "firmware/control/voltage_limit.h"

enum { INDUCTANCE_FEED_FORWARD = TORQUE_DEMAND_GAINS, GAINS };

static const struct law_gain gains[GAINS] = {
    TORQUE_DEMAND_GAIN_LIST,
    [INDUCTANCE_FEED_FORWARD] = {"inductance_feed_forward", 0.0, 1.0},
};

const struct law_gain_list stmms_plus_law_gains = {gains, GAINS};

bool stmms_plus_law_design(struct stmms_plus_law_params *params,
                           const struct position_law_task *task, char error[DESIGN_ERROR_TEXT])
{
    params->inductive =
        inductive_voltage_design(task, law_gain_or(task, INDUCTANCE_FEED_FORWARD, 0.8));
    return torque_demand_design(&params->demand, task, error);
}

struct voltage_demand stmms_plus_law_step(struct stmms_plus_law_state *state,
                                          const struct stmms_plus_law_params *params,
                                          const struct voltage_law_input *input)
{
    const num_t speed = input->motion.speed;
    const num_t current = torque_demand_step(&state->demand, &params->demand, &input->motion);
    const struct dq reference = {input->current_d_reference, current};
    const struct dq inductive =
        inductive_voltage(&params->inductive, reference, current - state->current, speed);
    const struct dq wanted = {num_mul(input->resistance, reference.d) + inductive.d,
                              num_mul(input->resistance, current) + speed + inductive.q};
    const struct dq voltage = limit_voltage(wanted, input->voltage_limit);

    state->current = current;
    state->demand.shortfall = wanted.q - voltage.q;
    return (struct voltage_demand){voltage, current};
}
