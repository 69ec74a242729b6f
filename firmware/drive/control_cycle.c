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
#include "firmware/drive/block_reset.h"
#include "firmware/drive/drive.h"
#include "firmware/drive/position_detecting.h"
#include "firmware/drive/prepared_input.h"
#include "firmware/drive/standstill_angle.h"
#include "firmware/drive/state_machine.h"
#include "firmware/drive/synchronism.h"
#include "firmware/estimator/invariant_ekf_step.h"

/* The blocks that both paths of control() go through are compiled into each of them. */
#define IN_PLACE __attribute__((always_inline)) static inline

/* The motor at the instant at which the answer begins to act, as known at S(k). */
struct prediction {
    struct phases current;
    struct phases undisturbed_current; /* had what was demanded acted; for voltage laws */
    struct rotor rotor;
    struct sincos frame;     /* of the rotor */
    struct sincos half_turn; /* its rotation in half a period */
    const struct reference_sample *reference;
    num_t load_torque_change; /* over the period after it, as far as it is known */
};

/* What is regulated: the current in a frame, of the reference or of the rotor as it turns. */
struct current_demand {
    struct dq current;
    struct frame frame;
};

IN_PLACE bool prepare(struct drive *drive, const struct hal_samples *samples);
static bool step_outside(struct drive *drive, const struct hal_samples *samples);
IN_PLACE void move_reference(struct drive *drive);
static void turn_reference(struct drive *drive);
static void rest(struct drive *drive, const struct hal_samples *samples,
                 struct hal_outputs *outputs);
IN_PLACE void control_current(struct drive *drive, const struct hal_samples *samples,
                              struct hal_outputs *outputs);
IN_PLACE struct passage observe_sensorless(struct drive *drive, const struct sample_set *now,
                                           bool held);
IN_PLACE void predict(struct prediction *next, const struct drive *drive,
                      const struct estimate *estimate, struct passage passage);
IN_PLACE struct phases regulate_current(struct drive *drive, const struct prediction *next,
                                        bool held, bool torque, bool feed_forward);
IN_PLACE void hold_rotor(struct current_demand *demand, struct drive *drive,
                         const struct prediction *next);
IN_PLACE void move_rotor(struct current_demand *demand, struct drive *drive,
                         const struct prediction *next, bool torque, bool feed_forward);
IN_PLACE num_t current_of_law(struct drive *drive, const struct prediction *next,
                              bool feed_forward);
IN_PLACE struct position_law_input law_input(const struct prediction *next, bool feed_forward);
IN_PLACE void enter_or_leave_hold(struct drive *drive, bool held);
static void leave_or_lead_hold(struct drive *drive);
IN_PLACE bool hold_works(const struct drive *drive);
static void work_on_hold(struct drive *drive);
static void lead_rotor(struct drive *drive);
static void enter_hold(struct drive *drive);
static void stop_in_fault(struct drive *drive, enum drive_fault fault, struct hal_outputs *outputs);
static void watch_synchronism(struct drive *drive, struct hal_outputs *outputs);
static void act_on_synchronism(struct drive *drive, enum synchronism verdict,
                               struct hal_outputs *outputs);
static void control_general(struct drive *drive, const struct hal_samples *samples,
                            struct hal_outputs *outputs);
static struct passage observe(struct drive *drive, const struct sample_set *now);
IN_PLACE struct channels estimator_channels(struct drive *drive, struct channels measured);
static struct phases voltage_in_force(struct drive *drive);
static void control_with_all(struct drive *drive, const struct estimate *estimate,
                             struct passage passage, struct hal_outputs *outputs);
IN_PLACE bool torque_leads(const struct drive *drive);
static void present(struct prediction *next, const struct drive *drive,
                    const struct estimate *estimate, struct passage passage);
static void expect_current(struct drive *drive, const struct estimate *estimate,
                           struct prediction *next);
static struct phases current_under(const struct drive *drive, const struct estimate *estimate,
                                   struct phases voltage);
IN_PLACE void compensate_detent(struct drive *drive, const struct estimate *estimate,
                                struct prediction *next);
