#include "firmware/motion/motion_plan.h"

#include "firmware/design/elementary.h"

#define ADJUSTMENTS 6
#define TRIES       7
#define PERIODS_MAX 4e9 /* what a segment can count; the bounds of a command keep far below */

static const double two_to_32 = 4294967296.0;
static const double two_to_64 = 18446744073709551616.0;

int64_t motion_from_turns(double turns)
{
    const double x = turns * two_to_64;

    return (int64_t)(x < 0.0 ? x - 0.5 : x + 0.5);
}

double motion_to_turns(int64_t x)
{
    return (double)x / two_to_64;
}

double motion_distance(const struct motion_state *from, struct position to)
{
    const struct position here = {from->turns, (angle_t)(from->fraction >> 32)};
    const int64_t high = position_distance(here, to);

    return ((double)high - (double)(uint32_t)from->fraction / two_to_32) / two_to_32;
}

static int32_t nearest(double x)
{
    return (int32_t)(x < 0.0 ? x - 0.5 : x + 0.5);
}

/* The fraction is exact modulo a turn; the turns follow from the distance, known well to half. */
void motion_run(struct motion_state *state, int64_t jerk_sixth, uint32_t periods)
{
    const uint64_t n = periods;
    const uint64_t speed = (uint64_t)state->speed;
    const uint64_t half_acceleration = (uint64_t)(state->acceleration / 2);
    const uint64_t sixth = (uint64_t)jerk_sixth;
    const uint64_t fraction = state->fraction + n * (speed + n * (half_acceleration + n * sixth));
    const double time = (double)periods;
    const double travel =
        time * (motion_to_turns(state->speed) + time * (0.5 * motion_to_turns(state->acceleration) +
                                                        time * motion_to_turns(jerk_sixth)));

    const int32_t turns =
        nearest(travel + ((double)state->fraction - (double)fraction) / two_to_64);

    state->turns = (int32_t)((uint32_t)state->turns + (uint32_t)turns);
    state->fraction = fraction;
    state->speed = (int64_t)(speed + n * (2u * half_acceleration + 3u * n * sixth));
    state->acceleration = (int64_t)(2u * half_acceleration + 6u * n * sixth);
}

void motion_plan_begin(struct motion_plan *plan, const struct motion_state *from, uint32_t epoch)
{
    plan->from = *from;
    plan->epoch = epoch;
    plan->speed_jump = 0;
    plan->segments = 0;
    plan->continues_after = PLAN_SEGMENTS + 1u;
    plan->endless = false;
    plan->creeps = false;
    plan->lands = false;
}

static void append(struct motion_plan *plan, struct motion_state *end, uint32_t periods,
                   double jerk)
{
    const struct motion_segment segment = {.periods = periods,
                                           .acceleration = end->acceleration,
                                           .jerk_sixth = motion_from_turns(jerk / 6.0)};

    if (periods > 0u) {
        plan->segment[plan->segments++] = segment;
        motion_run(end, segment.jerk_sixth, periods);
    }
}

/*
 * With three segments of n1, n2, n3 periods and t1 = n2 + n3, t2 = n3 periods behind the first two,
 * jerks j_i reach at the end, beyond what the present acceleration and speed do by themselves,
 *
 *   A = sum n_i j_i,   V = sum n_i (n_i/2 + t_i) j_i,   X = sum n_i (n_i^2/6 + t_i (n_i + t_i)/2)
 * j_i
 *
 * and V - (n3/2) A, X - (n3^2/6) A are free of j3.
 */
