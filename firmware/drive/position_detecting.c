#include "firmware/drive/position_detecting.h"

#include "firmware/drive/modulate.h"
#include "firmware/drive/prepared_input.h"
#include "firmware/drive/state_machine.h"

static struct hal_outputs act(struct drive *drive, struct initial_position_output output)
{
    if (!output.bridge_on) {
        actuation_reset(&drive->actuation);
        return (struct hal_outputs){.bridge_on = false};
    }
    struct hal_outputs duties;

    modulate(drive,
             output.compensated ? actuation_compensate(&drive->actuation, output.voltage)
                                : output.voltage,
             &duties);
    if (has_zero_delay(&drive->params.path)) {
        (void)actuation_act(&drive->actuation);
    }
    return duties;
}

/* After an alignment its current flows on, now in the d axis of the hold. */
static void go_on(struct drive *drive, const struct sample_set *now)
{
    const struct initial_position *detection = &drive->enabling.detection;

    state_machine_position_found(drive, detection->angle);
    standstill_pulses_reset(
        &drive->standstill.pulses, &drive->standstill.params,
        detection->by_impulses
            ? initial_position_full_asymmetry(detection, &drive->enabling.detection_params)
            : NUM(0.0));
    if (!detection->by_impulses) {
        standstill_hold_preset(&drive->hold, detection->current_reference);
        current_control_preset(&drive->current_control, (struct dq){detection->voltage, NUM(0.0)});
        estimator_preset_current(&drive->estimator, &drive->params.estimator, now->winding.current);
        estimator_predict(&drive->estimator, &drive->params.estimator, &drive->params.model,
                          drive->actuation.in_force);
    }
}

/* Measures on its own: a sample set that is passed in would cost the default path registers. */
__attribute__((noinline)) struct hal_outputs
position_detecting_cycle(struct drive *drive, const struct hal_samples *samples)
{
    const struct sample_set set =
        measurement_step(&drive->measurement, &drive->params.measurement, samples);
    const struct sample_set *now = &set;

    modulator_track_bus(&drive->modulator, now->bus);

    const struct phases voltage = drive->params.path.infers_voltage
                                      ? prepared_input_voltage(drive, now->winding.current)
                                      : now->winding.voltage;

    (void)actuation_observe(&drive->actuation, voltage);
    (void)actuation_act(&drive->actuation);

    const struct initial_position_output output =
        initial_position_step(&drive->enabling.detection, &drive->enabling.detection_params,
                              now->winding.current, voltage);
    const struct hal_outputs duties = act(drive, output);

    if (drive->enabling.detection.stage == INITIAL_POSITION_FOUND) {
        go_on(drive, now);
    } else if (drive->enabling.detection.stage == INITIAL_POSITION_NOT_FOUND) {
        state_machine_fault(drive, DRIVE_FAULT_POSITION_NOT_FOUND);
        return (struct hal_outputs){.bridge_on = false};
    }
    return duties;
}
