/*
 * One position drive. The application owns the instance; a host may hold as many as it
 * likes. drive_control_cycle is the control interrupt, everything else is start-up or background.
 */
#ifndef STEADYSTEP_DRIVE_H
#define STEADYSTEP_DRIVE_H

#include "firmware/control/current_control.h"
#include "firmware/control/detent_compensation.h"
#include "firmware/control/modulator.h"
#include "firmware/control/position_law_dispatch.h"
#include "firmware/control/standstill_hold.h"
#include "firmware/drive/axis.h"
#include "firmware/drive/belt_watch.h"
#include "firmware/drive/brake.h"
#include "firmware/drive/command_queue.h"
#include "firmware/drive/expectation.h"
#include "firmware/drive/following_error.h"
#include "firmware/drive/idle_current.h"
#include "firmware/drive/inductance.h"
#include "firmware/drive/inductance_measurement.h"
#include "firmware/drive/lead_watch.h"
#include "firmware/drive/measurement.h"
#include "firmware/drive/offset_calibration.h"
#include "firmware/drive/parameter_store.h"
#include "firmware/drive/phase_balance.h"
#include "firmware/drive/phase_watch.h"
#include "firmware/drive/planned_end.h"
#include "firmware/drive/planner.h"
#include "firmware/drive/protection.h"
#include "firmware/drive/rotor_watch.h"
#include "firmware/drive/standing_rotor.h"
#include "firmware/drive/thermal_watch.h"
#include "firmware/drive/torque_constant.h"
#include "firmware/drive/torque_mode.h"
#include "firmware/estimator/encoder_alignment.h"
#include "firmware/estimator/estimator.h"
#include "firmware/estimator/initial_position.h"
#include "firmware/estimator/standstill_pulses.h"
#include "firmware/estimator/synchronism_monitor.h"
#include "firmware/interface/drive_interface.h"
#include "firmware/motion/reference.h"
#include "firmware/motor/actuation.h"
#include "firmware/motor/bridge_loss.h"
#include "firmware/simulation.h"
#include "hal/hal.h"

/* Which way the control interrupt goes. */
struct path_params {
    bool feed_forward;
    bool zero_delay; /* the answer acts from S(k) on, without a period of delay */
    bool general;    /* more is in use than a current law on the invariant EKF, with delay and loss
                        compensation */
    bool bridge_loss_compensation;
    bool infers_voltage; /* the phase voltages are not measured */
    bool detent_learning;
    bool standstill_pulses;
    bool prepares_input; /* the estimator's, beyond what is measured */
};

static inline bool has_zero_delay(const struct path_params *path)
{
    return SERVES_SIMULATION && path->zero_delay;
}

/* Of settings that are in force: false, and known to be, where no estimator reads an encoder. */
static inline bool reads_encoder(const struct drive_settings *settings)
{
    return ESTIMATORS_READ_ENCODER && settings->feedback == DRIVE_FEEDBACK_ENCODER;
}

/* The steps of enabling, and what is assumed of the motor before them. */
struct enabling_params {
    struct position initial_position;     /* rotor; with initial_angle_error_rad */
    struct position encoder_zero;         /* rotor where count 0 begins */
    struct position encoder_zero_assumed; /* with initial_angle_error_rad */
    num_t initial_load_torque;
    uint32_t hold_on_enable_periods;
    uint32_t balance_periods; /* behind the hold, at most; 0: the phases are not balanced */
    bool calibrates_offsets;
    bool detects_position;
    bool encoder_zero_known;
};

/* Constants: written at start-up, read by the interrupt. */
struct drive_params {
    struct measurement_params measurement;
    struct motor_model_params model;
    struct estimator_params estimator;
    struct reference_params reference;
    struct standstill_hold_params hold;
    struct current_control_params current_control;
    struct modulator_params modulator;
    struct protection_params protection;
    enum position_law position_law;
    struct path_params path;
    struct enabling_params enabling;
    union position_law_params law; /* large, so behind what every law uses */
    struct detent_compensation_params detent;
    struct bridge_loss_params bridge_loss;
    struct following_error_params following;
};

