#include "firmware/design/sliding_mode_design.h"

#include "firmware/design/loop_bandwidth.h"
#include "firmware/design/motor_check.h"

/* Of the paper: 100/s and 20/s to surface poles of 250/s and 300/s. */
#define INTEGRATOR_Q 0.37
#define INTEGRATOR_D 0.073

/* A bandwidth at the limit is allowed, however its product with the period is rounded. */
#define ROUNDING 1.000001

struct sliding_mode_gains sliding_mode_gains_of(const struct sliding_mode_task *task)
{
    const struct motor_params *motor = task->motor;
    const double w = task->bandwidth_rad_s;
    const double k3 = motor->torque_constant_Nm_A / motor->inertia_kgm2;
    const double current_gain_V_A = motor->inductance_H * task->current_bandwidth_rad_s;

    return (struct sliding_mode_gains){
        .k1_1_s2 = w * w,
        .k2_1_s = 2.0 * w,
        .mu_d_A = motor->supply_V / current_gain_V_A,
        .mu_q_rad_s2 = motor->supply_V * k3 / current_gain_V_A,
        .k0_d_1_s = INTEGRATOR_D * w,
        .k0_q_1_s = INTEGRATOR_Q * w,
        .voltage_V = motor->supply_V,
    };
}

bool sliding_mode_current_bandwidth_check(const struct sliding_mode_task *task,
                                          char error[DESIGN_ERROR_TEXT])
{
    const bool delayed = task->delay_periods > 0u;
    const double most = delayed ? SLIDING_MODE_DELAYED_MAX : SLIDING_MODE_ZERO_DELAY_MAX;

    if (!motor_check(task->motor, task->period_s, error) ||
        !design_require_positive(error, "current_bandwidth_rad_s", task->current_bandwidth_rad_s,
                                 "rad/s")) {
        return false;
    }
    if (task->current_bandwidth_rad_s * task->period_s > most * ROUNDING) {
        return design_refuse_limit(
            error, (struct refusal){.quantity = "current_bandwidth_rad_s",
                                    .value = task->current_bandwidth_rad_s,
                                    .relation = "at most",
                                    .limit = most / task->period_s,
                                    .unit = "rad/s",
                                    .reason = delayed ? "g = M T / (mu L) <= 0.25 with delay"
                                                      : "g = M T / (mu L) <= 1"});
    }
    return true;
}

bool sliding_mode_bandwidth_check(const struct sliding_mode_task *task,
                                  char error[DESIGN_ERROR_TEXT])
{
    const double most = task->current_bandwidth_rad_s / CURRENT_OVER_POSITION_BANDWIDTH_MIN;

    if (!design_require_positive(error, "law_bandwidth_rad_s", task->bandwidth_rad_s, "rad/s")) {
        return false;
    }
    if (task->bandwidth_rad_s > most * ROUNDING) {
        return design_refuse_limit(error, (struct refusal){.quantity = "law_bandwidth_rad_s",
                                                           .value = task->bandwidth_rad_s,
                                                           .relation = "at most",
                                                           .limit = most,
                                                           .unit = "rad/s",
                                                           .reason = "a quarter of the current's"});
    }
    return true;
}
