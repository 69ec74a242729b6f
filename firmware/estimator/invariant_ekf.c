#include "firmware/estimator/invariant_ekf.h"

/*
 * The mean innovation of a quiet hold is 1.2 mA rms at 6 A base (12-bit codes, 3 mA and 20 mV rms
 * of noise); a load step of a fifth of the rated torque passes 4 mA within a millisecond.
 */
#define LOAD_STEP_INNOVATION NUM(0.004 / 6.0)
#define INNOVATION_SHARE     UNIT(0.1)
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

static void reset_hold(struct invariant_ekf *ekf)
{
    ekf->bias.d = NUM(0.0);
    ekf->bias.q = NUM(0.0);
    ekf->innovation_mean = NUM(0.0);
    ekf->following_periods = 0;
}

void invariant_ekf_reset(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         struct position position, num_t resistance)
{
    estimate_reset(&ekf->estimate, &params->model, position, resistance);
    reset_hold(ekf);
}

static void predict(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                    struct phases voltage)
{
    struct estimate *x = &ekf->estimate;
    const struct phases next = forced_current(&x->winding, x->free_current, voltage);
    const struct phases sum = {x->current.a + next.a, x->current.b + next.b};

    predict_rotor(&params->model, &x->rotor, num_half(park(sum, x->mid_period).q));
    x->current = next;
}

/* Returns the innovation in the estimated rotor frame. */
static struct dq correct(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         const struct invariant_ekf_gain_set *gain, struct phases current)
{
    struct estimate *x = &ekf->estimate;
    const struct phases error = {current.a - x->current.a, current.b - x->current.b};
    const struct dq innovation = park(error, estimate_end_of_period(x));
    const num_t direction = num_limit(x->rotor.speed, params->odd_gain_speed);
    const num_t turns = num_mul(innovation.d, num_mul_coef(direction, gain->angle_d)) +
                        num_mul_coef(innovation.q, gain->angle_q);

    x->current.a += num_mul_coef(error.a, gain->current);
    x->current.b += num_mul_coef(error.b, gain->current);
    x->rotor.speed += num_mul_coef(innovation.q, gain->speed_q);
    x->rotor.position = position_add(x->rotor.position, angle_from_any_turns(turns));
    x->rotor.load_torque += num_mul_coef(innovation.q, gain->load_q);
    return innovation;
}

static void adapt_resistance(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                             const struct invariant_ekf_gain_set *gain)
{
    struct estimate *x = &ekf->estimate;
    const num_t i_d = park(x->current, x->mid_period).d;
    const num_t change = num_mul_coef(num_mul(ekf->bias.d, i_d), gain->resistance);

    winding_set_resistance(&x->winding, &params->model, x->winding.resistance + change);
}

/* Which of the two sets of gains serves this period of the hold. */
static const struct invariant_ekf_gain_set *hold_gains(struct invariant_ekf *ekf,
                                                       const struct invariant_ekf_params *params)
{
    if (num_abs(ekf->innovation_mean) > LOAD_STEP_INNOVATION) {
        ekf->following_periods = FOLLOWING_PERIODS;
    }
    if (ekf->following_periods == 0u) {
        return &params->holding;
    }
    ekf->following_periods--;
    return &params->following;
}

/* The voltage bias and what follows from it can be told apart from the back-EMF only at rest. */
static struct phases without_bias(const struct invariant_ekf *ekf, struct phases voltage)
{
    const struct phases bias = inverse_park(ekf->bias, ekf->estimate.mid_period);
    const struct phases driving = {voltage.a - bias.a, voltage.b - bias.b};

    return driving;
}

static void correct_hold(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                         const struct invariant_ekf_gain_set *gain, struct dq innovation)
{
    struct rotor *rotor = &ekf->estimate.rotor;

    rotor->load_torque -= num_mul_coef(rotor->load_torque, gain->load_leak);
    ekf->innovation_mean += num_mul_unit(innovation.q - ekf->innovation_mean, INNOVATION_SHARE);
    ekf->bias.d =
        num_mul_coef(ekf->bias.d, gain->bias_decay) + num_mul_coef(innovation.d, gain->bias_d);
    ekf->bias.q =
        num_mul_coef(ekf->bias.q, gain->bias_decay) + num_mul_coef(innovation.q, gain->bias_q);
    adapt_resistance(ekf, params, gain);
}

void invariant_ekf_step(struct invariant_ekf *ekf, const struct invariant_ekf_params *params,
                        struct phases current, struct phases voltage, bool holding)
{
    const struct invariant_ekf_gain_set *gain = holding ? hold_gains(ekf, params) : &params->moving;
    const struct phases driving = holding ? without_bias(ekf, voltage) : voltage;
    struct dq innovation;

    predict(ekf, params, driving);
    innovation = correct(ekf, params, gain, current);
    if (holding) {
        correct_hold(ekf, params, gain, innovation);
    } else {
        reset_hold(ekf);
    }
    estimate_look_ahead(&ekf->estimate, &params->model);
}
