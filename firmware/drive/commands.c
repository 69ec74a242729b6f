/* The background's side of the drive: commands in, signals out. */
#include "firmware/design/refusal.h"
#include "firmware/drive/board_limits.h"
#include "firmware/drive/command_rules.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/planned_end.h"

static enum profile_shape shape_of(enum drive_command_kind kind)
{
    if (kind == DRIVE_COMMAND_STEP) {
        return PROFILE_STEP;
    }
    return kind == DRIVE_COMMAND_MOVE_SMOOTH ? PROFILE_SMOOTH : PROFILE_TRAPEZOID;
}

static bool plan(struct drive *drive, const struct drive_command *command, struct profile *profile,
                 char error[DRIVE_ERROR_TEXT])
{
    const struct profile_move move = {
        .shape = shape_of(command->kind),
        .position_rad = command->position_rad,
        .duration_s = command->duration_s,
        .ramp_s = command->ramp_s,
        .jerk_s = command->jerk_s,
    };
    const struct speed_limit speed = board_limits_speed(&drive->settings, drive->board->facts);
    const struct profile_drive limits = {
        .period_s = drive->board->facts->control_period_s,
        .rotor_teeth = drive->settings.motor.rotor_teeth,
        .speed_limit_rad_s = speed.rad_s,
        .speed_limit_reason = speed.reason,
        .acceleration_limit_rad_s2 = drive->settings.current_limit_A *
                                     drive->settings.motor.torque_constant_Nm_A /
                                     drive->settings.motor.inertia_kgm2,
        .creep_rad_s = num_to_double(drive->params.reference.creep_speed) * drive->base.speed_rad_s,
    };

    const struct planned_end *end = &drive->planned_end;

    if (!planned_end_require_known(drive, error) ||
        !profile_plan(profile, position_plus(end->position, end->offset), &move, &limits, error)) {
        return false;
    }
    profile->start = position_minus(profile->start, end->offset);
    profile->target = position_minus(profile->target, end->offset);
    return true;
}

static bool set_position(struct drive *drive, const struct drive_command *command,
                         struct queued_command *queued, char error[DRIVE_ERROR_TEXT])
{
    const double range = POSITION_TURNS_MAX * drive->base.rad_per_turn;

    queued->position = position_from_rad(command->position_rad, drive->settings.motor.rotor_teeth);
    return design_require_within(error, "position", command->position_rad, -range, range, "rad",
                                 "range of positions") &&
           (drive_state_by(drive, command->at_period) == DRIVE_SWITCH_ON_DISABLED ||
            planned_end_require_rest(drive, error));
}

/* One more set-point of a stream that is open. */
static bool put_set_point(struct drive *drive, const struct drive_command *command,
                          char error[DRIVE_ERROR_TEXT])
{
    const int32_t teeth = drive->settings.motor.rotor_teeth;
    const double range = POSITION_TURNS_MAX * drive->base.rad_per_turn;

    if (!(command->position_rad >= -range && command->position_rad <= range)) {
        return design_refuse(error, "set-point refused: the position is out of range");
    }
    planner_address_set_point(&drive->planner, command->at_period);
    return set_points_put(
        &drive->planner.set_points,
        position_minus(position_from_rad(command->position_rad, teeth), drive->planned_end.offset),
        error);
}

/* The first set-point: begins a stream. */
static bool begin_set_points(struct drive *drive, const struct drive_command *command,
                             const struct motion_request *request, char error[DRIVE_ERROR_TEXT])
{
    struct planner *planner = &drive->planner;
    struct motion_limits limits = request->limits;

    if (!planned_end_require_known(drive, error)) {
        return false;
    }
    if (drive->commands.written - drive->commands.read == COMMAND_QUEUE_LENGTH - 1u) {
        return true; /* refused when it is put into the queue */
    }
    set_points_begin(&planner->set_points, drive->planned_end.position, request->interval_periods,
                     &limits);
    if (!put_set_point(drive, command, error)) {
        return false;
    }
    planner_open_set_points(planner, drive->commands.written);
    return true;
}

static bool request(struct drive *drive, const struct drive_command *command,
                    struct motion_request *asked, char error[DRIVE_ERROR_TEXT])
{
    if (!planned_end_require_no_stop(drive, error) ||
        !planner_request(drive, command, asked, error)) {
        return false;
    }
    return command->kind != DRIVE_COMMAND_SET_POINT ||
           begin_set_points(drive, command, asked, error);
}

static bool store(const struct drive *drive, char error[DRIVE_ERROR_TEXT])
{
    struct learned_parameters learned;

    return !drive_learned(drive, &learned) || parameter_store_write(drive->board, &learned) ||
           design_refuse(error, "the board has no parameter store, or refused to write");
}

double drive_planned_end_rad(struct drive *drive)
{
    planned_end_update(drive);
    return position_to_rad(position_plus(drive->planned_end.position, drive->planned_end.offset),
                           drive->settings.motor.rotor_teeth);
}

