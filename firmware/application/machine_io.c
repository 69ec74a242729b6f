#include "firmware/application/machine_io.h"

#include "firmware/application/application.h"
#include "firmware/design/elementary.h"
#include "firmware/design/refusal.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_motion.h"

/* Error codes of an emergency, CiA 402: reference limit; contacts 1 and 2. */
enum { LIMIT_CODE = 0x8612, QUICK_STOP_CODE = 0x5441, ENABLE_CODE = 0x5442 };

#define IN_POSITION_rad 0.01
#define AT_REST         1e-6 /* rad or rad/s: goes nowhere */

const char *machine_stop_text(enum machine_stop stop)
{
    static const char *const texts[] = {[MACHINE_STOP_NONE] = "",
                                        [MACHINE_STOP_LIMIT_MINUS] = "the limit switch - is active",
                                        [MACHINE_STOP_LIMIT_PLUS] = "the limit switch + is active",
                                        [MACHINE_STOP_QUICK] = "the quick stop input is active",
                                        [MACHINE_STOP_NOT_ENABLED] =
                                            "the enable input is not active"};

    return texts[stop];
}

static uint32_t active(const struct application *application, uint8_t levels)
{
    return (levels ^ (uint32_t)application->chosen.inputs_low) &
           (uint32_t)application->chosen.inputs_used;
}

uint32_t machine_io_active(const struct application *application)
{
    return active(application, application->io.levels);
}

uint32_t machine_io_seen(const struct application *application)
{
    return active(application, application->io.seen);
}

static uint8_t levels_of(const struct application *application)
{
    return (uint8_t)application->board.inputs_read(application->board.context);
}

static bool is_enabled(const struct application *application)
{
    return (application->chosen.inputs_used & HAL_INPUT_ENABLE) == 0 ||
           (machine_io_active(application) & HAL_INPUT_ENABLE) != 0u;
}

/* What stands against a motion up, down, or both ways. */
static enum machine_stop stop_of(const struct application *application, bool up, bool down)
{
    const uint32_t inputs = machine_io_active(application);

    if (!is_enabled(application)) {
        return MACHINE_STOP_NOT_ENABLED;
    }
    if ((inputs & HAL_INPUT_QUICK_STOP) != 0u) {
        return MACHINE_STOP_QUICK;
    }
    if (up && (inputs & HAL_INPUT_LIMIT_PLUS) != 0u) {
        return MACHINE_STOP_LIMIT_PLUS;
    }
    return down && (inputs & HAL_INPUT_LIMIT_MINUS) != 0u ? MACHINE_STOP_LIMIT_MINUS
                                                          : MACHINE_STOP_NONE;
}

static bool is_powered(const struct application *application)
{
    const enum drive_state state = interrupt_view_state(&application->drive);

    return state == DRIVE_OPERATION_ENABLED || state == DRIVE_ALIGNING;
}

static bool moves(const struct application *application)
{
    const struct drive *drive = &application->drive;

    return interrupt_view_moves(drive) || command_queue_holds_any(&drive->commands);
}

/* ---- commands ---- */

/* So that the brake holds before the current goes. */
static void put_off(struct application *application, struct drive_command *disable)
{
    const double engaging_s = application->chosen.holding_brake_s;
    const uint32_t off = interrupt_view_period(&application->drive) +
                         (uint32_t)(engaging_s / application->facts.control_period_s);

    if (engaging_s > 0.0 && is_powered(application)) {
        application->io.engages = true;
        if ((int32_t)(off - disable->at_period) > 0) {
            disable->at_period = off;
        }
    }
}