IN_PLACE bool has_time_to_learn(const struct drive *drive);
static struct phases regulate_voltage(struct drive *drive, const struct estimate *estimate,
                                      const struct prediction *next);
static void remember_demand(struct drive *drive, const struct estimate *estimate,
                            const struct prediction *next, struct sincos mid_period,
                            struct phases voltage);
static void act_at_once(struct drive *drive);
IN_PLACE void transfer(struct drive *drive, bool held);

void drive_control_cycle(struct drive *drive, const struct hal_samples *samples,
                         struct hal_outputs *outputs)
{
    if (RARE(!prepare(drive, samples))) {
        rest(drive, samples, outputs);
        return;
    }
    if (RARE(!protection_passes(&drive->params.protection, samples))) {
        state_machine_check_samples(drive, samples);
        rest(drive, samples, outputs);
        return;
    }
    drive->current_codes.a = samples->current_a; /* for the watches in the background */
    drive->current_codes.b = samples->current_b;
    if (RARE(drive->params.path.general)) {
        control_general(drive, samples, outputs);
    } else {
        control_current(drive, samples, outputs);
    }
    if (RARE(synchronism_is_due(drive))) {
        watch_synchronism(drive, outputs);
    }
}

/* Reference, states and commands; true: the control runs. */
IN_PLACE bool prepare(struct drive *drive, const struct hal_samples *samples)
{
    const uint32_t period = state_machine_begin_period(drive);

    if (RARE(drive->supervision.state != DRIVE_OPERATION_ENABLED)) {
        return step_outside(drive, samples);
    }
    move_reference(drive);
    return !RARE(command_queue_is_due(&drive->commands, period)) ||
           state_machine_obey(drive, samples);
}

/* Outside operation: whether the control runs all the same, in the first hold. Apart: rare. */
__attribute__((noinline)) static bool step_outside(struct drive *drive,
                                                   const struct hal_samples *samples)
{
    if (state_machine_powered(drive) && !reference_keeps_still(&drive->reference)) {
        turn_reference(drive);
    }
    return state_machine_step(drive, samples);
}

IN_PLACE void move_reference(struct drive *drive)
{
    if (RARE(!reference_step(&drive->reference, &drive->params.reference))) {
        turn_reference(drive);
    }
}

/* Where a phase or a stop begins; what has waited for the reference to rest is looked at in the
   next period. Apart: rare. */
__attribute__((noinline)) static void turn_reference(struct drive *drive)
{
    if (reference_turn(&drive->reference, &drive->params.reference, drive->hold.active)) {
        state_machine_claim_period(drive);
        if (!reference_busy(&drive->reference)) {
            command_queue_rest(&drive->commands, drive->supervision.period, 1u);
        }
    }
}

/* Nothing controls: the bus is shown in every state. Apart: rare. */
__attribute__((noinline)) static void rest(struct drive *drive, const struct hal_samples *samples,
                                           struct hal_outputs *outputs)
{
    if (drive->supervision.state == DRIVE_DETECTING_POSITION) {
        *outputs = position_detecting_cycle(drive, samples);
        return;
    }
    modulator_see_bus(&drive->modulator, measurement_bus(&drive->params.measurement, samples));
    *outputs = state_machine_resting_bridge(drive);
}

/* The path of the sensorless default: a current law or the hold. */
IN_PLACE void control_current(struct drive *drive, const struct hal_samples *samples,
                              struct hal_outputs *outputs)
{
    const struct sample_set now =
        measurement_step(&drive->measurement, &drive->params.measurement, samples);
    const bool held = drive->hold.active;
    const struct passage passage = observe_sensorless(drive, &now, held);
    const struct estimate *estimate = &drive->estimator.estimate;
    struct prediction next;

    if (RARE(!protection_trusts(&drive->params.protection, estimate))) {
        stop_in_fault(drive, DRIVE_FAULT_ESTIMATE_RANGE, outputs);
        return;
    }
    predict(&next, drive, estimate, passage);

    const struct phases voltage = regulate_current(drive, &next, held, false, true);

