#include "firmware/application/setting_change.h"

#include <stddef.h>

#include "firmware/application/application.h"
#include "firmware/application/settings_record.h"
#include "firmware/design/refusal.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/settings_in_motion.h"

bool setting_change_waits(const struct application *application)
{
    const uint32_t period = interrupt_view_period(&application->drive);

    return application_settings_wait(application, period + application_typed_delay(application));
}

/* What was learned of another motor is worth nothing; what is given, learning begins with. */
static void begin_to_learn(struct application *application, const struct setting *of)
{
    struct drive_settings *chosen = &application->chosen;

    if (of == NULL || setting_is_of_motor(of)) {
        chosen->initial_torque_constant_change = 0.0;
    } else if (of->offset != offsetof(struct drive_settings, initial_torque_constant_change)) {
        return;
    }
    torque_constant_put(&application->drive,
                        num_from_double(chosen->initial_torque_constant_change));
}

/* Puts `changed` in force, at the next enable or at once. */
static bool accept(struct application *application, const struct drive_settings *changed,
                   bool in_motion, char refusal[DRIVE_ERROR_TEXT])
{
    struct drive *drive = &application->drive;

    (void)design_refuse(refusal, "this is set while the drive is disabled");
    if (in_motion && interrupt_view_state(drive) != DRIVE_OPERATION_ENABLED) {
        (void)design_refuse(refusal, "the drive is being enabled, wait until it is ready");
        in_motion = false;
    }
    if (!setting_change_waits(application) &&
        !(in_motion && settings_in_motion_change(drive, changed, refusal))) {
        return false;
    }
    application->chosen = *changed;
    application->awaits_enable = true;
    return true;
}

/* Of what is no real number: whether it is one of its values at all. */
static bool is_whole(const struct setting *setting, double value)
{
    return setting->type == SETTING_REAL ||
           (value >= setting->least && value <= setting->most && value == (double)(int32_t)value);
}

enum setting_change setting_change(struct application *application, const struct setting *setting,
                                   size_t element, double value, char refusal[DRIVE_ERROR_TEXT])
{
    struct drive_settings changed = application->chosen;

    if (!is_whole(setting, value)) {
        (void)design_refuse(refusal, setting->name);
        return SETTING_OUT_OF_RANGE;
    }
    setting_choose(&changed, setting, element, value);
    if (!setting_check(&changed, setting, refusal)) {
        return SETTING_OUT_OF_RANGE;
    }
    if (!accept(application, &changed, setting->in_motion, refusal)) {
        return SETTING_NOT_NOW;
    }
    begin_to_learn(application, setting);
    return SETTING_CHANGED;
}

bool settings_restore(struct application *application, char refusal[DRIVE_ERROR_TEXT])
{
    struct drive_settings defaults;

    drive_settings_default(&defaults, &application->chosen.motor);
    if (!accept(application, &defaults, false, refusal)) {
        return false;
    }
    begin_to_learn(application, NULL);
    return true;
}

enum record_writing settings_store(struct application *application, char refusal[DRIVE_ERROR_TEXT])
{
    const struct drive_command learned = {.kind = DRIVE_COMMAND_STORE};
    struct drive *drive = &application->drive;

    if (!drive_settings_check(&application->chosen, refusal) ||
        !drive_command(drive, &learned, refusal)) {
        return RECORD_REFUSED;
    }
    application->chosen.initial_torque_constant_change =
        num_to_double(drive->torque_constant.change);
    drive_feed_watchdog(drive); /* one of the two may have erased a page, the other may, too */
    (void)design_refuse(refusal, "the board has no parameter store, or refused to write");
    return settings_record_write(&application->board, &application->chosen);
}
