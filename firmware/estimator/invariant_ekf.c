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
    struct invariant_ekf_gain_set set = {
        .current = coef_large_from_double(0.5 * (k->k_current_d + k->k_current_q)),
        .speed_q = coef_from_double(k->k_speed_q_rad_As * i / base->speed_rad_s),
        .angle_d = coef_large_from_double(k->k_angle_d_rad_A * turns_per_current / full_speed),
        .angle_q = coef_from_double(k->k_angle_q_rad_A * turns_per_current),
        .load_q = coef_large_from_double(k->k_load_q_Nm_A * i / base->torque_Nm),
        .bias_per_turn = coef_small_from_double(
            odd ? k->k_bias_d_V_A / k->k_angle_d_rad_A * volts_per_turn : 0.0),
        .bias_q = coef_from_double(k->k_bias_q_V_A / base->resistance_ohm),
        .resistance = coef_from_double(k->k_resistance_ohm_A2 * i * i / base->resistance_ohm),
        .load_return = coef_small_from_double(k->load_return),
        .angle_return =
            coef_small_from_double(k->angle_return_rad_Nm * base->torque_Nm / base->rad_per_turn),
        .bias_return =
            coef_small_from_double(k->bias_return_V_Nm * base->torque_Nm / base->voltage_V),
        .load_settle = coef_small_from_double(k->load_settle),
    };
    invariant_ekf_gain_set_fit_coefficients(&set);
    return set;
}

/* A settled hold takes the back-EMF of a rotor that creeps under a slow load for an offset, within
   some 1/w_h. When the rotor stops, that offset is wrong, and shows as a step of the load: only
   what has lasted as long as this is kept then. 0.1 to 1 s serve. */
#define BIAS_SETTLE_TIME_S 0.3
/* A load vibrates that has swung to the other side three times, or has made six steps, each no
   longer than this behind the one before, a cycle of 15 Hz and a half. Behind a step the rotor
   swings, too; a load that grows makes some to one side; a rotor of too much inertia is slower. */
#define VIBRATION_SWINGS 6u
#define VIBRATION_CALM_S 0.1
/* The mean change of a load that swings: over a cycle of 30 Hz. */
#define USUAL_CHANGE_TIME_S 0.03

enum { CALM_BLOCKS = (int)(VIBRATION_CALM_S / SYNCHRONISM_BLOCK_S) };
_Static_assert(CALM_BLOCKS < UINT8_MAX, "calm_blocks counts them");

/* 1 - exp(-x), x below 0.06, to 1e-7 of it: of constants, so by the compiler. */
#define FALLEN(x)               ((x) * (1.0 - (x) / 2.0 * (1.0 - (x) / 3.0 * (1.0 - (x) / 4.0))))
#define SHARE_PER_BLOCK(time_s) FALLEN(SYNCHRONISM_BLOCK_S / (time_s))

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
        .rest_periods = (uint16_t)hold->rest_periods,
        .swing_periods = (uint16_t)hold->swing_periods,
        .load_step = num_from_double(hold->load_step_Nm / base->torque_Nm),
        .feigned_share = coef_from_double(hold->feigned_share),
        .bias_settle = coef_small_from_double(SHARE_PER_BLOCK(BIAS_SETTLE_TIME_S)),
        .usual_memory = coef_from_double(SHARE_PER_BLOCK(USUAL_CHANGE_TIME_S)),
    };
    return params;
}

void invariant_ekf_reset(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         struct position position, num_t resistance, uint32_t unloaded_periods)
{
    estimate_reset(&ekf->estimate, &params->model, position, resistance);
    ekf->bias = (struct phases){NUM(0.0), NUM(0.0)};
    ekf->innovation_sum = NUM(0.0);
    ekf->adapted_sum = NUM(0.0);
    ekf->adapted_at = NUM(0.0);
    ekf->usual_change = NUM(0.0);
    ekf->swings = 0u;
    ekf->swung_up = false;
    ekf->calm_blocks = 0u;
    ekf->step_limit = params->load_step;
    ekf->unloaded_periods = unloaded_periods;
    ekf->swing_end =
        unloaded_periods > params->swing_periods ? unloaded_periods - params->swing_periods : 0u;
    ekf->settled_load = NUM(0.0);
    ekf->offset_load = NUM(0.0);
    ekf->settled_bias = ekf->bias;
    ekf->following_periods = 0u;
}

void invariant_ekf_settle(struct invariant_ekf *ekf, const struct invariant_ekf_params *params)
{
    invariant_ekf_carry_sum(ekf); /* that of motion */
    ekf->settled_load = ekf->estimate.rotor.load_torque;
    ekf->offset_load = ekf->settled_load;
    ekf->settled_bias = ekf->bias;
    ekf->following_periods = 0u;
    ekf->usual_change = params->load_step;
    ekf->step_limit = params->load_step + params->load_step;
    ekf->swings = VIBRATION_SWINGS;
    ekf->calm_blocks = CALM_BLOCKS;
}

