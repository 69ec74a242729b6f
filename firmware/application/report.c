#include "firmware/application/report.h"

#include <stdatomic.h>

#include "firmware/application/application.h"
#include "firmware/application/command_line.h"
#include "firmware/design/hold_check.h"
#include "firmware/drive/fault_reason.h"
#include "firmware/interface/dictionary.h"
#include "firmware/interface/parts_carried.h"
#include "firmware/interface/settings.h"
#include "firmware/drive/interrupt_view.h"

enum { DIGITS = 6 };

#define TEXT_OF(token) #token
#define NUMERIC(token) TEXT_OF(token) /* of NUM_FORMAT: float, fixed or double */

static void put_name(struct text *text, const char *name)
{
    text_put(text, " ");
    text_put(text, name);
    text_put(text, "=");
}

static void put_number(struct text *text, const char *name, double value)
{
    put_name(text, name);
    text_number(text, value, DIGITS);
}

static void put_word(struct text *text, const char *name, const char *value)
{
    put_name(text, name);
    text_put(text, value);
}

static void put_count(struct text *text, const char *name, uint32_t value)
{
    put_name(text, name);
    text_unsigned(text, value);
}

/* All of one period: read again if a control interrupt has come in between. */
static void read_signals(const struct drive *drive, struct drive_signals *signals)
{
    uint32_t before;
    int tries = 3;

    do {
        before = interrupt_view_period(drive);
        atomic_signal_fence(memory_order_seq_cst);
        drive_signals_read(drive, signals);
        atomic_signal_fence(memory_order_seq_cst);
    } while (before != interrupt_view_period(drive) && --tries > 0);
}

void report_start(struct text *text, const struct application *application)
{
    static const char *const from[] = {
        [APPLICATION_SETTINGS_GIVEN] = "given",
        [APPLICATION_SETTINGS_STORED] = "stored",
        [APPLICATION_SETTINGS_DEFAULT] = "default",
    };
    const struct drive_settings *settings = &application->drive.settings;
    const struct hal *board = &application->board;
    const double torque_Nm = hold_torque_Nm(&settings->motor, settings->hold_current_A);

    text_put(text, board->version);
    text_put(text, ", " NUMERIC(NUM_FORMAT) ", on ");
    text_put(text, board->facts->board_name);
    text_put(text, "; settings: ");
    text_put(text, from[application->settings_from]);
    for (size_t i = 0; i < SETTINGS_OF_MOTOR; i++) {
        const struct setting *setting = setting_number(i);

        put_number(text, setting->name, setting_get(settings, setting, 0));
    }
    put_word(text, "law", drive_law_name(settings->law));
    put_word(text, "feedback", drive_feedback_name(settings->feedback));
    if (settings->feedback == DRIVE_FEEDBACK_SENSORLESS) {
        put_number(text, "blind_below_rad_s", drive_blind_speed_rad_s(settings, board->facts));
        put_number(text, "hold_torque_Nm", torque_Nm);
        put_number(text, "hold_load_step_Nm", HOLD_LOAD_STEP_SHARE * torque_Nm);
        put_number(text, "hold_heat_W", hold_heat_W(&settings->motor, settings->hold_current_A));
    }
    put_count(text, "brake", board->facts->has_brake);
    text_put(text, "; started by: ");
    text_put(text, board->start_cause(board->context));
}

void report_refused_settings(struct text *text, const struct application *application)
{
    text_put(text, !SETTINGS_CARRIED && application->settings_from == APPLICATION_SETTINGS_STORED
                       ? "warning: stored, but not of this image:"
                       : "warning: the stored settings are not in force: ");
    text_put(text, application->stored_refusal);
}

void report_fault(struct text *text, const struct application *application)
{
    text_put(text, "fault: ");
    fault_reason_put(text, &application->drive);
    text_put(text, "; the bridge is open since period ");
    text_unsigned(text, application->drive.supervision.state_since);
    text_put(text, ", disable clears the fault");
}

void report_dropped(struct text *text, uint32_t more)
{
    text_put(text, "warning: ");
    text_unsigned(text, more);
    text_put(text, more == 1u ? " command" : " commands");
    text_put(text, " dropped: accepted, but not possible when the time to act came");
}

