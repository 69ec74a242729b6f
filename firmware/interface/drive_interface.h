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
#include "firmware/interface/commands_table.h"
#include "firmware/interface/faults_table.h"
#include "firmware/interface/settings_table.h"
#include "firmware/interface/signals_table.h"
#include "firmware/motor/motor_params.h"

struct hal_facts;

/* States of the drive; names and order of CiA 402 (IEC 61800-7-201), substates of enabling apart.
 */
enum drive_state {
    DRIVE_SWITCH_ON_DISABLED,  /* bridge off, waits for an enable command */
    DRIVE_CALIBRATING_OFFSETS, /* converter offsets are averaged, with the bridge off, then on */
    DRIVE_DETECTING_POSITION,  /* voltage impulses, or a gentle alignment, find the rotor */
    DRIVE_ALIGNING,          /* d-axis hold at the known angle, or an encoder's zero is found by it;
                                series resistance is calibrated */
    DRIVE_OPERATION_ENABLED, /* ready: holds or moves */
    DRIVE_FAULT,             /* bridge open until the drive is disabled */
    DRIVE_STATES
};

/* Why the bridge was opened; faults_table.h has each with cause and remedy. */
#define DRIVE_FAULT_CONSTANT(constant, code, name, cause, limit, position, remedy)                 \
    DRIVE_FAULT_##constant,
enum drive_fault { DRIVE_FAULT_NONE, DRIVE_FAULTS_TABLE(DRIVE_FAULT_CONSTANT) DRIVE_FAULTS };
#undef DRIVE_FAULT_CONSTANT

/* The settings that are one of several: settings_table.h says what each constant means. */
#define DRIVE_CHOICE_CONSTANT(constant, text, sentence) constant,
enum drive_feedback { DRIVE_FEEDBACK_CHOICES(DRIVE_CHOICE_CONSTANT) DRIVE_FEEDBACKS };
enum drive_estimator { DRIVE_ESTIMATOR_CHOICES(DRIVE_CHOICE_CONSTANT) DRIVE_ESTIMATORS };
enum drive_observer { DRIVE_OBSERVER_CHOICES(DRIVE_CHOICE_CONSTANT) DRIVE_OBSERVERS };
enum drive_voltage_source {
    DRIVE_VOLTAGE_SOURCE_CHOICES(DRIVE_CHOICE_CONSTANT) DRIVE_VOLTAGE_SOURCES
};
enum drive_initial_position {
    DRIVE_INITIAL_POSITION_CHOICES(DRIVE_CHOICE_CONSTANT) DRIVE_INITIAL_POSITIONS
};
enum drive_synchronism_policy {
    DRIVE_SYNCHRONISM_POLICY_CHOICES(DRIVE_CHOICE_CONSTANT) DRIVE_SYNCHRONISM_POLICIES
};
#undef DRIVE_CHOICE_CONSTANT

/* Whether a sensorless drive's rotor runs with its estimate, in operation. */
enum drive_synchronism {
    DRIVE_SYNCHRONISM_SURE,
    DRIVE_SYNCHRONISM_DOUBTFUL, /* half of what makes a loss, or nothing left of the torque */
    DRIVE_SYNCHRONISM_STALLED,  /* the rotor does not follow, although the estimate is sound */
    DRIVE_SYNCHRONISM_LOST,     /* stays until the bridge is switched on anew */
    DRIVE_SYNCHRONISMS
};

/* What is known of the position that is shown, and of where a motion goes. */
enum drive_position_reference {
    DRIVE_POSITION_ASSUMED,    /* it began at initial_angle_rad; the axis has not been homed */
    DRIVE_POSITION_REFERENCED, /* by set-position or an absolute encoder */
    DRIVE_POSITION_KEPT,       /* it was referenced before the bridge was off; without an encoder
                                  nobody saw what moved the rotor meanwhile */
    DRIVE_POSITION_UNCERTAIN,  /* the rotor may be elsewhere: home the axis again */
    DRIVE_POSITION_REFERENCES
};

/* Room for the gains that a law can be given by name. */
enum { DRIVE_LAW_GAINS = 12 };

/* a_1, b_1, a_2, b_2, a_4, b_4 (control/detent_compensation.h). */
enum { DRIVE_DETENT_COEFFICIENTS = 6 };

/*
 * Everything a drive is set to before it is enabled: a member for each row of settings_table.h,
 * with its unit, range, default and meaning there. Fill with drive_settings_default first. A real
 * number may be NaN, not given, where the table says that it follows from motor, board and period.
 */
#define DRIVE_CHOICE_MEMBER(index, member, type, constants, preset, when, sentence)                \
    enum type member;
#define DRIVE_FLAG_MEMBER(index, member, preset, when, sentence)                     bool member;
#define DRIVE_REAL_MEMBER(index, member, unit, least, most, preset, when, sentence)  double member;
#define DRIVE_COUNT_MEMBER(index, member, unit, least, most, preset, when, sentence) int32_t member;
#define DRIVE_REALS_MEMBER(index, member, count, unit, least, most, preset, when, sentence)        \
    double member[count];