enum drive_state drive_state_by(const struct drive *drive, uint32_t at_period)
{
    const struct urgent_command *disable = &drive->commands.disable;
    const bool posted = disable->posted; /* before the state, which changes when it is taken */
    const enum drive_state state = interrupt_view_state(drive);
    const uint32_t next = interrupt_view_period(drive) + 1u;
    const uint32_t acts_in = (int32_t)(at_period - next) > 0 ? at_period : next;

    return posted && (int32_t)(acts_in - disable->at_period) >= 0 ? DRIVE_SWITCH_ON_DISABLED
                                                                  : state;
}

/*
 * The board is asked at once, so that it can refuse: the state machine keeps the bridge open until
 * the enable acts. A latched trip is cleared if the bridge is open and has no fault to keep, or
 * none when the disable that waits has acted.
 */
static bool enable(struct drive *drive, uint32_t at_period, char error[DRIVE_ERROR_TEXT])
{
    const struct hal *board = drive->board;
    const enum drive_state found = drive_state_by(drive, at_period);
    const enum drive_state state = drive->supervision.state;

    if (found == DRIVE_SWITCH_ON_DISABLED &&
        (state == DRIVE_SWITCH_ON_DISABLED || state == DRIVE_FAULT)) {
        board->bridge_disable(board->context);
    }
    if (!board->bridge_enable(board->context)) {
        return design_refuse(error, "enable refused: the board's overcurrent trip is latched");
    }
    if (found != DRIVE_OPERATION_ENABLED) {
        planned_end_note_enable(drive);
    }
    return true;
}

bool drive_command(struct drive *drive, const struct drive_command *command,
                   char error[DRIVE_ERROR_TEXT])
{
    const uint32_t now = interrupt_view_period(drive);

    return drive_command_asked_in(drive, command, now, error);
}

bool drive_command_asked_in(struct drive *drive, const struct drive_command *command,
                            uint32_t asked_in, char error[DRIVE_ERROR_TEXT])
{
    struct queued_command queued = {.kind = command->kind, .at_period = command->at_period};

    if (!command_rules_check(drive, command, asked_in, error)) {
        return false;
    }
    if (command->kind == DRIVE_COMMAND_STORE) {
        return store(drive, error);
    }
    if (command->kind == DRIVE_COMMAND_DISABLE) {
        command_queue_put_urgent(&drive->commands, &drive->commands.disable, command->at_period);
        return true;
    }
    if (command->kind == DRIVE_COMMAND_STOP) {
        command_queue_put_urgent(&drive->commands, &drive->commands.stop, command->at_period);
        planned_end_note_stop(drive);
        return true;
    }
    if (command->kind == DRIVE_COMMAND_ENABLE && !enable(drive, command->at_period, error)) {
        return false;
    }
    if (queued_command_is_move(&queued) && !plan(drive, command, &queued.profile, error)) {
        return false;
    }
    if (command->kind == DRIVE_COMMAND_SET_POSITION &&
        !set_position(drive, command, &queued, error)) {
        return false;
    }
    if (command->kind == DRIVE_COMMAND_TORQUE &&
        !planner_request_torque(drive, command, &queued.torque, error)) {
        return false;
    }
    if (queued_command_is_planned(&queued)) {
        planner_follow(drive);
        if (command->kind == DRIVE_COMMAND_SET_POINT && drive->planner.set_points_open) {
            return put_set_point(drive, command, error);
        }
        if (!request(drive, command, &queued.request, error)) {
            return false;
        }
    }
    if (!command_queue_put(&drive->commands, &queued)) {
        return design_refuse(error, "command refused: 15 commands are waiting already");
    }
    planned_end_note_command(drive, &queued);
    return true;
}

#define READ(index, member, path, ...) signals->member = drive->path;
#define READ_ANGLE(index, member, path, ...)                                                       \
    signals->member = position_to_rad(position_plus(drive->path, drive->axis.offset),              \
                                      drive->settings.motor.rotor_teeth);
#define READ_REAL(index, member, path, brief, traced, in, ...)                                     \
    signals->member = num_to_double(drive->path) * drive->base.in;

void drive_signals_read(const struct drive *drive, struct drive_signals *signals)
{
    DRIVE_SIGNALS_TABLE(READ, READ, READ_ANGLE, READ, READ_REAL)
}

double drive_position_at_count_rad(const struct drive *drive, int32_t count)
{
    const struct encoder now = interrupt_view_encoder(drive);
    const struct position here = {now.turns, (angle_t)(now.fraction >> 32)};
    const float counts = (float)(int32_t)((uint32_t)count - (uint32_t)now.count);
    const float ahead_rad =
        counts * (6.2831853f / (float)drive->board->facts->encoder_counts_per_turn);

    return position_to_rad(position_plus(here, drive->axis.offset),
                           drive->settings.motor.rotor_teeth) +
           (double)ahead_rad;
}
