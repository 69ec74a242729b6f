/*
 * Holding at rest (Bendjedia 2012, section V): without motion there is no back-EMF to see the
 * rotor by, so a d current draws it into place like a compass needle. The current frame is that of
 * the reference; the q current carries the estimated load and damps.
 *
 *   i_d* ramps to the hold current,   i_q* = T_L/Km - k_w (w - w*)
 *
 * A reference that creeps takes the frame along: there the back-EMF shows as little as at rest, and
 * detent torque is quicker than any law of an angle that is not seen. Entered when the reference
 * has been slow for a while and the rotor has come near it, left as soon as it is faster; the d
 * current then ramps out in the rotor frame, where it makes no torque.
 */
#ifndef STEADYSTEP_STANDSTILL_HOLD_H
#define STEADYSTEP_STANDSTILL_HOLD_H

#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"
#include "firmware/numeric/coefficients.h"

struct standstill_hold_params {
    num_t current;        /* i_d* when ramped in */
    num_t motion_current; /* i_d* when ramped out, of a slow motion */
    num_t ramp_in;        /* of i_d*, per period */
    num_t ramp_out;
    num_t current_limit; /* of the q current */
    coef_t damping;      /* k_w */
    uint32_t delay_periods;
    num_t error_limit; /* electrical turns within which the hold may be entered */
    num_t speed_limit;
    bool enters_at_rest; /* false: it holds only while the drive is being enabled */
};

#define STANDSTILL_HOLD_PARAMS_COEFFICIENTS(X) X(damping, hold_damping)
COEFFICIENTS(standstill_hold_params, STANDSTILL_HOLD_PARAMS_COEFFICIENTS)

struct standstill_hold {
    bool active;
    bool leads;           /* the frame moves, or has not come to rest yet */
    struct sincos frame;  /* of the reference; of the middle of a period where it creeps */
    num_t speed;          /* of the frame: 0 at rest */
    int32_t place;        /* while it waits: where it may begin, off the reference, 2^-32 turn */
    int32_t offset;       /* where the frame is */
    num_t current;        /* the design's, but while enabling: to which i_d* ramps in */
    num_t motion_current; /* to which it ramps out */
    num_t i_d;
};

struct standstill_hold_task {
    double current_A;
    double motion_current_A;
    double ramp_s;
    double ramp_out_s;
    double delay_s;
    bool enters_at_rest;
    double current_limit_A;
    double damping_As_rad; /* k_w, design/hold_check.h */
    double period_s;
};

__attribute__((cold)) struct standstill_hold_params
standstill_hold_design(const struct per_unit *base, const struct standstill_hold_task *task);

void standstill_hold_reset(struct standstill_hold *hold,
                           const struct standstill_hold_params *params);

/* Holds from now on, the current frame at rest at this reference. */
void standstill_hold_enter(struct standstill_hold *hold, angle_t reference);

/* While enabling: holds at this angle of a frame that turns at `speed`, with this current. */
void standstill_hold_align(struct standstill_hold *hold, angle_t angle, num_t speed, num_t current);

/* Enabling ends: the current is the design's again, and the hold goes on if it may at rest. */
void standstill_hold_end_aligning(struct standstill_hold *hold,
                                  const struct standstill_hold_params *params);

/* Background: the current of the hold from now on, to which i_d* ramps. One word. */
static inline void standstill_hold_put_current(struct standstill_hold *hold, num_t current)
{
    hold->current = current;
}

/* Background: the d current of motion from now on, to which i_d* ramps. One word. */
static inline void standstill_hold_put_motion_current(struct standstill_hold *hold, num_t current)
{
    hold->motion_current = current;
}

/* Background: where, off the reference, a hold that waits may begin; 2^-32 turn. One word. */
static inline void standstill_hold_put_place(struct standstill_hold *hold, int32_t place)
{
    hold->place = place;
}

/* Background, of a hold that is active: a frame off its reference comes nearer by at most this. */
void standstill_hold_lead_back(struct standstill_hold *hold, int32_t angle);

/* Bumpless transfer: the ramp of i_d* begins here. */
void standstill_hold_preset(struct standstill_hold *hold, num_t i_d);

/*
 * The frame of a reference that creeps, and its speed; `goes_on`: it will move again. It turns by a
 * few degrees electrical at most from one call to the next, and counts as at rest for as long.
 */
__attribute__((noinline)) void standstill_hold_follow(struct standstill_hold *hold,
                                                      angle_t reference, num_t speed, bool goes_on);

/* Every fourth period of a hold is for its slow work: where it leads its rotor the frame turns,
   where it rests the resistance is adapted. What else takes its time and can wait leaves it alone.
   A share of the interrupts, not a time. `periods`: in this state, whenever the drive was switched
   on. */
static inline bool standstill_hold_works_in(uint32_t periods)
{
    return (periods & 3u) == 1u;
}

/* One period of the ramp: moves the d current by at most `step` towards `target`; returns it. */
static inline num_t standstill_hold_ramp(struct standstill_hold *hold, num_t target, num_t step)
{
    if (RARE(hold->i_d != target)) {
        hold->i_d += num_clamp(target - hold->i_d, -step, step);
    }
    return hold->i_d;
}

/* One period of the hold: its d current. */
static inline num_t standstill_hold_current(struct standstill_hold *hold,
                                            const struct standstill_hold_params *params)
{
    return standstill_hold_ramp(hold, hold->current, params->ramp_in);
}

/* One period of motion: its d current. */
static inline num_t standstill_hold_motion_current(struct standstill_hold *hold,
                                                   const struct standstill_hold_params *params)
{
    return standstill_hold_ramp(hold, hold->motion_current, params->ramp_out);
}

/*
 * At the end of a period: the hold ends with it if the reference moves (`slow_periods` is 0), and
 * leads the rotor from then on if it is `moving` all the same. So no interrupt pays for both the
 * hold and the position law.
 */
void standstill_hold_leave(struct standstill_hold *hold, uint32_t slow_periods, bool moving);

/* The reference has been slow for long enough. */
static inline bool standstill_hold_waits(const struct standstill_hold_params *params,
                                         uint32_t slow_periods)
{
    return RARE(slow_periods >= params->delay_periods);
}

/*
 * Enters a hold that waits for it if the rotor has come near the reference, or is where the hold
 * may begin, from the next period on. `position_error` in electrical turns.
 */
void standstill_hold_consider(struct standstill_hold *hold,
                              const struct standstill_hold_params *params, angle_t reference,
                              num_t position_error, num_t speed);

/* The q current of the hold; `speed`: by how much the rotor is faster than the reference. */
num_t standstill_hold_torque_current(const struct standstill_hold_params *params, num_t speed,
                                     num_t load_torque);

#endif