    modulate(drive, actuation_compensate(&drive->actuation, voltage), outputs);
    enter_or_leave_hold(drive, held);
}

/* The sensorless default: nothing is prepared, and it is the invariant EKF. */
IN_PLACE struct passage observe_sensorless(struct drive *drive, const struct sample_set *now,
                                           bool held)
{
    modulator_track_bus(&drive->modulator, now->bus);

    const struct phases surprise = actuation_observe(&drive->actuation, now->winding.voltage);
    const struct phases in_force = actuation_act(&drive->actuation);

    return invariant_ekf_step(&drive->estimator.invariant_ekf,
                              &drive->params.estimator.invariant_ekf, now->winding.current,
                              surprise, in_force, (struct rotor_hold){held, &drive->hold.frame});
}

/* At S(k+1), with the voltage already committed: what the estimator expects. */
IN_PLACE void predict(struct prediction *next, const struct drive *drive,
                      const struct estimate *estimate, struct passage passage)
{
    next->current = estimate->next.current;
    next->rotor.position = estimate->next.position;
    next->rotor.speed = estimate->next.speed;
    next->rotor.load_torque = estimate->rotor.load_torque;
    next->frame = estimate->next.frame;
    next->half_turn = passage.half_turn;
    next->reference = &drive->reference.next;
}

/* Hold, torque mode or current law, then current control. */
IN_PLACE struct phases regulate_current(struct drive *drive, const struct prediction *next,
                                        bool held, bool torque, bool feed_forward)
{
    struct current_demand demand;

    if (RARE(held)) {
        hold_rotor(&demand, drive, next);
    } else {
        move_rotor(&demand, drive, next, torque, feed_forward);
    }
    drive->current_reference = demand.current;
    drive->current = park(next->current, demand.frame.begin);
    drive->voltage_command = current_control_step(
        &drive->current_control, &drive->params.current_control, demand.current, drive->current,
        (struct rotation){demand.frame.speed, next->rotor.speed},
        modulator_voltage_limit(&drive->modulator, &drive->params.modulator));
    return inverse_park(drive->voltage_command, demand.frame.middle);
}

IN_PLACE void hold_rotor(struct current_demand *demand, struct drive *drive,
                         const struct prediction *next)
{
    const struct standstill_hold_params *params = &drive->params.hold;

    demand->current.d = standstill_hold_current(&drive->hold, params);
    demand->current.q = standstill_hold_torque_current(
        params, next->rotor.speed - drive->hold.speed,
        drive->supervision.aligns ? NUM(0.0) : next->rotor.load_torque);
    demand->frame = (struct frame){drive->hold.frame, drive->hold.frame, drive->hold.speed};
}

IN_PLACE void move_rotor(struct current_demand *demand, struct drive *drive,
                         const struct prediction *next, bool torque, bool feed_forward)
{
    const struct drive_params *params = &drive->params;

    demand->current.d = standstill_hold_motion_current(&drive->hold, &params->hold);
    demand->current.q =
        RARE(torque) ? torque_mode_lead(drive) : current_of_law(drive, next, feed_forward);
    demand->frame.begin = next->frame;
    demand->frame.middle = sincos_add(next->frame, next->half_turn);
    demand->frame.speed = next->rotor.speed;
}

IN_PLACE num_t current_of_law(struct drive *drive, const struct prediction *next, bool feed_forward)
{
    const struct drive_params *params = &drive->params;
    const struct position_law_input input = law_input(next, feed_forward);

    return position_law_current(params->position_law, &drive->law, &params->law, &input);
}

IN_PLACE struct position_law_input law_input(const struct prediction *next, bool feed_forward)
{
    const struct reference_sample *reference = next->reference;

    return (struct position_law_input){
        .position_error = position_difference(reference->position, next->rotor.position),
        .reference_speed = feed_forward ? reference->speed : NUM(0.0),
        .reference_acceleration = feed_forward ? reference->acceleration : NUM(0.0),
        .speed = next->rotor.speed,
        .load_torque = next->rotor.load_torque,
    };
}

