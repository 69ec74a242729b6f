/* The background's side of the drive: commands in, signals out. */
#include "firmware/design/refusal.h"
#include "firmware/drive/drive.h"

static enum profile_shape shape_of(enum drive_command_kind kind)
{
    if (kind == DRIVE_COMMAND_STEP) {
        return PROFILE_STEP;
    }
    return kind == DRIVE_COMMAND_MOVE_SMOOTH ? PROFILE_SMOOTH : PROFILE_TRAPEZOID;
}

/*
 * Where the reference will rest when the next command acts. With nothing waiting and the reference
 * at rest it is there already, whatever became of the commands before.
 */
static void update_planned_end(struct drive *drive)
{
    const struct command_queue *queue = &drive->commands;

    if (queue->read == queue->written && !reference_busy(&drive->reference)) {
        drive->planned_end = drive->reference.next.position;
        drive->stop_posted = drive->stop_posted && queue->stop.posted;
    }
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
    const struct profile_drive limits = {
        .period_s = drive->board->facts->control_period_s,
        .rotor_teeth = drive->settings.motor.rotor_teeth,
        .speed_limit_rad_s = drive->settings.speed_limit_rad_s,
        .acceleration_limit_rad_s2 = drive->settings.current_limit_A *
                                     drive->settings.motor.torque_constant_Nm_A /
                                     drive->settings.motor.inertia_kgm2,
    };

    update_planned_end(drive);
    if (drive->stop_posted) {
        return design_refuse(error,
                             "move refused: the reference has not come to rest after the stop");
    }
    return profile_plan(profile, drive->planned_end, &move, &limits, error);
}

bool drive_command(struct drive *drive, const struct drive_command *command,
                   char error[DRIVE_ERROR_TEXT])
{
    struct queued_command queued = {.kind = command->kind, .at_period = command->at_period};

    if (command->kind == DRIVE_COMMAND_DISABLE) {
        command_queue_put_urgent(&drive->commands, &drive->commands.disable, command->at_period);
        return true;
    }
    if (command->kind == DRIVE_COMMAND_STOP) {
        command_queue_put_urgent(&drive->commands, &drive->commands.stop, command->at_period);
        drive->stop_posted = true;
        return true;
    }
    if (command->kind == DRIVE_COMMAND_ENABLE) {
        if (drive->state == DRIVE_SWITCH_ON_DISABLED) {
            drive->board->bridge_disable(drive->board->context); /* clears a latched trip */
        }
        if (!drive->board->bridge_enable(drive->board->context)) {
            return design_refuse(error, "enable refused: the board's overcurrent trip is latched");
        }
        if (drive->state != DRIVE_OPERATION_ENABLED || drive->commands.disable.posted) {
            drive->planned_end = drive->params.initial_position;
            drive->stop_posted = false;
        }
    }
    if (queued_command_is_move(&queued) && !plan(drive, command, &queued.profile, error)) {
        return false;
    }
    if (!command_queue_put(&drive->commands, &queued)) {
        return design_refuse(error, "command refused: 15 commands are waiting already");
    }
    if (queued_command_is_move(&queued)) {
        drive->planned_end = queued.profile.target;
    }
    return true;
}

void drive_signals_read(const struct drive *drive, struct drive_signals *signals)
{
    const struct per_unit *base = &drive->base;
    const int32_t teeth = drive->settings.motor.rotor_teeth;
    const struct estimate *x = estimator_estimate(&drive->estimator, &drive->params.estimator);
    const struct reference_sample *reference = &drive->reference.now;

    signals->state = drive->state;
    signals->fault = drive->fault;
    signals->period = drive->period;
    signals->holding = drive->hold.active;
    signals->reference_moving = reference->moving;
    signals->theta_ref_rad = position_to_rad(reference->position, teeth);
    signals->omega_ref_rad_s = num_to_double(reference->speed) * base->speed_rad_s;
    signals->theta_est_rad = position_to_rad(x->rotor.position, teeth);
    signals->omega_est_rad_s = num_to_double(x->rotor.speed) * base->speed_rad_s;
    signals->load_torque_est_Nm = num_to_double(x->rotor.load_torque) * base->torque_Nm;
    signals->i_d_A = num_to_double(drive->current.d) * base->current_A;
    signals->i_q_A = num_to_double(drive->current.q) * base->current_A;
    signals->i_d_ref_A = num_to_double(drive->current_reference.d) * base->current_A;
    signals->i_q_ref_A = num_to_double(drive->current_reference.q) * base->current_A;
    signals->u_d_V = num_to_double(drive->voltage_command.d) * base->voltage_V;
    signals->u_q_V = num_to_double(drive->voltage_command.q) * base->voltage_V;
    signals->resistance_est_ohm = num_to_double(x->winding.resistance) * base->resistance_ohm;
    signals->bus_V = num_to_double(drive->bus) * base->voltage_V;
}
