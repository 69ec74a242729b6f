/*
 * Planning of a point-to-point move: a trapezoid of speed, a jerk-limited one, or a step.
 *
 * A profile is a ramp up, a cruise and the mirrored ramp down. A ramp of n_r periods is constant
 * acceleration A or, jerk-limited, n_j periods of jerk J, constant acceleration A = J n_j and n_j
 * periods of jerk -J. With n_c periods of cruise and the distance D:
 *
 *   cruise speed V = A (n_r - n_j),   D = V (n_r + n_c)      (n_j = 0 for the trapezoid)
 *
 * All quantities are integers in 2^-64 electrical turn per period^n, so that the reference
 * (reference.h) samples the continuous profile exactly, by additions, in every number format. The
 * distance that rounding A and J leaves over (below 1e-9 turn in moves of some seconds) is made up
 * by `rounding_speed`, added to the speed throughout; what is left then is far below 2^-32 turn.
 *
 * Runs in the background, in double precision.
 */
#ifndef STEADYSTEP_PROFILE_H
#define STEADYSTEP_PROFILE_H

#include "firmware/design/refusal.h"
#include "firmware/numeric/angle.h"

enum profile_shape {
    PROFILE_STEP,      /* target at once */
    PROFILE_TRAPEZOID, /* bounded acceleration */
    PROFILE_SMOOTH     /* bounded jerk, continuous acceleration */
};

/* A move as it is commanded; times are rounded to whole control periods. */
struct profile_move {
    enum profile_shape shape;
    double position_rad; /* target, mechanical, within +-10^9 electrical turns */
    double duration_s;   /* whole move, 4...2^30 periods */
    double ramp_s;       /* one ramp of speed, 2...2^20 periods, at most half the duration */
    double jerk_s;       /* PROFILE_SMOOTH: jerk at each end of a ramp, at least one period, at
                            most half the ramp */
};

/* What a move is planned for. */
struct profile_drive {
    double period_s;
    int32_t rotor_teeth;
    double speed_limit_rad_s;         /* of the cruise */
    const char *speed_limit_reason;   /* where it comes from */
    double acceleration_limit_rad_s2; /* of the ramps */
    double creep_rad_s;               /* up to where a move creeps */
};

/* A planned move. */
struct profile {
    struct position start;
    struct position target;
    int64_t jerk;         /* of the first phase; a multiple of 6 */
    int64_t jerk_sixth;   /* spares the interrupt a division */
    int64_t acceleration; /* of the first ramp; even */
    int64_t rounding_speed;
    uint32_t jerk_periods;
    uint32_t acceleration_periods; /* at constant acceleration */
    uint32_t cruise_periods;
    bool creeps; /* never faster than that */
};

/*
 * Plans the move from rest at `start`. Returns false, with the quantity, its value and the bound it
 * breaks in `error`, if a time or the position is out of range or not finite, if the cruise speed
 * exceeds its limit or 0.45 electrical turn per period, or the acceleration its limit or 2^-7
 * electrical turn per period^2. The profile is then undefined.
 */
bool profile_plan(struct profile *profile, struct position start, const struct profile_move *move,
                  const struct profile_drive *drive, char error[DESIGN_ERROR_TEXT]);

#endif
