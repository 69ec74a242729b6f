#include "firmware/motion/reference.h"

#include <stdatomic.h>
#include <stddef.h>

#define ACCELERATION_SCALE 64.0 /* turns_from_angle takes them for 2^-32 turn */
#define JERK_SCALE         1024.0

struct reference_params reference_design(const struct per_unit *base, double period_s,
                                         struct creep_limits creep)
{
    const double speed = 1.0 / base->turns_per_period;
    const double acceleration =
        base->rad_per_turn / (period_s * period_s * base->acceleration_rad_s2);
    struct reference_params params;

    params.speed = coef_from_double(speed);
    params.acceleration = coef_large_from_double(acceleration / ACCELERATION_SCALE);
    params.jerk = coef_from_double(acceleration / JERK_SCALE);
    reference_params_fit_coefficients(&params);
    params.speed_remainder = coef_from_double(speed - coef_to_double(params.speed));
    params.creep_speed = num_from_double(creep.speed_rad_s / base->speed_rad_s);
    params.creep_acceleration =
        num_from_double(creep.acceleration_rad_s2 / base->acceleration_rad_s2);
    return params;
}

static void place(struct reference *r, struct position position)
{
    r->at.turns = position.turns;
    r->at.fraction = (uint64_t)position.fraction << 32;
    r->next.position = position;
}

void reference_reset(struct reference *r, struct position position)
{
    r->next = (struct reference_sample){.position = position};
    r->now = r->next;
    r->slow_periods = 0;
    r->phase = REFERENCE_REST;
    r->periods_left = 0;
    r->stop_requested = false;
    r->at.speed = 0;
    r->at.acceleration = 0;
    r->jerks = false;
    r->jerk = 0;
    r->jerk_sixth = 0;
    r->course = REFERENCE_STILL;
    r->epoch++;
    place(r, position);
}

void reference_place(struct reference *r, struct position position)
{
    place(r, position);
    r->now.position = position;
}

void reference_follow(struct reference *r)
{
    r->phase = REFERENCE_PLANNED;
    r->periods_left = UINT32_MAX;
    r->creeps = false;
    r->stop_requested = false;
    r->jerks = false;
    r->at.acceleration = 0;
    r->next.acceleration = NUM(0.0);
    r->next.moving = true;
    r->now.moving = true;
    r->slow_periods = 0u;
    r->course = REFERENCE_STEADY;
    r->epoch++;
}

bool reference_load(struct reference *r, struct profile *profile)
{
    if (r->phase != REFERENCE_REST || r->next.position.turns != profile->start.turns ||
        r->next.position.fraction != profile->start.fraction) {
        return false;
    }
    r->profile = profile;
    r->phase = REFERENCE_LOADED;
    r->at.speed = profile->rounding_speed;
    r->creeps = profile->creeps;
    r->stopped = false;
    r->course = reference_is_still(r) ? REFERENCE_STARTS : REFERENCE_TURNS;
    return true;
}

/*
 * The ramp down mirrors the ramp up, so cutting the ramp up short where it stands leaves a profile
 * that ends at rest: the phases already behind keep the length they had. So many periods of the
 * present phase are left, so that the next phase begins in an interrupt of its own.
 */
static void cut_short(struct reference *r, uint32_t left)
{
    struct profile *profile = r->profile;
    const uint32_t surplus = r->periods_left - left;

    switch (r->phase) {
    case REFERENCE_JERK_TO_ACCELERATE:
        profile->jerk_periods -= surplus;
        profile->acceleration_periods = 0;
        r->periods_left = left;
        break;
    case REFERENCE_ACCELERATE:
        profile->acceleration_periods -= surplus;
        r->periods_left = left;
        break;
    case REFERENCE_JERK_TO_CRUISE:
        break;
    case REFERENCE_CRUISE:
        r->periods_left = left;
        break;
    case REFERENCE_PLANNED:
        r->epoch++;
        return;
    default: /* decelerates to rest already */
        return;
    }
    profile->cruise_periods = 0;
    r->stopped = true;
}

void reference_stop(struct reference *r)
{
    if (r->phase == REFERENCE_LOADED) {
        r->phase = REFERENCE_REST;
        r->at.speed = 0;
        r->next.speed = NUM(0.0);
    }
    if (r->phase < REFERENCE_PLANNED && r->periods_left > 1u) {
        cut_short(r, 2u); /* of the next step, too */
        return;
    }
    r->stop_requested = r->phase != REFERENCE_REST;
    r->course = REFERENCE_TURNS;
}

static void begin(struct reference *r, enum reference_phase phase, uint32_t periods,
                  int64_t acceleration)
{
    r->phase = phase;
    r->periods_left = periods;
    r->at.acceleration = acceleration;
    r->jerks = false;
    r->next.moving = phase != REFERENCE_REST;
    r->course = phase != REFERENCE_REST ? REFERENCE_STEADY : REFERENCE_ARRIVES;
}