/* `counts`: for so many swings, and two more if the load has swung to the other side. */
__attribute__((noinline)) static void note_swing(struct invariant_ekf *ekf, num_t away,
                                                 unsigned counts)
{
    unsigned swings = ekf->swings + counts;

    if ((away > NUM(0.0)) != ekf->swung_up) {
        ekf->swung_up = !ekf->swung_up;
        swings += 2u;
    }
    ekf->swings = (uint8_t)(swings < VIBRATION_SWINGS ? swings : VIBRATION_SWINGS);
    ekf->calm_blocks = CALM_BLOCKS;
}

void invariant_ekf_follow_step(struct invariant_ekf *ekf, const struct invariant_ekf_params *params)
{
    note_swing(ekf, invariant_ekf_away_from_settled_load(ekf), 1u);
    ekf->following_periods = params->following_periods + params->rest_periods;
    ekf->bias = ekf->settled_bias;
}

void invariant_ekf_settle_bias(struct invariant_ekf *ekf, const struct invariant_ekf_params *params)
{
    if (ekf->following_periods == 0u) {
        struct phases *settled = &ekf->settled_bias;

        settled->a += num_mul_small_nearest(ekf->bias.a - settled->a, params->bias_settle);
        settled->b += num_mul_small_nearest(ekf->bias.b - settled->b, params->bias_settle);
        ekf->offset_load +=
            num_mul_small_nearest(ekf->settled_load - ekf->offset_load, params->bias_settle);
    }
}

/* What an error of the resistance may make, on this side, of the q current that has come since the
   offset was found. */
static num_t feigned(const struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                     num_t away)
{
    const num_t more = num_mul_coef(ekf->settled_load - ekf->offset_load, params->feigned_share);

    return (away > NUM(0.0)) == (more > NUM(0.0)) ? num_abs(more) : NUM(0.0);
}

void invariant_ekf_watch_hold(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                              bool leads)
{
    const num_t away = invariant_ekf_away_from_settled_load(ekf);
    const num_t change = num_abs(away);

    if (ekf->following_periods <= params->rest_periods) {
        ekf->usual_change +=
            num_mul_coef(change + change + change - ekf->usual_change, params->usual_memory);
    }
    if (change > num_half(params->load_step)) {
        note_swing(ekf, away, 0u);
    } else if (ekf->calm_blocks > 0u && --ekf->calm_blocks == 0u) {
        ekf->swings = 0u;
    }
    ekf->step_limit = params->load_step + feigned(ekf, params, away) +
                      (leads || ekf->swings >= VIBRATION_SWINGS ? ekf->usual_change : NUM(0.0));
}

/* Behind its estimate is a rotor that springs back; of a light one's swing more than that would be
   too much. */
static void find_in_step(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         num_t innovation_d)
{
    struct outlook *expected = &ekf->estimate.next;
    const num_t turns =
        invariant_ekf_odd_turns(params, &params->following, expected->speed, innovation_d);
    const bool is_ahead = (turns > NUM(0.0)) == (expected->speed > NUM(0.0));

    expected->position =
        position_add(expected->position, angle_from_any_turns(is_ahead ? turns : num_half(turns)));
}

/* More than a sum of nu_d comes to in a few periods of a hold; fixed point multiplies no more. */
#define ADAPTING_SUM_MAX NUM(8.0)

void invariant_ekf_work_on_hold(struct invariant_ekf *ekf,
                                const struct invariant_ekf_params *params, bool leads)
{
    struct estimate *x = &ekf->estimate;
    const num_t sum = num_headroom(ekf->innovation_sum, ADAPTING_SUM_MAX);
    const num_t i_d = park(x->next.current, x->next.frame).d;
    const num_t mean = num_half(i_d + ekf->adapted_at);

    ekf->adapted_at = i_d;
    invariant_ekf_carry_sum(ekf);
    if (ekf->following_periods > params->rest_periods) {
        find_in_step(ekf, params, sum);
    }
    if (!leads) {
        const num_t change = num_mul_coef(num_mul(sum, mean), params->holding.resistance);

        winding_set_resistance(&x->winding, &params->model, x->winding.resistance + change);
    }
}

struct passage invariant_ekf_observe(struct invariant_ekf *ekf,
                                     const struct invariant_ekf_params *params,
                                     const struct estimator_input *input)
{
    return invariant_ekf_step(ekf, params, input->winding.current, input->surprise, input->in_force,
                              input->hold);
}
