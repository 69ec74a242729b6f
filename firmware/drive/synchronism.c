#include "firmware/drive/synchronism.h"

struct synchronism_monitor_params synchronism_params(const struct drive *drive,
                                                     const struct drive_settings *settings)
{
    const struct drive_params *params = &drive->params;
    const struct synchronism_monitor_task task = {
        .motor = &settings->motor,
        .base = &drive->base,
        .model = &params->model,
        .period_s = drive->board->facts->control_period_s,
        .current_gain_moving = coef_to_double(params->estimator.invariant_ekf.moving.current),
        .current_gain_holding = coef_to_double(params->estimator.invariant_ekf.holding.current),
        .current_limit_A = settings->current_limit_A,
        .resistance_adapted = settings->resistance_adaptation,
        .resistance_calibrated = settings->resistance_adaptation && settings->hold_on_enable,
    };

    return synchronism_monitor_design(&task);
}

void synchronism_design(struct drive *drive, const struct drive_settings *settings)
{
    struct synchronism_supervision *synchronism = &drive->synchronism;

    synchronism->monitored = drive->params.estimator.kind == ESTIMATOR_INVARIANT_EKF &&
                             settings->synchronism_policy != DRIVE_SYNCHRONISM_OFF;
    if (synchronism->monitored) {
        synchronism->policy = settings->synchronism_policy;
        synchronism->params = synchronism_params(drive, settings);
    }
}

#define NOT_YET (1u << 30) /* periods; longer than any enabling */

/* The steps of a block. */
enum step {
    TAKE,
    WATCH_HOLD,  /* of a hold alone */
    SETTLE_BIAS, /* likewise */
    JUDGE_VOLTAGE,
    JUDGE_LASTING,
    JUDGE_TORQUE,
    JUDGE_LOAD,
    JUDGE_FOLLOWING,
    JUDGE_PULL_OUT, /* of a hold alone */
    JUDGE_LOAD_ANGLE,
    BEHIND_PULL_OUT = JUDGE_LOAD_ANGLE,
    FOLLOW,     /* with an encoder: all there is */
    UNMONITORED /* no block, ever */
};

void synchronism_reset(struct drive *drive)
{
    synchronism_monitor_reset(&drive->synchronism.monitor, &drive->synchronism.params);
    drive->synchronism.shown = DRIVE_SYNCHRONISM_SURE;
    drive->synchronism.step = UNMONITORED;
    drive->synchronism.due = drive->supervision.period + NOT_YET;
    following_error_reset(&drive->following);
}

void synchronism_start(struct drive *drive)
{
    if (drive->params.following.limit > NUM(0.0)) {
        drive->synchronism.step = FOLLOW;
        drive->synchronism.due = drive->supervision.period + drive->params.following.periods;
    }
    if (drive->synchronism.monitored) {
        drive->synchronism.step = TAKE;
        drive->synchronism.block_began = drive->supervision.period;
        drive->synchronism.due =
            drive->supervision.period + drive->synchronism.params.block_periods;
        (void)invariant_ekf_take_innovation_sum(&drive->estimator.invariant_ekf,
                                                drive->hold.active);
    }
}

/* What steps that waited make a block longer by: mean of its sum, to within a quarter. */
static num_t of_a_block(const struct drive *drive, num_t sum)
{
    const uint32_t block = drive->synchronism.params.block_periods;
    const uint32_t lasted = drive->supervision.period - drive->synchronism.block_began;

    if (lasted <= block + block / 4u) {
        return sum;
    }
    return lasted <= 2u * block + block / 2u ? num_half(sum) : num_half(num_half(sum));
}

static enum synchronism judge_load_angle(struct drive *drive)
{
    const enum synchronism verdict =
        synchronism_monitor_judge_load_angle(&drive->synchronism.monitor);

    drive->synchronism.step = TAKE;
    if (drive->supervision.period - drive->synchronism.block_began <
        drive->synchronism.params.block_periods) {
        drive->synchronism.due =
            drive->synchronism.block_began + drive->synchronism.params.block_periods;
    }
    if (verdict == SYNCHRONISM_SURE && drive->synchronism.shown != DRIVE_SYNCHRONISM_LOST) {
        drive->synchronism.shown = DRIVE_SYNCHRONISM_SURE;
    }
    return verdict;
}

/* Of the rotor, beside the reference for this S(k). */
static num_t error_of(const struct drive *drive, const struct rotor *rotor)
{
    return position_difference(drive->reference.now.position, rotor->position);
}

static enum synchronism judge_lasting(struct drive *drive, const struct rotor *rotor)
{
    struct synchronism_monitor *monitor = &drive->synchronism.monitor;
    const struct synchronism_monitor_params *params = &drive->synchronism.params;

    return drive->hold.active
               ? synchronism_monitor_judge_hold(monitor, params, rotor->speed, drive->hold.leads)
               : synchronism_monitor_judge_motion(monitor, params, rotor->speed,
                                                  drive->current_reference.d);
}

static enum synchronism judge_following(struct drive *drive, const struct rotor *rotor)
{
    if (!drive->hold.active) {
        drive->synchronism.step = JUDGE_LOAD_ANGLE;
    }
    return synchronism_monitor_judge_following(&drive->synchronism.monitor,
                                               &drive->synchronism.params, error_of(drive, rotor),
                                               drive->reference.now.speed - rotor->speed);
}

