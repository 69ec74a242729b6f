/*
 * The closed-loop run that the target tests replay: settings, commands and laws, shared by the
 * host program that records it and the ARM program that replays it.
 */
#ifndef STEADYSTEP_REPLAY_CASE_H
#define STEADYSTEP_REPLAY_CASE_H

#include <string.h>

#include "firmware/interface/drive_interface.h"
#include "hal/sil/firmware_image.h"

/* The image under test: firmware_image_<REPLAY_NUMERIC>. */
#define REPLAY_JOIN(prefix, numeric) prefix##numeric
#define REPLAY_IMAGE_OF(numeric)     REPLAY_JOIN(firmware_image_, numeric)
#define REPLAY_IMAGE                 REPLAY_IMAGE_OF(REPLAY_NUMERIC)

/* The varying fields of hal_samples; the others are zero in this run. 12 bytes a period. */
struct replay_samples {
    uint16_t current_a, current_b, bus_voltage;
    int16_t phase_voltage_a, phase_voltage_b;
    int16_t encoder_step; /* counts since the period before */
};

enum { REPLAY_ENCODER_COUNTS = 16384 };

/*
 * Every state of the drive and every limit in a short time: offsets and a 30 ms hold when enabled,
 * then a third of a second of commands.
 */
enum {
    REPLAY_READY = 1540, /* enabling has ended: 1225 periods of offsets, 300 of hold */
    REPLAY_LOAD_FROM = REPLAY_READY + 50, /* 0.1 N m until REPLAY_LOAD_TO */
    REPLAY_LOAD_TO = REPLAY_READY + 1400,
    REPLAY_PERIODS = REPLAY_READY + 3260 /* 4800 periods fit the emulated flash */
};

/* One row of a list of commands: a drive_command of which the run uses a few fields. */
#define REPLAY_PLAIN(kind, at)                                                                     \
    {                                                                                              \
        kind, at, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0                                               \
    }
#define REPLAY_MOVE(kind, at, position_rad, duration_s, ramp_s, jerk_s)                            \
    {                                                                                              \
        kind, at, position_rad, duration_s, ramp_s, jerk_s, 0, 0, 0, 0, 0, 0, 0, 0                 \
    }
#define REPLAY_SINE(at, amplitude_rad, frequency_Hz, cycles, ramp_s)                               \
    {                                                                                              \
        DRIVE_COMMAND_SINE, at, 0, 0, ramp_s, 0, amplitude_rad, frequency_Hz, cycles, 0, 0, 0, 0,  \
            0                                                                                      \
    }
#define REPLAY_SET_POINT(at, position_rad, interval_s, acceleration_rad_s2, jerk_rad_s3)           \
    {                                                                                              \
        DRIVE_COMMAND_SET_POINT, at, position_rad, 0, 0, 0, 0, 0, 0, interval_s, 0,                \
            acceleration_rad_s2, jerk_rad_s3, 0                                                    \
    }
#define REPLAY_TOWARDS(kind, at, position_rad, speed_rad_s, acceleration_rad_s2, jerk_rad_s3)      \
    {                                                                                              \
        kind, at, position_rad, 0, 0, 0, 0, 0, 0, 0, speed_rad_s, acceleration_rad_s2,             \
            jerk_rad_s3, 0                                                                         \
    }

#define REPLAY_TORQUE(at, torque_Nm, speed_rad_s)                                                  \
    {                                                                                              \
        DRIVE_COMMAND_TORQUE, at, 0, 0, 0, 0, 0, 0, 0, 0, speed_rad_s, 0, 0, torque_Nm             \
    }

/* A move under load, a rest, a reversal too fast for the supply, a step, a stop. */
static const struct drive_command replay_moves[] = {
    REPLAY_PLAIN(DRIVE_COMMAND_ENABLE, 5),
    REPLAY_MOVE(DRIVE_COMMAND_MOVE_TRAPEZOID, REPLAY_READY, 2.0, 0.120, 0.040, 0),
    REPLAY_MOVE(DRIVE_COMMAND_MOVE_SMOOTH, REPLAY_READY + 1900, -0.2, 0.070, 0.030, 0.010),
    REPLAY_MOVE(DRIVE_COMMAND_STEP, REPLAY_READY + 2750, -0.17, 0, 0, 0),
    REPLAY_MOVE(DRIVE_COMMAND_MOVE_TRAPEZOID, REPLAY_READY + 2900, 4.0, 0.200, 0.060, 0),
    REPLAY_PLAIN(DRIVE_COMMAND_STOP, REPLAY_READY + 3100),
};

