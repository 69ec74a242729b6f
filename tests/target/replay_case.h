/*
 * The closed-loop run that the target tests replay: settings, commands and laws, shared by the
 * host program that records it and the ARM program that replays it.
 */
#ifndef STEADYSTEP_REPLAY_CASE_H
#define STEADYSTEP_REPLAY_CASE_H

#include <string.h>

#include "firmware/drive/drive_interface.h"
#include "hal/sil/firmware_image.h"

/* The image under test: firmware_image_<REPLAY_NUMERIC>. */
#define REPLAY_JOIN(prefix, numeric) prefix##numeric
#define REPLAY_IMAGE_OF(numeric)     REPLAY_JOIN(firmware_image_, numeric)
#define REPLAY_IMAGE                 REPLAY_IMAGE_OF(REPLAY_NUMERIC)

/* The varying fields of hal_samples; the others are zero in this run. 16 bytes a period. */
struct replay_samples {
    uint16_t current_a, current_b, bus_voltage;
    int16_t phase_voltage_a, phase_voltage_b;
    int32_t encoder_count;
};

struct replay_case {
    const char *name;
    enum position_law law;
    enum drive_feedback feedback;
    enum drive_estimator estimator;
};

enum { REPLAY_ENCODER_COUNTS = 16384 };

static const struct replay_case replay_cases[] = {
    {"default-sensorless", POSITION_LAW_STATE_FEEDBACK, DRIVE_FEEDBACK_SENSORLESS,
     DRIVE_ESTIMATOR_INVARIANT_EKF},
    {"pid", POSITION_LAW_PID, DRIVE_FEEDBACK_SENSORLESS, DRIVE_ESTIMATOR_INVARIANT_EKF},
    {"steady-state-ekf", POSITION_LAW_STATE_FEEDBACK, DRIVE_FEEDBACK_SENSORLESS,
     DRIVE_ESTIMATOR_STEADY_STATE_EKF},
    {"default-encoder", POSITION_LAW_FEEDBACK_LINEARISATION, DRIVE_FEEDBACK_ENCODER,
     DRIVE_ESTIMATOR_INVARIANT_EKF},
    {"microstepping", POSITION_LAW_MICROSTEPPING, DRIVE_FEEDBACK_ENCODER,
     DRIVE_ESTIMATOR_INVARIANT_EKF},
};

enum { REPLAY_CASES = sizeof replay_cases / sizeof replay_cases[0] };

/*
 * Every state of the drive and every limit in a short time: offsets and a 30 ms hold when enabled,
 * a move under load, a rest with hold current, a reversal too fast for the supply, a stop.
 */
enum {
    REPLAY_READY = 900,     /* enabling has ended: 512 periods of offsets, 300 of hold */
    REPLAY_LOAD_FROM = 950, /* 0.1 N m until REPLAY_LOAD_TO */
    REPLAY_LOAD_TO = 2400,
    REPLAY_PERIODS = 4800
};

/* What the run uses of a drive_command. */
struct replay_command {
    enum drive_command_kind kind;
    uint32_t at_period;
    double position_rad, duration_s, ramp_s, jerk_s;
};

static const struct replay_command replay_commands[] = {
    {DRIVE_COMMAND_ENABLE, 5, 0, 0, 0, 0},
    {DRIVE_COMMAND_MOVE_TRAPEZOID, REPLAY_READY, 2.0, 0.120, 0.040, 0},
    {DRIVE_COMMAND_MOVE_SMOOTH, 3000, -0.2, 0.070, 0.030, 0.010},
    {DRIVE_COMMAND_STEP, 3900, -0.17, 0, 0, 0},
    {DRIVE_COMMAND_MOVE_TRAPEZOID, 4100, 4.0, 0.200, 0.060, 0},
    {DRIVE_COMMAND_STOP, 4500, 0, 0, 0, 0},
};

enum { REPLAY_COMMANDS = sizeof replay_commands / sizeof replay_commands[0] };

static inline struct drive_command replay_command(int k)
{
    const struct replay_command *from = &replay_commands[k];
    struct drive_command command;

    memset(&command, 0, sizeof command);
    command.kind = from->kind;
    command.at_period = from->at_period;
    command.position_rad = from->position_rad;
    command.duration_s = from->duration_s;
    command.ramp_s = from->ramp_s;
    command.jerk_s = from->jerk_s;
    return command;
}

static inline const struct replay_case *replay_case_named(const char *name)
{
    for (int k = 0; k < (int)REPLAY_CASES; ++k)
        if (strcmp(replay_cases[k].name, name) == 0)
            return &replay_cases[k];
    return NULL;
}

/* Motor: bendjedia-2012. */
static inline void replay_settings(const struct replay_case *which, struct drive_settings *settings)
{
    static const struct motor_params motor = {0.37,     0.9e-3, 0.157, 0.307e-3,
                                              15.62e-5, 3.0,    24.0,  50};
    drive_settings_default(settings, &motor);
    drive_settings_select_feedback(settings, which->feedback);
    drive_settings_select_law(settings, which->law);
    settings->estimator = which->estimator;
    settings->hold_on_enable_s = 0.030;
}

#endif