/* States, faults and the count of periods: state_machine.h. */
struct supervision {
    enum drive_state state;
    enum drive_fault fault;
    uint8_t asked_for; /* by the background, of the next interrupt: a fault, or to realign */
    bool aligns; /* draws the rotor to where it is assumed to be: what the encoder then knows of the
                    frame, and with it load and detent, is worth nothing */
    uint32_t period;      /* index of the present or last control interrupt; 0 is the first */
    uint32_t state_since; /* period in which the state was entered */
    uint32_t claimed;     /* period in which something rare was done last */
};

/* The synchronism monitor and what comes of its verdicts: synchronism.h. */
struct synchronism_supervision {
    uint32_t due; /* first period for the monitor's next step */
    enum drive_synchronism shown;
    uint8_t step; /* the monitor's next */
    enum drive_synchronism_policy policy;
    bool monitored;
    uint32_t block_began; /* period */
    struct synchronism_monitor monitor;
    struct synchronism_monitor_params params;
};

/* What the estimator gets instead of samples: prepared_input.h. */
struct prepared_input {
    struct phases past_current; /* of S(k-1), where the phase voltages are inferred from it */
};

/* Pulses on the hold: standstill_angle.h. */
struct standstill {
    struct standstill_pulses pulses;
    struct standstill_pulses_params params;
    struct phases loss_before_pulse;
    struct phases bias_of_motion; /* offset of the measured voltage before the hold */
};

/* The steps between switched off and operation. */
struct enabling {
    struct offset_calibration calibration;
    struct offset_calibration_params calibration_params;
    struct initial_position detection;
    struct initial_position_params detection_params;
    union { /* a drive has one or the other: without an encoder, with one */
        struct {
            struct phase_balance balance;
            struct inductance_measurement inductance;
            struct inductance_put inductance_put;
        };
        struct encoder_alignment alignment;
    };
    union {
        struct {
            struct phase_balance_params balance_params;
            struct inductance_measurement_params inductance_params;
        };
        struct encoder_alignment_params alignment_params;
    };
    num_t phase_imbalance;   /* as last found */
    num_t inductance_change; /* by what share that in force is above the settings' */
};

/*
 * In the order of nearness, for the core's sake: first what every interrupt uses. In the background
 * in an order that leaves no gaps. The members of each are written by its own functions alone.
 */
struct drive {
    /* blocks, in the order of the block diagram */
    struct measurement measurement;
    struct reference reference;
    struct estimator estimator;
    struct standstill_hold hold;
    struct current_control current_control;
    struct modulator modulator;
    struct actuation actuation;

    /* this period's inner signals, shown by drive_signals_read */
    struct dq current;
    struct dq current_reference;
    struct dq voltage_command;
    int32_t encoder_count; /* of this S(k) */

    struct drive_params params;

    /* the blocks that the default does without */
    union position_law_state law;
    struct detent_compensation detent;
    struct torque_mode torque;

    struct supervision supervision;
    struct {
        uint16_t a, b;
    } current_codes; /* of the last S(k) of a bridge that is on */
    struct axis axis;
    struct expectation expectation;
    struct synchronism_supervision synchronism;
    struct following_error following; /* with an encoder, in the monitor's place */
    struct prepared_input input;
    struct command_queue commands;

    /* background */
    struct phase_watch phase_watch;
    struct phase_watch_params phase_watch_params;
    struct belt_watch belt_watch;
    const struct hal *board;
    struct torque_constant torque_constant;
    struct idle_current idle;
    struct idle_current_params idle_params;
    struct thermal_watch thermal;
    struct rotor_watch rotor_watch;
    struct lead_watch lead_watch;
    struct standing_rotor standing;
    uint32_t fed_in; /* period in which the watchdog was fed */
    struct drive_settings settings;
    struct per_unit base;
    struct planned_end planned_end;
    struct brake brake;
    struct planner planner;

