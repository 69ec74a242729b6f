/*
 * Holding at rest (Bendjedia 2012, section V): without motion there is no back-EMF to see the
 * rotor by, so a d current draws it into place like a compass needle. The current frame is fixed
 * to the reference; the q current carries the estimated load and damps.
 *
 *   i_d* ramps to the hold current,   i_q* = T_L/Km - 2 K_w w
 *
 * Entered when the reference has rested for a while and the rotor has come near it, left as soon
 * as the reference moves; the d current then ramps out in the rotor frame, where it makes no
 * torque.
 */
#ifndef STEADYSTEP_STANDSTILL_HOLD_H
#define STEADYSTEP_STANDSTILL_HOLD_H

#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"

struct standstill_hold_params {
    num_t current;        /* i_d* when ramped in */
    num_t motion_current; /* i_d* when ramped out */
    num_t current_ramp;   /* per period */
    num_t current_limit;  /* of the q current */
    coef_t damping;       /* 2 K_w */
    uint32_t delay_periods;
    num_t error_limit; /* electrical turns within which the hold may be entered */
    num_t speed_limit;
};

struct standstill_hold {
    bool active;
    struct sincos frame; /* of the reference at which the hold was entered */
    num_t i_d;
};

struct standstill_hold_task {
    double current_A;
    double motion_current_A;
    double ramp_s;
    double delay_s;
    double current_limit_A;
    double speed_gain_As_rad; /* K_w of the state feedback at the drive's bandwidth */
    double period_s;
};

struct standstill_hold_params standstill_hold_design(const struct per_unit *base,
                                                     const struct standstill_hold_task *task);

void standstill_hold_reset(struct standstill_hold *hold);

/* Holds from now on, the current frame fixed to this reference. */
void standstill_hold_enter(struct standstill_hold *hold, angle_t reference);

/* One period: ramps the d current in or out and returns it. */
num_t standstill_hold_step(struct standstill_hold *hold,
                           const struct standstill_hold_params *params);

/*
 * At the end of a period: the hold ends with it if the reference moves (`rest_periods` is 0). So no
 * interrupt pays for both the hold and the position law.
 */
void standstill_hold_leave(struct standstill_hold *hold, uint32_t rest_periods);

/*
 * Enters the hold if the reference has rested for long enough and the rotor has come near it: the
 * frame at once, its currents from the next period on. `position_error` in electrical turns.
 */
void standstill_hold_consider(struct standstill_hold *hold,
                              const struct standstill_hold_params *params, angle_t reference,
                              uint32_t rest_periods, num_t position_error, num_t speed);

/* The q current of the hold. */
num_t standstill_hold_torque_current(const struct standstill_hold_params *params, num_t speed,
                                     num_t load_torque);

#endif
