#include "firmware/control/csmc_servo.h"

#include "firmware/control/voltage_limit.h"

enum { M = SLIDING_MODE_GAINS, FREQUENCY, DECAY, GAINS };

static const struct law_gain gains[GAINS] = {
    SLIDING_MODE_GAIN_LIST,
    [M] = SLIDING_MODE_GAIN_M,
    [FREQUENCY] = {"servo_frequency_rad_s", 1e-2, 1e5},
    [DECAY] = {"servo_decay_1_s", 1e-2, 1e5},
};

const struct law_gain_list csmc_servo_law_gains = {gains, GAINS};

/* Decay of the slowest eigenvalue by the frequency, where none is given. */
#define DECAY_OVER_FREQUENCY 0.3

static struct servo_mode_params mode_of(const struct servocompensator_mode *mode)
{
    const coef_t sine = coef_from_double(mode->sine);

    return (struct servo_mode_params){
        .sine = sine,
        .sine_remainder = coef_from_double(mode->sine - coef_to_double(sine)),
        .one_minus_cosine = coef_from_double(mode->one_minus_cosine),
        .input_re = coef_from_double(SERVO_STATE_SCALE * mode->input_re),
        .input_im = coef_from_double(SERVO_STATE_SCALE * mode->input_im),
    };
}

static bool design_servocompensators(struct csmc_servo_law_params *params,
                                     const struct position_law_task *task,
                                     char error[DESIGN_ERROR_TEXT])
{
    const double frequency_rad_s = law_gain_or(task, FREQUENCY, 0.0);
    struct servocompensator_task servo = {
        .period_s = task->period_s,
        .frequency_rad_s = frequency_rad_s,
        .decay_1_s = law_gain_or(task, DECAY, DECAY_OVER_FREQUENCY * frequency_rad_s),
        .harmonics = 2,
    };
    struct servocompensator_design d;
    struct servocompensator_design q;

    if (!law_gain_is_given(task, FREQUENCY)) {
        return design_refuse(error, "law_gains.servo_frequency_rad_s: must be given");
    }
    if (!servocompensator_design(&servo, &d, error)) {
        return false;
    }
    servo.harmonics = 1;
    if (!servocompensator_design(&servo, &q, error)) {
        return false;
    }
    params->constant_d = coef_from_double(SERVO_STATE_SCALE * d.input);
    params->constant_q = coef_from_double(SERVO_STATE_SCALE * q.input);
    params->first_d = mode_of(&d.mode[0]);
    params->second_d = mode_of(&d.mode[1]);
    params->first_q = mode_of(&q.mode[0]);
    return true;
}

bool csmc_servo_law_design(struct csmc_servo_law_params *params,
                           const struct position_law_task *task, char error[DESIGN_ERROR_TEXT])
{
    struct sliding_mode_gains in_force;

    if (!sliding_mode_design(&params->mode, &in_force, task, error) ||
        !design_servocompensators(params, task, error)) {
        return false;
    }
    params->voltage =
        coef_from_double(law_gain_or(task, M, in_force.voltage_V) / task->base->voltage_V);
    return true;
}

static num_t share_of(num_t state)
{
    return num_mul_unit(state, UNIT(1.0 / SERVO_STATE_SCALE));
}

/* x = e^(j w T) x + input u */
static void rotate(struct servo_mode *x, const struct servo_mode_params *params, num_t u)
{
    const num_t re = x->re;
    const num_t im = x->im;

    x->re += num_mul_coef(u, params->input_re) - num_mul_coef(re, params->one_minus_cosine) -
             num_mul_coef_fine(im, params->sine, params->sine_remainder);
    x->im += num_mul_coef(u, params->input_im) - num_mul_coef(im, params->one_minus_cosine) +
             num_mul_coef_fine(re, params->sine, params->sine_remainder);
}

/* sat(s1/mu_d) */
static num_t step_d(struct csmc_servo_law_state *state, const struct csmc_servo_law_params *params,
                    num_t levels)
{
    const num_t share = share_of(state->constant_d + state->first_d.re + state->second_d.re);
    const num_t level = num_limit(levels + share, NUM(1.0));
    const num_t u = level - share;

    state->constant_d += num_mul_coef(u, params->constant_d);
    rotate(&state->first_d, &params->first_d, u);
    rotate(&state->second_d, &params->second_d, u);
    return level;
}

/* sat(s2/mu_q) */
static num_t step_q(struct csmc_servo_law_state *state, const struct csmc_servo_law_params *params,
                    num_t levels)
{
    const num_t share = share_of(state->constant_q + state->first_q.re);
    const num_t level = num_limit(levels + share, NUM(1.0));
    const num_t u = level - share;

    state->constant_q += num_mul_coef(u, params->constant_q);
    rotate(&state->first_q, &params->first_q, u);
    return level;
}

struct voltage_demand csmc_servo_law_step(struct csmc_servo_law_state *state,
                                          const struct csmc_servo_law_params *params,
                                          const struct voltage_law_input *input)
{
    const struct tracking_error e = tracking_error_of(&params->mode.surface, input);
    const struct dq levels = sliding_mode_levels(&params->mode, input, &e);
    const num_t d = step_d(state, params, levels.d);
    const num_t q = step_q(state, params, levels.q);
    const struct dq wanted = {-num_mul_coef(d, params->voltage), -num_mul_coef(q, params->voltage)};

    return (struct voltage_demand){limit_voltage(wanted, input->voltage_limit), NUM(0.0)};
}