/* The same below 30 rad/s. */
static const struct drive_command replay_slow_moves[] = {
    REPLAY_PLAIN(DRIVE_COMMAND_ENABLE, 5),
    REPLAY_MOVE(DRIVE_COMMAND_MOVE_TRAPEZOID, REPLAY_READY, 2.0, 0.120, 0.040, 0),
    REPLAY_MOVE(DRIVE_COMMAND_MOVE_SMOOTH, REPLAY_READY + 1900, 0.9, 0.070, 0.030, 0.010),
    REPLAY_MOVE(DRIVE_COMMAND_STEP, REPLAY_READY + 2750, 0.93, 0, 0, 0),
    REPLAY_MOVE(DRIVE_COMMAND_MOVE_TRAPEZOID, REPLAY_READY + 2900, 4.0, 0.200, 0.060, 0),
    REPLAY_PLAIN(DRIVE_COMMAND_STOP, REPLAY_READY + 3100),
};

/* What the background plans: a sine, set-points that run dry, a velocity, its reversal, a new
   target on the way, a velocity that is stopped. */
static const struct drive_command replay_references[] = {
    REPLAY_PLAIN(DRIVE_COMMAND_ENABLE, 5),
    REPLAY_SINE(REPLAY_READY, 0.1, 10.0, 1.0, 0.030),
    REPLAY_SET_POINT(REPLAY_READY + 1300, 0.02, 0.010, 2000.0, 4e5),
    REPLAY_SET_POINT(REPLAY_READY + 1400, 0.06, 0.010, 2000.0, 4e5),
    REPLAY_SET_POINT(REPLAY_READY + 1500, 0.12, 0.010, 2000.0, 4e5),
    REPLAY_TOWARDS(DRIVE_COMMAND_VELOCITY, REPLAY_READY + 1700, 0, 12.0, 2000.0, 4e5),
    REPLAY_TOWARDS(DRIVE_COMMAND_VELOCITY, REPLAY_READY + 2080, 0, -12.0, 2000.0, 4e5),
    REPLAY_TOWARDS(DRIVE_COMMAND_RETARGET, REPLAY_READY + 2440, 0.5, 15.0, 2000.0, 4e5),
    REPLAY_TOWARDS(DRIVE_COMMAND_VELOCITY, REPLAY_READY + 2980, 0, 10.0, 2000.0, 4e5),
    REPLAY_PLAIN(DRIVE_COMMAND_STOP, REPLAY_READY + 3120),
};

/* Torques with an encoder, up to a speed: from rest under a load, there and back, faster, to the
 * end. */
static const struct drive_command replay_torques[] = {
    REPLAY_PLAIN(DRIVE_COMMAND_ENABLE, 5),         REPLAY_TORQUE(REPLAY_READY, 0.3, 60.0),
    REPLAY_TORQUE(REPLAY_READY + 800, -0.1, 60.0), REPLAY_TORQUE(REPLAY_READY + 1200, -0.3, 40.0),
    REPLAY_TORQUE(REPLAY_READY + 2200, 0.4, 90.0),
};

#define REPLAY_COUNT(list) ((int)(sizeof(list) / sizeof(list)[0]))
#define REPLAY_MOVES       replay_moves, REPLAY_COUNT(replay_moves)
#define REPLAY_SLOW_MOVES  replay_slow_moves, REPLAY_COUNT(replay_slow_moves)
#define REPLAY_REFERENCES  replay_references, REPLAY_COUNT(replay_references)
#define REPLAY_TORQUES     replay_torques, REPLAY_COUNT(replay_torques)

enum { REPLAY_GAINS = 2 };

struct replay_gain {
    const char *name; /* NULL: none */
    double value;
};

struct replay_case {
    const char *name;
    enum position_law law;
    enum drive_feedback feedback;
    enum drive_estimator estimator;
    const struct drive_command *commands;
    int command_count;
    double speed_limit_rad_s; /* 0: the drive's default */
    struct replay_gain gain[REPLAY_GAINS];
};

#define REPLAY_NO_GAINS                                                                            \
    {                                                                                              \
        {NULL, 0},                                                                                 \
        {                                                                                          \
            NULL, 0                                                                                \
        }                                                                                          \
    }

#define REPLAY_SENSORLESS(name, law, estimator, commands)                                          \
    {                                                                                              \
        name, law, DRIVE_FEEDBACK_SENSORLESS, estimator, commands, 0, REPLAY_NO_GAINS              \
    }
