#include "firmware/estimator/encoder_observer.h"

#include "firmware/design/loop_bandwidth.h"
#include "firmware/design/elementary.h"

/* A step of the angle by x shows as a speed of up to 0.8 w_o x behind a triple pole: the most of
   w_o x (3 s - s^2) e^-s. Of the speed base, supply / Km, one count may feign this share. */
static const double rad_per_turn = 6.283185307179586;
#define COUNT_SPEED     0.8
#define COUNT_SPEED_MAX 0.45

bool encoder_observer_design(struct encoder_observer_params *params,
                             const struct motor_model_params *model,
                             const struct encoder_observer_task *task,
                             char error[DESIGN_ERROR_TEXT])
{
    const struct per_unit *base = task->base;
    const double period_s = task->period_s;

    if (task->counts_per_turn < 4u * (uint32_t)task->rotor_teeth) {
        return design_refuse_limit(error, (struct refusal){.quantity = "encoder counts per turn",
                                                           .value = (double)task->counts_per_turn,
                                                           .relation = "at least",
                                                           .limit = 4.0 * task->rotor_teeth,
                                                           .unit = "",
                                                           .reason = "four per rotor tooth"});
    }
    if (!design_require_positive(error, "observer_bandwidth_rad_s", task->bandwidth_rad_s,
                                 "rad/s")) {
        return false;
    }
    if (task->bandwidth_rad_s * period_s > ENCODER_OBSERVER_PERIOD_MAX) {
        return design_refuse_limit(error,
                                   (struct refusal){.quantity = "observer_bandwidth_rad_s",
                                                    .value = task->bandwidth_rad_s,
                                                    .relation = "at most",
                                                    .limit = ENCODER_OBSERVER_PERIOD_MAX / period_s,
                                                    .unit = "rad/s",
                                                    .reason = "0.5 per control period"});
    }
    if (!design_require_within(error, "encoder_count_speed",
                               COUNT_SPEED * task->bandwidth_rad_s * rad_per_turn /
                                   (double)task->counts_per_turn,
                               0.0, COUNT_SPEED_MAX * base->speed_rad_s, "rad/s",
                               "0.45 of supply / Km: more counts, or less "
                               "observer_bandwidth_rad_s")) {
        return false;
    }
    /* 1 - p by its series' sum, exact for small w_o T */
    const double x = task->bandwidth_rad_s * period_s;
    const double q = x * exponential_phi1(-x);
    const double p = 1.0 - q;
    const double speed_per_turn = base->rad_per_turn / base->speed_rad_s / period_s;
    const double acceleration_per_turn =
        base->rad_per_turn / (base->acceleration_rad_s2 * period_s * period_s);

    params->model = *model;
    params->encoder = encoder_design(task->rotor_teeth, task->counts_per_turn);
    params->gain_angle = coef_from_double(q * (1.0 + p + p * p));
    params->gain_speed = coef_from_double(1.5 * q * q * (1.0 + p) * speed_per_turn);
    params->gain_load = coef_from_double(q * q * q * acceleration_per_turn);
    params->gain_resistance = coef_from_double(0.0);
    if (task->resistance_adaptation_s > 0.0) {
        const double current = task->hold_current_A / base->current_A;
        const double admittance = num_to_double(model->nominal_admittance);

        params->gain_resistance = coef_from_double(
            period_s / (task->resistance_adaptation_s * admittance * current * current));
    }
    return true;
}

void encoder_observer_reset(struct encoder_observer *observer,
                            const struct encoder_observer_params *params, struct position position,
                            num_t load_torque, num_t resistance, int32_t count)
{
    encoder_set(&observer->encoder, position, count);
    estimate_reset(&observer->estimate, &params->model, position, resistance);
    observer->estimate.rotor.load_torque = load_torque;
    observer->known_torque = NUM(0.0);
}

void encoder_observer_place(struct encoder_observer *observer, struct position position,
                            int32_t count)
{
    struct rotor *rotor = &observer->estimate.rotor;

    encoder_set(&observer->encoder, position, count);
    rotor->position = position;
    rotor->speed = NUM(0.0);
    rotor->load_torque = park(observer->estimate.current, sincos_of(position.fraction)).q;
}

static void adapt_resistance(struct estimate *x, const struct encoder_observer_params *params,
                             struct phases current, struct phases surprise)
{
    const struct phases expected = forced_current(&x->winding, x->next.current, surprise);
    const num_t along =
        num_mul(current.a - expected.a, current.a) + num_mul(current.b - expected.b, current.b);

    winding_set_resistance(&x->winding, &params->model,
                           x->winding.resistance - num_mul_coef(along, params->gain_resistance));
}

/* By how much the rotor is faster than predicted, as the current is another. To nearest, as are its
   turns: what a floor left would be taken for a speed. */
static num_t speed_of_current(const struct estimate *x, const struct motor_model_params *model,
                              struct phases current)
{
    const struct phases error = {current.a - x->next.current.a, current.b - x->next.current.b};

    return num_mul_coef_nearest(num_half(park(error, x->next.frame).q), model->speed_per_torque);
}

static void correct(struct encoder_observer *observer, const struct encoder_observer_params *params,
                    struct phases current, int32_t count)
{
    struct estimate *x = &observer->estimate;
    const struct position measured = encoder_step(&observer->encoder, &params->encoder, count);
    const num_t more_speed = speed_of_current(x, &params->model, current);
    const num_t more_turns = num_mul_coef_nearest(more_speed, params->model.half_turns_per_speed);
    const num_t innovation =
        num_limit(position_difference(measured, x->next.position) - more_turns, NUM(0.25));

    x->rotor.position =
        position_add(x->next.position,
                     angle_from_turns(more_turns + num_mul_coef(innovation, params->gain_angle)));
    x->rotor.speed = x->next.speed + more_speed + num_mul_coef(innovation, params->gain_speed);
    x->rotor.load_torque -= num_mul_coef(innovation, params->gain_load);
    x->current = current;
}

/* Compiled into both its places. */
__attribute__((always_inline)) static inline struct passage
predict(struct encoder_observer *observer, const struct encoder_observer_params *params,
        struct phases voltage)
{
    struct estimate *x = &observer->estimate;
    const struct passage passage = estimate_predict_current(x, &params->model, voltage);

    estimate_predict_rotor(x, &params->model,
                           estimate_mean_of_ends(x, passage) - observer->known_torque);
    return passage;
}

struct passage encoder_observer_predict(struct encoder_observer *observer,
                                        const struct encoder_observer_params *params,
                                        struct phases voltage)
{
    return predict(observer, params, voltage);
}

struct passage encoder_observer_step(struct encoder_observer *observer,
                                     const struct encoder_observer_params *params,
                                     struct phases current, struct phases surprise,
                                     struct phases in_force, int32_t count, bool holding)
{
    if (holding) {
        adapt_resistance(&observer->estimate, params, current, surprise);
    }
    correct(observer, params, current, count);
    return predict(observer, params, in_force);
}

void encoder_observer_set_known_torque(struct encoder_observer *observer,
                                       const struct encoder_observer_params *params, num_t torque)
{
    const num_t half_more = num_half(torque - observer->known_torque);

    observer->estimate.next.speed -= num_mul_coef(half_more, params->model.speed_per_torque);
    observer->known_torque = torque;
}
