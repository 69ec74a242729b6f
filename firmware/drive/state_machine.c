#include "firmware/drive/state_machine.h"

#include <stdatomic.h>

#include "firmware/drive/block_reset.h"
#include "firmware/drive/command_rules.h"
#include "firmware/drive/encoder_aligning.h"
#include "firmware/drive/phase_balancing.h"
#include "firmware/drive/prepared_input.h"
#include "firmware/drive/synchronism.h"

static void enter(struct drive *drive, enum drive_state state)
{
    drive->supervision.state = state;
    drive->supervision.state_since = drive->supervision.period;
}

static void begin_operation(struct drive *drive)
{
    axis_note_ready(drive);
    synchronism_start(drive);
    enter(drive, DRIVE_OPERATION_ENABLED);
}

static void end_aligning(struct drive *drive)
{
    const struct drive_params *params = &drive->params;

    drive->supervision.aligns = false;
    estimator_expect_load(&drive->estimator, &drive->params.estimator);
    standstill_hold_end_aligning(&drive->hold, &params->hold);
    begin_operation(drive);
}

/* Apart: rare. */
__attribute__((noinline)) static void align_encoder(struct drive *drive)
{
    const enum encoder_aligning aligning = encoder_aligning_step(drive);

    if (aligning == ENCODER_ALIGNED) {
        end_aligning(drive);
    } else if (aligning == ENCODER_NOT_ALIGNED) {
        state_machine_fault(drive, DRIVE_FAULT_POSITION_NOT_FOUND);
    }
}

static void balance_phases(struct drive *drive, const struct hal_samples *samples)
{
    const enum phase_balancing balancing = phase_balancing_step(drive, samples);

    if (balancing == PHASES_ARE_BALANCED) {
        end_aligning(drive);
    } else if (balancing == PHASES_DO_NOT_MATCH) {
        state_machine_fault(drive, DRIVE_FAULT_PHASE_IMBALANCE);
    } else if (balancing == INDUCTANCE_DOES_NOT_MATCH) {
        state_machine_fault(drive, DRIVE_FAULT_INDUCTANCE);
    }
}

/* The first hold has lasted for so many periods longer than it has to. Apart: rare. */
__attribute__((noinline)) static void
end_first_hold(struct drive *drive, const struct hal_samples *samples, uint32_t longer)
{
    if (drive->params.enabling.balance_periods == 0u || phase_balancing_is_done(drive)) {
        end_aligning(drive);
    } else if (longer == 0u) {
        phase_balancing_start(drive);
    } else {
        balance_phases(drive, samples);
    }
}

/* The first hold: without an encoder, and with one whose zero is known, it calibrates. */
static inline void align(struct drive *drive, const struct hal_samples *samples)
{
    const uint32_t held = drive->supervision.period - drive->supervision.state_since;
    const uint32_t enough = drive->params.enabling.hold_on_enable_periods + 1u;

    if (drive->supervision.aligns) {
        align_encoder(drive);
    } else if (held >= enough) {
        end_first_hold(drive, samples, held - enough);
    }
}

static void power_up(struct drive *drive)
{
    drive_reset_motion(drive);
    if (drive->params.enabling.hold_on_enable_periods > 0u) {
        drive->supervision.aligns = estimator_has_encoder(&drive->params.estimator) &&
                                    !drive->params.enabling.encoder_zero_known &&
                                    !drive->axis.aligned;
        encoder_aligning_start(drive);
        standstill_hold_enter(&drive->hold, drive->reference.next.position.fraction);
        enter(drive, DRIVE_ALIGNING);
    } else {
        begin_operation(drive);
    }
}

/* The turn is the one that is assumed; nearest, if that is wrong by less than half. */
void state_machine_position_found(struct drive *drive, angle_t angle)
{
    const struct position assumed = drive->reference.next.position;

    reference_place(&drive->reference, position_add(assumed, (int32_t)(angle - assumed.fraction)));
    power_up(drive);
}

static void find_position_or_power_up(struct drive *drive)
{
    /* the bridge is off; a position that is found by alignment leaves it on, with current */
    actuation_reset(&drive->actuation);
    prepared_input_reset(drive);
    if (drive->params.enabling.detects_position && !drive->axis.aligned) {
        drive_reset_motion(drive);
        initial_position_start(&drive->enabling.detection, &drive->enabling.detection_params,
                               drive->reference.next.position.fraction);
        enter(drive, DRIVE_DETECTING_POSITION);
    } else {
        power_up(drive);
    }
}

