/*
 * Reference generator: samples a planned motion once per control period.
 *
 *   x += v + a/2 + j/6,   v += a + j/2,   a += j        exact for piecewise constant jerk
 *
 * in 64-bit integers of 2^-64 electrical turn per period^n (profile.h makes the halves and sixths
 * exact). Additions only; the same bits in every number format. It executes profiles, which it can
 * cut short by itself, and plans (motion_plan.h), which the background makes, continues and stops.
 *
 * The drive computes at S(k) what acts from S(k+1) on, so each step gives the reference of S(k+1).
 * What is asked of it is asked behind a step, for the next one: a profile loaded at S(k) begins at
 * S(k+2), and a stop asked for at S(k) takes effect from S(k+3) on, a period later where a phase of
 * the profile begins at S(k+2). Where the acceleration jumps, a sample shows its value behind the
 * jump.
 */
#ifndef STEADYSTEP_REFERENCE_H
#define STEADYSTEP_REFERENCE_H

#include "firmware/motion/motion_plan.h"
#include "firmware/motion/profile.h"
#include "firmware/motor/per_unit.h"
#include "firmware/numeric/coefficients.h"
#include "firmware/simulation.h"

/* Acceleration is shown through 32 bits of 2^-38 turn; profile_plan keeps it below 2^31 of them. */
#define REFERENCE_ACCELERATION_SHIFT 26
#define REFERENCE_JERK_SHIFT         22

/* Per-unit scales of what a sample shows. */
struct reference_params {
    coef_t speed;           /* per turn/period */
    coef_t speed_remainder; /* what a coef_t of 16 bits leaves of it */
    coef_t acceleration;    /* per 2^-6 turn/period^2 */
    coef_t jerk;            /* per 2^-10 turn/period^3 */
    num_t creep_speed;      /* what moves below is slow; 0: nothing is */
    num_t creep_acceleration;
};

/* The remainder has the shift that it happens to have. */
#define REFERENCE_PARAMS_COEFFICIENTS(X)                                                           \
    X(speed, reference_speed)                                                                      \
    X(acceleration, reference_acceleration)                                                        \
    X(jerk, reference_jerk)
COEFFICIENTS(reference_params, REFERENCE_PARAMS_COEFFICIENTS)

struct reference_sample {
    struct position position; /* electrical */
    num_t speed;              /* per-unit */
    num_t acceleration;       /* per-unit, torque base over inertia */
    bool moving;              /* within a profile or plan */
};

/* Phases of a profile, in order; those of no length are passed over. */
enum reference_phase {
    REFERENCE_LOADED, /* begins with the next step */
    REFERENCE_JERK_TO_ACCELERATE,
    REFERENCE_ACCELERATE,
    REFERENCE_JERK_TO_CRUISE,
    REFERENCE_CRUISE,
    REFERENCE_JERK_TO_DECELERATE,
    REFERENCE_DECELERATE,
    REFERENCE_JERK_TO_REST,
    REFERENCE_PLANNED, /* within a plan */
    REFERENCE_REST
};

/* What a step has to do. Chosen anew by each that does not just go on. */
enum reference_course {
    REFERENCE_TURNS,    /* it creeps, or something has been asked for */
    REFERENCE_SETS_OUT, /* a profile has begun: the first period of motion */
    REFERENCE_ARRIVES,  /* it has ended: the first period of rest */
    REFERENCE_STARTS,   /* a profile or plan begins from rest */
    REFERENCE_STILL,
    REFERENCE_STEADY, /* a phase of constant acceleration */
    REFERENCE_JERKS
};

struct reference {
    enum reference_course course;
    struct reference_sample now;  /* at S(k) */
    struct reference_sample next; /* at S(k+1) */
    uint32_t slow_periods;        /* since it came to rest or to creep, at S(k); saturates */

    struct profile *profile; /* the one in force */
    enum reference_phase phase;
    uint32_t periods_left; /* of the phase */
    bool creeps;           /* the profile or plan does */
    bool stop_requested;
    bool stopped; /* comes to rest where it may, not at the target */
    bool jerks;
    struct motion_state at; /* S(k+1) */
    int64_t jerk;           /* both count while it jerks */
    int64_t jerk_sixth;

    const struct motion_plan *plan; /* the one that began last */
    uint32_t segment;               /* of the plan: how many have begun */
    uint32_t epoch;                 /* counts resets and stops of plans: older plans are void */
    const struct motion_plan *volatile continuation; /* NULL: has not come */
};

/* Up to where a reference creeps. */
struct creep_limits {
    double speed_rad_s;
    double acceleration_rad_s2;
};

