#include "firmware/application/application.h"

#include "firmware/application/settings_record.h"
#include "firmware/design/refusal.h"
#include "firmware/design/text.h"
#include "firmware/drive/drive_hash.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/motion_current.h"
#include "firmware/interface/parts_carried.h"
#include "firmware/interface/settings.h"
#include "firmware/linkage.h"

static const struct hal_outputs bridge_off = {.bridge_on = false};

__attribute__((noinline)) uint32_t application_typed_delay(const struct application *application)
{
    return drive_typed_delay_periods(application->facts.control_period_s);
}

/* By `settings`, which are in force then. */
static bool design(struct application *application, const struct drive_settings *settings,
                   bool starts, char error[DRIVE_ERROR_TEXT])
{
    const uint32_t counts = (uint32_t)settings->encoder_counts_per_turn;

    application->facts.encoder_counts_per_turn = counts > 0u ? counts : application->board_counts;
    if (!machine_io_start(application, starts, error)) {
        return false;
    }
    if (reads_encoder(settings) && application->facts.encoder_counts_per_turn == 0u) {
        return design_refuse(error, "feedback = encoder, but none is known: set "
                                    "encoder_counts_per_turn, or feedback = sensorless");
    }
    if (!(starts ? drive_init(&application->drive, &application->board, settings, error)
                 : drive_design(&application->drive, settings, error))) {
        return false;
    }
    application->gains_hash = drive_hash_gains(&application->drive.params);
    application->timeout_periods =
        (uint32_t)(settings->command_timeout_s / application->facts.control_period_s + 0.5);
    application->in_force = *settings;
    application->awaits_enable = false;
    return true;
}

static void prepare(struct application *application, const struct hal *board)
{
    application->board = *board;
    application->facts = *board->facts;
    application->board_counts = board->facts->encoder_counts_per_turn;
    application->board.facts = &application->facts;
    application->outputs = bridge_off;
    application->cycles = (struct control_cycles){.periods = 0};
    application->cycle_statistics = (struct control_cycle_statistics){.periods = 0};
    application->stored_refusal[0] = '\0';
    application->heard_in = 0;
    application->unheard = false;
    application->io = (struct machine_io){.stop = MACHINE_STOP_NONE};
    console_init(&application->console);
    application->link = NULL;
}

CALLED_FROM_OUTSIDE void application_put_link(struct application *application, struct link *link)
{
    link_init(link);
    application->link = link;
    if (LINK_CARRIED && application->chosen.modbus_rtu) {
        link_open_modbus(application);
    }
}

/* What was stored for parts that this image does not carry. */
static void leave_out(struct application *application)
{
    struct drive_settings *stored = &application->chosen;
    struct text names = text_in(application->stored_refusal, sizeof application->stored_refusal);
    const struct setting *setting;

    for (size_t i = 0; (setting = setting_number(i)) != NULL; i++) {
        if (setting_is_left_out(setting) && setting_get(stored, setting, 0) != setting->preset) {
            setting_put(stored, setting, 0, setting->preset);
            text_put(&names, " ");
            text_put(&names, setting->name);
        }
    }
}

static bool read_stored(struct application *application)
{
    if (!settings_record_read(&application->board, &application->chosen)) {
        return false;
    }
    if (!SETTINGS_CARRIED) {
        leave_out(application);
    }
    return true;
}

static bool start_with_stored(struct application *application, char error[DRIVE_ERROR_TEXT])
{
    if (!read_stored(application)) {
        return false;
    }
    application->settings_from = APPLICATION_SETTINGS_STORED;
    return design(application, &application->chosen, true, error) ||
           design_refuse(application->stored_refusal, error);
}

CALLED_FROM_OUTSIDE bool application_init(struct application *application, const struct hal *board,
                                          const struct motor_params *motor_default,
                                          char error[DRIVE_ERROR_TEXT])
{
    prepare(application, board);
    if (start_with_stored(application, error)) {
        return true;
    }
    application->settings_from = APPLICATION_SETTINGS_DEFAULT;
    drive_settings_default(&application->chosen, motor_default);
    return design(application, &application->chosen, true, error);
}

bool application_init_with(struct application *application, const struct hal *board,
                           const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT])
{
    prepare(application, board);
    application->settings_from = APPLICATION_SETTINGS_GIVEN;
    application->chosen = *settings;
    return design(application, &application->chosen, true, error);
}