/* A jerk phase takes the acceleration on from the phase before. */
static void begin_jerk(struct reference *r, enum reference_phase phase, int64_t jerk,
                       int64_t jerk_sixth)
{
    r->phase = phase;
    r->periods_left = r->profile->jerk_periods;
    r->jerks = true;
    r->jerk = jerk;
    r->jerk_sixth = jerk_sixth;
    r->next.moving = true;
    r->course = REFERENCE_JERKS;
}

/* At the target, but where it has been stopped, or a plan does not end at one. */
static void come_to_rest(struct reference *r, bool at_target, struct position target)
{
    begin(r, REFERENCE_REST, 0, 0);
    r->stop_requested = false;
    r->at.speed = 0;
    r->next.speed = NUM(0.0);
    r->next.acceleration = NUM(0.0);
    place(r, at_target ? target : motion_position(&r->at));
}

__attribute__((noinline)) static void begin_next_segment(struct reference *r)
{
    const struct motion_plan *continuation = r->continuation;
    const struct motion_segment *segment;

    if (r->stop_requested) { /* here too: segments of one period leave no other place */
        r->stop_requested = false;
        r->epoch++;
    }
    if (r->segment == r->plan->continues_after && continuation != NULL) {
        r->continuation = NULL;
        r->plan = continuation;
        r->creeps = continuation->creeps;
        r->segment = 0;
    }
    if (r->segment == 0u) {
        r->at.speed += r->plan->speed_jump;
    }
    if (r->segment == r->plan->segments) {
        if (!r->plan->endless) {
            come_to_rest(r, r->plan->lands, r->plan->target);
            return;
        }
        r->segment--;
    }
    segment = &r->plan->segment[r->segment++];
    begin(r, REFERENCE_PLANNED, segment->periods, segment->acceleration);
    r->jerks = segment->jerk_sixth != 0;
    r->course = reference_course_of_phase(r);
    r->jerk_sixth = segment->jerk_sixth;
    r->jerk = 2 * segment->jerk_sixth + 4 * segment->jerk_sixth; /* no library call on a M0+ */
}

/* From the begin to the cruise; false: none of these phases has a length. */
static inline __attribute__((always_inline)) bool begin_ramp_up(struct reference *r)
{
    const struct profile *profile = r->profile;
    const enum reference_phase ended = r->phase;
    const bool smooth = profile->jerk_periods > 0u;

    if (ended < REFERENCE_JERK_TO_ACCELERATE && smooth) { /* from rest, without acceleration */
        begin_jerk(r, REFERENCE_JERK_TO_ACCELERATE, profile->jerk, profile->jerk_sixth);
    } else if (ended < REFERENCE_ACCELERATE && profile->acceleration_periods > 0u) {
        begin(r, REFERENCE_ACCELERATE, profile->acceleration_periods, profile->acceleration);
    } else if (ended < REFERENCE_JERK_TO_CRUISE && smooth) {
        begin_jerk(r, REFERENCE_JERK_TO_CRUISE, -profile->jerk, -profile->jerk_sixth);
    } else if (profile->cruise_periods > 0u) {
        begin(r, REFERENCE_CRUISE, profile->cruise_periods, 0);
    } else {
        return false;
    }
    return true;
}

/* From the cruise to rest. */
static inline __attribute__((always_inline)) void begin_ramp_down(struct reference *r)
{
    const struct profile *profile = r->profile;
    const enum reference_phase ended = r->phase;
    const bool smooth = profile->jerk_periods > 0u;

    if (ended < REFERENCE_JERK_TO_DECELERATE && smooth) {
        begin_jerk(r, REFERENCE_JERK_TO_DECELERATE, -profile->jerk, -profile->jerk_sixth);
    } else if (ended < REFERENCE_DECELERATE && profile->acceleration_periods > 0u) {
        begin(r, REFERENCE_DECELERATE, profile->acceleration_periods, -profile->acceleration);
    } else if (ended < REFERENCE_JERK_TO_REST && smooth) {
        begin_jerk(r, REFERENCE_JERK_TO_REST, profile->jerk, profile->jerk_sixth);
    } else {
        come_to_rest(r, !r->stopped, profile->target);
        if (RARE(ended == REFERENCE_LOADED)) { /* a step */
            r->slow_periods = 0u;
        }
    }
}

/* Begins the first phase of the profile behind the one that has ended which has a length. */
static inline __attribute__((always_inline)) void begin_next_phase_of_profile(struct reference *r)
{
    if (r->phase >= REFERENCE_CRUISE || !begin_ramp_up(r)) {
        begin_ramp_down(r);
    }
}

/* true: of a plan, and so the speed may jump. */
static inline __attribute__((always_inline)) bool begin_next_phase(struct reference *r)
{
    const bool planned = r->phase == REFERENCE_PLANNED;

    if (planned) {
        begin_next_segment(r);
    } else {
        begin_next_phase_of_profile(r);
    }
    return planned;
}

