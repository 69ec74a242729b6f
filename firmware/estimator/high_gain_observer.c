#include "firmware/estimator/high_gain_observer.h"

#include "firmware/design/small_matrix.h"

/* alpha of the paper: (s + 2)(s + 5)(s + 10) */
static const double alpha[3] = {17.0, 80.0, 100.0};

#define EPSILON_PERIOD_MIN 0.01

/* z3 eps^2 never exceeds this for an initial error of one. */
#define PEAK 4.3

/* Error from which the observer may start: a full step. */
#define INITIAL_ERROR_TURNS 0.25

/* e^(A tau) and, in the fourth column, the integral of e^(A s) e1 over 0...tau. */
static void transition_over(double tau, struct matrix *transition)
{
    enum { SQUARINGS = 16 };
    const double scale = tau / (double)(1 << SQUARINGS);
    struct matrix a = {{{0.0}}};
    struct matrix other;

    for (int row = 0; row < 3; row++) {
        a.at[row][0] = -alpha[row] * scale;
    }
    a.at[0][1] = scale;
    a.at[1][2] = scale;
    a.at[0][3] = scale;
    matrix_exponential(4, &a, transition);
    for (int i = 0; i < SQUARINGS; i++) {
        other = *transition;
        matrix_multiply(4, &other, &other, transition);
    }
}

bool high_gain_observer_design(struct high_gain_observer_params *params,
                               const struct motor_model_params *model,
                               const struct high_gain_observer_task *task,
                               char error[DESIGN_ERROR_TEXT])
{
    const struct per_unit *base = task->base;
    const double epsilon_s = task->epsilon_s;
    const double speed_per_turn = base->rad_per_turn / base->speed_rad_s / epsilon_s;
    const double acceleration_per_turn =
        base->rad_per_turn / base->acceleration_rad_s2 / (epsilon_s * epsilon_s);
    const double peak = PEAK * INITIAL_ERROR_TURNS * acceleration_per_turn;
    struct matrix transition;

    if (!(epsilon_s >= EPSILON_PERIOD_MIN * task->period_s)) {
        return design_refuse_limit(error,
                                   (struct refusal){.quantity = "high_gain_epsilon_s",
                                                    .value = epsilon_s,
                                                    .relation = "at least",
                                                    .limit = EPSILON_PERIOD_MIN * task->period_s,
                                                    .unit = "s",
                                                    .reason = "0.01 control period"});
    }
    if (peak > NUM_MAX) {
        return design_refuse_limit(error,
                                   (struct refusal){.quantity = "acceleration of the high-gain "
                                                                "observer",
                                                    .value = peak,
                                                    .relation = "at most",
                                                    .limit = NUM_MAX,
                                                    .unit = "per-unit",
                                                    .reason = "the range of fixed point"});
    }
    transition_over(task->period_s / epsilon_s, &transition);
    params->model = *model;
    params->encoder = *task->encoder;
    params->speed_limit = num_from_double(task->speed_limit_rad_s / base->speed_rad_s);
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            params->transition[row][column] = coef_from_double(transition.at[row][column]);
        }
        params->input[row] = coef_from_double(-transition.at[row][3] * epsilon_s / task->period_s);
    }
    params->speed_per_turn = coef_from_double(speed_per_turn);
    params->acceleration_per_turn = coef_from_double(acceleration_per_turn);
    return true;
}

void high_gain_observer_reset(struct high_gain_observer *observer,
                              const struct high_gain_observer_params *params,
                              struct position position, struct position measured, num_t resistance,
                              int32_t count)
{
    encoder_set(&observer->encoder, measured, count);
    estimate_reset(&observer->estimate, &params->model, measured, resistance);
    observer->measured = measured;
    observer->x[0] = position_difference(position, measured);
    observer->x[1] = NUM(0.0);
    observer->x[2] = NUM(0.0);
}

void high_gain_observer_place(struct high_gain_observer *observer, struct position position,
                              int32_t count)
{
    encoder_set(&observer->encoder, position, count);
    observer->estimate.rotor.position = position;
    observer->measured = position;
}

static void move_on(struct high_gain_observer *observer,
                    const struct high_gain_observer_params *params, struct position measured)
{
    const num_t moved = position_difference(measured, observer->measured);
    const num_t x[3] = {observer->x[0], observer->x[1], observer->x[2]};

    for (int row = 0; row < 3; row++) {
        observer->x[row] = num_mul_coef(x[0], params->transition[row][0]) +
                           num_mul_coef(x[1], params->transition[row][1]) +
                           num_mul_coef(x[2], params->transition[row][2]) +
                           num_mul_coef(moved, params->input[row]);
    }
    observer->measured = measured;
}

struct passage high_gain_observer_predict(struct high_gain_observer *observer,
                                          const struct high_gain_observer_params *params,
                                          struct phases voltage)
{
    struct estimate *x = &observer->estimate;
    const num_t speed = x->rotor.speed;
    struct passage passage;

    x->rotor.speed = num_limit(speed, params->speed_limit);
    passage = estimate_predict_current(x, &params->model, voltage);
    x->rotor.speed = speed;
    estimate_predict_rotor(x, &params->model, estimate_mean_current(x, passage.mid_period));
    return passage;
}

struct passage high_gain_observer_step(struct high_gain_observer *observer,
                                       const struct high_gain_observer_params *params,
                                       struct phases current, struct phases in_force, int32_t count)
{
    struct estimate *x = &observer->estimate;

    move_on(observer, params, encoder_step(&observer->encoder, &params->encoder, count));

    const num_t acceleration = num_mul_coef(observer->x[2], params->acceleration_per_turn);

    x->rotor.position = observer->measured;
    x->rotor.speed = num_mul_coef(observer->x[1], params->speed_per_turn);
    x->current = current;
    x->rotor.load_torque = park(current, sincos_of(observer->measured.fraction)).q -
                           num_mul_coef(x->rotor.speed, params->model.friction) - acceleration;
    return high_gain_observer_predict(observer, params, in_force);
}
