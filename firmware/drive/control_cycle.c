/*
 * The control interrupt, read as the block diagram of the drive:
 *
 *   samples -> per-unit -> estimator -> reference -> position law or hold -> current control,
 *   decoupling, voltage limit -> loss compensation, modulator -> duties, watched by the protection
 *
 * What is computed from S(k) acts from S(k+1) on. So currents and rotor are predicted to S(k+1)
 * with the voltage already committed, and compared with the reference of S(k+1).
 */
#include "firmware/control/position_law_dispatch.h"
#include "firmware/drive/drive.h"
#include "firmware/drive/state_machine.h"

static const struct hal_outputs bridge_off = {.bridge_on = false};

/* The motor at S(k+1) as known at S(k). */
struct prediction {
    struct phases current;
    struct rotor rotor;
};

static struct prediction predict(const struct drive *drive, const struct estimate *estimate)
{
    const struct motor_model_params *model = &drive->params.model;
    struct prediction next;

    next.rotor = estimate->rotor;
    next.current = forced_current(&estimate->winding, estimate->free_current,
                                  actuation_in_force(&drive->actuation));
    predict_rotor(model, &next.rotor, park(next.current, estimate->mid_period).q);
    return next;
}

static struct dq wanted_current(struct drive *drive, const struct rotor *rotor)
{
    const struct drive_params *params = &drive->params;
    const struct reference_sample *reference = &drive->reference.next;
    struct dq current;

    current.d = standstill_hold_step(&drive->hold, &params->hold);
    if (drive->hold.active) {
        current.q = standstill_hold_torque_current(&params->hold, rotor->speed, rotor->load_torque);
    } else {
        const struct position_law_input input = {
            .position_error = position_difference(reference->position, rotor->position),
            .reference_speed = params->feed_forward ? reference->speed : NUM(0.0),
            .reference_acceleration = params->feed_forward ? reference->acceleration : NUM(0.0),
            .speed = rotor->speed,
            .load_torque = rotor->load_torque,
        };

        current.q = position_law_step(params->position_law, &drive->law, &params->law, &input);
        standstill_hold_consider(&drive->hold, &params->hold, reference->position.fraction,
                                 drive->reference.rest_periods, input.position_error, rotor->speed);
    }
    return current;
}

/* The hold fixes the current frame to the reference; in motion it turns with the rotor. */
static struct sincos control_frame(const struct drive *drive, const struct estimate *estimate)
{
    return drive->hold.active ? drive->hold.frame : estimate_end_of_period(estimate);
}

/* The voltage turns back to phases at the angle of the middle of S(k+1)...S(k+2). */
static struct phases regulate_current(struct drive *drive, const struct estimate *estimate,
                                      const struct prediction *next)
{
    const struct sincos frame = control_frame(drive, estimate);

    drive->current = park(next->current, frame);
    drive->voltage_command = current_control_step(
        &drive->current_control, &drive->params.current_control, drive->current_reference,
        drive->current, next->rotor.speed, modulator_voltage_limit(&drive->modulator));
    return inverse_park(drive->voltage_command, sincos_add(frame, estimate->half_turn));
}

static struct hal_outputs modulate(struct drive *drive, struct phases voltage)
{
    const struct phases command = actuation_compensate(&drive->actuation, voltage);
    const struct modulation out =
        modulator_step(&drive->modulator, &drive->params.modulator, command);
    const struct hal_outputs duties = {
        .high_counts = {out.a.plus, out.a.minus, out.b.plus, out.b.minus},
        .bridge_on = true,
    };

    actuation_commit(&drive->actuation, out.voltage);
    return duties;
}

static struct hal_outputs control(struct drive *drive, const struct estimate *estimate)
{
    struct hal_outputs duties;
    struct prediction next;

    reference_step(&drive->reference, &drive->params.reference);
    next = predict(drive, estimate);
    drive->current_reference = wanted_current(drive, &next.rotor);
    duties = modulate(drive, regulate_current(drive, estimate, &next));
    standstill_hold_leave(&drive->hold, drive->reference.rest_periods);
    return duties;
}

static const struct estimate *observe(struct drive *drive, const struct sample_set *now)
{
    modulator_track_bus(&drive->modulator, now->bus);
    actuation_observe(&drive->actuation, now->voltage);
    return estimator_step(&drive->estimator, &drive->params.estimator, now->current, now->voltage,
                          drive->hold.active);
}

/* The bridge is on and stays on for this period: what it needs of estimate and duties. */
static struct hal_outputs powered_cycle(struct drive *drive, const struct sample_set *now)
{
    const struct estimate *estimate = observe(drive, now);
    const enum drive_fault fault = protection_check_estimate(&drive->params.protection, estimate);

    if (fault != DRIVE_FAULT_NONE) {
        state_machine_fault(drive, fault);
        return bridge_off;
    }
    return control(drive, estimate);
}

struct hal_outputs drive_control_cycle(struct drive *drive, const struct hal_samples *samples)
{
    const struct sample_set now =
        measurement_step(&drive->measurement, &drive->params.measurement, samples);

    drive->bus = now.bus;
    drive->period++;
    return state_machine_step(drive, samples) ? powered_cycle(drive, &now) : bridge_off;
}