/* Apart: rare. */
__attribute__((noinline)) static void start_enabling(struct drive *drive)
{
    phase_balancing_forget(drive);
    drive_reset_control(drive);
    measurement_reset(&drive->measurement, &drive->params.measurement);
    offset_calibration_reset(&drive->enabling.calibration);
    if (drive->params.enabling.calibrates_offsets) {
        enter(drive, DRIVE_CALIBRATING_OFFSETS);
    } else {
        find_position_or_power_up(drive);
    }
}

#define TO_REALIGN ((uint8_t)DRIVE_FAULTS) /* beside the faults */

static void ask_for(struct drive *drive, uint8_t what)
{
    drive->supervision.asked_for = what;
    atomic_signal_fence(memory_order_release);
    command_queue_look_next(&drive->commands);
}

void state_machine_ask_for_fault(struct drive *drive, enum drive_fault fault)
{
    ask_for(drive, (uint8_t)fault);
}

void state_machine_ask_to_realign(struct drive *drive)
{
    if (drive->supervision.asked_for == DRIVE_FAULT_NONE) {
        ask_for(drive, TO_REALIGN);
    }
}

/* Apart: rare, and so its registers are not take_urgent's. */
__attribute__((noinline)) static void disable(struct drive *drive)
{
    axis_note_bridge_off(drive, DRIVE_FAULT_NONE);
    axis_note_disabled(drive);
    drive->supervision.aligns = false;
    drive->supervision.fault = DRIVE_FAULT_NONE;
    enter(drive, DRIVE_SWITCH_ON_DISABLED);
}

/* What a phase that carries another current than is measured comes to. Not a stall, which is a
   load's as a rule: currents stand then, too. */
#define COMES_OF_PHASE                                                                             \
    (1u << DRIVE_FAULT_OVERCURRENT | 1u << DRIVE_FAULT_HARDWARE_OVERCURRENT |                      \
     1u << DRIVE_FAULT_ESTIMATE_RANGE | 1u << DRIVE_FAULT_LOST_SYNCHRONISM |                       \
     1u << DRIVE_FAULT_FOLLOWING_ERROR)

/* Too much current is none of a phase that is open; of a sensor stuck at zero it may be. An
   estimate that was made of a wrong voltage stalls without a rotor that does. */
static bool comes_of(enum drive_fault suspected, enum drive_fault fault)
{
    if (suspected == DRIVE_FAULT_VOLTAGE_SENSOR &&
        (fault == DRIVE_FAULT_STALLED || fault == DRIVE_FAULT_HARDWARE_OVERCURRENT)) {
        return fault == DRIVE_FAULT_STALLED; /* a comparator has tripped for what flows */
    }
    return suspected != DRIVE_FAULT_NONE && (COMES_OF_PHASE >> fault & 1u) != 0u &&
           (fault > DRIVE_FAULT_HARDWARE_OVERCURRENT || suspected >= DRIVE_FAULT_CURRENT_SENSOR_A);
}

/* Apart: rare. */
__attribute__((noinline)) static void enter_fault(struct drive *drive, enum drive_fault fault)
{
    const enum drive_fault suspected = (enum drive_fault)drive->phase_watch.suspected;

    if (comes_of(suspected, fault)) {
        fault = suspected;
    }
    axis_note_bridge_off(drive, fault);
    drive->supervision.fault = fault;
    command_queue_look_next(&drive->commands); /* nothing waits for a rest any more */
    enter(drive, DRIVE_FAULT);
}

/* Currents flow, and what the next sample shows of them is expected. */
__attribute__((cold, noinline)) static void realign(struct drive *drive)
{
    const struct outlook next = drive->estimator.estimate.next;

    axis_note_uncertain(drive);
    reference_reset(&drive->reference, next.position);
    drive_reset_control(drive);
    drive_reset_motion(drive);
    estimator_expect_current(&drive->estimator, next.current);
    standstill_hold_preset(&drive->hold, drive->params.hold.current);
    standstill_hold_enter(&drive->hold, next.position.fraction);
    enter(drive, DRIVE_ALIGNING);
}

__attribute__((cold, noinline)) static void do_as_asked(struct drive *drive)
{
    const uint8_t what = drive->supervision.asked_for;

    drive->supervision.asked_for = DRIVE_FAULT_NONE;
    if (drive->supervision.state != DRIVE_OPERATION_ENABLED) {
        return;
    }
    if (LINK_CARRIED && what == TO_REALIGN) {
        realign(drive);
    } else {
        enter_fault(drive, (enum drive_fault)what);
    }
}

