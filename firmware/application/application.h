/*
 * The application around a drive: what a board runs besides its own peripherals. A thin layer,
 * the same on every board, the simulated one included: settings at start-up, the control interrupt,
 * and a background loop with the console on the serial line.
 *
 * A board calls
 *
 *     application_init                 once, then starts its timer
 *     application_control_interrupt    in the control interrupt, with the samples of S(k)
 *     control_cycles_count             in the same interrupt or behind it, if it can measure
 *     application_background           all the time, from its main loop
 */
#ifndef STEADYSTEP_APPLICATION_H
#define STEADYSTEP_APPLICATION_H

#include "firmware/application/console.h"
#include "firmware/application/control_cycles.h"
#include "firmware/application/machine_io.h"
#include "firmware/drive/drive.h"
#include "firmware/link/link.h"
#include "hal/hal.h"

/* Where the settings in force come from. */
enum application_settings {
    APPLICATION_SETTINGS_GIVEN,  /* to application_init_with */
    APPLICATION_SETTINGS_STORED, /* the newest record in the board's parameter store */
    APPLICATION_SETTINGS_DEFAULT /* of the motor that is compiled in */
};

/* One instance, which stays where it was initialised. */
struct application {
    struct drive drive;
    uint64_t gains_hash;        /* drive_hash_gains of this start */
    struct hal_outputs outputs; /* of the last control interrupt */
    struct control_cycles cycles;
    struct control_cycle_statistics cycle_statistics;

    /* background */
    struct hal board;       /* as given, with the facts below */
    struct hal_facts facts; /* as given, with the encoder of the settings */
    uint32_t board_counts;  /* of the encoder, as given */
    enum application_settings settings_from;
    struct drive_settings chosen;          /* as given, stored or set: what `store` keeps */
    struct drive_settings in_force;        /* those that the drive was designed by */
    uint32_t timeout_periods;              /* command_timeout_s in force; 0: none */
    uint32_t heard_in;                     /* period of the last line or command */
    bool unheard;                          /* since then for so long that a motion was stopped */
    bool awaits_enable;                    /* `chosen` does, as it may differ from them */
    char stored_refusal[DRIVE_ERROR_TEXT]; /* of what is stored, until it is announced: why, or
                                              what is passed over */
    struct machine_io io;
    struct console console;
    struct link *link; /* NULL: none */
};

/*
 * Start-up with the newest valid settings in pages 2 and 3 of the parameter store, or, without any,
 * with the defaults for `motor_default`. Settings that the drive refuses are announced on the
 * console, and the defaults apply. So are those of parts that the image does not carry, and the
 * rest applies. false: these are refused, too; reason in error. Takes as long as drive_init.
 */
bool application_init(struct application *application, const struct hal *board,
                      const struct motor_params *motor_default, char error[DRIVE_ERROR_TEXT]);

/* Start-up with these settings, whatever is stored. false: refused, reason in error. */
bool application_init_with(struct application *application, const struct hal *board,
                           const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT]);

/* Back to what is stored, as behind a power cycle; without any to the defaults, of the motor that
   is set. Nothing changes while the bridge is on, and where settings were given and none is stored.
 */
void application_recall_settings(struct application *application);

/* Behind the start-up: a fieldbus link, which stays where it is. */
void application_put_link(struct application *application, struct link *link);

/*
 * Background: drive_command_asked_in, for whoever commands a drive that has a console. What was set
 * since the drive was designed is put in force before an enable: it is designed anew, with its
 * bridge off, which takes as long as drive_init. If the period to act in has passed by then, the
 * command acts, and its at_period is, DRIVE_TYPED_DELAY_s after the end of the design. false:
 * refused, reason in error; a set-up that the drive refuses leaves the one before in force.
 */
bool application_command(struct application *application, struct drive_command *command,
                         uint32_t asked_in, char error[DRIVE_ERROR_TEXT]);

/* Background: whoever commands the drive was heard in this period. */
void application_hear(struct application *application, uint32_t period);

/* DRIVE_TYPED_DELAY_s in control periods. */
uint32_t application_typed_delay(const struct application *application);

/* Background: by this period the bridge is off, and no enable waits: what is set waits for one. */
bool application_settings_wait(const struct application *application, uint32_t at_period);

/*
 * The control interrupt: drive_control_cycle. What it returns acts over S(k+1)...S(k+2); a bridge
 * that is to be off is switched off at once.
 */
const struct hal_outputs *application_control_interrupt(struct application *application,
                                                        const struct hal_samples *samples);

/*
 * The control interrupt of a board that has a brake resistor (facts.has_brake), behind the outputs:
 * whether it stays off; and if not, whether it is to be on until the next S(k).
 */
static inline bool application_brake_idles(const struct application *application,
                                           const struct hal_samples *samples)
{
    return brake_idles(&application->drive.brake, samples->bus_voltage);
}

static inline bool application_brake(struct application *application,
                                     const struct hal_samples *samples)
{
    return brake_switch(&application->drive.brake, samples->bus_voltage);
}

/* What a board calls behind the control interrupt while it is asked to (hal.h, follow_control). */
void application_follow_control(struct application *application);

/*
 * The main loop calls it all the time, at least once in 3 ms. One call takes at most one typed line
 * (1 ms on a Cortex-M4F) and lets the planner plan once (1 ms); a line that writes the parameter
 * store takes up to 60 ms, an enable behind changed settings as long as drive_init, of a refused
 * set-up twice. The watchdog is fed only if control interrupts have come since.
 */
void application_background(struct application *application);

#endif
