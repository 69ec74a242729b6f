#include "firmware/motion/sine.h"

#include "firmware/design/elementary.h"

#define KNOTS        4u     /* in a plan; three segments each */
#define KNOT_MAX_s   1.5e-3 /* from knot to knot: a stop need not wait for long */
#define KNOT_MAX_RAD 0.075  /* of phase: error below 1e-8 of the amplitude */
#define KNOT_PERIODS 3u     /* at least: one per segment */

static const double two_pi = 6.283185307179586476925;
static const double two_to_64 = 18446744073709551616.0;

struct sine_cosine {
    double sin, cos;
};

/* Taylor series about the nearest quarter; 1 ulp. */
static struct sine_cosine of_phase(uint64_t phase)
{
    const uint64_t shifted = phase + ((uint64_t)1 << 61);
    const uint32_t quarter = (uint32_t)(shifted >> 62);
    const int64_t rest = (int64_t)(phase - ((uint64_t)quarter << 62));
    const double x = (double)rest / two_to_64 * two_pi;
    const double s = x * alternating_series(x * x, 2, 8);
    const double c = alternating_series(x * x, 1, 8);

    switch (quarter) {
    case 0:
        return (struct sine_cosine){s, c};
    case 1:
        return (struct sine_cosine){c, -s};
    case 2:
        return (struct sine_cosine){-s, -c};
    default:
        return (struct sine_cosine){-c, s};
    }
}

/* The envelope and its derivatives by time in periods. */
struct envelope {
    double value, slope, curvature;
};

static struct envelope envelope_at(const struct sine *sine, uint64_t time)
{
    const double ramp = (double)sine->ramp_periods;
    const bool falling = sine->periods > 0u && time > sine->periods - sine->ramp_periods;
    const uint64_t from_end = falling ? sine->periods - time : time;
    const double s = (double)from_end / ramp;
    const double rest = 1.0 - s;

    if (from_end >= sine->ramp_periods) {
        return (struct envelope){1.0, 0.0, 0.0};
    }
    return (struct envelope){
        .value = s * s * s * (10.0 + s * (6.0 * s - 15.0)),
        .slope = (falling ? -30.0 : 30.0) * s * s * rest * rest / ramp,
        .curvature = 60.0 * s * rest * (rest - s) / (ramp * ramp),
    };
}

struct sine sine_design(const struct sine_task *task)
{
    const double cycles_per_period = task->frequency_Hz * task->period_s;
    struct sine sine = {.amplitude = task->amplitude_turns};

    sine.ramp_periods = (uint32_t)(task->ramp_s / task->period_s + 0.5);
    sine.omega = two_pi * cycles_per_period;
    sine.phase_step = (uint64_t)(cycles_per_period * two_to_64);
    if (task->cycles > 0.0) {
        /* so many whole periods, to which the frequency is rounded */
        sine.periods = (uint64_t)(task->cycles / cycles_per_period + 0.5);
        sine.omega = two_pi * task->cycles / (double)sine.periods;
        sine.phase_step = (uint64_t)(task->cycles / (double)sine.periods * two_to_64);
        if (2u * (uint64_t)sine.ramp_periods > sine.periods) {
            sine.ramp_periods = (uint32_t)(sine.periods / 2u);
        }
    }
    const double knot = smaller(KNOT_MAX_RAD / sine.omega, KNOT_MAX_s / task->period_s);

    sine.knot_periods = (uint32_t)knot / KNOT_PERIODS * KNOT_PERIODS;
    if (sine.knot_periods < KNOT_PERIODS) {
        sine.knot_periods = KNOT_PERIODS;
    }
    return sine;
}

/* The envelope's derivatives are at most 15/8, 10/sqrt 3 and 60 by its ramp, squared, cubed. */
struct motion_limits sine_peaks(const struct sine *sine)
{
    const double A = magnitude(sine->amplitude);
    const double w = sine->omega;
    const double r = sine->ramp_periods > 0u ? 1.0 / (double)sine->ramp_periods : 0.0;

    return (struct motion_limits){
        .speed = A * (w + 1.875 * r),
        .acceleration = A * (w * w + 3.75 * w * r + 5.7736 * r * r),
        .jerk = A * (w * w * w + 5.625 * w * w * r + 17.33 * w * r * r + 60.0 * r * r * r),
    };
}

struct motion_target sine_at(const struct sine *sine, uint64_t time)
{
    const struct sine_cosine p = of_phase(time * sine->phase_step);
    const struct envelope e = envelope_at(sine, time);
    const double A = sine->amplitude;
    const double w = sine->omega;

    return (struct motion_target){
        .distance = A * e.value * p.sin,
        .speed = A * (e.slope * p.sin + e.value * w * p.cos),
        .acceleration =
            A * (e.curvature * p.sin + 2.0 * e.slope * w * p.cos - e.value * w * w * p.sin),
    };
}

/* The last step takes what would be too short for one of its own. */
static uint32_t next_step(const struct sine *sine)
{
    const uint64_t left = sine->periods - sine->elapsed;

    return sine->periods > 0u && left < sine->knot_periods + KNOT_PERIODS ? (uint32_t)left
                                                                          : sine->knot_periods;
}

bool sine_continue(struct sine *sine, struct motion_plan *plan, struct motion_state *end)
{
    if (sine->elapsed == 0u && sine->ramp_periods == 0u) {
        plan->speed_jump = motion_from_turns(sine_at(sine, 0).speed) / 2 * 2;
        end->speed += plan->speed_jump;
    }
    for (uint32_t i = 0; i < KNOTS; i++) {
        const uint32_t step = next_step(sine);
        struct motion_target target;

        sine->elapsed += step;
        target = sine_at(sine, sine->elapsed);
        target.distance += motion_distance(end, sine->centre);
        motion_plan_transfer(plan, end, &target, step);
        if (sine->elapsed == sine->periods) {
            plan->lands = true;
            plan->target = sine->centre;
            return false;
        }
    }
    plan->continues_after = plan->segments;
    return true;
}