#define REPLAY_ENCODER(name, law, commands)                                                        \
    {                                                                                              \
        name, law, DRIVE_FEEDBACK_ENCODER, DRIVE_ESTIMATOR_INVARIANT_EKF, commands, 0,             \
            REPLAY_NO_GAINS                                                                        \
    }

static const struct replay_case replay_cases[] = {
    REPLAY_SENSORLESS("default-sensorless", POSITION_LAW_STATE_FEEDBACK,
                      DRIVE_ESTIMATOR_INVARIANT_EKF, REPLAY_MOVES),
    REPLAY_SENSORLESS("references", POSITION_LAW_STATE_FEEDBACK, DRIVE_ESTIMATOR_INVARIANT_EKF,
                      REPLAY_REFERENCES),
    REPLAY_SENSORLESS("pid", POSITION_LAW_PID, DRIVE_ESTIMATOR_INVARIANT_EKF, REPLAY_MOVES),
    REPLAY_SENSORLESS("steady-state-ekf", POSITION_LAW_STATE_FEEDBACK,
                      DRIVE_ESTIMATOR_STEADY_STATE_EKF, REPLAY_MOVES),
    REPLAY_ENCODER("feedback-linearisation", POSITION_LAW_FEEDBACK_LINEARISATION, REPLAY_MOVES),
    REPLAY_ENCODER("encoder-references", POSITION_LAW_FEEDBACK_LINEARISATION, REPLAY_REFERENCES),
    REPLAY_ENCODER("torque", POSITION_LAW_FEEDBACK_LINEARISATION, REPLAY_TORQUES),
    REPLAY_ENCODER("microstepping", POSITION_LAW_MICROSTEPPING, REPLAY_MOVES),
    /* What the law accepts with this winding: 4 R/(N L). */
    {"stmms", POSITION_LAW_STMMS, DRIVE_FEEDBACK_ENCODER, DRIVE_ESTIMATOR_INVARIANT_EKF,
     REPLAY_SLOW_MOVES, 32.8, REPLAY_NO_GAINS},
    REPLAY_ENCODER("stmms-plus", POSITION_LAW_STMMS_PLUS, REPLAY_MOVES),
    REPLAY_ENCODER("foc", POSITION_LAW_FOC, REPLAY_MOVES),
    REPLAY_ENCODER("csmc", POSITION_LAW_CSMC, REPLAY_MOVES),
    REPLAY_ENCODER("csmc-equivalent", POSITION_LAW_CSMC_EQUIVALENT, REPLAY_MOVES),
    {"csmc-servo",
     POSITION_LAW_CSMC_SERVO,
     DRIVE_FEEDBACK_ENCODER,
     DRIVE_ESTIMATOR_INVARIANT_EKF,
     REPLAY_MOVES,
     0,
     {{"servo_frequency_rad_s", 31.4159}, {NULL, 0}}},
    /* With the supply on the d axis nothing would be left for the torque (smc.h). */
    {"smc",
     POSITION_LAW_SMC,
     DRIVE_FEEDBACK_ENCODER,
     DRIVE_ESTIMATOR_INVARIANT_EKF,
     REPLAY_MOVES,
     0,
     {{"M_V", 12.0}, {"M_d_V", 6.0}}},
};

enum { REPLAY_CASES = sizeof replay_cases / sizeof replay_cases[0] };

static inline const struct replay_case *replay_case_named(const char *name)
{
    for (int k = 0; k < (int)REPLAY_CASES; ++k)
        if (strcmp(replay_cases[k].name, name) == 0)
            return &replay_cases[k];
    return NULL;
}

/* Gives the law a gain by its name. */
static inline void replay_set_gain(struct drive_settings *settings, const struct replay_gain *gain)
{
    const char *name;

    if (gain->name == NULL)
        return;
    for (int k = 0; (name = REPLAY_IMAGE.law_gain(settings->law, (size_t)k)) != NULL; ++k)
        if (strcmp(name, gain->name) == 0)
            settings->law_gains[k] = gain->value;
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
    settings->balance_phases = false;    /* takes 0.18 s */
    settings->encoder_zero_known = true; /* aligning takes longer than this hold */
    if (which->law != POSITION_LAW_MICROSTEPPING)
        settings->following_error_rad = 100.0; /* watched; the reversal is too fast for some laws */
    if (which->speed_limit_rad_s > 0.0)
        settings->speed_limit_rad_s = which->speed_limit_rad_s;
    for (int k = 0; k < (int)REPLAY_GAINS; ++k)
        replay_set_gain(settings, &which->gain[k]);
}

#endif
