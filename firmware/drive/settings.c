#include "firmware/design/refusal.h"
#include "firmware/drive/board_limits.h"
#include "firmware/drive/drive_interface.h"
#include "firmware/linkage.h"

static const double not_given = __builtin_nan("");

CALLED_FROM_OUTSIDE void drive_settings_default(struct drive_settings *settings,
                                                const struct motor_params *motor)
{
    const struct drive_settings defaults = {
        .motor = *motor,
        .law = POSITION_LAW_STATE_FEEDBACK,
        .estimator = DRIVE_ESTIMATOR_INVARIANT_EKF,
        .law_bandwidth_rad_s = not_given,
        .feed_forward = true,
        .current_bandwidth_rad_s = not_given,
        .observer_bandwidth_rad_s = not_given,
        .high_gain_epsilon_s = 1e-3,
        .synchronism_policy = DRIVE_SYNCHRONISM_FAULT,
        .bridge_loss_compensation = true,
        .current_limit_A = motor->rated_current_A,
        .overcurrent_trip_A = not_given,
        .speed_limit_rad_s = default_speed_limit_rad_s(motor),
        .resistance_adaptation = true,
        .hold_current_A = not_given,
        .hold_ramp_s = 0.010,
        .hold_delay_s = not_given,
        .hold_at_rest = true,
        .hold_bandwidth_rad_s = not_given,
        .calibrate_offsets = true,
        .hold_on_enable = true,
        .hold_on_enable_s = 0.150,
    };
    *settings = defaults;
    for (int i = 0; i < DRIVE_LAW_GAINS; i++) {
        settings->law_gains[i] = not_given;
    }
}

CALLED_FROM_OUTSIDE void drive_settings_select_feedback(struct drive_settings *settings,
                                                        enum drive_feedback feedback)
{
    settings->feedback = feedback;
    settings->hold_at_rest = feedback == DRIVE_FEEDBACK_SENSORLESS;
    drive_settings_select_law(settings, feedback == DRIVE_FEEDBACK_ENCODER
                                            ? POSITION_LAW_FEEDBACK_LINEARISATION
                                            : POSITION_LAW_STATE_FEEDBACK);
}

CALLED_FROM_OUTSIDE void drive_settings_select_law(struct drive_settings *settings,
                                                   enum position_law law)
{
    settings->law = law;
    settings->law_bandwidth_rad_s = not_given;
    settings->current_bandwidth_rad_s = not_given;
    settings->observer_bandwidth_rad_s = not_given;
    settings->detent_learning =
        law == POSITION_LAW_FEEDBACK_LINEARISATION && settings->feedback == DRIVE_FEEDBACK_ENCODER;
}

/* Name, value and allowed range of one setting. */
struct bounded {
    const char *name;
    double value;
    double min;
    double max;
    const char *unit;
};

static bool check(const struct bounded *setting, char error[DRIVE_ERROR_TEXT])
{
    struct refusal refusal = {.quantity = setting->name,
                              .value = setting->value,
                              .unit = setting->unit,
                              .reason = "the range of this setting"};

    if (!(setting->value >= setting->min)) {
        refusal.relation = "at least";
        refusal.limit = setting->min;
        return design_refuse_limit(error, refusal);
    }
    if (!(setting->value <= setting->max)) {
        refusal.relation = "at most";
        refusal.limit = setting->max;
        return design_refuse_limit(error, refusal);
    }
    return true;
}

/* NaN, not given, becomes a value that is in order. */
static double or_in_order(double value, double in_order)
{
    return value == value ? value : in_order;
}

