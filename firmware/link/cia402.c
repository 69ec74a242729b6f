#include "firmware/link/cia402.h"

#include "firmware/application/application.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/link.h"

/* Bits of the controlword. */
enum {
    SWITCH_ON = 0x01,
    ENABLE_VOLTAGE = 0x02,
    NO_QUICK_STOP = 0x04,
    ENABLE_OPERATION = 0x08,
    RESET_FAULT = 0x80
};

/* What a controlword asks for, its reset of a fault apart. */
enum request {
    REQUEST_DISABLE_VOLTAGE,
    REQUEST_QUICK_STOP,
    REQUEST_SHUTDOWN,
    REQUEST_SWITCH_ON,
    REQUEST_ENABLE_OPERATION
};

/* Option codes of a quick stop: off at once, with the profile's deceleration or its own, then off;
   5 and 6 as 1 and 2, and stays. */
enum { OFF_AT_ONCE = 0, AS_PROFILE = 1, STAYS_IN_QUICK_STOP = 5 };

static enum request request_of(uint32_t word)
{
    if ((word & ENABLE_VOLTAGE) == 0u) {
        return REQUEST_DISABLE_VOLTAGE;
    }
    if ((word & NO_QUICK_STOP) == 0u) {
        return REQUEST_QUICK_STOP;
    }
    if ((word & SWITCH_ON) == 0u) {
        return REQUEST_SHUTDOWN;
    }
    return (word & ENABLE_OPERATION) == 0u ? REQUEST_SWITCH_ON : REQUEST_ENABLE_OPERATION;
}

bool cia402_command(struct application *application, struct drive_command *command)
{
    const uint32_t period = interrupt_view_period(&application->drive);
    char refusal[DRIVE_ERROR_TEXT];

    application->link->axis.motion.brakes = 0;
    command->at_period = period;
    return application_command(application, command, period, refusal);
}

const struct drive_signals *cia402_signals(struct application *application)
{
    struct cia402 *axis = &application->link->axis;
    const uint32_t period = interrupt_view_period(&application->drive);

    if (period != axis->signals_in) {
        const enum drive_state drive = interrupt_view_state(&application->drive);

        axis->signals_in = period;
        drive_signals_read(&application->drive, &axis->signals);
        if (drive == DRIVE_FAULT || drive == DRIVE_SWITCH_ON_DISABLED) {
            axis->signals.omega_est_rad_s = 0.0; /* stays what it was */
            axis->signals.omega_ref_rad_s = 0.0;
        }
    }
    return &axis->signals;
}

/* ---- states ---- */

static void switch_off(struct application *application, enum cia402_state state)
{
    struct drive_command disable = {.kind = DRIVE_COMMAND_DISABLE};
    struct cia402 *axis = &application->link->axis;

    (void)cia402_command(application, &disable);
    axis->asked = false;
    axis->lost = false;
    axis->state = (uint8_t)state;
}

/* Once, as soon as the bridge is off. */
static void switch_on(struct application *application, enum drive_state drive)
{
    struct drive_command enable = {.kind = DRIVE_COMMAND_ENABLE};
    struct cia402 *axis = &application->link->axis;

    if (application->io.engages) {
        return; /* on its way off */
    }
    if (drive == DRIVE_SWITCH_ON_DISABLED && !axis->asked && !axis->refused) {
        axis->asked = cia402_command(application, &enable);
        axis->refused = !axis->asked;
    } else if (drive == DRIVE_ALIGNING || drive == DRIVE_OPERATION_ENABLED) {
        axis->state = CIA402_SWITCHED_ON;
    }
}

static void leave_ready(struct application *application, enum drive_state drive,
                        enum request request)
{
    struct cia402 *axis = &application->link->axis;

    if (request >= REQUEST_SWITCH_ON) {
        switch_on(application, drive);
    } else if (request != REQUEST_SHUTDOWN || axis->asked) {
        switch_off(application, request == REQUEST_SHUTDOWN ? CIA402_READY_TO_SWITCH_ON
                                                            : CIA402_SWITCH_ON_DISABLED);
    }
}