void motion_plan_transfer(struct motion_plan *plan, struct motion_state *end,
                          const struct motion_target *target, uint32_t periods)
{
    const uint32_t third = periods / 3u;
    const uint32_t middle = periods - 2u * third;
    const double n1 = (double)third;
    const double n2 = (double)middle;
    const double n = (double)periods;
    const double v0 = motion_to_turns(end->speed);
    const double a0 = motion_to_turns(end->acceleration);
    const double A = target->acceleration - a0;
    const double V = target->speed - v0 - n * a0;
    const double X = target->distance - n * (v0 + n * a0 / 2.0);
    const double t1 = n2 + n1;
    /* rows of V and X without j3 */
    const double v1 = n1 * (n1 / 2.0 + t1 - n1 / 2.0);
    const double v2 = n2 * (n2 / 2.0 + n1 - n1 / 2.0);
    const double x1 = n1 * (n1 * n1 / 6.0 + t1 * (n1 + t1) / 2.0 - n1 * n1 / 6.0);
    const double x2 = n2 * (n2 * n2 / 6.0 + n1 * (n2 + n1) / 2.0 - n1 * n1 / 6.0);
    const double Vr = V - n1 / 2.0 * A;
    const double Xr = X - n1 * n1 / 6.0 * A;
    const double determinant = v1 * x2 - v2 * x1;
    const double j1 = (Vr * x2 - Xr * v2) / determinant;
    const double j2 = (Xr * v1 - Vr * x1) / determinant;

    append(plan, end, third, j1);
    append(plan, end, middle, j2);
    append(plan, end, third, (A - n1 * j1 - n2 * j2) / n1);
}

/*
 * A change of speed, from v0 at acceleration a0 to v1: to a peak acceleration in n[0] periods, n[1]
 * periods with it, n[2] to none.
 */
struct speed_change {
    double v0, a0, v1;
    double n[3];
};

/* Newton's from a first guess by halving the exponent; 0 for what is not above zero. */
static double root_of(double x)
{
    union {
        double value;
        uint64_t bits;
    } root = {.value = x};

    if (!(x > 0.0)) {
        return 0.0;
    }
    root.bits = (root.bits >> 1) + ((uint64_t)511 << 52);
    for (int i = 0; i < 4; i++) {
        root.value = 0.5 * (root.value + x / root.value);
    }
    return root.value;
}

/*
 * Least times. In the direction of the change, seen from the speed at which a0 alone would fade
 * out, acceleration rises to a peak p = sqrt(j dv + a0^2/2), at most the limit, and falls to zero.
 */
static void take_least_times(struct speed_change *change, const struct motion_limits *limits)
{
    const double j = limits->jerk;
    const double a0 = change->a0;
    const double faded = change->v0 + a0 * magnitude(a0) / (2.0 * j);
    const double sign = change->v1 < faded ? -1.0 : 1.0;
    const double dv = sign * (change->v1 - change->v0);
    const double a = sign * a0;
    const double free_peak = root_of(j * dv + a * a / 2.0);
    const double peak = smaller(free_peak, limits->acceleration);

    change->n[0] = magnitude(peak - a) / j;
    change->n[2] = peak / j;
    change->n[1] = 0.0;
    if (free_peak > peak) {
        change->n[1] =
            larger((dv - (a + peak) / 2.0 * change->n[0] - peak / 2.0 * change->n[2]) / peak, 0.0);
    }
}

/* To whole periods: up, but for what is rounding. */
static double whole(double periods)
{
    const double capped = smaller(periods, PERIODS_MAX);
    const double rounded = (double)(uint32_t)capped;

    return capped - rounded > 1e-6 ? rounded + 1.0 : rounded;
}

static void round_up(struct speed_change *change)
{
    change->n[0] = whole(larger(change->n[0], 1.0));
    change->n[1] = whole(change->n[1]);
    change->n[2] = whole(larger(change->n[2], 1.0));
}

/* The peak acceleration with which the change of these times ends at v1. */
static double peak_acceleration(const struct speed_change *change)
{
    const double *n = change->n;

    return (change->v1 - change->v0 - change->a0 * n[0] / 2.0) / (n[0] / 2.0 + n[1] + n[2] / 2.0);
}