/* Posted for a drive at rest, and nothing can have come before it. */
static void set_position(struct drive *drive, const struct queued_command *command)
{
    if (command_rules_obeyed(command->kind, drive->supervision.state) &&
        !reference_busy(&drive->reference)) {
        axis_set_position(drive, command->position);
    } else {
        command_queue_count_dropped(&drive->commands, command);
    }
}

/* Outside operation, or of an axis at rest. Apart: rare. */
__attribute__((noinline)) static void obey_at_rest(struct drive *drive,
                                                   const struct queued_command *command)
{
    if (drive->supervision.state == DRIVE_SWITCH_ON_DISABLED &&
        command->kind == DRIVE_COMMAND_ENABLE) {
        start_enabling(drive);
    } else if (command->kind == DRIVE_COMMAND_SET_POSITION) {
        set_position(drive, command);
    } else if (!command_rules_obeyed(command->kind, drive->supervision.state)) {
        command_queue_count_dropped(&drive->commands, command);
    }
}

/* Torque waits for no rest; false: it is another command. */
static inline bool take_torque(struct drive *drive, const struct queued_command *command)
{
    if (!ESTIMATORS_READ_ENCODER || command->kind != DRIVE_COMMAND_TORQUE) {
        return false;
    }
    torque_mode_take(drive, &command->torque);
    return true;
}

/* true: done with the command; false: it waits for its period or for the reference to rest. */
static inline bool obey(struct drive *drive, struct queued_command *command)
{
    const bool moves = queued_command_is_move(command);

    if (!moves && command->at_period == drive->supervision.period + 1u) {
        return false; /* it has been looked at ahead */
    }
    if (drive->supervision.state != DRIVE_OPERATION_ENABLED ||
        command->kind == DRIVE_COMMAND_SET_POSITION) {
        obey_at_rest(drive, command);
        return true;
    }
    if (reference_busy(&drive->reference)) {
        /* and so the profile in use stays in the queue's memory */
        return take_torque(drive, command);
    }
    if (moves) {
        if (!reference_load(&drive->reference, &command->profile)) {
            command_queue_count_dropped(&drive->commands, command);
        }
        return true;
    }
    if (queued_command_is_planned(command)) {
        return false; /* it goes when its plan begins */
    }
    if (command->kind == DRIVE_COMMAND_HOLD) {
        reference_count_as_slow(&drive->reference);
    } else {
        (void)take_torque(drive, command);
    }
    return true;
}

/* Apart: it needs many registers. */
__attribute__((noinline)) static void preempt(struct drive *drive, const struct motion_plan *plan,
                                              uint32_t wait)
{
    if (drive->supervision.state == DRIVE_OPERATION_ENABLED &&
        reference_preempt(&drive->reference, plan)) {
        command_queue_accept_preemption(&drive->commands);
        command_queue_rest_if_empty(&drive->commands, drive->supervision.period, wait);
    }
}

/* A plan, or there is nothing to do for `wait` periods or less. */
static void take_plan(struct drive *drive, uint32_t wait)
{
    struct command_queue *queue = &drive->commands;
    const uint32_t period = drive->supervision.period;
    const struct motion_plan *plan = command_queue_preemption(queue, period + 1u, &wait);

    if (plan != NULL) {
        state_machine_claim_period(drive);
        preempt(drive, plan, wait);
    } else {
        command_queue_rest(queue, period, wait);
    }
}

/* What acts in turn, and plans. `urgent_wait`: periods until an urgent command is to be looked at.
 */
__attribute__((noinline)) static void take_in_turn(struct drive *drive, uint32_t urgent_wait)
{
    struct command_queue *queue = &drive->commands;
    const uint32_t period = drive->supervision.period;
    uint32_t wait = urgent_wait;
    struct queued_command *command = command_queue_due(queue, period + 1u, &wait);

    if (command != NULL && obey(drive, command)) {
        state_machine_claim_period(drive);
        command_queue_drop(queue);
        command_queue_rest_if_empty(queue, period, urgent_wait);
    } else {
        take_plan(drive, command_queue_wait_of(command, period + 1u, wait));
    }
}

