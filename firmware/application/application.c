#include "firmware/application/application.h"

#include "firmware/application/settings_record.h"
#include "firmware/design/refusal.h"
#include "firmware/drive/drive_hash.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/linkage.h"

static const struct hal_outputs bridge_off = {.bridge_on = false};

static bool start(struct application *application, const struct drive_settings *settings,
                  char error[DRIVE_ERROR_TEXT])
{
    application->chosen = *settings;
    if (settings->encoder_counts_per_turn > 0) {
        application->facts.encoder_counts_per_turn = (uint32_t)settings->encoder_counts_per_turn;
    }
    if (settings->feedback == DRIVE_FEEDBACK_ENCODER &&
        application->facts.encoder_counts_per_turn == 0u) {
        return design_refuse(error, "feedback = encoder, but the board has none that is known: set "
                                    "encoder_counts_per_turn, or feedback = sensorless");
    }
    if (!drive_init(&application->drive, &application->board, settings, error)) {
        return false;
    }
    application->gains_hash = drive_hash_gains(&application->drive.params);
    return true;
}

static void prepare(struct application *application, const struct hal *board)
{
    application->board = *board;
    application->facts = *board->facts;
    application->board.facts = &application->facts;
    application->outputs = bridge_off;
    application->cycles = (struct control_cycles){.periods = 0};
    application->stored_refused = false;
    application->fed_in = UINT32_MAX;
    console_init(&application->console);
}

/* Kept apart: the settings of one way to start need no stack during the other. */
__attribute__((noinline)) static bool start_with_stored(struct application *application)
{
    struct drive_settings stored;

    if (!settings_record_read(&application->board, &stored)) {
        return false;
    }
    application->settings_from = APPLICATION_SETTINGS_STORED;
    application->stored_refused = !start(application, &stored, application->stored_refusal);
    return !application->stored_refused;
}

__attribute__((noinline)) static bool start_with_default(struct application *application,
                                                         const struct motor_params *motor,
                                                         char error[DRIVE_ERROR_TEXT])
{
    struct drive_settings settings;

    application->settings_from = APPLICATION_SETTINGS_DEFAULT;
    drive_settings_default(&settings, motor);
    return start(application, &settings, error);
}

CALLED_FROM_OUTSIDE bool application_init(struct application *application, const struct hal *board,
                                          const struct motor_params *motor_default,
                                          char error[DRIVE_ERROR_TEXT])
{
    prepare(application, board);
    if (start_with_stored(application)) {
        return true;
    }
    application->facts = *board->facts;
    return start_with_default(application, motor_default, error);
}

bool application_init_with(struct application *application, const struct hal *board,
                           const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT])
{
    prepare(application, board);
    application->settings_from = APPLICATION_SETTINGS_GIVEN;
    return start(application, settings, error);
}

/* A board whose control interrupt no longer comes is to be reset. */
static void feed_watchdog(struct application *application)
{
    const uint32_t period = interrupt_view_period(&application->drive);

    if (period != application->fed_in) {
        application->fed_in = period;
        application->board.watchdog_feed(application->board.context);
    }
}

CALLED_FROM_OUTSIDE void application_background(struct application *application)
{
    feed_watchdog(application);
    drive_background(&application->drive);
    console_background(application);
}