bool reference_preempt(struct reference *r, const struct motion_plan *plan)
{
    const struct motion_state *from = &plan->from;

    if (plan->epoch != r->epoch || r->stop_requested || from->turns != r->at.turns ||
        from->fraction != r->at.fraction || from->speed != r->at.speed ||
        from->acceleration != r->at.acceleration) {
        return false;
    }
    r->plan = plan;
    r->creeps = plan->creeps;
    r->segment = 0;
    r->continuation = NULL;
    r->phase = REFERENCE_PLANNED;
    r->periods_left = r->periods_left > 0u ? 1u : 0u;
    if (reference_is_still(r)) {
        r->course = REFERENCE_STARTS;
    } else if (r->course < REFERENCE_STEADY || plan->creeps) {
        r->course = REFERENCE_TURNS;
    } /* else the step that follows goes on, and the phase ends with it */
    return true;
}

void reference_continue(struct reference *r, const struct motion_plan *continuation)
{
    atomic_signal_fence(memory_order_release);
    r->continuation = continuation;
}

void reference_skip(struct reference *r, uint32_t periods)
{
    while (periods > 0u && r->phase != REFERENCE_REST) {
        const uint32_t run = r->periods_left < periods ? r->periods_left : periods;

        if (run > 0u) {
            motion_run(&r->at, reference_jerk_sixth(r), run);
            r->periods_left -= run;
            periods -= run;
        } else {
            periods--;
        }
        if (r->periods_left == 0u) {
            (void)begin_next_phase(r);
        }
    }
}

/* Creeps: with a rotor that is held, its ramps too, in motion the cruise alone. */
static bool is_slow(const struct reference *r, const struct reference_params *params, bool held)
{
    const struct reference_sample *sample = &r->next;

    return !sample->moving ||
           (r->creeps && num_abs(sample->speed) < params->creep_speed &&
            num_abs(sample->acceleration) <= (held ? params->creep_acceleration : NUM(0.0)));
}

/* Of the steps that follow. */
static enum reference_course course_of(const struct reference *r)
{
    if (r->phase == REFERENCE_REST) {
        return REFERENCE_STILL;
    }
    if (r->creeps) {
        return REFERENCE_TURNS;
    }
    return reference_course_of_phase(r);
}

static inline void advance(struct reference *r)
{
    if (r->jerks) {
        reference_advance_with_jerk(r);
    } else {
        reference_advance(r);
    }
}

/* A phase ends with this period, or is to be cut short. */
static bool ends_phase(const struct reference *r)
{
    return (r->periods_left <= 1u || r->stop_requested) && r->phase != REFERENCE_REST;
}

/* One period on, but for the phase that begins; true: one does. Apart: it needs many registers. */
__attribute__((noinline)) static bool turn(struct reference *r,
                                           const struct reference_params *params, bool held)
{
    const bool ends = ends_phase(r);

    if (is_slow(r, params, held)) {
        reference_count_slow(r);
    } else {
        r->slow_periods = 0u;
    }
    reference_pass(r);
    r->now.moving = r->next.moving;
    if (r->periods_left > 0u) {
        advance(r);
        reference_show(r, params);
    }
    if (ends) {
        return true;
    }
    if (r->phase != REFERENCE_REST) {
        reference_show_acceleration(r, params);
    }
    r->course = course_of(r);
    return false;
}

/* A phase has begun, and does not just go on. */
static inline void keep_turning(struct reference *r)
{
    if (RARE(r->creeps || r->stop_requested)) {
        r->course = REFERENCE_TURNS;
    } else if (RARE(!r->now.moving)) {
        r->course = REFERENCE_SETS_OUT;
    }
}

/* What comes before a phase begins where it does not just go on; false: none begins. */
static bool turn_to_phase(struct reference *r, const struct reference_params *params, bool held)
{
    if (r->course == REFERENCE_STARTS) {
        reference_count_slow(r);
    } else if (!turn(r, params, held)) {
        return false;
    }
    if (r->phase == REFERENCE_LOADED) {
        reference_show(r, params); /* the speed jumps by what rounding adds to it */
    }
    if (r->periods_left > 0u) { /* a stop has been asked for */
        cut_short(r, 1u);
        r->stop_requested = false;
        r->course = reference_course_of_phase(r);
    }
    return true;
}

bool reference_turn(struct reference *r, const struct reference_params *params, bool held)
{
    if (RARE(r->course <= REFERENCE_STARTS) && !turn_to_phase(r, params, held)) {
        return false;
    }
    if (!RARE(r->periods_left > 0u) && begin_next_phase(r)) {
        reference_show(r, params);
    }
    if (r->phase != REFERENCE_REST) {
        reference_show_acceleration(r, params);
        keep_turning(r);
    }
    return true;
}