static void leave_switched_on(struct application *application, enum drive_state drive,
                              enum request request)
{
    struct cia402 *axis = &application->link->axis;

    if (request == REQUEST_ENABLE_OPERATION && drive == DRIVE_OPERATION_ENABLED &&
        axis_motion_rests(application)) { /* what brakes yet is no place to begin at */
        axis->state = CIA402_OPERATION_ENABLED;
        axis_motion_start(application);
    } else if (request < REQUEST_SWITCH_ON) {
        switch_off(application, request == REQUEST_SHUTDOWN ? CIA402_READY_TO_SWITCH_ON
                                                            : CIA402_SWITCH_ON_DISABLED);
    }
}

static void begin_quick_stop(struct application *application)
{
    const int16_t option = application->link->objects.quick_stop_option;

    if (option == OFF_AT_ONCE) {
        switch_off(application, CIA402_SWITCH_ON_DISABLED);
        return;
    }
    application->link->axis.state = CIA402_QUICK_STOP_ACTIVE;
    axis_motion_brake(application, option != AS_PROFILE && option != STAYS_IN_QUICK_STOP);
}

static void leave_operation(struct application *application, enum request request)
{
    struct cia402 *axis = &application->link->axis;

    switch (request) {
    case REQUEST_DISABLE_VOLTAGE:
        switch_off(application, CIA402_SWITCH_ON_DISABLED);
        break;
    case REQUEST_SHUTDOWN:
        switch_off(application, CIA402_READY_TO_SWITCH_ON);
        break;
    case REQUEST_QUICK_STOP:
        begin_quick_stop(application);
        break;
    case REQUEST_SWITCH_ON:
        axis->state = CIA402_SWITCHED_ON;
        axis_motion_brake(application, false);
        break;
    default:
        break;
    }
}

/* The rotor comes to rest behind its reference: a bridge that opens before lets it coast. */
static bool has_settled(struct application *application)
{
    const float settling_s = 0.05f;
    const uint32_t since =
        interrupt_view_period(&application->drive) - application->link->axis.moved_in;

    return (float)since * (float)application->facts.control_period_s > settling_s;
}

static void leave_quick_stop(struct application *application, enum request request)
{
    struct cia402 *axis = &application->link->axis;
    const bool stays =
        !axis->lost && application->link->objects.quick_stop_option >= STAYS_IN_QUICK_STOP;

    if (request == REQUEST_DISABLE_VOLTAGE || (has_settled(application) && !stays)) {
        switch_off(application, CIA402_SWITCH_ON_DISABLED);
    } else if (stays && request == REQUEST_ENABLE_OPERATION && axis_motion_rests(application)) {
        axis->state = CIA402_OPERATION_ENABLED;
        axis_motion_start(application);
    }
}

/* What the drive has done by itself. */
static void follow(struct cia402 *axis, enum drive_state drive)
{
    const bool powered = axis->state == CIA402_SWITCHED_ON ||
                         axis->state == CIA402_OPERATION_ENABLED ||
                         axis->state == CIA402_QUICK_STOP_ACTIVE;

    if (drive == DRIVE_FAULT) {
        axis->state = CIA402_FAULT;
        axis->asked = false;
    } else if (axis->state == CIA402_FAULT || (powered && drive == DRIVE_SWITCH_ON_DISABLED)) {
        axis->state = CIA402_SWITCH_ON_DISABLED;
        axis->asked = false;
        axis->lost = false;
    }
}

