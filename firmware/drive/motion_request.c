/* From the units of a command to those of the reference: turns and periods. */
#include "firmware/design/elementary.h"
#include "firmware/design/refusal.h"
#include "firmware/drive/board_limits.h"
#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"

/* Ranges of the reference, electrical turns per period^n: profile.c */
#define SPEED_MAX_TURNS        0.45
#define ACCELERATION_MAX_TURNS 0.0078125

#define DURATION_MAX      1073741824.0 /* 2^30 periods */
#define JERK_TIME_MAX     131072.0 /* 2^17 periods: rounding of the jerk stays far below 2^-32 turn */
#define SINE_PERIODS_MIN  20.0     /* of a cycle */
#define INTERVAL_MIN      3.0      /* periods: a segment each */
#define INTERVAL_MAX      65536.0
#define AMPLITUDE_MIN_rad 1e-6
#define SPEED_MIN_rad_s   1e-9
#define FREQUENCY_MIN_Hz  1e-3
#define CYCLES_MAX        1e9

static const double two_pi = 6.283185307179586476925;

/* What one turn and one period are. */
struct units {
    double turn_rad;
    double period_s;
    double speed;        /* rad/s per turn/period */
    double acceleration; /* rad/s^2 per turn/period^2 */
    double jerk;
};

static struct units units_of(const struct drive *drive)
{
    const double T = drive->board->facts->control_period_s;
    const double turn = two_pi / (double)drive->settings.motor.rotor_teeth;

    return (struct units){turn, T, turn / T, turn / (T * T), turn / (T * T * T)};
}

/* What the drive can follow, rad/s and rad/s^2. */
static struct speed_limit speed_limit(const struct drive *drive, const struct units *units)
{
    struct speed_limit limit = board_limits_speed(&drive->settings, drive->board->facts);

    limit.rad_s = smaller(limit.rad_s, SPEED_MAX_TURNS * units->speed);
    return limit;
}

static double acceleration_limit(const struct drive *drive, const struct units *units)
{
    const struct drive_settings *settings = &drive->settings;

    return smaller(settings->current_limit_A * settings->motor.torque_constant_Nm_A /
                       settings->motor.inertia_kgm2,
                   ACCELERATION_MAX_TURNS * units->acceleration);
}

static bool limits_of(const struct drive *drive, const struct drive_command *command,
                      struct motion_limits *limits, char error[DRIVE_ERROR_TEXT])
{
    const struct units units = units_of(drive);
    const double speed = speed_limit(drive, &units).rad_s;
    const double acceleration = acceleration_limit(drive, &units);
    const double slowest = 2.0 * speed / (DURATION_MAX * units.period_s);
    const double softest = command->acceleration_rad_s2 / (JERK_TIME_MAX * units.period_s);

    if (!design_require_within(error, "acceleration", command->acceleration_rad_s2, slowest,
                               acceleration, "rad/s^2", "limit of the drive") ||
        !design_require_within(error, "jerk", command->jerk_rad_s3, softest, 1e30, "rad/s^3",
                               "2^17 control periods to the acceleration")) {
        return false;
    }
    limits->speed = speed / units.speed;
    limits->acceleration = command->acceleration_rad_s2 / units.acceleration;
    limits->jerk = command->jerk_rad_s3 / units.jerk;
    return true;
}

static bool request_velocity(const struct drive *drive, const struct drive_command *command,
                             struct motion_request *request, char error[DRIVE_ERROR_TEXT])
{
    const struct units units = units_of(drive);
    const struct speed_limit limit = speed_limit(drive, &units);

    request->speed = command->speed_rad_s / units.speed;
    return design_require_within(error, "speed", command->speed_rad_s, -limit.rad_s, limit.rad_s,
                                 "rad/s", limit.reason) &&
           limits_of(drive, command, &request->limits, error);
}

/* Of a reference that may be in motion: its position is longer than a word. */
__attribute__((noinline)) static struct position reference_position(const struct drive *drive)
{
    struct reference now;

    (void)interrupt_view_reference(drive, &now);
    return now.next.position;
}

static bool request_retarget(struct drive *drive, const struct drive_command *command,
                             struct motion_request *request, char error[DRIVE_ERROR_TEXT])
{
    const struct units units = units_of(drive);
    const struct speed_limit limit = speed_limit(drive, &units);
    const double range = POSITION_TURNS_MAX * units.turn_rad;
    const int32_t teeth = drive->settings.motor.rotor_teeth;
    const struct position here = reference_position(drive);
    double distance;

    if (!design_require_within(error, "position", command->position_rad, -range, range, "rad",
                               "range of positions") ||
        !planned_end_require_in_range(drive, here, error)) {
        return false;
    }
    request->target =
        position_minus(position_from_rad(command->position_rad, teeth), drive->planned_end.offset);
    distance = magnitude(command->position_rad -
                         position_to_rad(position_plus(here, drive->planned_end.offset), teeth));
    const double slowest = larger(distance / (DURATION_MAX * units.period_s), SPEED_MIN_rad_s);

    if (!design_require_within(
            error, "speed", command->speed_rad_s, slowest, larger(limit.rad_s, slowest), "rad/s",
            command->speed_rad_s < slowest ? "2^30 periods to go" : limit.reason) ||
        !limits_of(drive, command, &request->limits, error)) {
        return false;
    }
    request->limits.speed = command->speed_rad_s / units.speed;
    return true;
}

