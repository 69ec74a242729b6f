#include "firmware/control/stmms.h"

#include "firmware/control/voltage_limit.h"

static const struct law_gain gains[TORQUE_DEMAND_GAINS] = {TORQUE_DEMAND_GAIN_LIST};

const struct law_gain_list stmms_law_gains = {gains, TORQUE_DEMAND_GAINS};

bool stmms_law_design(struct stmms_law_params *params, const struct position_law_task *task,
                      char error[DESIGN_ERROR_TEXT])
{
    if (torque_demand_needs_design(task) &&
        !winding_lag_check(task->motor, task->bandwidth_rad_s, task->speed_limit_rad_s, error)) {
        return false;
    }
    return torque_demand_design(&params->demand, task, error);
}

struct voltage_demand stmms_law_step(struct stmms_law_state *state,
                                     const struct stmms_law_params *params,
                                     const struct voltage_law_input *input)
{
    const num_t current = torque_demand_step(&state->demand, &params->demand, &input->motion);
    const struct dq wanted = {num_mul(input->resistance, input->current_d_reference),
                              num_mul(input->resistance, current) + input->motion.speed};
    const struct dq voltage = limit_voltage(wanted, input->voltage_limit);

    state->demand.shortfall = wanted.q - voltage.q;
    return (struct voltage_demand){voltage, current};
}