void cia402_background(struct application *application)
{
    struct cia402 *axis = &application->link->axis;
    const enum drive_state drive = interrupt_view_state(&application->drive);
    const bool stops = (machine_io_active(application) & HAL_INPUT_QUICK_STOP) != 0u;
    const enum request request =
        request_of(stops ? axis->controlword & ~(uint32_t)NO_QUICK_STOP : axis->controlword);

    if (drive == DRIVE_OPERATION_ENABLED && !axis_motion_rests(application)) {
        axis->moved_in = interrupt_view_period(&application->drive);
    }
    follow(axis, drive);
    switch (axis->state) {
    case CIA402_SWITCH_ON_DISABLED:
        if (request == REQUEST_SHUTDOWN) {
            axis->state = CIA402_READY_TO_SWITCH_ON;
        }
        break;
    case CIA402_READY_TO_SWITCH_ON:
        leave_ready(application, drive, request);
        break;
    case CIA402_SWITCHED_ON:
        leave_switched_on(application, drive, request);
        break;
    case CIA402_OPERATION_ENABLED:
        leave_operation(application, request);
        break;
    case CIA402_QUICK_STOP_ACTIVE:
        leave_quick_stop(application, request);
        break;
    default:
        break;
    }
    if (axis->state == CIA402_OPERATION_ENABLED) {
        axis_motion_background(application);
    } else {
        axis->mode = application->link->objects.mode;
    }
    application->drive.axis.seeks_stop =
        axis->state == CIA402_OPERATION_ENABLED && axis_homing_seeks_stop(&axis->motion.homing);
}

void cia402_control(struct application *application, uint16_t word)
{
    struct cia402 *axis = &application->link->axis;
    const uint16_t risen = (uint16_t)(word & ~axis->controlword);

    axis->refused = axis->refused && word == axis->controlword;
    axis->controlword = word;
    if ((risen & RESET_FAULT) != 0u && axis->state == CIA402_FAULT) {
        struct drive_command disable = {.kind = DRIVE_COMMAND_DISABLE};

        (void)cia402_command(application, &disable);
    }
    if (axis->state == CIA402_OPERATION_ENABLED) {
        axis_motion_control(application, risen);
    }
    cia402_background(application);
}

void cia402_look(struct application *application)
{
    axis_motion_brake_on(application);
    if (application->link->axis.state == CIA402_OPERATION_ENABLED) {
        axis_motion_look(application);
    }
}

void cia402_lose(struct application *application)
{
    struct cia402 *axis = &application->link->axis;

    if (axis->state == CIA402_OPERATION_ENABLED || axis->state == CIA402_QUICK_STOP_ACTIVE ||
        (axis->state == CIA402_SWITCHED_ON && !axis_motion_is_free(application))) {
        axis->state = CIA402_QUICK_STOP_ACTIVE;
        axis_motion_brake(application, true);
        axis->lost = true;
        axis->controlword = ENABLE_VOLTAGE;
    } else if (axis->state == CIA402_SWITCHED_ON || axis->asked) {
        switch_off(application, CIA402_SWITCH_ON_DISABLED);
        axis->controlword = 0;
    }
}

void cia402_switch_off(struct application *application)
{
    cia402_lose(application);
    if (application->link->axis.state == CIA402_FAULT) {
        switch_off(application, CIA402_SWITCH_ON_DISABLED);
    }
}

/* A drive that the console has enabled, or a client that is gone, is switched on, and waits for
   "enable operation": what moves is brought to rest, unless the client only listens. */
void cia402_start(struct application *application)
{
    struct cia402 *axis = &application->link->axis;
    const enum drive_state drive = interrupt_view_state(&application->drive);

    *axis = (struct cia402){
        .mode = application->link->objects.mode,
        .signals_in = interrupt_view_period(&application->drive) - 1u,
        .moved_in = interrupt_view_period(&application->drive) + 0x80000000u,
        .state = drive == DRIVE_FAULT                ? CIA402_FAULT
                 : drive == DRIVE_SWITCH_ON_DISABLED ? CIA402_SWITCH_ON_DISABLED
                                                     : CIA402_SWITCHED_ON,
    };
    axis->controlword =
        axis->state == CIA402_SWITCHED_ON ? SWITCH_ON | ENABLE_VOLTAGE | NO_QUICK_STOP : 0u;
    axis_motion_put_defaults(application);
    if (axis->state == CIA402_SWITCHED_ON && !application->link->listens_only) {
        axis_motion_brake(application, true);
    }
}
