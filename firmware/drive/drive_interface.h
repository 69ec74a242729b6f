/*
 * The only way into a drive: settings before it is enabled, commands while it runs, and the
 * signals it shows. Scenarios, the serial line and a fieldbus link all use these types; they carry
 * SI units and know no number format, so one header serves float, fixed-point and double drives.
 */
#ifndef STEADYSTEP_DRIVE_INTERFACE_H
#define STEADYSTEP_DRIVE_INTERFACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/control/position_laws.h"
#include "firmware/motor/motor_params.h"

/* States of the drive; names and order of CiA 402 (IEC 61800-7-201), substates of enabling apart.
 */
enum drive_state {
    DRIVE_SWITCH_ON_DISABLED,  /* bridge off, waits for an enable command */
    DRIVE_CALIBRATING_OFFSETS, /* bridge off, converter offsets are averaged */
    DRIVE_ALIGNING,            /* d-axis hold at the known angle; series resistance is calibrated */
    DRIVE_OPERATION_ENABLED,   /* ready: holds or moves */
    DRIVE_FAULT,               /* bridge open until the drive is disabled */
    DRIVE_STATES
};

/* Why the bridge was opened. */
enum drive_fault {
    DRIVE_FAULT_NONE,
    DRIVE_FAULT_OVERCURRENT,          /* a sampled phase current beyond overcurrent_trip_A */
    DRIVE_FAULT_HARDWARE_OVERCURRENT, /* the board's comparator tripped */
    DRIVE_FAULT_DEADLINE_MISSED,      /* a control interrupt ended too late */
    DRIVE_FAULT_BUS_VOLTAGE,          /* measured bus outside 0.5...1.3 x nominal */
    DRIVE_FAULT_ESTIMATE_RANGE,       /* an estimate left its physical range or is not finite */
    DRIVE_FAULT_OFFSET_RANGE,         /* a converter offset too large to be an offset */
    DRIVE_FAULTS
};

enum drive_estimator {
    DRIVE_ESTIMATOR_INVARIANT_EKF,    /* constant-gain invariant EKF, exact current prediction */
    DRIVE_ESTIMATOR_STEADY_STATE_EKF, /* Bendjedia 2012: constant gain, Euler predictor */
    DRIVE_ESTIMATORS
};

/* Everything a drive is told before it is enabled. Fill with drive_settings_default first. */
struct drive_settings {
    struct motor_params motor;

    enum position_law law;
    enum drive_estimator estimator;
    double law_bandwidth_rad_s;     /* w0 of the position law, double pole; 200 */
    bool feed_forward;              /* reference speed and acceleration into the law; true */
    double current_bandwidth_rad_s; /* of the d-q current control; 1500 */
    double current_limit_A;         /* limit of the current reference; rated current */
    double overcurrent_trip_A;      /* software trip on a sampled phase current; 1.8 x rated */
    double speed_limit_rad_s; /* estimates beyond it open the bridge; 1.3 supply/Km, cut to 0.24
                                 electrical turn per period */

    bool resistance_adaptation; /* track the series resistance while holding; true */
    double hold_current_A;      /* d-axis current at rest; half the rated current */
    double hold_ramp_s;         /* time for the hold current to ramp in or out; 0.010 */
    double hold_delay_s;        /* from the end of a profile to the hold; 0.015 */

    bool calibrate_offsets;         /* step of enabling; true */
    bool hold_on_enable;            /* step of enabling: 150 ms hold before ready; true */
    double hold_on_enable_s;        /* 0.150 */
    double initial_angle_rad;       /* mechanical rotor angle the drive is told; 0 */
    double initial_angle_error_rad; /* added to it, to tell the drive something wrong; 0 */
};

enum drive_command_kind {
    DRIVE_COMMAND_ENABLE,
    DRIVE_COMMAND_DISABLE,        /* opens the bridge; clears a fault */
    DRIVE_COMMAND_HOLD,           /* ramps the hold current in at the present reference */
    DRIVE_COMMAND_MOVE_TRAPEZOID, /* trapezoid of speed: position, duration_s, ramp_s */
    DRIVE_COMMAND_MOVE_SMOOTH,    /* jerk-limited: ramp_s of which jerk_s each at its two ends */
    DRIVE_COMMAND_STEP,           /* position at once */
    DRIVE_COMMAND_STOP,           /* decelerates the reference to rest with the ramp in force */
    DRIVE_COMMANDS
};

/*
 * A command, addressed to a period: it acts in the control interrupt whose index is at_period
 * (0 is the first), or in the next one if that has passed. Moves are absolute and start from the
 * end of the last posted move.
 */
struct drive_command {
    enum drive_command_kind kind;
    uint32_t at_period;
    double position_rad; /* target, mechanical */
    double duration_s;   /* whole move, > 2 ramp_s or equal */
    double ramp_s;       /* one ramp of speed */
    double jerk_s; /* of MOVE_SMOOTH: constant-jerk part at each end of a ramp, <= ramp_s / 2 */
};

/* What a drive shows each period, valid after the control interrupt k: values at S(k). */
struct drive_signals {
    enum drive_state state;
    enum drive_fault fault;
    uint32_t period; /* index k of the control interrupt */
    bool holding;    /* d-axis hold in force */
    bool reference_moving;
    double theta_ref_rad; /* reference theta*(k) */
    double omega_ref_rad_s;
    double theta_est_rad; /* estimate (k|k) */
    double omega_est_rad_s;
    double load_torque_est_Nm;
    double i_d_A, i_q_A; /* measured currents in the control frame */
    double i_d_ref_A, i_q_ref_A;
    double u_d_V, u_q_V; /* commanded voltages, after the limit */
    double resistance_est_ohm;
    double bus_V;
};

enum { DRIVE_ERROR_TEXT = 160 };

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Fills `settings` with the documented defaults for `motor`.
 */
void drive_settings_default(struct drive_settings *settings, const struct motor_params *motor);

/*
 * Checks every setting against its physical range. Returns true, or false with the name of the
 * field, its value and the allowed range in `error`.
 */
bool drive_settings_check(const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT]);

/* Name of a state, fault, law or estimator as scenarios and the serial line spell it. */
const char *drive_state_name(enum drive_state state);
const char *drive_fault_name(enum drive_fault fault);
const char *drive_law_name(enum position_law law);
const char *drive_estimator_name(enum drive_estimator estimator);

#ifdef __cplusplus
}
#endif

#endif