    /* behind all that an interrupt in operation uses */
    struct standstill standstill;
    struct enabling enabling;
};

/*
 * Start-up: checks the settings and designs every gain. false: refused, reason in error.
 * Takes up to 50 ms on a Cortex-M4F, 500 ms on a Cortex-M0+.
 */
__attribute__((noinline)) bool drive_init(struct drive *drive, const struct hal *board,
                                          const struct drive_settings *settings,
                                          char error[DRIVE_ERROR_TEXT]);

/*
 * Background, of a drive that is switch-on-disabled or in fault, with no enable waiting: the same
 * for other settings. Control interrupts go on meanwhile: of a drive whose bridge is off they use
 * nothing that is designed but the scale of the bus voltage. They count periods, take commands and
 * keep the bridge off; the watchdog is fed between the parts, of 100 ms at most on a Cortex-M0+.
 * Refused, the drive must be designed by settings that it accepts before it is enabled.
 */
__attribute__((noinline)) bool drive_design(struct drive *drive, const struct drive_settings *given,
                                            char error[DRIVE_ERROR_TEXT]);

/* Whether this image has the law; one that it has not is refused. */
bool drive_carries_law(enum position_law law);

/* Background: feeds the board's watchdog, if a control interrupt has come since it was fed: a board
   where none comes any more is to be reset. */
void drive_feed_watchdog(struct drive *drive);

/* Background: what has been learned since the start or before; false: the drive does not learn. */
bool drive_learned(const struct drive *drive, struct learned_parameters *learned);

/* Background, behind a design: goes on learning from there. */
void drive_put_learned(struct drive *drive, const struct learned_parameters *learned);

/* The control interrupt: from the samples of S(k) to the duties of S(k+1)...S(k+2). */
__attribute__((noinline)) void drive_control_cycle(struct drive *drive,
                                                   const struct hal_samples *samples,
                                                   struct hal_outputs *outputs);

/* Background: judges a command by command_rules.h, plans and posts it. false: refused, reason in
   error. */
bool drive_command(struct drive *drive, const struct drive_command *command,
                   char error[DRIVE_ERROR_TEXT]);

/* The same of one that was asked for in a period that may have passed. */
bool drive_command_asked_in(struct drive *drive, const struct drive_command *command,
                            uint32_t asked_in, char error[DRIVE_ERROR_TEXT]);

/* Background: the state that a command posted now for `at_period` will find: the present one, or
   switch-on-disabled if a disable waits that acts by then. A fault to come is not foreseen. */
enum drive_state drive_state_by(const struct drive *drive, uint32_t at_period);

/* Background: control periods in a time, to the nearest. */
static inline uint32_t drive_periods_in(const struct drive *drive, num_real time_s)
{
    return (uint32_t)(time_s / (num_real)drive->board->facts->control_period_s + (num_real)0.5);
}

/* Background: where the reference rests when all posted moves are done; the last place it was known
   to rest, while a stop, sine, set-points or a speed leave that open. */
double drive_planned_end_rad(struct drive *drive);

/*
 * Background: plans sines, set-points, speed changes, new targets and the stops of these, and keeps
 * those that go on supplied. To be called all the time, from the context that calls drive_command,
 * at least once in 3 ms (set-points: in half an interval); some ten instructions when nothing is to
 * be planned, up to 1 ms on a Cortex-M4F for a retarget.
 */
void drive_background(struct drive *drive);

/* Background: what the drive shows of the last period. */
void drive_signals_read(const struct drive *drive, struct drive_signals *signals);

/* Background, with an encoder, in operation: the position, in its middle, of a count that is
   not long ago. */
double drive_position_at_count_rad(const struct drive *drive, int32_t count);

#endif