/* What was learned stays learned. Refused, the drive is as it was before. */
static bool design_anew(struct application *application, char error[DRIVE_ERROR_TEXT])
{
    struct learned_parameters learned;
    const bool learns = drive_learned(&application->drive, &learned);
    const num_t torque_constant = application->drive.torque_constant.change;
    const bool accepted = design(application, &application->chosen, false, error);

    if (!accepted) {
        char none[DRIVE_ERROR_TEXT];

        (void)design(application, &application->in_force, false, none);
        application->awaits_enable = true;
    }
    if (learns) {
        drive_put_learned(&application->drive, &learned);
    }
    torque_constant_put(&application->drive, torque_constant);
    return accepted;
}

bool application_settings_wait(const struct application *application, uint32_t at_period)
{
    const struct drive *drive = &application->drive;
    const enum drive_state found = drive_state_by(drive, at_period);

    return (found == DRIVE_SWITCH_ON_DISABLED || found == DRIVE_FAULT) &&
           !command_queue_enable_waits(&drive->commands);
}

void application_recall_settings(struct application *application)
{
    const uint32_t period = interrupt_view_period(&application->drive);

    if (!application_settings_wait(application, period + application_typed_delay(application))) {
        return;
    }
    if (!read_stored(application) && application->settings_from != APPLICATION_SETTINGS_GIVEN) {
        drive_settings_default(&application->chosen, &application->chosen.motor);
    }
    application->awaits_enable = true;
}

/* Before an enable that would begin with it: puts in force what was set. */
static bool prepare_enable(struct application *application, uint32_t *at_period,
                           char error[DRIVE_ERROR_TEXT])
{
    const struct drive *drive = &application->drive;

    if (!application->awaits_enable ||
        drive_state_by(drive, *at_period) != DRIVE_SWITCH_ON_DISABLED) {
        return true;
    }
    if (!application_settings_wait(application, interrupt_view_period(drive))) {
        return design_refuse(error, "enable refused: settings have changed, wait until the bridge "
                                    "is off");
    }
    if (!design_anew(application, error)) {
        return false;
    }
    const uint32_t period = interrupt_view_period(drive);

    if ((int32_t)(*at_period - period) <= 0) {
        *at_period = period + application_typed_delay(application);
    }
    return true;
}

void application_hear(struct application *application, uint32_t period)
{
    application->heard_in = period;
    application->unheard = false;
}

/* The reference moves, or will. */
static bool commands_motion(const struct drive *drive)
{
    return interrupt_view_state(drive) == DRIVE_OPERATION_ENABLED &&
           (interrupt_view_moves(drive) || command_queue_holds_any(&drive->commands));
}

/* Acts as if it had been asked for in the period in which the time is over, whenever the background
   comes to it. */
static void stop_if_unheard(struct application *application)
{
    const struct drive *drive = &application->drive;
    const uint32_t over = application->heard_in + application->timeout_periods;
    char refusal[DRIVE_ERROR_TEXT];

    if (application->timeout_periods > 0u && !application->unheard &&
        (int32_t)(interrupt_view_period(drive) - over) >= 0 && commands_motion(drive)) {
        const struct drive_command stop = {
            .kind = DRIVE_COMMAND_STOP,
            .at_period = over + application_typed_delay(application),
        };

        application->unheard = drive_command_asked_in(&application->drive, &stop, over, refusal);
    }
}

bool application_command(struct application *application, struct drive_command *command,
                         uint32_t asked_in, char error[DRIVE_ERROR_TEXT])
{
    application_hear(application, asked_in);
    return (!MACHINE_IO_CARRIED || machine_io_allows(application, command, error)) &&
           (command->kind != DRIVE_COMMAND_ENABLE ||
            prepare_enable(application, &command->at_period, error)) &&
           drive_command_asked_in(&application->drive, command, asked_in, error);
}

CALLED_FROM_OUTSIDE void application_follow_control(struct application *application)
{
    if (LINK_CARRIED && application->link != NULL) {
        capture_follow(&application->link->capture, &application->drive);
    }
}

CALLED_FROM_OUTSIDE void application_background(struct application *application)
{
    drive_feed_watchdog(&application->drive);
    drive_background(&application->drive);
    phase_watch_background(&application->drive);
    idle_current_background(&application->drive);
    motion_current_background(&application->drive);
    standing_rotor_background(&application->drive);
    thermal_watch_background(&application->drive);
    rotor_watch_background(&application->drive);
    lead_watch_background(&application->drive);
    belt_watch_background(&application->drive);
    torque_constant_background(&application->drive);
    stop_if_unheard(application);
    if (MACHINE_IO_CARRIED) {
        machine_io_background(application);
    }
    control_cycles_gather(&application->cycle_statistics, &application->cycles);
    console_background(application);
}
