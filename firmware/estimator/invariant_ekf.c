#include "firmware/estimator/invariant_ekf.h"

/*
 * The mean innovation of a quiet hold is 1.2 mA rms at 6 A base (12-bit codes, 3 mA and 20 mV rms
 * of noise); a load step of a fifth of the rated torque passes 4 mA within a millisecond.
 */
#define LOAD_STEP_INNOVATION NUM(0.004 / 6.0)
#define INNOVATION_SHARE     NUM(0.1)
#define FOLLOWING_PERIODS    100u

static struct invariant_ekf_gain_set scale(const struct per_unit *base,
                                           const struct invariant_ekf_gains *k)
{
    const double i = base->current_A;
    const double turns_per_current = i / base->rad_per_turn;
    const double full_speed = k->angle_d_full_speed_rad_s / base->speed_rad_s;
    const struct invariant_ekf_gain_set set = {
        .current = coef_from_double(0.5 * (k->k_current_d + k->k_current_q)),
        .speed_q = coef_from_double(k->k_speed_q_rad_As * i / base->speed_rad_s),
        .angle_d = coef_from_double(k->k_angle_d_rad_A * turns_per_current / full_speed),
        .angle_q = coef_from_double(k->k_angle_q_rad_A * turns_per_current),
        .load_q = coef_from_double(k->k_load_q_Nm_A * i / base->torque_Nm),
        .load_leak = coef_from_double(1.0 - k->load_decay),
        .bias_decay = coef_from_double(k->bias_decay),
        .bias_d = coef_from_double(k->k_bias_d_V_A / base->resistance_ohm),
        .bias_q = coef_from_double(k->k_bias_q_V_A / base->resistance_ohm),
        .resistance = coef_from_double(k->k_resistance_ohm_AV * i * i),
    };
    return set;
}

struct invariant_ekf_params invariant_ekf_scale(const struct motor_model_params *model,
                                                const struct per_unit *base,
                                                const struct invariant_ekf_gains *moving,
                                                const struct invariant_ekf_gains *holding,
                                                const struct invariant_ekf_gains *following)
{
    const struct invariant_ekf_params params = {
        .model = *model,
        .moving = scale(base, moving),
        .holding = scale(base, holding),
        .following = scale(base, following),
        .odd_gain_speed = num_from_double(moving->angle_d_full_speed_rad_s / base->speed_rad_s),
    };
    return params;
}

void invariant_ekf_reset(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         struct position position, num_t resistance)
{
    const struct dq no_bias = {NUM(0.0), NUM(0.0)};

    estimate_reset(&ekf->estimate, &params->model, position, resistance);
    ekf->bias = no_bias;
    ekf->innovation_mean = NUM(0.0);
    ekf->following_periods = 0;
}

static void predict(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                    struct phases voltage)
{
    struct estimate *x = &ekf->estimate;
    struct phases bias = inverse_park(ekf->bias, x->mid_period);
    struct phases driving = {voltage.a - bias.a, voltage.b - bias.b};
    struct phases next = forced_current(&x->winding, x->free_current, driving);
    struct phases mean = {num_half(x->current.a + next.a), num_half(x->current.b + next.b)};

    predict_rotor(&params->model, &x->rotor, park(mean, x->mid_period).q);
    x->current = next;
}

static void correct(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                    const struct invariant_ekf_gain_set *gain, struct phases current)
{
    struct estimate *x = &ekf->estimate;
    struct phases error = {current.a - x->current.a, current.b - x->current.b};
    struct dq innovation = park(error, estimate_end_of_period(x));
    num_t direction = num_limit(x->rotor.speed, params->odd_gain_speed);
    ekf->innovation_mean += num_mul(innovation.q - ekf->innovation_mean, INNOVATION_SHARE);
    num_t turns = num_mul_coef(num_mul(direction, innovation.d), gain->angle_d) +
                  num_mul_coef(innovation.q, gain->angle_q);

    x->current.a += num_mul_coef(error.a, gain->current);
    x->current.b += num_mul_coef(error.b, gain->current);
    x->rotor.speed += num_mul_coef(innovation.q, gain->speed_q);
    x->rotor.position = position_add(x->rotor.position, angle_from_any_turns(turns));
    x->rotor.load_torque += num_mul_coef(innovation.q, gain->load_q) -
                            num_mul_coef(x->rotor.load_torque, gain->load_leak);
    ekf->bias.d =
        num_mul_coef(ekf->bias.d, gain->bias_decay) + num_mul_coef(innovation.d, gain->bias_d);
    ekf->bias.q =
        num_mul_coef(ekf->bias.q, gain->bias_decay) + num_mul_coef(innovation.q, gain->bias_q);
}

static void adapt_resistance(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                             const struct invariant_ekf_gain_set *gain)
{
    struct estimate *x = &ekf->estimate;
    num_t i_d = park(x->current, x->mid_period).d;
    num_t change = num_mul_coef(num_mul(i_d, ekf->bias.d), gain->resistance);

    winding_set_resistance(&x->winding, &params->model, x->winding.resistance + change);
}

/* Which gains serve this period. */
static const struct invariant_ekf_gain_set *
select_gains(struct invariant_ekf *ekf, const struct invariant_ekf_params *params, bool holding)
{
    if (!holding) {
        ekf->following_periods = 0;
        return &params->moving;
    }
    if (num_abs(ekf->innovation_mean) > LOAD_STEP_INNOVATION) {
        ekf->following_periods = FOLLOWING_PERIODS;
    }
    if (ekf->following_periods == 0u) {
        return &params->holding;
    }
    ekf->following_periods--;
    return &params->following;
}

void invariant_ekf_step(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                        struct phases current, struct phases voltage, bool holding)
{
    const struct invariant_ekf_gain_set *gain = select_gains(ekf, params, holding);

    predict(ekf, params, voltage);
    correct(ekf, params, gain, current);
    if (holding) {
        adapt_resistance(ekf, params, gain);
    }
    estimate_look_ahead(&ekf->estimate, &params->model);
}
