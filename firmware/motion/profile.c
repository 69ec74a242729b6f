#include "firmware/motion/profile.h"

#include "firmware/design/elementary.h"
#define TURNS_MAX              1e9         /* differences of two positions stay in int32_t */
#define DURATION_PERIODS_MAX   1073741824u /* 2^30: distances in 2^-32 turn stay in int64_t */
#define RAMP_PERIODS_MAX       1048576u    /* 2^20: keeps rounding_speed below 1e-7 turn/period */
#define RAMP_PERIODS_MIN       2u
#define SPEED_MAX_TURNS        0.45      /* per period; the angle of a period must not wrap */
#define ACCELERATION_MAX_TURNS 0.0078125 /* 2^-7 per period^2: range of reference.c */

static const double two_pi = 6.283185307179586476925;
static const double two_to_32 = 4294967296.0;

/* Nearest integer in 2^-64 turn; |turns| < 1/2. */
static int64_t in_2_64(double turns)
{
    double x = turns * two_to_32 * two_to_32;

    return (int64_t)(x < 0.0 ? x - 0.5 : x + 0.5);
}

/* The magnitude against the limit of the drive and against the range of the reference. */
static bool require_below(const char *quantity, double value, double limit, const char *reason,
                          double range, const char *unit, char error[DESIGN_ERROR_TEXT])
{
    return design_require_within(error, quantity, magnitude(value), 0.0, smaller(limit, range),
                                 unit, limit < range ? reason : "range of the reference");
}

/* The time in whole periods, low...high. */
static bool whole_periods(uint32_t *periods, const char *quantity, double time_s, uint32_t low,
                          uint32_t high, const char *reason, double period_s,
                          char error[DESIGN_ERROR_TEXT])
{
    double rounded = time_s / period_s + 0.5;

    if (rounded >= (double)low && rounded < (double)high + 1.0) {
        *periods = (uint32_t)rounded;
        return true;
    }
    return design_require_within(error, quantity, time_s, low * period_s, high * period_s, "s",
                                 reason);
}

/*
 * The distance `speed` (2^-64 turn per period) leaves over after `periods`, in turns. The product
 * has up to 95 bits, so the two halves of the speed are multiplied apart.
 */
static double distance_left(int64_t distance, int64_t speed, uint32_t periods)
{
    int64_t high = (speed >> 32) * (int64_t)periods;
    uint64_t low = (uint64_t)(uint32_t)speed * periods;

    return ((double)(distance - high) - (double)low / two_to_32) / two_to_32;
}

/* Jerk, acceleration and rounding speed of a ramp whose periods are set. */
static bool scale(struct profile *profile, const struct profile_drive *drive,
                  char error[DESIGN_ERROR_TEXT])
{
    const double turn_rad = two_pi / (double)drive->rotor_teeth;
    const double turn_rad_s = turn_rad / drive->period_s;
    const uint32_t to_speed = profile->jerk_periods + profile->acceleration_periods;
    const uint32_t at_speed = to_speed + profile->jerk_periods + profile->cruise_periods;
    const uint32_t all = at_speed + to_speed + profile->jerk_periods;
    const int64_t distance = position_distance(profile->start, profile->target);
    const double speed = (double)distance / two_to_32 / at_speed;
    const double acceleration = speed / to_speed;

    if (!require_below("cruise speed", speed * turn_rad_s, drive->speed_limit_rad_s,
                       drive->speed_limit_reason, SPEED_MAX_TURNS * turn_rad_s, "rad/s", error) ||
        !require_below("acceleration", acceleration * turn_rad_s / drive->period_s,
                       drive->acceleration_limit_rad_s2, "limit of the drive",
                       ACCELERATION_MAX_TURNS * turn_rad_s / drive->period_s, "rad/s^2", error)) {
        return false;
    }
    if (profile->jerk_periods > 0u) {
        profile->jerk_sixth = in_2_64(acceleration / (6.0 * profile->jerk_periods));
        profile->jerk = 6 * profile->jerk_sixth;
        profile->acceleration = profile->jerk * (int64_t)profile->jerk_periods;
    } else {
        profile->acceleration = 2 * in_2_64(acceleration / 2.0);
    }
    profile->creeps = magnitude(speed) * turn_rad_s <= drive->creep_rad_s;
    profile->rounding_speed =
        in_2_64(distance_left(distance, profile->acceleration * (int64_t)to_speed, at_speed) / all);
    return true;
}

bool profile_plan(struct profile *profile, struct position start, const struct profile_move *move,
                  const struct profile_drive *drive, char error[DESIGN_ERROR_TEXT])
{
    const double T = drive->period_s;
    const double position_max_rad = TURNS_MAX * two_pi / (double)drive->rotor_teeth;
    uint32_t duration = 0;
    uint32_t ramp = 0;
    uint32_t jerk = 0;

    if (!design_require_within(error, "position", move->position_rad, -position_max_rad,
                               position_max_rad, "rad", "range of positions")) {
        return false;
    }
    *profile = (struct profile){
        .start = start, .target = position_from_rad(move->position_rad, drive->rotor_teeth)};
    if (move->shape == PROFILE_STEP) {
        return true;
    }
    if (!whole_periods(&duration, "duration", move->duration_s, 2u * RAMP_PERIODS_MIN,
                       DURATION_PERIODS_MAX, "4 to 2^30 control periods", T, error)) {
        return false;
    }
    if (!whole_periods(&ramp, "ramp", move->ramp_s, RAMP_PERIODS_MIN,
                       duration / 2u < RAMP_PERIODS_MAX ? duration / 2u : RAMP_PERIODS_MAX,
                       "2 to 2^20 control periods, at most half the duration", T, error)) {
        return false;
    }
    if (move->shape == PROFILE_SMOOTH &&
        !whole_periods(&jerk, "jerk time", move->jerk_s, 1u, ramp / 2u,
                       "one control period to half the ramp", T, error)) {
        return false;
    }
    profile->jerk_periods = jerk;
    profile->acceleration_periods = ramp - 2u * jerk;
    profile->cruise_periods = duration - 2u * ramp;
    return scale(profile, drive, error);
}
