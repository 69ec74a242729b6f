#include "firmware/control/detent_compensation.h"

#include "firmware/design/elementary.h"
#include <stddef.h>

/* k per electrical turn: nine tenths are learned in four turns, 1/12 turn of the shaft. */
#define LEARNING_PER_TURN 0.6

/* k_m: a small load step is soon none of the residual; the first harmonic's phase leads by 26 deg.
 */
#define MEAN_PER_TURN 3.0

/* Learning ends at this frequency of a harmonic over the observer's bandwidth: its delay of three
   time constants is then still within a tenth of a period of its phase. */
static const double learning_share = 1.0;

/* Of the observer's triple pole: a step is within 0.3 % then. */
#define SETTLING_TIME_CONSTANTS 10.0

/* Compensation ends at this angle of a harmonic per control period. */
static const double playing_rad_per_period = 0.6;

/*
 * Scales that keep resolution in fixed point: coefficients and travel are held this much larger. A
 * coefficient is below 0.11, so 32 keeps the sum of a pair below 7 and 2^-26/32 is one part in
 * 10^8 of it; a period's travel is below 0.03 turn while learning.
 */
#define TORQUE_SCALE 32.0
#define TRAVEL_SCALE 64.0
#define WAY_MAX      ((int32_t)(1.9 / TRAVEL_SCALE * 4294967296.0))

#define MEAN_PACE     UNIT(MEAN_PER_TURN / TRAVEL_SCALE)
#define LEARNING_PACE UNIT(2.0 * LEARNING_PER_TURN * TORQUE_SCALE / TRAVEL_SCALE)

/* Electrical turns; below half a turn. */
#define LAG_MAX NUM(0.49)

/* Play in electrical turns, each way: of counts, and of noise. */
static const double play_counts = 1.25;
static const double play_min = 1.0 / 64.0;

/* Per-unit speed; its eightfold is within the number range. */
#define SPEED_MAX 3.9
/* Of the fourth harmonic; what fades out beyond never does. */
#define FADE_MAX (4.0 * SPEED_MAX)

static const double sqrt_2 = 1.41421356237309504880;

/* zero: the per-unit speed at which the share reaches 0. */
static struct detent_fade fade_out(double zero)
{
    return (struct detent_fade){num_from_double(0.5 * zero < FADE_MAX ? 0.5 * zero : FADE_MAX),
                                coef_from_double(2.0 / zero)};
}

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
    const double counts = task->counts_per_turn > 0u ? play_counts * (double)motor->rotor_teeth /
                                                           (double)task->counts_per_turn
                                                     : 0.0;

    return (struct detent_compensation_params){
        .play = angle_from_turns(num_from_double(larger(counts, play_min))),
        .lag = coef_from_double(lag_periods * base->turns_per_period),
        .learning = fade_out(learning_share * bandwidth / electrical_rad_s),
        .playing = fade_out(playing_rad_per_period / (electrical_rad_s * task->period_s)),
        .residual_limit = num_from_double(limit),
        .settling_periods = (uint32_t)(SETTLING_TIME_CONSTANTS / (bandwidth * task->period_s)),
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
    detent->followed = false;
    detent->unsettled_periods = 0;
}

/* How far the angle takes its follower along behind the play, 2^-32 turn; no matter which way. */
static int32_t way(struct detent_compensation *detent,
                   const struct detent_compensation_params *params, angle_t angle)
{
    const int32_t away = (int32_t)(angle - detent->follower);
    int32_t beyond = 0;

    if (!detent->followed) {
        detent->followed = true;
        detent->follower = angle;
    } else if (away > params->play) {
        beyond = away - params->play;
    } else if (away < -params->play) {
        beyond = away + params->play;
    }
    detent->follower += (angle_t)beyond;
    return beyond < 0 ? -beyond : beyond;
}

static struct sincos doubled(struct sincos x)
{
    return sincos_add(x, x);
}

/* The harmonics fade one after the other, so that no period pays for more than one product. */
static num_t faded(num_t whole, num_t speed, const struct detent_fade *fade)
{
    if (speed <= fade->speed) {
        return whole;
    }
    return speed < fade->speed + fade->speed
               ? num_mul(whole, NUM(2.0) - num_mul_coef(speed, fade->slope))
               : NUM(0.0);
}

/* a cos + b sin of one harmonic; scaled. */
static num_t played(const num_t coefficient[2], struct sincos harmonic)
{
    return num_mul_unit(coefficient[0], harmonic.cos) + num_mul_unit(coefficient[1], harmonic.sin);
}

static void learn(num_t coefficient[2], struct sincos harmonic, num_t step, num_t limit)
{
    coefficient[0] = num_limit(coefficient[0] + num_mul_unit(step, harmonic.cos), limit);
    coefficient[1] = num_limit(coefficient[1] + num_mul_unit(step, harmonic.sin), limit);
}

static num_t scaled_turns(int32_t gone)
{
    const num_t turns = turns_from_angle((gone < WAY_MAX ? gone : WAY_MAX) * 16); /* of 64 */

    return turns + turns + turns + turns;
}

/* All coefficients, from what the observer has seen at an angle of some time ago. */
static void learn_all(struct detent_compensation *detent,
                      const struct detent_compensation_params *params, angle_t angle, num_t speed,
                      num_t pace, int32_t gone, num_t load_torque)
{
    const num_t residual = load_torque - detent->mean;

    if (num_abs(residual) > params->residual_limit) {
        detent->unsettled_periods = params->settling_periods;
    }
    if (detent->unsettled_periods > 0u) {
        detent->unsettled_periods--;
        detent->mean = load_torque;
        return;
    }
    const num_t travel = scaled_turns(gone);
    const num_t lag = num_limit(num_mul_coef(speed, params->lag), LAG_MAX);
    const num_t step = num_mul(num_mul_unit(residual, LEARNING_PACE), travel);
    struct sincos then = sincos_of(angle - (angle_t)angle_from_turns(lag));
    num_t pace_of_harmonic = pace;

    detent->mean += num_mul(num_mul_unit(residual, MEAN_PACE), travel);
    for (int i = 0; i < DETENT_COEFFICIENTS; i += 2) {
        learn(&detent->coefficient[i], then, faded(step, pace_of_harmonic, &params->learning),
              params->limit);
        then = doubled(then);
        pace_of_harmonic += pace_of_harmonic;
    }
}

void detent_compensation_step(struct detent_compensation *detent,
                              const struct detent_compensation_params *params, angle_t angle,
                              struct sincos frame, num_t speed, num_t load_torque, bool learns)
{
    struct sincos now = frame;
    num_t torque = NUM(0.0);
    num_t pace_of_harmonic = num_abs(num_limit(speed, NUM(SPEED_MAX)));
    const int32_t gone = learns ? way(detent, params, angle) : 0;

    if (gone > 0) {
        learn_all(detent, params, angle, speed, pace_of_harmonic, gone, load_torque);
    }
    for (int i = 0; i < DETENT_COEFFICIENTS; i += 2) {
        torque += faded(played(&detent->coefficient[i], now), pace_of_harmonic, &params->playing);
        now = doubled(now);
        pace_of_harmonic += pace_of_harmonic;
    }
    detent->torque = num_mul_unit(torque, UNIT(1.0 / TORQUE_SCALE));
}
