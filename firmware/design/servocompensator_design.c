#include "firmware/design/servocompensator_design.h"

#include "firmware/design/complex_number.h"
#include "firmware/design/elementary.h"

/* |x| <= 1/2: truncation below 1e-14 of the value. */
static double sine(double x)
{
    return x * alternating_series(x * x, 2, 4);
}

static double one_minus_cosine(double x)
{
    const double y = x * x;

    return 0.5 * y * alternating_series(y, 3, 4);
}

/* e^(x + jy) - 1: all poles lie about 1, so they are distinguished by what they differ from it. */
static struct complex_number pole_less_one(double x, double y)
{
    const double growth = exponential(x);

    return (struct complex_number){x * exponential_phi1(x) - growth * one_minus_cosine(y),
                                   growth * sine(y)};
}

/* Residue of p(z)/q(z) at z. */
static struct complex_number residue(int n, const struct complex_number *p,
                                     const struct complex_number *q, int at)
{
    struct complex_number r = {1.0, 0.0};

    for (int i = 0; i < n; i++) {
        r = complex_product(r, complex_difference(q[at], p[i]));
        if (i != at) {
            r = complex_quotient(r, complex_difference(q[at], q[i]));
        }
    }
    return r;
}

static bool check(const struct servocompensator_task *task, char error[DESIGN_ERROR_TEXT])
{
    const double most = SERVOCOMPENSATOR_ROTATION_MAX / (task->harmonics * task->period_s);

    if (!design_require_positive(error, "servo_frequency_rad_s", task->frequency_rad_s, "rad/s") ||
        !design_require_positive(error, "servo_decay_1_s", task->decay_1_s, "1/s")) {
        return false;
    }
    if (task->frequency_rad_s > most) {
        return design_refuse_limit(error, (struct refusal){.quantity = "servo_frequency_rad_s",
                                                           .value = task->frequency_rad_s,
                                                           .relation = "at most",
                                                           .limit = most,
                                                           .unit = "rad/s",
                                                           .reason = "fifty samples a cycle"});
    }
    if (task->decay_1_s * task->period_s > SERVOCOMPENSATOR_ROTATION_MAX) {
        return design_refuse_limit(
            error, (struct refusal){.quantity = "servo_decay_1_s",
                                    .value = task->decay_1_s,
                                    .relation = "at most",
                                    .limit = SERVOCOMPENSATOR_ROTATION_MAX / task->period_s,
                                    .unit = "1/s",
                                    .reason = "an eighth per control period"});
    }
    return true;
}

bool servocompensator_design(const struct servocompensator_task *task,
                             struct servocompensator_design *design, char error[DESIGN_ERROR_TEXT])
{
    enum { POLES_MAX = 1 + 2 * SERVOCOMPENSATOR_HARMONICS_MAX };
    static const struct complex_number pattern[POLES_MAX] = {
        {-1.0, 0.0}, {-2.0, 1.0}, {-2.0, -1.0}, {-3.0, 1.0}, {-3.0, -1.0}};
    const int n = 1 + 2 * task->harmonics;
    const double rate = task->decay_1_s * task->period_s;
    struct complex_number p[POLES_MAX];
    struct complex_number q[POLES_MAX] = {{0.0, 0.0}}; /* the integrator's is 1 */
    int poles = 1;

    if (!check(task, error)) {
        return false;
    }
    for (int i = 0; i < n; i++) {
        p[i] = pole_less_one(rate * pattern[i].re, rate * pattern[i].im);
    }
    for (int h = 1; h <= task->harmonics; h++) {
        const double angle = h * task->frequency_rad_s * task->period_s;

        q[poles++] = pole_less_one(0.0, angle);
        q[poles++] = pole_less_one(0.0, -angle);
    }
    design->input = residue(n, p, q, 0).re;
    for (int h = 1; h <= task->harmonics; h++) {
        const struct complex_number r = residue(n, p, q, 2 * h - 1);
        const double angle = h * task->frequency_rad_s * task->period_s;

        design->mode[h - 1] = (struct servocompensator_mode){
            .sine = sine(angle),
            .one_minus_cosine = one_minus_cosine(angle),
            .input_re = 2.0 * r.re,
            .input_im = 2.0 * r.im,
        };
    }
    return true;
}
