#include "firmware/motion/reference.h"

/* Acceleration is shown through 32 bits of 2^-38 turn; profile_plan keeps it below 2^31 of them. */
#define ACCELERATION_SHIFT 26
#define ACCELERATION_SCALE 64.0 /* turns_from_angle takes them for 2^-32 turn */

struct reference_params reference_design(const struct per_unit *base, double period_s)
{
    const double speed = 1.0 / base->turns_per_period;
    const double acceleration =
        base->rad_per_turn / (period_s * period_s * base->acceleration_rad_s2);
    struct reference_params params;

    params.speed = coef_from_double(speed);
    params.speed_remainder = coef_from_double(speed - coef_to_double(params.speed));
    params.acceleration = coef_from_double(acceleration / ACCELERATION_SCALE);
    return params;
}

static struct reference_sample sample_of(const struct reference *r,
                                         const struct reference_params *params)
{
    num_t speed = turns_from_angle((int32_t)(r->speed >> 32));
    num_t acceleration = turns_from_angle((int32_t)(r->acceleration >> ACCELERATION_SHIFT));

    return (struct reference_sample){
        .position = {.turns = r->turns, .fraction = (angle_t)(r->fraction >> 32)},
        .speed = num_mul_coef_fine(speed, params->speed, params->speed_remainder),
        .acceleration = num_mul_coef(acceleration, params->acceleration),
        .moving = r->phase > REFERENCE_LOADED && r->phase < REFERENCE_REST,
    };
}

static void place(struct reference *r, struct position position)
{
    r->turns = position.turns;
    r->fraction = (uint64_t)position.fraction << 32;
}

void reference_reset(struct reference *r, struct position position)
{
    r->next = (struct reference_sample){.position = position};
    r->now = r->next;
    r->rest_periods = 0;
    r->phase = REFERENCE_REST;
    r->periods_left = 0;
    r->stop_requested = false;
    r->speed = 0;
    r->acceleration = 0;
    place(r, position);
}

bool reference_load(struct reference *r, struct profile *profile)
{
    if (r->phase != REFERENCE_REST || r->next.position.turns != profile->start.turns ||
        r->next.position.fraction != profile->start.fraction) {
        return false;
    }
    r->profile = profile;
    r->phase = REFERENCE_QUEUED;
    r->speed = profile->rounding_speed;
    r->stopped = false;
    return true;
}

void reference_stop(struct reference *r)
{
    if (r->phase == REFERENCE_QUEUED || r->phase == REFERENCE_LOADED) {
        r->phase = REFERENCE_REST;
        r->speed = 0;
    }
    r->stop_requested = r->phase != REFERENCE_REST;
}

static void advance(struct reference *r)
{
    const int64_t travel = r->speed + (r->acceleration >> 1) + r->jerk_sixth;
    const uint64_t fraction = r->fraction + (uint64_t)travel;

    r->turns += (int32_t)(travel >> 63) + (fraction < r->fraction ? 1 : 0);
    r->fraction = fraction;
    r->speed += r->acceleration + (r->jerk >> 1);
    r->acceleration += r->jerk;
    r->periods_left--;
    r->rest_periods = 0;
}

/*
 * The ramp down mirrors the ramp up, so cutting the ramp up short where it stands leaves a profile
 * that ends at rest: the phases already behind keep the length they had. One period of the present
 * phase is left, so that the next phase begins in an interrupt of its own.
 */
static void cut_short(struct reference *r)
{
    struct profile *profile = r->profile;
    const uint32_t surplus = r->periods_left - 1u;

    switch (r->phase) {
    case REFERENCE_JERK_TO_ACCELERATE:
        profile->jerk_periods -= surplus;
        profile->acceleration_periods = 0;
        r->periods_left = 1;
        break;
    case REFERENCE_ACCELERATE:
        profile->acceleration_periods -= surplus;
        r->periods_left = 1;
        break;
    case REFERENCE_JERK_TO_CRUISE:
        break;
    case REFERENCE_CRUISE:
        r->periods_left = 1;
        break;
    default: /* decelerates to rest already */
        return;
    }
    profile->cruise_periods = 0;
    r->stopped = true;
}

static void begin(struct reference *r, enum reference_phase phase, uint32_t periods,
                  int64_t acceleration)
{
    r->phase = phase;
    r->periods_left = periods;
    r->acceleration = acceleration;
    r->jerk = 0;
    r->jerk_sixth = 0;
}

/* A jerk phase takes the acceleration on from the phase before. */
static void begin_jerk(struct reference *r, enum reference_phase phase, int64_t jerk,
                       int64_t jerk_sixth)
{
    r->phase = phase;
    r->periods_left = r->profile->jerk_periods;
    r->jerk = jerk;
    r->jerk_sixth = jerk_sixth;
}

static void come_to_rest(struct reference *r)
{
    begin(r, REFERENCE_REST, 0, 0);
    r->stop_requested = false;
    r->speed = 0;
    r->rest_periods = 0;
    place(r, r->stopped ? (struct position){r->turns, (angle_t)(r->fraction >> 32)}
                        : r->profile->target);
}

/* Begins the first phase behind the one that has ended which has a length. */
static void begin_next_phase(struct reference *r)
{
    const struct profile *profile = r->profile;
    const enum reference_phase ended = r->phase;
    const bool ramped = profile->acceleration_periods > 0u;
    const bool smooth = profile->jerk_periods > 0u;

    if (ended < REFERENCE_JERK_TO_ACCELERATE && smooth) {
        r->acceleration = 0;
        begin_jerk(r, REFERENCE_JERK_TO_ACCELERATE, profile->jerk, profile->jerk_sixth);
    } else if (ended < REFERENCE_ACCELERATE && ramped) {
        begin(r, REFERENCE_ACCELERATE, profile->acceleration_periods, profile->acceleration);
    } else if (ended < REFERENCE_JERK_TO_CRUISE && smooth) {
        begin_jerk(r, REFERENCE_JERK_TO_CRUISE, -profile->jerk, -profile->jerk_sixth);
    } else if (ended < REFERENCE_CRUISE && profile->cruise_periods > 0u) {
        begin(r, REFERENCE_CRUISE, profile->cruise_periods, 0);
    } else if (ended < REFERENCE_JERK_TO_DECELERATE && smooth) {
        begin_jerk(r, REFERENCE_JERK_TO_DECELERATE, -profile->jerk, -profile->jerk_sixth);
    } else if (ended < REFERENCE_DECELERATE && ramped) {
        begin(r, REFERENCE_DECELERATE, profile->acceleration_periods, -profile->acceleration);
    } else if (ended < REFERENCE_JERK_TO_REST && smooth) {
        begin_jerk(r, REFERENCE_JERK_TO_REST, profile->jerk, profile->jerk_sixth);
    } else {
        come_to_rest(r);
    }
}

void reference_step(struct reference *r, const struct reference_params *params)
{
    if (r->periods_left > 0u) {
        advance(r);
    } else if (r->phase == REFERENCE_REST && r->rest_periods < UINT32_MAX) {
        r->rest_periods++;
    }
    if (r->phase == REFERENCE_QUEUED) {
        r->phase = REFERENCE_LOADED;
    } else if (r->periods_left == 0u && r->phase != REFERENCE_REST) {
        begin_next_phase(r);
    } else if (r->stop_requested && r->phase != REFERENCE_REST) {
        cut_short(r);
        r->stop_requested = false;
    }
    r->now = r->next;
    r->next = sample_of(r, params);
}
