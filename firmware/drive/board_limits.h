/*
 * What a board's sensing and the supply allow of a motor and its settings: refused where it cannot
 * work, and stated where the drive is blind. At start-up only.
 */
#ifndef STEADYSTEP_BOARD_LIMITS_H
#define STEADYSTEP_BOARD_LIMITS_H

#include "firmware/interface/drive_interface.h"
#include "hal/hal.h"

/* Shares of the nominal supply beyond which the protection opens the bridge. */
#define BUS_VOLTAGE_MIN 0.5
#define BUS_VOLTAGE_MAX 1.29

/* Default overcurrent trip / rated current. */
#define OVERCURRENT_SHARE 1.8

/* Default speed limit / the speed whose back-EMF is the supply. */
#define SPEED_LIMIT_SHARE 1.3

/* Of the following error with an encoder, electrical turns: the default limit, four full steps; and
   the largest, as position_difference shows no more than 15. */
#define FOLLOWING_ERROR_TURNS     1.0
#define FOLLOWING_ERROR_TURNS_MAX 14.0

/* Of the range in which the board measures currents: the rated current, above which the trip needs
   room, unless a current limit is given; a limit that is given, and the default trip. */
#define RATED_CURRENT_SHARE 0.8
#define CURRENT_LIMIT_SHARE 0.98

/* The supply, V, whose over-voltage a board's last code but one still shows. */
#define BOARD_SUPPLY_LIMIT_V(codes, V_per_code)                                                    \
    (((double)(codes)-2.0) * (V_per_code) / BUS_VOLTAGE_MAX)

/* The largest current, A, that in both directions leaves a code beyond it. */
#define BOARD_CURRENT_RANGE_A(codes, zero_code, A_per_code)                                        \
    (((double)(2 * (zero_code) < (codes) ? (zero_code) : (codes)-1 - (zero_code)) - 1.0) *         \
     (A_per_code))

#ifdef __cplusplus
extern "C" {
#endif

/* Default of speed_limit_rad_s. */
double default_speed_limit_rad_s(const struct motor_params *motor);

/*
 * Puts in force what follows from motor and board: overcurrent_trip_A, if it is not given. false:
 * over-voltage or overcurrent could never be seen; what was given, the limit and the reason are in
 * `error`.
 */
bool board_limits_apply(struct drive_settings *settings, const struct hal_facts *facts,
                        char error[DRIVE_ERROR_TEXT]);

/* The speed at which reference speeds end, and why there. */
struct speed_limit {
    double rad_s;
    const char *reason;
};

/* rad/s: at which back-EMF and friction leave nothing of the supply, or speed_limit_rad_s. */
double no_load_speed_rad_s(const struct drive_settings *settings, const struct hal_facts *facts);

/*
 * At which reference speeds end: at a fifth of an electrical turn in a period; where back-EMF and
 * friction leave nothing of the supply, without an encoder nothing but what drives a default ramp;
 * and at speed_limit_rad_s. Is that beyond its default, it counts instead of the supply: then
 * motion that lags for want of voltage is what is asked for.
 */
struct speed_limit board_limits_speed(const struct drive_settings *settings,
                                      const struct hal_facts *facts);

/*
 * What the supply drives along the torque at a speed, A: to accelerate there, and to brake from
 * there, where the back-EMF helps; 0: nothing. Of the largest modulation of the motor's supply.
 *
 *   V^2 = (Km w +- R i)^2 + (N w L i)^2
 */
struct supplied_current {
    float accelerating_A, braking_A;
};
struct supplied_current board_limits_current(const struct drive_settings *settings,
                                             const struct hal_facts *facts, float speed_rad_s);

#ifdef __cplusplus
}
#endif

#endif
