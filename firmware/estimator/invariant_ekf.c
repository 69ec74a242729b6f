#include "firmware/estimator/invariant_ekf.h"

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
        .led_memory = coef_from_double(hold->led_load_memory),
    };
    return params;
}

/* The load a hold begins with is the one that was estimated in motion. */
static void settle(struct invariant_ekf *ekf)
{
    ekf->settled_load = ekf->estimate.rotor.load_torque;
    ekf->following_periods = 0;
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
    settle(ekf);
}

/* Current and rotor as the model has them at S(k). */
struct predicted {
    struct phases current;
    struct rotor rotor;
};

static struct predicted predict(const struct invariant_ekf *ekf,
                                const struct invariant_ekf_params *params, struct phases voltage)
{
    const struct estimate *x = &ekf->estimate;
    struct predicted next = {forced_current(&x->winding, x->free_current, voltage), x->rotor};
    const struct phases sum = {x->current.a + next.current.a, x->current.b + next.current.b};

    predict_rotor(&params->model, &next.rotor, num_half(park(sum, x->mid_period).q));
    return next;
}

/* Corrections that differ between motion and hold. */
struct correction {
    num_t turns;  /* of the angle */
    num_t bias_q; /* of the voltage offset, in the direction of the frame's q axis */
    num_t load_torque;
};

static struct correction correct_in_motion(const struct invariant_ekf_params *params, num_t speed,
                                           struct dq innovation)
{
    const struct invariant_ekf_gain_set *gain = &params->moving;
    const num_t direction = num_limit(speed, params->odd_gain_speed);
    const num_t odd = num_mul(innovation.d, num_mul_coef(direction, gain->angle_d));

    return (struct correction){.turns = odd + num_mul_coef(innovation.q, gain->angle_q),
                               .bias_q = num_mul_coef_nearest(odd, gain->bias_per_turn),
                               .load_torque = num_mul_coef(innovation.q, gain->load_q)};
}

/* `away`: of the load from the one settled at. */
static struct correction correct_in_hold(const struct invariant_ekf_gain_set *gain,
                                         struct dq innovation, num_t away)
{
    return (struct correction){
        .turns = num_mul_coef(innovation.q, gain->angle_q) + num_mul_coef(away, gain->angle_return),
        .bias_q = num_mul_coef_nearest(innovation.q, gain->bias_q) -
                  num_mul_coef_nearest(away, gain->bias_return),
        .load_torque =
            num_mul_coef(innovation.q, gain->load_q) - num_mul_coef(away, gain->load_return)};
}

static num_t away_from_settled_load(const struct invariant_ekf *ekf)
{
    return ekf->estimate.rotor.load_torque - ekf->settled_load;
}

/* Returns the innovation in the estimated rotor frame. */
static struct dq correct(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         const struct invariant_ekf_gain_set *gain,
                         const struct predicted *predicted, struct phases current, bool holding)
{
    struct estimate *x = &ekf->estimate;
    const struct rotor *rotor = &predicted->rotor;
    const struct phases error = {current.a - predicted->current.a,
                                 current.b - predicted->current.b};
    const struct sincos frame = estimate_end_of_period(x);
    const struct dq innovation = park(error, frame);
    const struct correction by =
        holding ? correct_in_hold(gain, innovation, away_from_settled_load(ekf))
                : correct_in_motion(params, rotor->speed, innovation);

    x->current.a = predicted->current.a + num_mul_coef(error.a, gain->current);
    x->current.b = predicted->current.b + num_mul_coef(error.b, gain->current);
    x->rotor.speed = rotor->speed + num_mul_coef(innovation.q, gain->speed_q);
    x->rotor.position = position_add(rotor->position, angle_from_any_turns(by.turns));
    x->rotor.load_torque = rotor->load_torque + by.load_torque;
    ekf->bias.a -= num_mul_unit_nearest(by.bias_q, frame.sin);
    ekf->bias.b += num_mul_unit_nearest(by.bias_q, frame.cos);
    return innovation;
}

static void adapt_resistance(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                             const struct invariant_ekf_gain_set *gain, num_t innovation_d)
{
    struct estimate *x = &ekf->estimate;
    const num_t i_d = park(x->current, x->mid_period).d;
    const num_t change = num_mul_coef(num_mul(innovation_d, i_d), gain->resistance);

    winding_set_resistance(&x->winding, &params->model, x->winding.resistance + change);
}

/* By how much the change of the load is more than twice what it has been of late: a rotor that is
   led passes its detent torque. */
static num_t beyond_detent(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                           num_t change)
{
    const num_t beyond = change - ekf->led_change;

    ekf->led_change += num_mul_coef(change + beyond, params->led_memory);
    return beyond;
}

/* Which of the sets of gains serves this period of the hold. */
static const struct invariant_ekf_gain_set *
hold_gains(struct invariant_ekf *ekf, const struct invariant_ekf_params *params, bool leads)
{
    if (ekf->unloaded_periods > 0u) {
        ekf->unloaded_periods--;
        if (ekf->unloaded_periods == ekf->swing_end) { /* the back-EMF was taken for an offset */
            ekf->bias = (struct phases){NUM(0.0), NUM(0.0)};
        }
        return &params->unloaded;
    }

    const num_t away = away_from_settled_load(ekf);
    const num_t change = leads ? beyond_detent(ekf, params, num_abs(away)) : num_abs(away);

    if (change > params->load_step &&
        (ekf->following_periods == 0u || num_half(change) > params->load_step)) {
        ekf->following_periods = params->following_periods + params->rest_periods;
    }
    if (ekf->following_periods == 0u) {
        return &params->holding;
    }
    ekf->following_periods--;
    if (ekf->following_periods < params->rest_periods) {
        return &params->holding;
    }
    ekf->settled_load += num_mul_coef(away, params->following.load_settle);
    return &params->following;
}

void invariant_ekf_step(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                        struct phases current, struct phases voltage, struct rotor_hold hold)
{
    const bool holding = hold.active;
    const struct invariant_ekf_gain_set *gain =
        holding ? hold_gains(ekf, params, *hold.leads) : &params->moving;
    const struct phases driving = {voltage.a - ekf->bias.a, voltage.b - ekf->bias.b};
    const struct predicted predicted = predict(ekf, params, driving);
    const struct dq innovation = correct(ekf, params, gain, &predicted, current, holding);

    ekf->innovation_sum = num_add_around(ekf->innovation_sum, innovation.d);
    if (!holding) {
        settle(ekf);
    } else if (!*hold.leads) { /* a led rotor's lag behind its frame shows in nu_d, too */
        adapt_resistance(ekf, params, gain, innovation.d);
    }
    estimate_look_ahead(&ekf->estimate, &params->model);
}