static enum machine_stop stop_of_command(struct application *application,
                                         const struct drive_command *command)
{
    struct drive_signals now;
    double way = command->speed_rad_s;

    switch (command->kind) {
    case DRIVE_COMMAND_SINE:
        return stop_of(application, true, true);
    case DRIVE_COMMAND_MOVE_TRAPEZOID:
    case DRIVE_COMMAND_MOVE_SMOOTH:
    case DRIVE_COMMAND_STEP:
    case DRIVE_COMMAND_SET_POINT:
    case DRIVE_COMMAND_RETARGET:
        drive_signals_read(&application->drive, &now);
        way = command->position_rad - now.theta_ref_rad;
        break;
    case DRIVE_COMMAND_VELOCITY:
        break;
    case DRIVE_COMMAND_TORQUE:
        way = command->torque_Nm;
        break;
    default:
        return MACHINE_STOP_NONE;
    }
    return magnitude(way) < AT_REST ? MACHINE_STOP_NONE
                                    : stop_of(application, way > 0.0, way < 0.0);
}

bool machine_io_allows(struct application *application, struct drive_command *command,
                       char error[DRIVE_ERROR_TEXT])
{
    enum machine_stop stop = MACHINE_STOP_NONE;

    if (command->kind == DRIVE_COMMAND_DISABLE) {
        put_off(application, command);
    } else if (command->kind == DRIVE_COMMAND_ENABLE) {
        stop = is_enabled(application) ? MACHINE_STOP_NONE : MACHINE_STOP_NOT_ENABLED;
    } else if (application->chosen.inputs_used != 0) {
        stop = stop_of_command(application, command);
    }
    return stop == MACHINE_STOP_NONE || design_refuse(error, machine_stop_text(stop));
}

/* ---- inputs ---- */

bool machine_io_start(struct application *application, bool starts, char error[DRIVE_ERROR_TEXT])
{
    struct machine_io *io = &application->io;

    if (!MACHINE_IO_CARRIED || application->board.inputs_read == NULL) {
        return (application->chosen.inputs_used == 0 &&
                !(application->chosen.holding_brake_s > 0.0)) ||
               design_refuse(error, "inputs_used, holding_brake_s: this board has no such pins, "
                                    "expected 0");
    }
    if (starts) {
        io->seen = levels_of(application);
        io->levels = io->seen;
    }
    return true;
}

static void look_at_inputs(struct application *application)
{
    struct machine_io *io = &application->io;
    const uint8_t levels = levels_of(application);
    const uint8_t same = (uint8_t) ~(levels ^ io->seen);

    io->levels = (uint8_t)((io->levels & ~same) | (levels & same));
    io->seen = levels;
}

static void command(struct application *application, enum drive_command_kind kind)
{
    struct drive_command command = {.kind = kind,
                                    .at_period = interrupt_view_period(&application->drive)};
    char refusal[DRIVE_ERROR_TEXT];

    (void)application_command(application, &command, command.at_period, refusal);
}

static bool has_link(const struct application *application)
{
    return LINK_CARRIED && application->link != NULL && application->link->open;
}

static bool link_operates(const struct application *application)
{
    return has_link(application) && application->link->axis.state == CIA402_OPERATION_ENABLED;
}

/* What an emergency has said is over. */
static void end_errors(struct application *application)
{
    const uint32_t inputs = machine_io_active(application);

    if ((inputs & (HAL_INPUT_LIMIT_MINUS | HAL_INPUT_LIMIT_PLUS)) == 0u) {
        link_end_error(application, LINK_ERROR_LIMIT);
    }
    if ((inputs & HAL_INPUT_QUICK_STOP) == 0u && is_enabled(application)) {
        link_end_error(application, LINK_ERROR_INPUT);
    }
}

/* On a fieldbus with the quick stop's deceleration, which cia402.c begins with its input by itself;
   else with the motion's own. */