/* Ranges wide enough for any hybrid stepper, narrow enough to catch a slip of the unit. */
bool drive_settings_check(const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT])
{
    const struct motor_params *motor = &settings->motor;
    const double rated = motor->rated_current_A;
    const struct bounded bounds[] = {
        {"resistance_ohm", motor->resistance_ohm, 1e-3, 1e3, "ohm"},
        {"inductance_H", motor->inductance_H, 1e-6, 1.0, "H"},
        {"torque_constant_Nm_A", motor->torque_constant_Nm_A, 1e-4, 100.0, "N m/A"},
        {"viscous_friction_Nms_rad", motor->viscous_friction_Nms_rad, 0.0, 10.0, "N m s/rad"},
        {"inertia_kgm2", motor->inertia_kgm2, 1e-9, 10.0, "kg m2"},
        {"rated_current_A", rated, 1e-2, 50.0, "A"},
        {"supply_V", motor->supply_V, 5.0, 400.0, "V"},
        {"rotor_teeth", (double)motor->rotor_teeth, 1.0, 1000.0, ""},
        {"law_bandwidth_rad_s", or_in_order(settings->law_bandwidth_rad_s, 100.0), 1.0, 1e4,
         "rad/s"},
        {"current_bandwidth_rad_s", or_in_order(settings->current_bandwidth_rad_s, 1000.0), 10.0,
         1e6, "rad/s"},
        {"observer_bandwidth_rad_s", or_in_order(settings->observer_bandwidth_rad_s, 1000.0), 1.0,
         1e6, "rad/s"},
        {"high_gain_epsilon_s", settings->high_gain_epsilon_s, 1e-7, 1.0, "s"},
        {"hold_bandwidth_rad_s", or_in_order(settings->hold_bandwidth_rad_s, 100.0), 1.0, 1e4,
         "rad/s"},
        {"encoder_zero_rad", settings->encoder_zero_rad, -1e4, 1e4, "rad"},
        {"initial_load_torque_Nm", settings->initial_load_torque_Nm, -100.0, 100.0, "N m"},
        {"current_limit_A", settings->current_limit_A, 0.01 * rated, 2.0 * rated, "A"},
        {"overcurrent_trip_A", or_in_order(settings->overcurrent_trip_A, rated), 0.1 * rated,
         6.0 * rated, "A"},
        {"speed_limit_rad_s", settings->speed_limit_rad_s, 0.1, 1e4, "rad/s"},
        {"hold_current_A", or_in_order(settings->hold_current_A, rated), 0.01 * rated, rated, "A"},
        {"motion_current_A", settings->motion_current_A, 0.0, rated, "A"},
        {"hold_ramp_s", settings->hold_ramp_s, 1e-3, 1.0, "s"},
        {"hold_delay_s", or_in_order(settings->hold_delay_s, 0.0), 0.0, 100.0, "s"},
        {"hold_on_enable_s", settings->hold_on_enable_s, 0.01, 10.0, "s"},
        {"initial_angle_rad", settings->initial_angle_rad, -1e4, 1e4, "rad"},
        {"initial_angle_error_rad", settings->initial_angle_error_rad, -10.0, 10.0, "rad"},
    };

    for (size_t i = 0; i < sizeof bounds / sizeof bounds[0]; i++) {
        if (!check(&bounds[i], error)) {
            return false;
        }
    }
    for (int i = 0; i < DRIVE_DETENT_COEFFICIENTS; i++) {
        const struct bounded coefficient = {"detent_torque_Nm", settings->detent_torque_Nm[i],
                                            -100.0, 100.0, "N m"};

        if (!check(&coefficient, error)) {
            return false;
        }
    }
    if (settings->detent_learning && (settings->feedback != DRIVE_FEEDBACK_ENCODER ||
                                      settings->observer != DRIVE_OBSERVER_MODEL)) {
        return design_refuse(error, "detent_learning: needs an encoder and its model observer");
    }
    if (settings->standstill_pulses && settings->initial_position == DRIVE_INITIAL_POSITION_TOLD) {
        return design_refuse(error, "standstill_pulses: needs initial_position impulses, which "
                                    "show what the motor's saturation is");
    }
    if (settings->feedback == DRIVE_FEEDBACK_ENCODER &&
        settings->initial_position != DRIVE_INITIAL_POSITION_TOLD) {
        return design_refuse(error,
                             "initial_position: an encoder has its own way, encoder_zero_known");
    }
    return true;
}

const char *drive_state_name(enum drive_state state)
{
    static const char *const names[DRIVE_STATES] = {
        [DRIVE_SWITCH_ON_DISABLED] = "switch-on-disabled",
        [DRIVE_CALIBRATING_OFFSETS] = "calibrating-offsets",
        [DRIVE_FINDING_POSITION] = "finding-position",
        [DRIVE_ALIGNING] = "aligning",
        [DRIVE_OPERATION_ENABLED] = "operation-enabled",
        [DRIVE_FAULT] = "fault",
    };
    return names[state];
}