/* A disable or stop waits; the others' turn comes if it does so still. Apart: rare. */
__attribute__((noinline)) static void take_urgent(struct drive *drive)
{
    struct command_queue *queue = &drive->commands;
    const uint32_t period = drive->supervision.period;
    uint32_t wait = COMMAND_QUEUE_NEVER;

    if (command_queue_take_urgent(queue, &queue->disable, period, &wait)) {
        disable(drive);
    } else if (command_queue_take_urgent(queue, &queue->stop, period + 1u, &wait)) {
        state_machine_claim_period(drive);
        reference_stop(&drive->reference);
        command_queue_stop_acted(queue, period + 1u);
        command_queue_rest_if_empty(queue, period, wait);
    } else {
        take_in_turn(drive, wait);
    }
}

/*
 * One command a period, and in the next the rest is looked at: short worst case. The reference has
 * been moved to S(k+1): what is asked of it for the period that follows is put to it now. What acts
 * claims the period; that something is looked at depends on when the background has posted it.
 */
static void take_commands(struct drive *drive)
{
    command_queue_look(&drive->commands, drive->supervision.period);
    if (RARE(drive->supervision.asked_for != DRIVE_FAULT_NONE)) {
        do_as_asked(drive);
    } else if (RARE(command_queue_holds_urgent(&drive->commands))) {
        take_urgent(drive);
    } else {
        take_in_turn(drive, COMMAND_QUEUE_NEVER);
    }
}

static void calibrate_offsets(struct drive *drive, const struct hal_samples *samples)
{
    struct channels offset;

    if (drive->enabling.calibration.bridge_on) {
        state_machine_fault(drive, protection_check_samples(&drive->params.protection, samples));
        if (drive->supervision.state == DRIVE_FAULT) {
            return;
        }
    }
    if (offset_calibration_is_done(&drive->enabling.calibration)) {
        find_position_or_power_up(drive);
        return;
    }

    const enum offset_result result =
        offset_calibration_step(&drive->enabling.calibration, &drive->enabling.calibration_params,
                                &drive->params.measurement, samples, &offset);

    if (result != OFFSETS_PENDING) {
        measurement_set_offset(&drive->measurement, offset);
    }
    if (result == OFFSETS_OUT_OF_RANGE) {
        state_machine_fault(drive, DRIVE_FAULT_OFFSET_RANGE);
    }
}

void state_machine_fault(struct drive *drive, enum drive_fault fault)
{
    if (fault != DRIVE_FAULT_NONE) {
        enter_fault(drive, fault);
    }
}

struct hal_outputs state_machine_resting_bridge(const struct drive *drive)
{
    const bool on = drive->supervision.state == DRIVE_CALIBRATING_OFFSETS &&
                    drive->enabling.calibration.bridge_on;
    const uint16_t half = on ? (uint16_t)drive->params.modulator.middle_counts : 0u;

    return (struct hal_outputs){.high_counts = {half, half, half, half}, .bridge_on = on};
}

void state_machine_check_samples(struct drive *drive, const struct hal_samples *samples)
{
    const enum drive_fault fault = protection_check_samples(&drive->params.protection, samples);

    state_machine_fault(drive, fault);
}

bool state_machine_obey(struct drive *drive, const struct hal_samples *samples)
{
    drive->encoder_count = samples->encoder_count;
    take_commands(drive);
    return drive->supervision.state == DRIVE_OPERATION_ENABLED;
}

/* The bridge is off as the period begins. Apart: rare. */
__attribute__((noinline)) static void step_unpowered(struct drive *drive,
                                                     const struct hal_samples *samples)
{
    if (ESTIMATORS_READ_ENCODER && drive->axis.counts) {
        axis_follow_encoder(drive);
    }
    if (command_queue_is_due(&drive->commands, drive->supervision.period)) {
        take_commands(drive);
    }
    if (drive->supervision.state == DRIVE_CALIBRATING_OFFSETS) {
        calibrate_offsets(drive, samples);
    } else if (drive->supervision.state == DRIVE_ALIGNING) {
        align(drive, samples);
    }
    if (drive->supervision.state == DRIVE_DETECTING_POSITION || state_machine_powered(drive)) {
        /* the control has only been reset; a fault is entered at once */
        state_machine_check_samples(drive, samples);
    }
}

bool state_machine_step(struct drive *drive, const struct hal_samples *samples)
{
    drive->encoder_count = samples->encoder_count;
    if (!state_machine_powered(drive)) {
        step_unpowered(drive, samples);
        return false;
    }
    if (command_queue_is_due(&drive->commands, drive->supervision.period)) {
        take_commands(drive);
    }
    if (drive->supervision.state == DRIVE_ALIGNING) {
        align(drive, samples);
    }
    return state_machine_powered(drive);
}