struct drive_settings {
    struct motor_params motor;
    DRIVE_SETTINGS(DRIVE_CHOICE_MEMBER, DRIVE_FLAG_MEMBER, DRIVE_REAL_MEMBER, DRIVE_REALS_MEMBER,
                   DRIVE_COUNT_MEMBER)
};
#undef DRIVE_CHOICE_MEMBER
#undef DRIVE_FLAG_MEMBER
#undef DRIVE_REAL_MEMBER
#undef DRIVE_REALS_MEMBER
#undef DRIVE_COUNT_MEMBER

/* Where and when a command is planned. */
enum drive_planning {
    DRIVE_AT_ONCE, /* acts in the background, in no period */
    DRIVE_URGENT,  /* the interrupt obeys it before all that waits, and flushes that */
    DRIVE_IN_TURN, /* nothing is: the interrupt obeys it in its turn */
    DRIVE_PROFILE, /* when it is posted; a profile waits with it for the reference to rest */
    DRIVE_AHEAD    /* in the background, DRIVE_LEAD_s ahead of its begin */
};

#define DRIVE_COMMAND_CONSTANT(number, constant, name, required, optional, states, planning,       \
                               sentence)                                                           \
    DRIVE_COMMAND_##constant,
enum drive_command_kind { DRIVE_COMMANDS_TABLE(DRIVE_COMMAND_CONSTANT) DRIVE_COMMANDS };
#undef DRIVE_COMMAND_CONSTANT

#define DRIVE_COMMAND_PLANNED(number, constant, name, required, optional, states, planned,         \
                              sentence)                                                            \
    || (kind == DRIVE_COMMAND_##constant && planning == DRIVE_##planned)
/* Background and interrupt; `planning` is a constant, which leaves a comparison or two. */
__attribute__((always_inline)) static inline bool drive_command_is(enum drive_command_kind kind,
                                                                   enum drive_planning planning)
{
    return false DRIVE_COMMANDS_TABLE(DRIVE_COMMAND_PLANNED);
}
#undef DRIVE_COMMAND_PLANNED

#define DRIVE_PARAMETER_PLACE(index, member, unit, least, most, sentence) DRIVE_PARAMETER_##member,
enum drive_parameter { DRIVE_PARAMETERS_TABLE(DRIVE_PARAMETER_PLACE) DRIVE_PARAMETERS };
#undef DRIVE_PARAMETER_PLACE

/*
 * A command, addressed to a period, is judged by the state that it will find there
 * (drive/command_rules.h): a move, say, is refused unless the drive is ready, and it is dropped and
 * counted if a fault has come when its period does. It acts in the control interrupt whose index is
 * at_period (0 is the first), or in the next one if that has passed. Moves are absolute and start
 * from the end of the last posted move. Of two disables or two stops that wait, the earlier period
 * counts. An enable may follow a disable at once; if the board's overcurrent trip comes between the
 * posting of the two and the disable, the drive is in fault again as soon as it is enabled. A drive
 * whose encoder's zero is known starts where its rotor is: it refuses all motion between the
 * posting of an enable and operation.
 *
 * Sine, set-points, velocity and retarget are planned by drive_background, DRIVE_LEAD_s ahead: they
 * act in the period they are addressed to if they are posted that much earlier, else that much
 * after their posting. Sine and set-points begin at rest and wait for it, as moves do. Velocity and
 * retarget preempt at once whatever is in motion when the commands before them have begun,
 * with continuous position, speed and acceleration; so does a stop of these four and of a torque,
 * with the limits they were given (the sine with its own largest acceleration and jerk),
 * DRIVE_LEAD_s after its period. Until the reference rests behind a sine, set-points, velocity or a
 * stop, moves are refused, because where they would start is not known; a retarget ends where it is
 * asked to, and moves may follow.
 *
 * Torque, of a drive with an encoder alone, acts in its period from whatever motion, and ends what
 * was planned; from then on the reference follows the rotor, until a stop, a velocity or a
 * retarget.
 *
 * A set-point is reached two intervals, DRIVE_LEAD_s and a period after its posting. The stream
 * ends when the last position comes three times; if it runs dry before, the reference comes to rest
 * with the limits given, and drive_signals counts an underrun.
 */
#define DRIVE_PARAMETER_MEMBER(index, member, unit, least, most, sentence) double member;
struct drive_command {
    enum drive_command_kind kind;
    uint32_t at_period;
    DRIVE_PARAMETERS_TABLE(DRIVE_PARAMETER_MEMBER)
};
#undef DRIVE_PARAMETER_MEMBER

/* A command that is typed acts so much later than the control period in which the last byte of its
   line has arrived, as the background takes to read a line; one that is planned DRIVE_LEAD_s after
   that. 10 control periods at 10 kHz. */
#define DRIVE_TYPED_DELAY_s 1e-3

static inline uint32_t drive_typed_delay_periods(double control_period_s)
{
    return (uint32_t)(DRIVE_TYPED_DELAY_s / control_period_s + 0.5);
}

/* How far ahead a typed line may ask for its period with at=. */
#define DRIVE_AHEAD_MAX_s 600.0

/* How far ahead of its begin a motion is planned; at least 3 periods. Doubled each time the
   background has been too late, up to DRIVE_LEAD_MAX_s, and back to DRIVE_LEAD_s once a plan has
   been in time or the drive is enabled anew. */
#define DRIVE_LEAD_s     1e-3
#define DRIVE_LEAD_MAX_s 50e-3

/* What a drive shows each period, valid after the control interrupt k: values at S(k); a member for
   each row of signals_table.h. */
#define DRIVE_FLAG_MEMBER(index, member, ...)                                  bool member;
#define DRIVE_COUNT_MEMBER(index, member, ...)                                 uint32_t member;
#define DRIVE_REAL_MEMBER(index, member, ...)                                  double member;
#define DRIVE_NAMED_MEMBER(index, member, path, brief, traced, type, sentence) enum type member;
struct drive_signals {
    DRIVE_SIGNALS_TABLE(DRIVE_FLAG_MEMBER, DRIVE_COUNT_MEMBER, DRIVE_REAL_MEMBER,
                        DRIVE_NAMED_MEMBER, DRIVE_REAL_MEMBER)
};
#undef DRIVE_FLAG_MEMBER
#undef DRIVE_COUNT_MEMBER
#undef DRIVE_REAL_MEMBER
#undef DRIVE_NAMED_MEMBER

enum { DRIVE_ERROR_TEXT = 160 };

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Fills `settings` with the documented defaults for `motor`.
 */
void drive_settings_default(struct drive_settings *settings, const struct motor_params *motor);

/* Chooses the feedback, and the law and the hold that are its defaults. */
void drive_settings_select_feedback(struct drive_settings *settings, enum drive_feedback feedback);

/* Chooses the law, and bandwidths and detent learning that are its defaults with the feedback. */
void drive_settings_select_law(struct drive_settings *settings, enum position_law law);

/*
 * Checks every setting against its physical range. Returns true, or false with the name of the
 * field, its value and the allowed range in `error`.
 */
bool drive_settings_check(const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT]);

