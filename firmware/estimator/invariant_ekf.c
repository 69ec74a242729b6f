#include "firmware/design/elementary.h"
#include "firmware/estimator/invariant_ekf_step.h"
#include "firmware/estimator/synchronism_monitor.h"

static struct invariant_ekf_gain_set scale(const struct per_unit *base,
                                           const struct invariant_ekf_gains *k)
{
    const double i = base->current_A;
    const double turns_per_current = i / base->rad_per_turn;
    const double full_speed = k->angle_d_full_speed_rad_s / base->speed_rad_s;
    const double volts_per_turn = base->rad_per_turn / base->voltage_V;
    const bool odd = k->k_angle_d_rad_A != 0.0;
    const struct invariant_ekf_gain_set set = {
        .current = coef_from_double(0.5 * (k->k_current_d + k->k_current_q)),
        .speed_q = coef_from_double(k->k_speed_q_rad_As * i / base->speed_rad_s),
        .angle_d = coef_from_double(k->k_angle_d_rad_A * turns_per_current / full_speed),
        .angle_q = coef_from_double(k->k_angle_q_rad_A * turns_per_current),
        .load_q = coef_from_double(k->k_load_q_Nm_A * i / base->torque_Nm),
        .bias_per_turn =
            coef_from_double(odd ? k->k_bias_d_V_A / k->k_angle_d_rad_A * volts_per_turn : 0.0),
        .bias_q = coef_from_double(k->k_bias_q_V_A / base->resistance_ohm),
        .resistance = coef_from_double(k->k_resistance_ohm_A2 * i * i / base->resistance_ohm),
        .load_return = coef_from_double(k->load_return),
        .angle_return =
            coef_from_double(k->angle_return_rad_Nm * base->torque_Nm / base->rad_per_turn),
        .bias_return = coef_from_double(k->bias_return_V_Nm * base->torque_Nm / base->voltage_V),
        .load_settle = coef_from_double(k->load_settle),
    };
    return set;
}

struct invariant_ekf_params invariant_ekf_scale(const struct motor_model_params *model,
                                                const struct per_unit *base,
                                                const struct invariant_ekf_gains *moving,
                                                const struct invariant_ekf_hold_gains *hold)
{
    struct invariant_ekf_params params = {
        .model = *model,
        .moving = scale(base, moving),
        .holding = scale(base, &hold->quiet),
        .unloaded = scale(base, &hold->unloaded),
        .following = scale(base, &hold->following),
        .odd_gain_speed = num_from_double(moving->angle_d_full_speed_rad_s / base->speed_rad_s),
        .following_periods = hold->following_periods,
        .rest_periods = hold->rest_periods,
        .swing_periods = hold->swing_periods,
        .load_step = num_from_double(hold->load_step_Nm / base->torque_Nm),
        .bias_settle =
            coef_from_double(1.0 - exponential(-SYNCHRONISM_BLOCK_S / hold->bias_settle_s)),
        .led_memory = coef_from_double(hold->led_load_memory),
    };
    return params;
}

void invariant_ekf_reset(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         struct position position, num_t resistance, uint32_t unloaded_periods)
{
    estimate_reset(&ekf->estimate, &params->model, position, resistance);
    ekf->bias = (struct phases){NUM(0.0), NUM(0.0)};
    ekf->innovation_sum = NUM(0.0);
    ekf->led_change = NUM(0.0);
    ekf->unloaded_periods = unloaded_periods;
    ekf->swing_end =
        unloaded_periods > params->swing_periods ? unloaded_periods - params->swing_periods : 0u;
    invariant_ekf_settle(ekf);
}

void invariant_ekf_follow_step(struct invariant_ekf *ekf, const struct invariant_ekf_params *params)
{
    ekf->following_periods = params->following_periods + params->rest_periods;
    ekf->bias = ekf->settled_bias;
}

void invariant_ekf_settle_bias(struct invariant_ekf *ekf, const struct invariant_ekf_params *params)
{
    if (ekf->following_periods == 0u) {
        struct phases *settled = &ekf->settled_bias;

        settled->a += num_mul_coef_nearest(ekf->bias.a - settled->a, params->bias_settle);
        settled->b += num_mul_coef_nearest(ekf->bias.b - settled->b, params->bias_settle);
    }
}

struct passage invariant_ekf_observe(struct invariant_ekf *ekf,
                                     const struct invariant_ekf_params *params,
                                     const struct estimator_input *input)
{
    return invariant_ekf_step(ekf, params, input->winding.current, input->surprise, input->in_force,
                              input->hold);
}