const char *drive_fault_name(enum drive_fault fault)
{
    static const char *const names[DRIVE_FAULTS] = {
        [DRIVE_FAULT_NONE] = "none",
        [DRIVE_FAULT_OVERCURRENT] = "overcurrent",
        [DRIVE_FAULT_HARDWARE_OVERCURRENT] = "hardware-overcurrent",
        [DRIVE_FAULT_DEADLINE_MISSED] = "deadline-missed",
        [DRIVE_FAULT_BUS_VOLTAGE] = "bus-voltage",
        [DRIVE_FAULT_ESTIMATE_RANGE] = "estimate-range",
        [DRIVE_FAULT_OFFSET_RANGE] = "offset-range",
        [DRIVE_FAULT_POSITION_NOT_FOUND] = "position-not-found",
        [DRIVE_FAULT_LOST_SYNCHRONISM] = "lost-synchronism",
        [DRIVE_FAULT_STALLED] = "stalled",
    };
    return names[fault];
}

const char *drive_law_name(enum position_law law)
{
#define LAW_TEXT(constant, function, text) text,
    static const char *const names[] = {POSITION_LAWS(LAW_TEXT)};
#undef LAW_TEXT
    return names[law];
}

const char *drive_feedback_name(enum drive_feedback feedback)
{
    static const char *const names[DRIVE_FEEDBACKS] = {
        [DRIVE_FEEDBACK_SENSORLESS] = "sensorless",
        [DRIVE_FEEDBACK_ENCODER] = "encoder",
    };
    return names[feedback];
}

const char *drive_observer_name(enum drive_observer observer)
{
    static const char *const names[DRIVE_OBSERVERS] = {
        [DRIVE_OBSERVER_MODEL] = "model",
        [DRIVE_OBSERVER_HIGH_GAIN] = "high-gain",
    };
    return names[observer];
}

const char *drive_estimator_name(enum drive_estimator estimator)
{
    static const char *const names[DRIVE_ESTIMATORS] = {
        [DRIVE_ESTIMATOR_INVARIANT_EKF] = "invariant-ekf",
        [DRIVE_ESTIMATOR_STEADY_STATE_EKF] = "steady-state-ekf",
    };
    return names[estimator];
}

const char *drive_voltage_source_name(enum drive_voltage_source source)
{
    static const char *const names[DRIVE_VOLTAGE_SOURCES] = {
        [DRIVE_VOLTAGE_MEASURED] = "measured",
        [DRIVE_VOLTAGE_COMMANDED] = "commanded",
    };
    return names[source];
}

const char *drive_initial_position_name(enum drive_initial_position position)
{
    static const char *const names[DRIVE_INITIAL_POSITIONS] = {
        [DRIVE_INITIAL_POSITION_TOLD] = "told",
        [DRIVE_INITIAL_POSITION_IMPULSES] = "impulses",
        [DRIVE_INITIAL_POSITION_PUBLISHED_IMPULSES] = "published-impulses",
    };
    return names[position];
}

const char *drive_synchronism_name(enum drive_synchronism synchronism)
{
    static const char *const names[DRIVE_SYNCHRONISMS] = {
        [DRIVE_SYNCHRONISM_SURE] = "sure",
        [DRIVE_SYNCHRONISM_DOUBTFUL] = "doubtful",
        [DRIVE_SYNCHRONISM_STALLED] = "stalled",
        [DRIVE_SYNCHRONISM_LOST] = "lost",
    };
    return names[synchronism];
}

const char *drive_synchronism_policy_name(enum drive_synchronism_policy policy)
{
    static const char *const names[DRIVE_SYNCHRONISM_POLICIES] = {
        [DRIVE_SYNCHRONISM_FAULT] = "fault",
        [DRIVE_SYNCHRONISM_WARN] = "warn",
        [DRIVE_SYNCHRONISM_OFF] = "off",
    };
    return names[policy];
}