static bool request_set_point(const struct drive *drive, const struct drive_command *command,
                              struct motion_request *request, char error[DRIVE_ERROR_TEXT])
{
    const struct units units = units_of(drive);
    const double intervals = command->interval_s / units.period_s;

    if (!design_require_within(error, "interval", intervals, INTERVAL_MIN - 0.5, INTERVAL_MAX,
                               "periods", "3 to 2^16 control periods") ||
        !limits_of(drive, command, &request->limits, error)) {
        return false;
    }
    request->interval_periods = (uint32_t)(intervals + 0.5);
    return true;
}

static bool request_sine(const struct drive *drive, const struct drive_command *command,
                         struct motion_request *request, char error[DRIVE_ERROR_TEXT])
{
    const struct units units = units_of(drive);
    const double T = units.period_s;
    const double amplitude = magnitude(command->amplitude_rad);
    const double halves = 2.0 * command->cycles;
    const double stop_s = 0.1;
    const struct speed_limit speed = speed_limit(drive, &units);
    struct motion_limits *limits = &request->limits;

    if (!design_require_within(error, "amplitude", amplitude, AMPLITUDE_MIN_rad,
                               POSITION_TURNS_MAX * units.turn_rad, "rad", "range of amplitudes") ||
        !design_require_within(error, "frequency", command->frequency_Hz, FREQUENCY_MIN_Hz,
                               1.0 / (SINE_PERIODS_MIN * T), "Hz",
                               "20 control periods to a cycle") ||
        !design_require_within(error, "cycles", command->cycles, 0.0, CYCLES_MAX, "",
                               "range of cycles")) {
        return false;
    }
    if (halves != (double)(uint32_t)halves) {
        return design_refuse(error, "cycles: must be a whole number or a half");
    }
    if (!design_require_within(error, "ramp", command->ramp_s, 0.0, DURATION_MAX * T, "s",
                               "2^30 control periods") ||
        (command->cycles > 0.0 &&
         !design_require_within(error, "ramp", command->ramp_s, 0.0,
                                command->cycles / command->frequency_Hz / 2.0, "s",
                                "half of the cycles"))) {
        return false;
    }
    request->sine = sine_design(&(struct sine_task){
        .amplitude_turns = command->amplitude_rad / units.turn_rad,
        .frequency_Hz = command->frequency_Hz,
        .cycles = command->cycles,
        .ramp_s = command->ramp_s,
        .period_s = T,
    });
    *limits = sine_peaks(&request->sine);
    if (!design_require_within(error, "speed of the sine", limits->speed * units.speed, 0.0,
                               speed.rad_s, "rad/s", speed.reason) ||
        !design_require_within(
            error, "acceleration of the sine", limits->acceleration * units.acceleration, 0.0,
            acceleration_limit(drive, &units), "rad/s^2", "limit of the drive")) {
        return false;
    }
    /* a slow sine need not stop as slowly */
    if (limits->acceleration < limits->speed * T / stop_s) {
        limits->acceleration = limits->speed * T / stop_s;
    }
    if (limits->jerk < limits->acceleration * T / stop_s) {
        limits->jerk = limits->acceleration * T / stop_s;
    }
    return true;
}

/* It stops as a fieldbus's quick stop: with half of the acceleration. */
bool planner_request_torque(struct drive *drive, const struct drive_command *command,
                            struct torque_mode *asked, char error[DRIVE_ERROR_TEXT])
{
    const struct drive_settings *settings = &drive->settings;
    const double current_A = command->torque_Nm / settings->motor.torque_constant_Nm_A;
    const double rounded_A = 1e-3 * settings->motor.rated_current_A; /* by who states thousandths */
    const double most_A = settings->current_limit_A + rounded_A; /* the interrupt cuts the rest */
    const struct units units = units_of(drive);
    struct motion_request stop;
    struct drive_command velocity = {.speed_rad_s = command->speed_rad_s};

    if (!reads_encoder(settings)) {
        return design_refuse(error, "torque refused: without an encoder a slow rotor is lost");
    }
    if (velocity.speed_rad_s == 0.0) {
        velocity.speed_rad_s = speed_limit(drive, &units).rad_s;
    }
    velocity.acceleration_rad_s2 = 0.5 * acceleration_limit(drive, &units);
    velocity.jerk_rad_s3 = 200.0 * velocity.acceleration_rad_s2;
    if (!planned_end_require_no_stop(drive, error) ||
        !design_require_within(error, "torque's current", current_A, -most_A, most_A, "A",
                               "current_limit_A") ||
        !request_velocity(drive, &velocity, &stop, error)) {
        return false;
    }
    planner_stop_within(&drive->planner, &stop.limits);
    asked->current = num_from_double(current_A / drive->base.current_A);
    asked->speed = num_from_double(velocity.speed_rad_s / drive->base.speed_rad_s);
    return asked->speed > NUM(0.0) || design_refuse(error, "speed: must be above 0");
}

bool planner_request(struct drive *drive, const struct drive_command *command,
                     struct motion_request *request, char error[DRIVE_ERROR_TEXT])
{
    switch (command->kind) {
    case DRIVE_COMMAND_SINE:
        return request_sine(drive, command, request, error);
    case DRIVE_COMMAND_SET_POINT:
        return request_set_point(drive, command, request, error);
    case DRIVE_COMMAND_VELOCITY:
        return request_velocity(drive, command, request, error);
    default:
        return request_retarget(drive, command, request, error);
    }
}
