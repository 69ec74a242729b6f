#include "firmware/control/detent_compensation.h"

#include <stddef.h>

/* k per electrical turn: nine tenths are learned in eight turns, a fifth of a turn of the shaft. */
static const double learning_per_turn = 0.3;

/* k_m: fast against the learning, slow against the first harmonic, whose phase it leads by 9 deg.
 */
static const double mean_per_turn = 1.0;

/* Learning ends at this frequency of a harmonic over the observer's bandwidth: its delay of three
   time constants is then still within a tenth of a period of its phase. */
static const double learning_share = 1.0;

/* Compensation ends at this angle of a harmonic per control period. */
static const double playing_rad_per_period = 0.6;

/*
 * Scales that keep resolution in fixed point: coefficients and travel are held this much larger. A
 * coefficient is below 0.11, so 32 keeps the sum of a pair below 7 and 2^-26/32 is one part in
 * 10^8 of it; a period's travel is below 0.03 turn while learning.
 */
#define TORQUE_SCALE 32.0
#define TRAVEL_SCALE 64.0
#define TRAVEL_MAX   NUM(1.9)

static const double sqrt_2 = 1.41421356237309504880;

struct detent_compensation_params
detent_compensation_design(const struct detent_compensation_task *task)
{
    const struct motor_params *motor = task->motor;
    const struct per_unit *base = task->base;
    const double bandwidth = task->observer_bandwidth_rad_s;
    const double electrical_rad_s = (double)motor->rotor_teeth * base->speed_rad_s;
    const double limit = DETENT_SHARE_MAX * sqrt_2 * motor->rated_current_A / base->current_A;
    /* three time constants of the observer, half a period of its sampling, one of the prediction */
    const double lag_periods = 3.0 / (bandwidth * task->period_s) + 1.5;

    return (struct detent_compensation_params){
        .travel = coef_from_double(TRAVEL_SCALE * base->turns_per_period),
        .lag = coef_from_double(lag_periods * base->turns_per_period),
        .rate = coef_from_double(2.0 * learning_per_turn * TORQUE_SCALE / TRAVEL_SCALE),
        .mean_rate = coef_from_double(mean_per_turn / TRAVEL_SCALE),
        .learning_fade = coef_from_double(2.0 * electrical_rad_s / (learning_share * bandwidth)),
        .playing_fade =
            coef_from_double(2.0 * electrical_rad_s * task->period_s / playing_rad_per_period),
        .torque = coef_from_double(1.0 / TORQUE_SCALE),
        .lag_limit = NUM(0.49),
        .residual_limit = num_from_double(limit),
        .limit = num_from_double(limit * TORQUE_SCALE),
    };
}

void detent_compensation_set(struct detent_compensation *detent,
                             const struct detent_compensation_params *params,
                             const struct per_unit *base,
                             const double torque_Nm[DETENT_COEFFICIENTS])
{
    for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
        detent->coefficient[i] = num_limit(
            num_from_double(torque_Nm[i] / base->torque_Nm * TORQUE_SCALE), params->limit);
    }
    detent_compensation_reset(detent);
}

void detent_compensation_get(const struct detent_compensation *detent, const struct per_unit *base,
                             double torque_Nm[DETENT_COEFFICIENTS])
{
    for (int i = 0; i < DETENT_COEFFICIENTS; i++) {
        torque_Nm[i] = num_to_double(detent->coefficient[i]) / TORQUE_SCALE * base->torque_Nm;
    }
}

void detent_compensation_reset(struct detent_compensation *detent)
{
    detent->mean = NUM(0.0);
    detent->torque = NUM(0.0);
}

static struct sincos doubled(struct sincos x)
{
    return sincos_add(x, x);
}

static struct detent_harmonics harmonics_of(struct sincos frame)
{
    const struct sincos second = doubled(frame);

    return (struct detent_harmonics){{frame, second, doubled(second)}};
}

/* 1 up to x = 1, half of where a harmonic fades out, and 0 from x = 2 on. */
static num_t share(num_t x)
{
    return num_clamp(NUM(2.0) - x, NUM(0.0), NUM(1.0));
}

/* a cos + b sin of one harmonic; scaled. */
static num_t played(const struct detent_compensation *detent, const struct detent_harmonics *now,
                    size_t harmonic)
{
    const struct sincos *h = &now->of[harmonic];
    const num_t *c = &detent->coefficient[2u * harmonic];

    return num_mul_unit(c[0], h->cos) + num_mul_unit(c[1], h->sin);
}

static void learn(struct detent_compensation *detent,
                  const struct detent_compensation_params *params,
                  const struct detent_harmonics *then, size_t harmonic, num_t step)
{
    const struct sincos *h = &then->of[harmonic];
    num_t *c = &detent->coefficient[2u * harmonic];

    c[0] = num_limit(c[0] + num_mul_unit(step, h->cos), params->limit);
    c[1] = num_limit(c[1] + num_mul_unit(step, h->sin), params->limit);
}

void detent_compensation_step(struct detent_compensation *detent,
                              const struct detent_compensation_params *params, angle_t angle,
                              struct sincos frame, num_t speed, num_t load_torque)
{
    const num_t pace = num_abs(speed);
    const num_t travel = num_clamp(num_mul_coef(pace, params->travel), NUM(0.0), TRAVEL_MAX);
    const num_t lag = num_limit(num_mul_coef(speed, params->lag), params->lag_limit);
    const num_t residual = num_limit(load_torque - detent->mean, params->residual_limit);
    const num_t step = num_mul(num_mul_coef(residual, params->rate), travel);
    num_t learning = num_clamp(num_mul_coef(pace, params->learning_fade), NUM(0.0), NUM(2.0));
    num_t playing = num_clamp(num_mul_coef(pace, params->playing_fade), NUM(0.0), NUM(2.0));
    const struct detent_harmonics now = harmonics_of(frame);
    const struct detent_harmonics then =
        harmonics_of(sincos_of(angle - (angle_t)angle_from_turns(lag)));
    num_t torque = NUM(0.0);

    detent->mean += num_mul(num_mul_coef(residual, params->mean_rate), travel);
    for (size_t i = 0; i < DETENT_HARMONICS; i++) {
        learn(detent, params, &then, i, num_mul(step, share(learning)));
        torque += num_mul(played(detent, &now, i), share(playing));
        learning += learning; /* of twice the harmonic */
        playing += playing;
    }
    detent->torque = num_mul_coef(torque, params->torque);
}