/*
 * Lengthens the ends of a change whose jerk rounding has raised above the limit, at the expense of
 * the time at the peak as far as there is some. true: it had to.
 */
static bool lengthen(struct speed_change *change, double jerk)
{
    const double peak = peak_acceleration(change);
    const double first = whole(magnitude(peak - change->a0) / jerk) - change->n[0];
    const double last = whole(magnitude(peak) / jerk) - change->n[2];

    if (first > 0.0) {
        change->n[0] += first;
        change->n[1] -= smaller(first, change->n[1]);
    }
    if (last > 0.0) {
        change->n[2] += last;
        change->n[1] -= smaller((double)(uint32_t)(last / 2.0), change->n[1]);
    }
    return first > 0.0 || last > 0.0;
}

/* The peak is within its limit, or no further beyond than the motion begins. */
static bool is_bounded(const struct speed_change *change, double limit)
{
    return magnitude(peak_acceleration(change)) <=
           larger(magnitude(change->a0), limit) * (1.0 + 1e-6);
}

/* Lengthens until it is enough; false: it never is. */
static bool settles(struct speed_change *change, const struct motion_limits *limits)
{
    for (int i = 0; i < ADJUSTMENTS; i++) {
        if (!lengthen(change, limits->jerk)) {
            return is_bounded(change, limits->acceleration);
        }
    }
    return false;
}

/*
 * A motion that uses all of the jerk for all of its time has none left to make up for whole
 * periods: it is planned again with less and less, of the acceleration as well.
 */
static struct motion_limits softened(const struct motion_limits *limits, int tried)
{
    const double share = tried > 0 ? 1.0 - 1.0 / (double)(128 >> tried) : 1.0;

    return (struct motion_limits){.speed = limits->speed,
                                  .acceleration = share * limits->acceleration,
                                  .jerk = share * limits->jerk};
}

static double distance_of(const struct speed_change *change)
{
    const double *n = change->n;
    const double p = peak_acceleration(change);
    const double v_peak = change->v0 + (change->a0 + p) / 2.0 * n[0];
    const double v_fall = v_peak + p * n[1];

    return n[0] * (change->v0 + n[0] * (2.0 * change->a0 + p) / 6.0) +
           n[1] * (v_peak + p * n[1] / 2.0) + n[2] * (v_fall + p * n[2] / 3.0);
}

/* From where the plan ends, which a segment before may have left a rounding beside. */
static void append_change(struct motion_plan *plan, struct motion_state *end,
                          struct speed_change *change)
{
    change->v0 = motion_to_turns(end->speed);
    change->a0 = motion_to_turns(end->acceleration);
    append(plan, end, (uint32_t)change->n[0],
           (peak_acceleration(change) - change->a0) / change->n[0]);
    append(plan, end, (uint32_t)change->n[1], 0.0);
    append(plan, end, (uint32_t)change->n[2], -motion_to_turns(end->acceleration) / change->n[2]);
    end->acceleration = 0; /* but for rounding it is */
}

void motion_plan_speed(struct motion_plan *plan, struct motion_state *end, double speed,
                       const struct motion_limits *limits)
{
    struct speed_change change = {
        .v0 = motion_to_turns(end->speed), .a0 = motion_to_turns(end->acceleration), .v1 = speed};

    if (change.v0 == speed && change.a0 == 0.0) {
        return;
    }
    for (int i = 0; i < TRIES; i++) {
        const struct motion_limits softer = softened(limits, i);

        take_least_times(&change, &softer);
        round_up(&change);
        if (settles(&change, limits)) {
            break;
        }
    }
    append_change(plan, end, &change);
}

void motion_plan_cruise(struct motion_plan *plan)
{
    plan->segment[plan->segments++] = (struct motion_segment){.periods = UINT32_MAX};
    plan->endless = true;
}