/* The hold begins or ends with the period that follows. */
IN_PLACE void enter_or_leave_hold(struct drive *drive, bool held)
{
    if (RARE(held)) {
        if (!reference_is_at_rest(&drive->reference) || drive->hold.leads) {
            leave_or_lead_hold(drive);
        } else if (hold_works(drive)) {
            work_on_hold(drive);
        }
    } else if (standstill_hold_waits(&drive->params.hold, drive->reference.slow_periods)) {
        enter_hold(drive);
    }
}

/* The hold ends where the reference moves, but takes its frame along with one that creeps, until
   that has come to rest. */
static void leave_or_lead_hold(struct drive *drive)
{
    standstill_hold_leave(&drive->hold, drive->reference.slow_periods,
                          drive->reference.next.moving);
    if (drive->hold.active && drive->hold.leads && hold_works(drive)) {
        work_on_hold(drive);
    }
}

/* Whether a hold may do its slow work. */
IN_PLACE bool hold_works(const struct drive *drive)
{
    return RARE(standstill_hold_works_in(drive->supervision.period -
                                         drive->supervision.state_since)) &&
           !state_machine_period_is_claimed(drive);
}

/* That. Apart: rare. */
__attribute__((noinline)) static void work_on_hold(struct drive *drive)
{
    state_machine_claim_period(drive);
    estimator_work_on_hold(&drive->estimator, &drive->params.estimator, drive->hold.leads);
    if (drive->hold.leads) {
        lead_rotor(drive);
    }
}

/* To the middle of the periods in which the frame acts, S(k+2)...S(k+6). */
static void lead_rotor(struct drive *drive)
{
    const struct reference_sample *reference = &drive->reference.next;
    const int32_t offset = drive->hold.offset;
    const int32_t half_turn =
        angle_from_turns(half_period_turns(&drive->params.model, reference->speed));

    standstill_hold_follow(&drive->hold,
                           reference->position.fraction + 6u * (angle_t)half_turn + (angle_t)offset,
                           reference->speed, reference->moving || offset != 0);
}

/* Enters the hold, if the rotor has come near its reference. Apart: rare. */
__attribute__((noinline)) static void enter_hold(struct drive *drive)
{
    const struct outlook *rotor = &drive->estimator.estimate.next;
    const struct position reference = drive->reference.next.position;

    standstill_hold_consider(&drive->hold, &drive->params.hold, reference.fraction,
                             position_difference(reference, rotor->position), rotor->speed);
    if (drive->hold.active) {
        state_machine_claim_period(drive);
        estimator_begin_hold(&drive->estimator, &drive->params.estimator);
        standstill_hold_leave(&drive->hold, drive->reference.slow_periods,
                              drive->reference.next.moving);
    }
}

/* Opens the bridge. Apart: rare. */
__attribute__((noinline)) static void stop_in_fault(struct drive *drive, enum drive_fault fault,
                                                    struct hal_outputs *outputs)
{
    state_machine_fault(drive, fault);
    *outputs = (struct hal_outputs){.bridge_on = false};
}

/* Last of all, as nothing is kept for it: a step of the monitor. Apart: its switch would be a table
   of addresses in the interrupt's body. */
__attribute__((noinline)) static void watch_synchronism(struct drive *drive,
                                                        struct hal_outputs *outputs)
{
    const enum synchronism verdict = synchronism_step(drive);

    if (RARE(verdict != SYNCHRONISM_SURE)) {
        act_on_synchronism(drive, verdict, outputs);
    }
}

/* Apart: rare. */
__attribute__((noinline)) static void
act_on_synchronism(struct drive *drive, enum synchronism verdict, struct hal_outputs *outputs)
{
    const enum drive_fault fault = synchronism_act(drive, verdict);

    if (fault != DRIVE_FAULT_NONE) {
        stop_in_fault(drive, fault, outputs);
    }
}

/*
 * The path of voltage laws, of encoders, of the detent compensation and of what only a simulation
 * has: no delay, no loss compensation. Kept out of the interrupt's body, so that the registers and
 * the stack of the heaviest law cost the default path nothing.
 */
