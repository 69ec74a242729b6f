#include "firmware/application/application.h"

#include "firmware/application/settings_record.h"
#include "firmware/design/refusal.h"
#include "firmware/drive/drive_hash.h"
#include "firmware/linkage.h"

static const struct hal_outputs bridge_off = {.bridge_on = false};

static bool start(struct application *application, const struct drive_settings *settings,
                  char error[DRIVE_ERROR_TEXT])
{
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
    struct stored_settings stored;

    if (!settings_record_read(&application->board, &stored)) {
        return false;
    }
    application->settings_from = APPLICATION_SETTINGS_STORED;
    if (stored.encoder_counts_per_turn != 0u) {
        application->facts.encoder_counts_per_turn = stored.encoder_counts_per_turn;
    }
    application->stored_refused =
        (stored.drive.feedback == DRIVE_FEEDBACK_ENCODER &&
         application->facts.encoder_counts_per_turn == 0u &&
         !design_refuse(application->stored_refusal,
                        "feedback = encoder, but neither board nor stored settings have an "
                        "encoder: store its counts per turn, or feedback = sensorless")) ||
        !start(application, &stored.drive, application->stored_refusal);
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

CALLED_FROM_OUTSIDE struct hal_outputs
application_control_interrupt(struct application *application, const struct hal_samples *samples)
{
    application->outputs = drive_control_cycle(&application->drive, samples);
    return application->outputs;
}

static void count(struct control_stage_cycles *stage, uint32_t cycles)
{
    stage->last = cycles;
    stage->max = cycles > stage->max ? cycles : stage->max;
    stage->sum += cycles;
}

CALLED_FROM_OUTSIDE void application_count_cycles(struct application *application,
                                                  const struct control_cycles_of_period *cycles)
{
    struct control_cycles *counted = &application->cycles;
    uint32_t total = 0;

    if (counted->restart) {
        *counted = (struct control_cycles){.periods = 0};
    }
    for (int stage = 0; stage < CONTROL_STAGES; stage++) {
        count(&counted->stage[stage], cycles->stage[stage]);
        total += cycles->stage[stage];
    }
    count(&counted->total, total);
    counted->periods++;
}

/* A board whose control interrupt no longer comes is to be reset. */
static void feed_watchdog(struct application *application)
{
    const uint32_t period = *(const volatile uint32_t *)&application->drive.period;

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