/*
 * The speed, rad/s, below which a drive without an encoder is blind on this board: there the
 * back-EMF is less than what the offset that calibration leaves in the currents makes of the
 * resistance, offset x R / Km. 0 with an encoder.
 */
double drive_blind_speed_rad_s(const struct drive_settings *settings,
                               const struct hal_facts *facts);

/* What a drive without an encoder bears of a motor, from its hold as it is designed. */
struct drive_hold_bearing {
    double current_A;         /* of the hold */
    double heat_W;            /* that it makes of the winding, R current_A^2 */
    double torque_Nm;         /* lasting load that pulls the rotor out of it, Km current_A */
    double load_step_Nm;      /* the same of a load that comes at once, undamped */
    double noticed_step_Nm;   /* a load step of less is not followed: the rotor yields to it */
    double creep_speed_rad_s; /* up to it the hold leads the rotor */
    double motion_current_A;  /* d-axis current in slow motion, as the drive chooses it */
    double thrown_deg;        /* electrical; the estimate in motion, by 25 % of the rated torque */
    double drop_deg;          /* electrical; the estimate, by 2.5 % of R x rated current in 1/w_h */
};

/* Of settings that need not be complete, on a board that is blind below `blind_speed_rad_s`. False,
   with the refusal in `error`, if the drive does not bear the motor without an encoder. */
bool drive_hold_bearing_of(const struct drive_settings *settings, double period_s,
                           double blind_speed_rad_s, struct drive_hold_bearing *bearing,
                           char error[DRIVE_ERROR_TEXT]);

/* With the default law of an encoder of so many counts, as it is designed of settings that need not
   be complete: its stiffness J w0^2, N m/rad, against what it has not observed yet. */
double drive_law_stiffness_Nm_rad(const struct drive_settings *settings, double period_s,
                                  uint32_t counts_per_turn);

/* Name of a state, fault, command, law or estimator as scenarios and the serial line spell it. */
const char *drive_state_name(enum drive_state state);
const char *drive_fault_name(enum drive_fault fault);
const char *drive_command_name(enum drive_command_kind kind);
const char *drive_law_name(enum position_law law);
const char *drive_estimator_name(enum drive_estimator estimator);
const char *drive_feedback_name(enum drive_feedback feedback);
const char *drive_observer_name(enum drive_observer observer);
const char *drive_voltage_source_name(enum drive_voltage_source source);
const char *drive_initial_position_name(enum drive_initial_position position);
const char *drive_synchronism_name(enum drive_synchronism synchronism);
const char *drive_position_reference_name(enum drive_position_reference reference);
const char *drive_synchronism_policy_name(enum drive_synchronism_policy policy);

#ifdef __cplusplus
}
#endif

#endif
