#include "firmware/design/refusal.h"
#include "firmware/drive/board_limits.h"
#include "firmware/interface/settings.h"
#include "firmware/linkage.h"

CALLED_FROM_OUTSIDE void drive_settings_default(struct drive_settings *settings,
                                                const struct motor_params *motor)
{
    settings->motor = *motor;
    settings_put_presets(settings);
    settings->speed_limit_rad_s = default_speed_limit_rad_s(motor);
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
    const double not_given = __builtin_nan("");

    for (int i = 0; law != settings->law && i < DRIVE_LAW_GAINS; i++) {
        settings->law_gains[i] = not_given; /* the other law's, by other names */
    }
    settings->law = law;
    settings->law_bandwidth_rad_s = not_given;
    settings->current_bandwidth_rad_s = not_given;
    settings->observer_bandwidth_rad_s = not_given;
    settings->detent_learning =
        law == POSITION_LAW_FEEDBACK_LINEARISATION && settings->feedback == DRIVE_FEEDBACK_ENCODER;
}

bool drive_settings_check(const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT])
{
    for (size_t i = 0; setting_number(i) != NULL; i++) {
        if (!setting_check(settings, setting_number(i), error)) {
            return false;
        }
    }
    if (settings->detent_learning && (settings->feedback != DRIVE_FEEDBACK_ENCODER ||
                                      settings->observer != DRIVE_OBSERVER_MODEL)) {
        return design_refuse(error, "detent_learning: needs an encoder and its model observer");
    }
    if (settings->standstill_pulses &&
        settings->initial_position == DRIVE_INITIAL_POSITION_ASSUMED) {
        return design_refuse(error, "standstill_pulses: needs initial_position impulses, which "
                                    "show what the motor's saturation is");
    }
    if (settings->feedback == DRIVE_FEEDBACK_ENCODER &&
        settings->initial_position != DRIVE_INITIAL_POSITION_ASSUMED) {
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
        [DRIVE_DETECTING_POSITION] = "detecting-position",
        [DRIVE_ALIGNING] = "aligning",
        [DRIVE_OPERATION_ENABLED] = "operation-enabled",
        [DRIVE_FAULT] = "fault",
    };
    return names[state];
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

const char *drive_position_reference_name(enum drive_position_reference reference)
{
    static const char *const names[DRIVE_POSITION_REFERENCES] = {
        [DRIVE_POSITION_ASSUMED] = "assumed",
        [DRIVE_POSITION_REFERENCED] = "referenced",
        [DRIVE_POSITION_KEPT] = "kept",
        [DRIVE_POSITION_UNCERTAIN] = "uncertain",
    };
    return names[reference];
}

/* The texts are those of the setting. */
#define NAME_OF(name, type, member)                                                                \
    const char *drive_##name##_name(enum type member)                                              \
    {                                                                                              \
        return setting_at(offsetof(struct drive_settings, member))->choices[member];               \
    }

NAME_OF(law, position_law, law)
NAME_OF(feedback, drive_feedback, feedback)
NAME_OF(estimator, drive_estimator, estimator)
NAME_OF(observer, drive_observer, observer)
NAME_OF(voltage_source, drive_voltage_source, voltage_source)
NAME_OF(initial_position, drive_initial_position, initial_position)
NAME_OF(synchronism_policy, drive_synchronism_policy, synchronism_policy)