static enum synchronism judge_pull_out(struct drive *drive, const struct rotor *rotor)
{
    if (!drive->hold.active) {
        return SYNCHRONISM_SURE;
    }
    return synchronism_monitor_judge_pull_out(
        &drive->synchronism.monitor, error_of(drive, rotor) + turns_from_angle(drive->hold.offset));
}

/* A hold whose rotor has pulled out drives it on: the position law catches it, if it may. */
static void release(struct drive *drive)
{
    standstill_hold_leave(&drive->hold, 0u, false);
    position_law_reset(&drive->law);
}

static void take(struct drive *drive)
{
    const bool held = drive->hold.active;
    const num_t sum =
        of_a_block(drive, invariant_ekf_take_innovation_sum(&drive->estimator.invariant_ekf, held));

    drive->synchronism.block_began = drive->supervision.period;
    if (!held) {
        drive->synchronism.step = JUDGE_VOLTAGE;
    }
    synchronism_monitor_take(&drive->synchronism.monitor, &drive->synchronism.params, sum, held);
}

/* What a hold takes for a step of the load, or what of its offset lasts. Apart, as it calls others:
   no step's registers are saved for that. */
__attribute__((noinline)) static void watch_hold(struct drive *drive, bool settles)
{
    struct invariant_ekf *ekf = &drive->estimator.invariant_ekf;
    const struct invariant_ekf_params *params = &drive->params.estimator.invariant_ekf;

    if (!drive->hold.active) {
        return;
    }
    if (settles) {
        invariant_ekf_settle_bias(ekf, params);
    } else {
        invariant_ekf_bear(ekf, drive->params.hold.current_limit);
        invariant_ekf_watch_hold(ekf, params, drive->hold.leads);
    }
}

_Static_assert((int)SYNCHRONISM_DOUBTFUL == (int)DRIVE_SYNCHRONISM_DOUBTFUL &&
                   (int)SYNCHRONISM_STALLED == (int)DRIVE_SYNCHRONISM_STALLED &&
                   (int)SYNCHRONISM_LOST == (int)DRIVE_SYNCHRONISM_LOST,
               "a verdict is shown as it is");

/* With the policy `warn` the worst stays on show: a loss until the bridge is switched on anew, the
   rest until the estimate is sure again. */
enum drive_fault synchronism_act(struct drive *drive, enum synchronism verdict)
{
    const enum drive_synchronism shown = (enum drive_synchronism)verdict;

    if (drive->synchronism.step == FOLLOW) {
        return DRIVE_FAULT_FOLLOWING_ERROR;
    }
    if (drive->hold.active && drive->synchronism.step == BEHIND_PULL_OUT &&
        verdict == SYNCHRONISM_STALLED) {
        release(drive);
    }
    if (shown > drive->synchronism.shown) {
        drive->synchronism.shown = shown;
    }
    if (verdict > SYNCHRONISM_DOUBTFUL) {
        axis_note_uncertain(drive);
    }
    if (verdict == SYNCHRONISM_DOUBTFUL || !synchronism_loss_is_fault(drive)) {
        return DRIVE_FAULT_NONE;
    }
    return verdict == SYNCHRONISM_LOST ? DRIVE_FAULT_LOST_SYNCHRONISM : DRIVE_FAULT_STALLED;
}

static bool follow(struct drive *drive, const struct rotor *rotor)
{
    const bool exceeds =
        following_error_exceeds(&drive->following, &drive->params.following, error_of(drive, rotor),
                                drive->reference.now.speed - rotor->speed);

    drive->synchronism.step = FOLLOW;
    drive->synchronism.due = drive->supervision.period + drive->params.following.periods;
    return exceeds;
}

/* One of the steps of a block, each in a period of its own. */
enum synchronism synchronism_step(struct drive *drive)
{
    struct synchronism_monitor *monitor = &drive->synchronism.monitor;
    const struct synchronism_monitor_params *params = &drive->synchronism.params;
    const struct rotor *rotor = &drive->estimator.estimate.rotor;

    drive->synchronism.due = drive->supervision.period + 1u;
    switch (drive->synchronism.step++) {
    case TAKE:
        take(drive);
        return SYNCHRONISM_SURE;
    case WATCH_HOLD:
    case SETTLE_BIAS:
        watch_hold(drive, drive->synchronism.step > SETTLE_BIAS);
        return SYNCHRONISM_SURE;
    case JUDGE_VOLTAGE:
        return synchronism_monitor_judge_voltage(monitor, params, rotor->speed,
                                                 drive->current_reference.d);
    case JUDGE_LASTING:
        return judge_lasting(drive, rotor);
    case JUDGE_TORQUE:
        return synchronism_monitor_judge_torque(monitor, params, drive->current_reference.q,
                                                rotor->speed);
    case JUDGE_LOAD:
        return synchronism_monitor_judge_load(monitor, params, rotor->load_torque);
    case JUDGE_FOLLOWING:
        return judge_following(drive, rotor);
    case JUDGE_PULL_OUT:
        return judge_pull_out(drive, rotor);
    case JUDGE_LOAD_ANGLE:
        return judge_load_angle(drive);
    case FOLLOW:
        return follow(drive, rotor) ? SYNCHRONISM_LOST : SYNCHRONISM_SURE;
    default:
        drive->synchronism.step = UNMONITORED;
        drive->synchronism.due = drive->supervision.period + NOT_YET;
        return SYNCHRONISM_SURE;
    }
}
