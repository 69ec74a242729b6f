#include "firmware/control/sliding_mode.h"

/* Per-unit bound of a term of the surface: two of these and an acceleration stay in range. */
static const double term_limit = 10.0;

__attribute__((noinline)) static num_t error_limit(double gain)
{
    const double most = POSITION_DIFFERENCE_MAX;

    return num_from_double(gain * most > term_limit ? term_limit / gain : most);
}

struct sliding_mode_task sliding_mode_task_of(const struct position_law_task *task)
{
    return (struct sliding_mode_task){
        .motor = task->motor,
        .period_s = task->period_s,
        .delay_periods = task->delay_periods,
        .bandwidth_rad_s = task->bandwidth_rad_s,
        .current_bandwidth_rad_s = task->current_bandwidth_rad_s,
    };
}

struct sliding_surface_params sliding_surface_design(const struct position_law_task *task,
                                                     double k1_1_s2, double k2_1_s)
{
    const struct per_unit *base = task->base;
    const double position = k1_1_s2 * base->rad_per_turn / base->acceleration_rad_s2;
    const double speed = k2_1_s * base->speed_rad_s / base->acceleration_rad_s2;

    return (struct sliding_surface_params){
        .position = coef_from_double(position),
        .speed = coef_from_double(speed),
        .friction = coef_from_double(task->motor->viscous_friction_Nms_rad * base->speed_rad_s /
                                     base->torque_Nm),
        .position_limit = error_limit(position),
        .speed_limit = error_limit(speed),
        .current_limit = num_from_double(task->current_limit_A / base->current_A),
    };
}

/* mu_pu: of a current or an acceleration in per-unit. */
__attribute__((noinline)) static struct boundary_layer_params boundary_layer_design(double mu_pu)
{
    return (struct boundary_layer_params){
        .levels = coef_from_double(1.0 / mu_pu),
        .limit = num_from_double(SURFACE_LEVELS_MAX * mu_pu),
    };
}

bool sliding_mode_design(struct sliding_mode_params *params, struct sliding_mode_gains *gains,
                         const struct position_law_task *task, char error[DESIGN_ERROR_TEXT])
{
    const struct sliding_mode_task bandwidths = sliding_mode_task_of(task);
    const bool layers_given =
        law_gain_is_given(task, SLIDING_MODE_MU_D) && law_gain_is_given(task, SLIDING_MODE_MU_Q);
    const bool surface_given =
        law_gain_is_given(task, SLIDING_MODE_K1) && law_gain_is_given(task, SLIDING_MODE_K2);

    if ((!layers_given && !sliding_mode_current_bandwidth_check(&bandwidths, error)) ||
        (!surface_given && !sliding_mode_bandwidth_check(&bandwidths, error))) {
        return false;
    }
    *gains = sliding_mode_gains_of(&bandwidths);
    gains->k1_1_s2 = law_gain_or(task, SLIDING_MODE_K1, gains->k1_1_s2);
    gains->k2_1_s = law_gain_or(task, SLIDING_MODE_K2, gains->k2_1_s);
    gains->mu_d_A = law_gain_or(task, SLIDING_MODE_MU_D, gains->mu_d_A);
    gains->mu_q_rad_s2 = law_gain_or(task, SLIDING_MODE_MU_Q, gains->mu_q_rad_s2);
    params->surface = sliding_surface_design(task, gains->k1_1_s2, gains->k2_1_s);
    params->layer_d = boundary_layer_design(gains->mu_d_A / task->base->current_A);
    params->layer_q = boundary_layer_design(gains->mu_q_rad_s2 / task->base->acceleration_rad_s2);
    return true;
}

struct conditional_integrator_params conditional_integrator_design(double k0_1_s, double period_s)
{
    return (struct conditional_integrator_params){
        .rate = coef_from_double(CONDITIONAL_INTEGRATOR_SCALE * k0_1_s * period_s),
    };
}