void report_synchronism(struct text *text, enum drive_synchronism synchronism)
{
    switch (synchronism) {
    case DRIVE_SYNCHRONISM_SURE:
        text_put(text, "synchronism: sure again");
        break;
    case DRIVE_SYNCHRONISM_DOUBTFUL:
        text_put(text, "warning: synchronism doubtful: near the end of the torque, or the rotor "
                       "beside its estimate");
        break;
    case DRIVE_SYNCHRONISM_STALLED:
        text_put(text, "warning: stalled: the rotor does not follow, although the estimate is "
                       "sound");
        break;
    default:
        text_put(text, "warning: synchronism lost: the rotor is not where the estimate has it");
        break;
    }
}

void report_heat(struct text *text, uint8_t shown)
{
    static const char *const texts[] = {" motor derated", " bridge derated", " no bridge sensor"};

    text_put(text, shown == 0u ? "thermal: all well" : "warning: thermal:");
    for (int i = 0; i < 3; i++) {
        text_put(text, (shown >> i & 1) != 0 ? texts[i] : "");
    }
}

void report_ready(struct text *text, const struct application *application)
{
    struct drive_signals signals;

    read_signals(&application->drive, &signals);
    text_put(text, "ready:");
    put_count(text, "period", application->drive.supervision.state_since);
    put_number(text, "reference_rad", signals.theta_ref_rad);
    put_number(text, "resistance_ohm", signals.resistance_est_ohm);
    put_word(text, "position", drive_position_reference_name(signals.position_reference));
    if (application->drive.params.enabling.detects_position) {
        put_word(text, "found_by",
                 application->drive.enabling.detection.by_impulses ? "impulses" : "alignment");
        put_number(text, "confidence",
                   initial_position_confidence(&application->drive.enabling.detection));
    }
    if (signals.position_reference == DRIVE_POSITION_UNCERTAIN) {
        text_put(text, "; home the axis again");
    }
}

static void put_signal(struct text *text, const char *name, const struct drive_signals *signals,
                       const struct signal_row *signal)
{
    const double value = signal_get(signals, signal);
    const char *word = signal_word(signal, value);

    if (word != NULL) {
        put_word(text, name, word);
    } else if (signal->type == SIGNAL_COUNT) {
        put_count(text, name, (uint32_t)value);
    } else {
        put_number(text, name, value);
    }
}

void report_state(struct text *text, const struct application *application)
{
    const struct drive *drive = &application->drive;
    struct drive_signals signals;

    read_signals(drive, &signals);
    text_put(text, drive_state_name(signals.state));
    for (int i = 0; i < SIGNALS; i++) {
        const struct signal_row *signal = signal_at((enum drive_signal)i);

        if (signal->brief[0] != '\0') {
            put_signal(text, signal->brief, &signals, signal);
        }
    }
    put_word(text, "law", drive_law_name(drive->settings.law));
    put_word(text, "feedback", drive_feedback_name(drive->settings.feedback));
    text_put(text, "; ");
    text_put(text, application->board.version);
}

void report_signals(struct text *text, const struct application *application)
{
    struct drive_signals signals;

    read_signals(&application->drive, &signals);
    for (int i = 0; i < SIGNALS; i++) {
        const struct signal_row *signal = signal_at((enum drive_signal)i);

        put_signal(text, signal->name, &signals, signal);
    }
}

void report_cycles(struct text *text, const struct application *application)
{
    const double share = 0.9; /* of the period, in which the interrupt must end (hal.h) */
    const struct hal_facts *facts = application->board.facts;
    const struct control_cycle_statistics *cycles = &application->cycle_statistics;

    put_count(text, "periods", cycles->periods);
    if (cycles->periods == 0u) {
        text_put(text, ": none counted yet, or this board does not count");
        return;
    }
    put_number(text, "mean", (double)cycles->sum / (double)cycles->periods);
    put_count(text, "most", cycles->most);
    put_number(text, "budget", share * facts->control_period_s * facts->cycle_counter_Hz);
}

void report_help(struct text *text, const struct line_form *topic)
{
    if (topic != NULL) {
        line_form_usage(text, topic);
        text_put(text, ": ");
        text_put(text, topic->about);
        return;
    }
    for (size_t i = 0; line_form_number(i) != NULL; i++) {
        text_put(text, i == 0u ? "" : ", ");
        text_put(text, line_form_number(i)->name);
    }
    text_put(text, "; help <command> explains one");
}