__attribute__((cold)) struct reference_params
reference_design(const struct per_unit *base, double period_s, struct creep_limits creep);

/*
 * Change of the per-unit acceleration in a control period, from S(k+1) on. The range is 2^-11 turn
 * per period^3 (61e6 rad/s^3 at 10 kHz and 50 teeth); it saturates beyond. Zero where the
 * acceleration jumps. Not part of the sample: only the laws that use it pay for it.
 */
static inline num_t reference_jerk(const struct reference *reference,
                                   const struct reference_params *params)
{
    /* 2^-42 turn in 32 bits; one comparison: what is below them wraps to a large number */
    const int64_t jerk = reference->jerks ? reference->jerk : 0;
    const int32_t high = (int32_t)(jerk >> 32);
    const uint32_t range = 1u << (REFERENCE_JERK_SHIFT - 1);
    int32_t limited = (int32_t)(uint32_t)(jerk >> REFERENCE_JERK_SHIFT);

    if (RARE((uint32_t)high + range >= 2u * range)) {
        limited = high < 0 ? -INT32_MAX : INT32_MAX;
    }
    return num_mul_coef(turns_from_angle(limited), KNOWN(reference_params, params)->jerk);
}

/* A sixth of the jerk, 2^-64 turn per period^3. */
static inline int64_t reference_jerk_sixth(const struct reference *reference)
{
    return reference->jerks ? reference->jerk_sixth : 0;
}

/* At rest at a position. */
__attribute__((noinline)) void reference_reset(struct reference *reference,
                                               struct position position);

/* Of a reference at rest while nothing follows it: the position is now this one. */
void reference_place(struct reference *reference, struct position position);

/* From whatever motion: goes on for ever at its speed, where it is placed meanwhile. In a new
   epoch: what was planned is void. */
void reference_follow(struct reference *reference);

/* Behind a step of such a reference: the rotor as it will be at S(k+1); `half_turns` are those of
   half a period, `speed` per-unit. */
static inline void reference_place_in_motion(struct reference *reference, struct position position,
                                             num_t speed, int32_t half_turns)
{
    reference->at.turns = position.turns;
    reference->at.fraction = (uint64_t)position.fraction << 32;
    reference->at.speed = (int64_t)half_turns * ((int64_t)1 << 33);
    reference->next.position = position;
    reference->next.speed = speed;
    reference->periods_left = UINT32_MAX;
}

/* It goes on so, and has not been stopped; a plan preempts it only when nothing places it any more.
 */
static inline bool reference_follows(const struct reference *reference)
{
    return reference->course == REFERENCE_STEADY;
}

/* By a plan, not by a profile. */
static inline bool reference_is_planned(const struct reference *reference)
{
    return reference->phase == REFERENCE_PLANNED;
}

/* A profile is loaded or runs: another one would be refused. */
static inline bool reference_busy(const struct reference *reference)
{
    return reference->phase != REFERENCE_REST;
}

/*
 * Takes a planned profile over, without copying it: it must live until the reference rests, and a
 * stop changes it. Refused (false) while another one runs or if it does not start where the
 * reference rests: the caller keeps it, or plans again from next.position.
 */
bool reference_load(struct reference *reference, struct profile *profile);

/*
 * Goes on with a plan whatever it does: the first segment begins at S(k+1). The plan must live
 * until another one is in force. Refused (false) if a reset or a stop came in between or the
 * reference is not where the plan begins: nothing has happened then, and the background plans
 * again.
 */
bool reference_preempt(struct reference *reference, const struct motion_plan *plan);

/*
 * Background: offers the continuation of the plan in force, or withdraws it (NULL). The interrupt
 * takes it where that plan continues, and never again after that: it can preempt this at any
 * instant and sees either none or all of the continuation, because a barrier keeps the compiler
 * from writing the pointer before what it points to, and on one core nothing else could.
 */
void reference_continue(struct reference *reference, const struct motion_plan *continuation);

/* Background, on a copy: what the reference will be `periods` later if nobody intervenes. */
__attribute__((cold)) void reference_skip(struct reference *r, uint32_t periods);

/*
 * Comes to rest as soon as the ramps of the profile allow: with its own acceleration and jerk,
 * without a step of position or speed. Nothing happens at rest or while it decelerates already; a
 * profile that has not begun is dropped. A plan goes on, in a new epoch: its stop is planned by the
 * background.
 */
void reference_stop(struct reference *reference);

/* At rest: it counts as having been so for as long as anybody asks for. */
static inline void reference_count_as_slow(struct reference *reference)
{
    reference->slow_periods = UINT32_MAX;
}

/* The rest of a step that does not just go on. `held`: the rotor is, and stays so while the
   reference creeps. true: a phase or a stop has begun. */