static void stop(struct application *application, enum machine_stop stop)
{
    static const uint16_t codes[] = {0, LIMIT_CODE, LIMIT_CODE, QUICK_STOP_CODE, ENABLE_CODE};

    if (codes[stop] == LIMIT_CODE && link_operates(application) &&
        axis_homing_seeks_switch(&application->link->axis.motion.homing)) {
        application->io.stop = MACHINE_STOP_NONE; /* looks again, should the homing end */
        return;
    }
    if (has_link(application)) {
        link_begin_error(application,
                         codes[stop] == LIMIT_CODE ? LINK_ERROR_LIMIT : LINK_ERROR_INPUT,
                         codes[stop]);
    }
    if (!link_operates(application)) {
        if (moves(application)) {
            command(application, DRIVE_COMMAND_STOP);
        }
    } else if (stop == MACHINE_STOP_NOT_ENABLED) {
        cia402_lose(application);
    } else if (stop != MACHINE_STOP_QUICK) {
        axis_motion_end_at_switch(application, stop == MACHINE_STOP_LIMIT_PLUS);
    }
}

/* By its sign. A torque goes where it pushes, whatever a rotor at rest seems to do. */
static num_t way_of_motion(const struct drive *drive)
{
    const num_t torque = drive->torque.current;

    return interrupt_view_torque(drive) && torque != NUM(0.0) ? torque
                                                              : interrupt_view_speed(drive);
}

static void obey_inputs(struct application *application)
{
    struct machine_io *io = &application->io;
    const enum drive_state state = interrupt_view_state(&application->drive);
    const bool on = state != DRIVE_SWITCH_ON_DISABLED && state != DRIVE_FAULT;
    const bool moving = state == DRIVE_OPERATION_ENABLED && moves(application);
    enum machine_stop found = MACHINE_STOP_NONE;

    if (on && application->chosen.inputs_used != 0) {
        const num_t way = moving ? way_of_motion(&application->drive) : NUM(0.0);

        found = stop_of(application, way > NUM(0.0), way < NUM(0.0));
    }
    if (found != io->stop) {
        io->stop = (uint8_t)found;
        if (found != MACHINE_STOP_NONE) {
            stop(application, found);
        }
    }
    if (on && !moving && !io->engages && !is_enabled(application)) {
        command(application, DRIVE_COMMAND_DISABLE);
    }
    if (has_link(application)) {
        end_errors(application);
    }
}

/* ---- outputs ---- */

static bool is_in_position(struct application *application)
{
    struct drive_signals now;

    if (interrupt_view_state(&application->drive) != DRIVE_OPERATION_ENABLED ||
        moves(application) ||
        interrupt_view_synchronism(&application->drive) != DRIVE_SYNCHRONISM_SURE) {
        return false;
    }
    drive_signals_read(&application->drive, &now);
    return magnitude(now.theta_ref_rad - now.theta_est_rad) <= IN_POSITION_rad;
}

/* The hold's current takes its ramp until it is in. */
static bool is_brake_released(const struct application *application)
{
    const struct drive *drive = &application->drive;
    const uint32_t since = interrupt_view_period(drive) - interrupt_view_state_since(drive);
    const uint32_t ramp =
        (uint32_t)(drive->settings.hold_ramp_s / application->facts.control_period_s);

    return is_powered(application) && !application->io.engages &&
           ((application->io.outputs & HAL_OUTPUT_BRAKE) != 0u || since > ramp);
}

static void show_outputs(struct application *application)
{
    struct machine_io *io = &application->io;
    const struct hal *board = &application->board;
    const bool alarm = interrupt_view_state(&application->drive) == DRIVE_FAULT;

    io->engages = io->engages && is_powered(application);
    io->outputs = (uint8_t)((alarm ? HAL_OUTPUT_ALARM : 0u) |
                            (is_in_position(application) ? HAL_OUTPUT_IN_POSITION : 0u) |
                            (is_brake_released(application) ? HAL_OUTPUT_BRAKE : 0u));
    board->outputs_write(board->context, io->outputs ^ (uint32_t)application->chosen.outputs_low);
}

void machine_io_background(struct application *application)
{
    struct machine_io *io = &application->io;
    const uint32_t period = interrupt_view_period(&application->drive);

    if (application->board.inputs_read == NULL ||
        period - io->looked_in < application_typed_delay(application)) {
        return;
    }
    io->looked_in = period;
    look_at_inputs(application);
    obey_inputs(application);
    show_outputs(application);
}
