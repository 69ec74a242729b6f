/*
 * The control interrupt, read as the block diagram of the drive:
 *
 *   samples -> per-unit -> estimator -> reference -> position law or hold -> current control,
 *   decoupling, voltage limit -> loss compensation, modulator -> duties, watched by the protection
 *
 * What is computed from S(k) acts from S(k+1) on. So currents and rotor are predicted to S(k+1)
 * with the voltage already committed, and compared with the reference of S(k+1).
 */
#include "firmware/drive/modulate.h"
#include "firmware/drive/drive.h"
#include "firmware/drive/finding_position.h"
#include "firmware/drive/prepared_input.h"
#include "firmware/drive/standstill_angle.h"
#include "firmware/drive/state_machine.h"
#include "firmware/drive/synchronism.h"

/* The blocks that both paths of control() go through are compiled into each of them. */
#define IN_PLACE __attribute__((always_inline)) static inline

static const struct hal_outputs bridge_off = {.bridge_on = false};

/* The motor at the instant at which the answer begins to act, as known at S(k). */
struct prediction {
    struct phases current;
    struct phases undisturbed_current; /* had what was demanded acted; for voltage laws */
    struct rotor rotor;
    struct sincos frame; /* of the rotor */
    const struct reference_sample *reference;
    num_t load_torque_change; /* over the period after it, as far as it is known */
};

/* At S(k+1), with the voltage already committed. */
IN_PLACE void predict(struct prediction *next, const struct drive *drive,
                      const struct estimate *estimate)
{
    next->current = forced_current(&estimate->winding, estimate->free_current,
                                   actuation_in_force(&drive->actuation));
    next->rotor = estimate->rotor;
    next->frame = estimate_end_of_period(estimate);
    next->reference = &drive->reference.next;
    predict_rotor(&drive->params.model, &next->rotor, park(next->current, estimate->mid_period).q);
}

/* At S(k): without a delay nothing need be predicted. */
IN_PLACE void present(struct prediction *next, const struct drive *drive,
                      const struct estimate *estimate)
{
    next->current = estimate->current;
    next->rotor = estimate->rotor;
    next->frame = estimate_begin_of_period(estimate);
    next->reference = &drive->reference.now;
}

IN_PLACE struct position_law_input law_input(const struct drive *drive,
                                             const struct prediction *next)
{
    const struct reference_sample *reference = next->reference;
    const bool feed_forward = drive->params.path.feed_forward;

    return (struct position_law_input){
        .position_error = position_difference(reference->position, next->rotor.position),
        .reference_speed = feed_forward ? reference->speed : NUM(0.0),
        .reference_acceleration = feed_forward ? reference->acceleration : NUM(0.0),
        .speed = next->rotor.speed,
        .load_torque = next->rotor.load_torque,
    };
}

IN_PLACE void consider_hold(struct drive *drive, const struct prediction *next,
                            num_t position_error)
{
    standstill_hold_consider(&drive->hold, &drive->params.hold, next->reference->position.fraction,
                             drive->reference.slow_periods, position_error, next->rotor.speed);
}

IN_PLACE struct dq wanted_current(struct drive *drive, const struct prediction *next)
{
    const struct drive_params *params = &drive->params;
    struct dq current;

    current.d = standstill_hold_step(&drive->hold, &params->hold);
    if (drive->hold.active) {
        current.q = standstill_hold_torque_current(
            &params->hold, next->rotor.speed - drive->hold.speed,
            drive->supervision.aligns ? NUM(0.0) : next->rotor.load_torque);
    } else {
        const struct position_law_input input = law_input(drive, next);

        current.q = position_law_current(params->position_law, &drive->law, &params->law, &input);
        consider_hold(drive, next, input.position_error);
    }
    return current;
}

/* Of the hold: of the reference. In motion: of the rotor, as it turns. */
IN_PLACE struct frame current_frame(const struct drive *drive, const struct estimate *estimate,
                                    const struct prediction *next)
{
    if (drive->hold.active) {
        return (struct frame){drive->hold.frame, drive->hold.frame, drive->hold.speed};
    }
    return (struct frame){next->frame, sincos_add(next->frame, estimate->half_turn),
                          next->rotor.speed};
}

/* Hold or current law, then current control. */
IN_PLACE struct phases regulate_current(struct drive *drive, const struct estimate *estimate,
                                        const struct prediction *next)
{
    drive->current_reference = wanted_current(drive, next);

    const struct frame frame = current_frame(drive, estimate, next);

    drive->current = park(next->current, frame.begin);
    drive->voltage_command = current_control_step(
        &drive->current_control, &drive->params.current_control, drive->current_reference,
        drive->current, (struct rotation){frame.speed, next->rotor.speed},
        modulator_voltage_limit(&drive->modulator, &drive->params.modulator));
    return inverse_park(drive->voltage_command, frame.middle);
}