__attribute__((noinline)) static void
control_general(struct drive *drive, const struct hal_samples *samples, struct hal_outputs *outputs)
{
    const struct sample_set now =
        measurement_step(&drive->measurement, &drive->params.measurement, samples);
    const struct passage passage = observe(drive, &now);
    const struct estimate *estimate = &drive->estimator.estimate;

    if (!protection_trusts(&drive->params.protection, estimate)) {
        stop_in_fault(drive, DRIVE_FAULT_ESTIMATE_RANGE, outputs);
        return;
    }
    control_with_all(drive, estimate, passage, outputs);
}

static struct passage observe(struct drive *drive, const struct sample_set *now)
{
    modulator_track_bus(&drive->modulator, now->bus);

    const struct channels winding = estimator_channels(drive, now->winding);
    const struct phases surprise = actuation_observe(&drive->actuation, winding.voltage);
    const struct estimator_input input = {
        .winding = winding,
        .surprise = surprise,
        .in_force = voltage_in_force(drive),
        .encoder_count = now->encoder_count,
        .hold = {.active = drive->hold.active, .frame = &drive->hold.frame},
    };

    return estimator_observe(&drive->estimator, &drive->params.estimator, &input);
}

/* What the estimator gets instead of what is measured. */
IN_PLACE struct channels estimator_channels(struct drive *drive, struct channels measured)
{
    if (RARE(drive->params.path.prepares_input)) {
        struct channels prepared = measured;

        prepared_input_make(drive, &prepared);
        return prepared;
    }
    return measured;
}

/* The voltage in force until S(k+1): as was found before a pulse, where one holds. */
static struct phases voltage_in_force(struct drive *drive)
{
    if (drive->params.path.standstill_pulses) {
        standstill_angle_begin(drive);
    }
    return actuation_act(&drive->actuation);
}

/* A law or the hold, with all that only some drives have. */
static void control_with_all(struct drive *drive, const struct estimate *estimate,
                             struct passage passage, struct hal_outputs *outputs)
{
    const struct drive_params *params = &drive->params;
    const bool held = drive->hold.active;
    const bool torque = torque_leads(drive);
    struct dq integral = {NUM(0.0), NUM(0.0)}; /* before this period; for pulses alone */
    struct prediction next;
    struct phases voltage;

    if (has_zero_delay(&params->path)) {
        present(&next, drive, estimate, passage);
    } else {
        predict(&next, drive, estimate, passage);
    }
    expect_current(drive, estimate, &next);
    if (ESTIMATORS_READ_ENCODER && params->path.detent_learning && !drive->supervision.aligns) {
        compensate_detent(drive, estimate, &next);
    }
    if (RARE(params->path.standstill_pulses)) {
        integral = drive->current_control.integral;
    }
    voltage = !held && !torque && position_law_gives_voltage(params->position_law)
                  ? regulate_voltage(drive, estimate, &next)
                  : regulate_current(drive, &next, held, torque, params->path.feed_forward);
    if (RARE(params->path.standstill_pulses)) {
        if (held) {
            voltage = standstill_angle_step(drive, estimate, integral, voltage);
        } else {
            standstill_angle_rest(drive);
        }
    }
    remember_demand(drive, estimate, &next, passage.mid_period, voltage);
    modulate(drive,
             params->path.bridge_loss_compensation
                 ? actuation_compensate(&drive->actuation, voltage)
                 : voltage,
             outputs);
    if (has_zero_delay(&params->path)) {
        act_at_once(drive);
    }
    transfer(drive, held);
}

/* Whether torque is commanded. */
IN_PLACE bool torque_leads(const struct drive *drive)
{
    return ESTIMATORS_READ_ENCODER && RARE(num_bits(drive->torque.speed) != 0u);
}

/* At S(k): without a delay nothing need be predicted. */
static void present(struct prediction *next, const struct drive *drive,
                    const struct estimate *estimate, struct passage passage)
{
    next->current = estimate->current;
    next->rotor = estimate->rotor;
    next->frame = sincos_of(estimate->rotor.position.fraction);
    next->half_turn = passage.half_turn;
    next->reference = &drive->reference.now;
}