/* Up to the cruise speed, a cruise and down to rest. */
struct move {
    struct speed_change up;
    struct speed_change down;
    double cruise_periods;
    double distance; /* that it is to go */
};

static void set_cruise(struct move *move, double speed)
{
    move->up.v1 = speed;
    move->down.v0 = speed;
}

static double distance_at(struct move *move, double cruise)
{
    set_cruise(move, cruise);
    return distance_of(&move->up) + cruise * move->cruise_periods + distance_of(&move->down);
}

/* What is left of the distance at this cruise speed, reached and left in the least times. */
static double left_at(struct move *move, double cruise, const struct motion_limits *limits)
{
    set_cruise(move, cruise);
    take_least_times(&move->up, limits);
    take_least_times(&move->down, limits);
    /* a change of no length divides by nothing */
    move->up.n[0] = larger(move->up.n[0], 1e-9);
    move->down.n[0] = larger(move->down.n[0], 1e-9);
    return move->distance - distance_at(move, cruise);
}

/* In the times of the move: the distance is linear in it. */
static void fit_cruise(struct move *move, const struct motion_limits *limits)
{
    const double at_zero = distance_at(move, 0.0);
    const double at_limit = distance_at(move, limits->speed);

    set_cruise(move, limits->speed * (move->distance - at_zero) / (at_limit - at_zero));
}

/*
 * The distance grows with the cruise speed: the speed at which nothing is left for the cruise is
 * found by bisection, unless the largest leaves some. With the times rounded to whole periods, the
 * distance is linear in the speed, which then follows exactly.
 */
static void plan_move(struct move *move, const struct motion_limits *limits)
{
    enum { BISECTIONS = 30 };

    move->cruise_periods = 0.0;
    const bool forward = left_at(move, 0.0, limits) >= 0.0;
    double fast = forward ? limits->speed : -limits->speed;
    double slow = 0.0;
    double left = left_at(move, fast, limits);

    if (forward ? left >= 0.0 : left <= 0.0) {
        move->cruise_periods = whole(left / fast);
    } else {
        for (int i = 0; i < BISECTIONS; i++) {
            const double middle = 0.5 * (slow + fast);

            left = left_at(move, middle, limits);
            if (forward ? left >= 0.0 : left <= 0.0) {
                slow = middle;
            } else {
                fast = middle;
            }
        }
    }
    round_up(&move->up);
    round_up(&move->down);
    fit_cruise(move, limits);
}

/* As settles(), of both changes; the cruise speed follows their times. */
static bool move_settles(struct move *move, const struct motion_limits *limits)
{
    for (int i = 0; i < ADJUSTMENTS; i++) {
        const bool up = lengthen(&move->up, limits->jerk);
        const bool down = lengthen(&move->down, limits->jerk);

        if (!up && !down) {
            return is_bounded(&move->up, limits->acceleration) &&
                   is_bounded(&move->down, limits->acceleration);
        }
        fit_cruise(move, limits);
    }
    return false;
}

static double sum(const struct speed_change *change)
{
    return change->n[0] + change->n[1] + change->n[2];
}

void motion_plan_move(struct motion_plan *plan, struct motion_state *end, struct position target,
                      const struct motion_limits *limits)
{
    struct move move = {
        .up = {.v0 = motion_to_turns(end->speed), .a0 = motion_to_turns(end->acceleration)},
        .distance = motion_distance(end, target)};

    for (int i = 0; i < TRIES; i++) {
        const struct motion_limits softer = softened(limits, i);

        plan_move(&move, &softer);
        if (move_settles(&move, limits)) {
            break;
        }
    }
    append_change(plan, end, &move.up);
    append(plan, end, (uint32_t)move.cruise_periods, 0.0);
    append_change(plan, end, &move.down);
    plan->speed_jump = motion_from_turns(motion_distance(end, target) /
                                         (sum(&move.up) + move.cruise_periods + sum(&move.down)));
    plan->lands = true;
    plan->target = target;
}
