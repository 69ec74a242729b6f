#include "firmware/drive/block_reset.h"

#include "firmware/drive/synchronism.h"

void drive_reset_control(struct drive *drive)
{
    standstill_hold_reset(&drive->hold, &drive->params.hold);
    position_law_reset(&drive->law);
    detent_compensation_reset(&drive->detent);
    current_control_reset(&drive->current_control);
    torque_mode_leave(&drive->torque);
    synchronism_reset(drive);
    expectation_reset(&drive->expectation);
}

void drive_preset_current_control(struct drive *drive)
{
    const num_t resistance = drive->estimator.estimate.winding.resistance;
    const struct dq drop = {num_mul(resistance, drive->current.d),
                            num_mul(resistance, drive->current.q)};

    current_control_preset(&drive->current_control, drop);
}

void drive_reset_motion(struct drive *drive)
{
    const struct drive_params *params = &drive->params;
    const bool encoder = estimator_has_encoder(&params->estimator);
    const struct position kept = drive->reference.next.position;
    const struct estimator_start start = {
        .position = encoder ? axis_position(drive, params->enabling.encoder_zero_assumed) : kept,
        .encoder_position = encoder ? axis_position(drive, params->enabling.encoder_zero) : kept,
        .load_torque = params->enabling.initial_load_torque,
        .resistance = drive->estimator.estimate.winding.resistance,
        .unloaded_periods =
            params->enabling.hold_on_enable_periods + params->enabling.balance_periods,
        .encoder_count = drive->encoder_count,
    };

    estimator_begin(&drive->estimator, &params->estimator, &start);
    reference_reset(&drive->reference, start.position);
}
