#include "firmware/drive/synchronism.h"

void synchronism_design(struct drive *drive, const struct drive_settings *settings, double period_s)
{
    struct drive_params *params = &drive->params;

    params->monitors_synchronism = params->estimator.kind == ESTIMATOR_INVARIANT_EKF &&
                                   settings->synchronism_policy != DRIVE_SYNCHRONISM_OFF;
    if (!params->monitors_synchronism) {
        return;
    }
    const struct synchronism_monitor_task task = {
        .motor = &settings->motor,
        .base = &drive->base,
        .model = &params->model,
        .period_s = period_s,
        .current_gain_moving = coef_to_double(params->estimator.invariant.moving.current),
        .current_gain_holding = coef_to_double(params->estimator.invariant.holding.current),
        .current_limit_A = settings->current_limit_A,
        .resistance_known = settings->resistance_adaptation && settings->hold_on_enable,
    };

    params->synchronism_policy = settings->synchronism_policy;
    params->synchronism_monitor = synchronism_monitor_design(&task);
}

#define NOT_YET (1u << 30) /* periods; longer than any enabling */

void synchronism_reset(struct drive *drive)
{
    synchronism_monitor_reset(&drive->synchronism_monitor);
    drive->synchronism = DRIVE_SYNCHRONISM_SURE;
    drive->synchronism_step = 0;
    drive->synchronism_due = drive->period + NOT_YET;
}

void synchronism_start(struct drive *drive)
{
    drive->synchronism_due = drive->period;
    if (drive->params.monitors_synchronism) {
        drive->estimator.invariant.innovation_sum = NUM(0.0);
    }
}

/* In the last step of a block: the doubts of all of them are known. */
static enum synchronism finish(struct drive *drive, enum synchronism verdict)
{
    drive->synchronism_step = 0;
    if (drive->period - drive->synchronism_block < SYNCHRONISM_BLOCK_PERIODS) {
        drive->synchronism_due = drive->synchronism_block + SYNCHRONISM_BLOCK_PERIODS;
    }
    if (verdict == SYNCHRONISM_SURE && drive->synchronism == DRIVE_SYNCHRONISM_DOUBTFUL) {
        drive->synchronism = DRIVE_SYNCHRONISM_SURE;
    }
    return verdict;
}

/* One of the five steps of a block. */
static enum synchronism step(struct drive *drive, const struct rotor *rotor)
{
    struct synchronism_monitor *monitor = &drive->synchronism_monitor;
    const struct synchronism_monitor_params *params = &drive->params.synchronism_monitor;
    const struct reference_sample *reference = &drive->reference.next; /* for this S(k) */
    struct invariant_ekf *ekf = &drive->estimator.invariant;

    drive->synchronism_due = drive->period + 1u;
    switch (drive->synchronism_step++) {
    case 0:
        drive->synchronism_block = drive->period;
        synchronism_monitor_take(monitor, params, ekf->innovation_sum, drive->hold.active);
        ekf->innovation_sum = NUM(0.0);
        return SYNCHRONISM_SURE;
    case 1:
        return synchronism_monitor_judge_voltage(monitor, params, rotor->speed,
                                                 drive->current_reference.d);
    case 2:
        return synchronism_monitor_judge_hold(monitor, params, rotor->speed, drive->hold.active);
    case 3:
        return synchronism_monitor_judge_torque(monitor, params, drive->current_reference.q, rotor);
    default:
        return finish(drive, synchronism_monitor_judge_following(
                                 monitor, params,
                                 position_difference(reference->position, rotor->position),
                                 reference->speed - rotor->speed, drive->hold.active));
    }
}

/* With the policy `warn` a loss stays on show until the bridge is switched on anew. */
static enum drive_fault act(struct drive *drive, enum synchronism verdict)
{
    if (verdict == SYNCHRONISM_LOST) {
        drive->synchronism = DRIVE_SYNCHRONISM_LOST;
    } else if (drive->synchronism != DRIVE_SYNCHRONISM_LOST) {
        drive->synchronism = DRIVE_SYNCHRONISM_DOUBTFUL;
    }
    if (verdict == SYNCHRONISM_DOUBTFUL ||
        drive->params.synchronism_policy != DRIVE_SYNCHRONISM_FAULT) {
        return DRIVE_FAULT_NONE;
    }
    return verdict == SYNCHRONISM_LOST ? DRIVE_FAULT_LOST_SYNCHRONISM : DRIVE_FAULT_STALLED;
}

enum drive_fault synchronism_watch(struct drive *drive, const struct rotor *rotor)
{
    if (!drive->params.monitors_synchronism) {
        drive->synchronism_due = drive->period + NOT_YET;
        return DRIVE_FAULT_NONE;
    }
    const enum synchronism verdict = step(drive, rotor);

    return verdict == SYNCHRONISM_SURE ? DRIVE_FAULT_NONE : act(drive, verdict);
}