bool reference_turn(struct reference *reference, const struct reference_params *params, bool held);

static inline void reference_travel(struct reference *r, int64_t travel)
{
    const uint64_t begun_at = r->at.fraction;
    const uint64_t fraction = begun_at + (uint64_t)travel;
    const uint32_t carry = (uint32_t)(travel >> 63) + (fraction < begun_at ? 1u : 0u);
    const int32_t turns = (int32_t)((uint32_t)r->at.turns + carry); /* 2^31 goes round */

    r->periods_left--;
    r->at.turns = turns;
    r->at.fraction = fraction;
    r->next.position = (struct position){turns, (angle_t)(fraction >> 32)};
}

/* Through a phase without jerk. */
static inline void reference_advance(struct reference *r)
{
    const int64_t speed = r->at.speed;
    const int64_t acceleration = r->at.acceleration;

    r->at.speed = speed + acceleration;
    reference_travel(r, speed + (acceleration >> 1));
}

static inline void reference_advance_with_jerk(struct reference *r)
{
    const int64_t travel = r->at.speed + (r->at.acceleration >> 1) + r->jerk_sixth;

    r->at.speed += r->at.acceleration + (r->jerk >> 1);
    r->at.acceleration += r->jerk;
    reference_travel(r, travel);
}

/* Of the sample what changes in each period of motion. */
static inline void reference_show(struct reference *r, const struct reference_params *params)
{
    const num_t speed = turns_from_angle((int32_t)(r->at.speed >> 32));

    r->next.speed =
        num_mul_coef_fine(speed, KNOWN(reference_params, params)->speed, params->speed_remainder);
}

/* The rest of it, constant but for a jerk. */
static inline void reference_show_acceleration(struct reference *r,
                                               const struct reference_params *params)
{
    const num_t acceleration =
        turns_from_angle((int32_t)(r->at.acceleration >> REFERENCE_ACCELERATION_SHIFT));

    r->next.acceleration =
        num_mul_large(acceleration, KNOWN(reference_params, params)->acceleration);
}

static inline void reference_count_slow(struct reference *r)
{
    if (r->slow_periods < UINT32_MAX) {
        r->slow_periods++;
    }
}

/* What was to come is now. Only a simulation asks for the present acceleration. */
static inline void reference_pass(struct reference *r)
{
    r->now.position.turns = r->next.position.turns;
    r->now.position.fraction = r->next.position.fraction;
    r->now.speed = r->next.speed;
    if (SERVES_SIMULATION) {
        r->now.acceleration = r->next.acceleration;
    }
}

/* It rests, and has not only just begun to. */
static inline bool reference_is_still(const struct reference *r)
{
    return r->course == REFERENCE_STILL;
}

/* The same, and a profile or plan may begin with the next step. */
static inline bool reference_is_at_rest(const struct reference *r)
{
    return r->course == REFERENCE_STILL || r->course == REFERENCE_STARTS;
}

/* One control period at rest; false: it does not rest, or has only just begun to. */
static inline bool reference_keeps_still(struct reference *r)
{
    if (!reference_is_still(r)) {
        return false;
    }
    reference_count_slow(r);
    return true;
}

/* How a phase goes on that has begun. */
static inline enum reference_course reference_course_of_phase(const struct reference *r)
{
    return r->jerks ? REFERENCE_JERKS : REFERENCE_STEADY;
}

static inline void reference_set_out(struct reference *r)
{
    r->now.moving = true;
    r->slow_periods = 0u;
    r->course = reference_course_of_phase(r);
}

static inline void reference_arrive(struct reference *r)
{
    reference_count_slow(r);
    reference_pass(r);
    r->now.moving = false;
    r->course = REFERENCE_STILL;
}

/* One control period on; false: it does not just go on, reference_turn is to follow, or a phase has
   ended, and reference_turn begins the next. */
static inline bool reference_step(struct reference *r, const struct reference_params *params)
{
    if (reference_keeps_still(r)) {
        return true;
    }
    if (RARE(r->course < REFERENCE_STILL)) {
        if (r->course == REFERENCE_ARRIVES) {
            reference_arrive(r);
            return true;
        }
        if (r->course != REFERENCE_SETS_OUT) {
            return false;
        }
        reference_set_out(r);
    }
    reference_pass(r);
    if (RARE(r->course == REFERENCE_JERKS)) {
        reference_advance_with_jerk(r);
        if (!RARE(r->periods_left == 0u)) {
            reference_show_acceleration(r, params);
        }
    } else {
        reference_advance(r);
    }
    reference_show(r, params);
    return !RARE(r->periods_left == 0u);
}

#endif