/* A voltage law. */
static struct phases regulate_voltage(struct drive *drive, const struct estimate *estimate,
                                      const struct prediction *next)
{
    const struct drive_params *params = &drive->params;
    const struct voltage_law_input input = {
        .motion = law_input(drive, next),
        .current = park(next->current, next->frame),
        .undisturbed_current = park(next->undisturbed_current, next->frame),
        .innovation = expectation_innovation(&drive->expectation, estimate->current),
        .current_d_reference = standstill_hold_step(&drive->hold, &params->hold),
        .reference_jerk = params->path.feed_forward
                              ? reference_jerk(&drive->reference, &params->reference)
                              : NUM(0.0),
        .load_torque_change = next->load_torque_change,
        .resistance = estimate->winding.resistance,
        .voltage_limit = modulator_voltage_limit(&drive->modulator, &drive->params.modulator),
        .angle = next->rotor.position.fraction,
        .reference_angle = next->reference->position.fraction,
    };
    const struct voltage_demand demand =
        position_law_voltage(params->position_law, &drive->law, &params->law, &input);

    consider_hold(drive, next, input.motion.position_error);
    drive->current = input.current;
    drive->current_reference = (struct dq){input.current_d_reference, demand.torque_current};
    drive->voltage_command = demand.voltage;
    return inverse_park(demand.voltage, sincos_add(next->frame, estimate->half_turn));
}

/*
 * What would come of the demanded voltage alone, for the laws that observe what disturbs it: at
 * S(k) the current of the coming one if there is a delay, else the present one, which is measured.
 */
static void expect_current(struct drive *drive, const struct estimate *estimate,
                           struct prediction *next)
{
    next->load_torque_change = NUM(0.0);
    next->undisturbed_current = has_zero_delay(&drive->params.path)
                                    ? estimate->current
                                    : forced_current(&estimate->winding, estimate->free_current,
                                                     drive->expectation.demanded_voltage);
}

/* Afterwards, with this period's voltage. */
static void remember_demand(struct drive *drive, const struct estimate *estimate,
                            const struct prediction *next, struct phases voltage)
{
    struct phases expected = next->undisturbed_current;

    if (has_zero_delay(&drive->params.path)) {
        expected = forced_current(&estimate->winding, estimate->free_current, voltage);
    }
    expectation_set(&drive->expectation, voltage, expected, estimate->mid_period);
}

/* The detent torque at the instant of action, learned from what the observer has left of it. A
   period in which a motion begins or ends has no time to learn. */
__attribute__((noinline)) static void
compensate_detent(struct drive *drive, const struct estimate *estimate, struct prediction *next)
{
    const num_t before = drive->detent.torque;

    if (!has_zero_delay(
            &drive->params.path)) { /* the prediction knew the estimated part of the load alone */
        next->rotor.speed -= num_mul_coef(before, drive->params.model.speed_per_torque);
    }
    detent_compensation_step(&drive->detent, &drive->params.detent, next->rotor.position.fraction,
                             next->frame, next->rotor.speed, estimate->rotor.load_torque,
                             drive->reference.now.moving == drive->reference.next.moving);
    if (estimator_is(&drive->params.estimator, ESTIMATOR_ENCODER_OBSERVER)) {
        encoder_observer_set_known_torque(&drive->estimator.encoder_observer, drive->detent.torque);
    }
    next->load_torque_change = drive->detent.torque - before;
    next->rotor.load_torque = estimate->rotor.load_torque + drive->detent.torque;
}

/* To the middle of the periods in which the frame acts, S(k+2)...S(k+6). Apart: rare. */
__attribute__((noinline)) static void lead_rotor(struct drive *drive)
{
    const struct reference_sample *reference = &drive->reference.next;
    const int32_t half_turn = half_period_rotation(&drive->params.model, reference->speed);

    standstill_hold_follow(&drive->hold, reference->position.fraction + 6u * (angle_t)half_turn,
                           reference->speed, reference->moving);
}

/* The hold ends where the reference moves, but takes its frame along with one that creeps, until
   that has come to rest. */
IN_PLACE void leave_or_lead(struct drive *drive)
{
    if (!drive->hold.active) {
        return;
    }
    standstill_hold_leave(&drive->hold, drive->reference.slow_periods,
                          drive->reference.next.moving);
    if (drive->hold.active && drive->hold.leads &&
        standstill_hold_leads_in(drive->supervision.period) &&
        drive->commands.looked != drive->supervision.period) {
        lead_rotor(drive);
    }
}

/* Between hold and voltage law nothing of the past of the one that takes over is left. */
IN_PLACE void hand_over(struct drive *drive, const struct estimate *estimate, bool held)
{
    leave_or_lead(drive);
    if (drive->hold.active && !held) {
        const num_t resistance = estimate->winding.resistance;
        const struct dq drop = {num_mul(resistance, drive->current.d),
                                num_mul(resistance, drive->current.q)};

        current_control_preset(&drive->current_control, drop);
    } else if (held && !drive->hold.active &&
               position_law_gives_voltage(drive->params.position_law)) {
        position_law_reset(&drive->law);
    }
}