/*
 * What would come of the demanded voltage alone, for the laws that observe what disturbs it: at
 * S(k) the current of the coming one if there is a delay, else the present one, which is measured.
 */
static void expect_current(struct drive *drive, const struct estimate *estimate,
                           struct prediction *next)
{
    next->load_torque_change = NUM(0.0);
    next->undisturbed_current =
        has_zero_delay(&drive->params.path)
            ? estimate->current
            : current_under(drive, estimate, drive->expectation.demanded_voltage);
}

/* Of the coming S(k), had this voltage acted since the present one. */
static struct phases current_under(const struct drive *drive, const struct estimate *estimate,
                                   struct phases voltage)
{
    const struct phases expected = drive->actuation.in_force;
    const struct phases more = {voltage.a - expected.a, voltage.b - expected.b};

    return forced_current(&estimate->winding, estimate->next.current, more);
}

/* The detent torque at the instant of action, learned from what the encoder's observer has left of
   it: drive_settings_check() grants it to no other. */
IN_PLACE void compensate_detent(struct drive *drive, const struct estimate *estimate,
                                struct prediction *next)
{
    const num_t before = drive->detent.torque;

    detent_compensation_step(&drive->detent, &drive->params.detent, next->rotor.position.fraction,
                             next->frame, next->rotor.speed, estimate->rotor.load_torque,
                             has_time_to_learn(drive));
    encoder_observer_set_known_torque(&drive->estimator.encoder_observer,
                                      &drive->params.estimator.encoder_observer,
                                      drive->detent.torque);
    next->load_torque_change = drive->detent.torque - before;
    next->rotor.load_torque = estimate->rotor.load_torque + drive->detent.torque;
}

/* No period has in which a motion begins or ends, or a segment of a plan: all of them claim it. */
IN_PLACE bool has_time_to_learn(const struct drive *drive)
{
    const struct reference *reference = &drive->reference;

    return !RARE(state_machine_period_is_claimed(drive)) ||
           (reference->now.moving == reference->next.moving && !reference_is_planned(reference));
}

/* A voltage law. */
static struct phases regulate_voltage(struct drive *drive, const struct estimate *estimate,
                                      const struct prediction *next)
{
    const struct drive_params *params = &drive->params;
    const struct voltage_law_input input = {
        .motion = law_input(next, params->path.feed_forward),
        .current = park(next->current, next->frame),
        .undisturbed_current = park(next->undisturbed_current, next->frame),
        .innovation = expectation_innovation(&drive->expectation, estimate->current),
        .current_d_reference = standstill_hold_motion_current(&drive->hold, &params->hold),
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

    drive->current = input.current;
    drive->current_reference = (struct dq){input.current_d_reference, demand.torque_current};
    drive->voltage_command = demand.voltage;
    return inverse_park(demand.voltage, sincos_add(next->frame, next->half_turn));
}

/* What this period's voltage should give, for the next expect_current(). */
static void remember_demand(struct drive *drive, const struct estimate *estimate,
                            const struct prediction *next, struct sincos mid_period,
                            struct phases voltage)
{
    struct phases expected = next->undisturbed_current;

    if (has_zero_delay(&drive->params.path)) {
        expected = current_under(drive, estimate, voltage);
    }
    expectation_set(&drive->expectation, voltage, expected, mid_period);
}

/* Without a delay the command is in force at once, and the estimator did not know of it. */
static void act_at_once(struct drive *drive)
{
    estimator_predict(&drive->estimator, &drive->params.estimator, &drive->params.model,
                      actuation_act(&drive->actuation));
}

/* The hold begins or ends, bumpless: of a voltage law that begins nothing of the past is left. */
IN_PLACE void transfer(struct drive *drive, bool held)
{
    enter_or_leave_hold(drive, held);
    if (RARE(drive->hold.active != held)) {
        if (!held) {
            drive_preset_current_control(drive);
        } else if (position_law_gives_voltage(drive->params.position_law)) {
            position_law_reset(&drive->law);
        }
    }
}
