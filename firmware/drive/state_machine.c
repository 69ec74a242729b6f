#include "firmware/drive/state_machine.h"

static void enter(struct drive *drive, enum drive_state state)
{
    drive->state = state;
    drive->state_since = drive->period;
}

/* All blocks at rest at the position the drive is told; a calibrated resistance is kept. */
static void reset_blocks(struct drive *drive)
{
    const struct drive_params *params = &drive->params;
    const num_t resistance =
        estimator_estimate(&drive->estimator, &params->estimator)->winding.resistance;

    estimator_reset(&drive->estimator, &params->estimator, params->initial_position, resistance);
    reference_reset(&drive->reference, params->initial_position);
    standstill_hold_reset(&drive->hold);
    drive->law.integral = NUM(0.0);
    current_control_reset(&drive->current_control);
    actuation_reset(&drive->actuation);
}

static void power_up(struct drive *drive)
{
    reset_blocks(drive);
    if (drive->params.hold_on_enable_periods > 0u) {
        standstill_hold_enter(&drive->hold, drive->params.initial_position.fraction);
        enter(drive, DRIVE_ALIGNING);
    } else {
        enter(drive, DRIVE_OPERATION_ENABLED);
    }
}

static void start_enabling(struct drive *drive)
{
    measurement_reset(&drive->measurement);
    if (drive->params.calibrate_offsets) {
        enter(drive, DRIVE_CALIBRATING_OFFSETS);
    } else {
        power_up(drive);
    }
}

static void disable(struct drive *drive)
{
    drive->fault = DRIVE_FAULT_NONE;
    enter(drive, DRIVE_SWITCH_ON_DISABLED);
}

/* true: done with the command; false: it waits for its period or for the reference to rest. */
static bool obey(struct drive *drive, struct queued_command *command)
{
    const bool ahead = command->at_period == drive->period + 1u;

    if (ahead && !queued_command_is_move(command)) {
        return false;
    }
    if (drive->state == DRIVE_SWITCH_ON_DISABLED && command->kind == DRIVE_COMMAND_ENABLE) {
        start_enabling(drive);
        return true;
    }
    if (drive->state != DRIVE_OPERATION_ENABLED) {
        return true;
    }
    if (reference_busy(&drive->reference)) {
        return false; /* and so the profile in use stays in the queue's memory */
    }
    if (command->kind == DRIVE_COMMAND_ENABLE) {
        return true;
    }
    if (command->kind == DRIVE_COMMAND_HOLD) {
        drive->reference.rest_periods = UINT32_MAX;
    } else {
        (void)reference_load(&drive->reference, &command->profile);
    }
    return true;
}

/* One command a period, and the check for more only in a period without: short worst case. */
static void take_commands(struct drive *drive)
{
    struct command_queue *queue = &drive->commands;
    struct queued_command *command;

    if (command_queue_take_urgent(queue, &queue->disable, drive->period)) {
        disable(drive);
        return;
    }
    if (command_queue_take_urgent(queue, &queue->stop, drive->period)) {
        reference_stop(&drive->reference);
        /* here, because the next interrupt cuts the ramp */
        queue->attention = queue->disable.posted || queue->written != queue->read;
        return;
    }
    /* A move is loaded a period ahead: it begins with the period it is addressed to. */
    command = command_queue_due(queue, drive->period + 1u);
    if (command == NULL) {
        command_queue_rest(queue);
    } else if (obey(drive, command)) {
        command_queue_drop(queue);
    }
}

static void calibrate_offsets(struct drive *drive, const struct hal_samples *samples)
{
    switch (measurement_calibrate(&drive->measurement, &drive->params.measurement, samples)) {
    case OFFSETS_PENDING:
        break;
    case OFFSETS_FOUND:
        power_up(drive);
        break;
    case OFFSETS_OUT_OF_RANGE:
        state_machine_fault(drive, DRIVE_FAULT_OFFSET_RANGE);
        break;
    }
}

void state_machine_fault(struct drive *drive, enum drive_fault fault)
{
    if (fault != DRIVE_FAULT_NONE) {
        drive->fault = fault;
        enter(drive, DRIVE_FAULT);
    }
}

bool state_machine_step(struct drive *drive, const struct hal_samples *samples)
{
    const bool was_powered = state_machine_powered(drive);

    if (drive->commands.attention) {
        take_commands(drive);
    }
    if (drive->state == DRIVE_CALIBRATING_OFFSETS) {
        calibrate_offsets(drive, samples);
    } else if (drive->state == DRIVE_ALIGNING &&
               drive->period - drive->state_since > drive->params.hold_on_enable_periods) {
        enter(drive, DRIVE_OPERATION_ENABLED);
    }
    if (!state_machine_powered(drive)) {
        return false;
    }
    const enum drive_fault fault = protection_check_samples(&drive->params.protection, samples);

    state_machine_fault(drive, fault);
    return was_powered && fault == DRIVE_FAULT_NONE;
}