/*
 * The path of voltage laws, of the detent compensation and of what only a simulation has: no
 * delay, no loss compensation. Kept out of the interrupt's body, so that the registers and the
 * stack of the heaviest law cost the default path nothing.
 */
__attribute__((noinline)) static struct hal_outputs control_general(struct drive *drive,
                                                                    const struct estimate *estimate)
{
    const struct drive_params *params = &drive->params;
    const bool held = drive->hold.active;
    const struct current_control before = drive->current_control;
    struct prediction next;
    struct phases voltage;
    struct hal_outputs duties;

    if (params->path.standstill_pulses) {
        standstill_angle_begin(drive);
    }
    if (has_zero_delay(&params->path)) {
        present(&next, drive, estimate);
    } else {
        predict(&next, drive, estimate);
    }
    expect_current(drive, estimate, &next);
    if (ESTIMATORS_READ_ENCODER && params->path.detent_learning && !drive->supervision.aligns) {
        compensate_detent(drive, estimate, &next);
    }
    voltage = !drive->hold.active && position_law_gives_voltage(params->position_law)
                  ? regulate_voltage(drive, estimate, &next)
                  : regulate_current(drive, estimate, &next);
    if (params->path.standstill_pulses) {
        standstill_angle_step(drive, estimate, &before, &voltage);
    }
    remember_demand(drive, estimate, &next, voltage);
    duties = modulate(drive, params->path.bridge_loss_compensation
                                 ? actuation_compensate(&drive->actuation, voltage)
                                 : voltage);
    if (has_zero_delay(&params->path)) {
        actuation_commit_past(&drive->actuation); /* measured at the next S(k) already */
    }
    hand_over(drive, estimate, held);
    return duties;
}

/* The path of the sensorless default: a current law or the hold. */
IN_PLACE struct hal_outputs control_current(struct drive *drive, const struct estimate *estimate)
{
    struct prediction next;
    struct phases voltage;
    struct hal_outputs duties;

    predict(&next, drive, estimate);
    voltage = regulate_current(drive, estimate, &next);
    duties = modulate(drive, actuation_compensate(&drive->actuation, voltage));
    leave_or_lead(drive);
    return duties;
}

IN_PLACE struct hal_outputs control(struct drive *drive, const struct estimate *estimate)
{
    reference_step(&drive->reference, &drive->params.reference, drive->hold.active);
    return drive->params.path.general ? control_general(drive, estimate)
                                      : control_current(drive, estimate);
}

IN_PLACE const struct estimate *observe(struct drive *drive, const struct sample_set *now)
{
    struct channels winding = now->winding;

    modulator_track_bus(&drive->modulator, now->bus);
    if (drive->params.path.general && drive->params.path.prepares_input) {
        prepared_input_make(drive, winding.current, winding.voltage);
        winding = drive->input.winding;
    }
    actuation_observe(&drive->actuation, winding.voltage);
    const struct estimator_input input = {
        .winding = &winding,
        .encoder_count = drive->encoder_count,
        .hold = {.active = drive->hold.active, .leads = &drive->hold.leads},
    };

    return estimator_observe(&drive->estimator, &drive->params.estimator, &input);
}

/* The bridge is on and stays on for this period: what it needs of estimate and duties. */
IN_PLACE struct hal_outputs powered_cycle(struct drive *drive, const struct sample_set *now)
{
    const struct estimate *estimate = observe(drive, now);
    enum drive_fault fault = protection_check_estimate(&drive->params.protection, estimate);

    if (fault == DRIVE_FAULT_NONE && synchronism_is_due(drive)) {
        fault = synchronism_watch(drive, &estimate->rotor);
    }
    if (fault != DRIVE_FAULT_NONE) {
        state_machine_fault(drive, fault);
        return bridge_off;
    }
    return control(drive, estimate);
}

IN_PLACE struct sample_set measure(struct drive *drive, const struct hal_samples *samples)
{
    const struct sample_set now =
        measurement_step(&drive->measurement, &drive->params.measurement, samples);

    drive->bus = now.bus;
    return now;
}

struct hal_outputs drive_control_cycle(struct drive *drive, const struct hal_samples *samples)
{
    drive->encoder_count = samples->encoder_count;
    state_machine_begin_period(drive);
    if (state_machine_step(drive, samples)) {
        const struct sample_set now = measure(drive, samples);

        return powered_cycle(drive, &now);
    }
    (void)measure(drive, samples); /* the bus is shown in every state */
    return drive->supervision.state == DRIVE_FINDING_POSITION
               ? finding_position_cycle(drive, samples)
               : state_machine_resting_bridge(drive);
}
