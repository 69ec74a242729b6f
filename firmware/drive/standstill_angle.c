#include "firmware/drive/standstill_angle.h"

/* Offset of the measured voltage, of which the steady-state EKF knows nothing. */
static struct phases estimated_bias(const struct drive *drive)
{
    return estimator_is(&drive->params.estimator, ESTIMATOR_INVARIANT_EKF)
               ? drive->estimator.invariant_ekf.bias
               : (struct phases){NUM(0.0), NUM(0.0)};
}

/*
 * Half of the way each time: 1.5 degrees of noise in a measurement leave 0.9, and a load is known
 * in some five of them, 0.15 s. The load is the torque that holds the rotor there: with any other
 * the estimator's model would turn away from the angle that is preset. The estimator corrects its
 * voltage offset across the rotor's frame, which moves with what is preset: without a hold on what
 * this adds along the current, offset and resistance would drift away together.
 */
static void preset_estimator(struct drive *drive, const struct standstill_angle *shown)
{
    const struct estimate *x = &drive->estimator.estimate;
    const int32_t difference = (int32_t)(shown->angle - x->rotor.position.fraction);
    struct rotor rotor = x->rotor;

    rotor.position = position_add(rotor.position, difference / 2);
    rotor.speed = NUM(0.0);
    rotor.load_torque = park(shown->current, sincos_of(rotor.position.fraction)).q;
    estimator_preset_rotor(&drive->estimator, &drive->params.estimator, &rotor);
    if (estimator_is(&drive->params.estimator, ESTIMATOR_INVARIANT_EKF)) {
        invariant_ekf_preset_bias_along(&drive->estimator.invariant_ekf,
                                        drive->standstill.bias_of_motion, drive->hold.frame);
    }
    estimator_predict(&drive->estimator, &drive->params.estimator, &drive->params.model,
                      drive->actuation.in_force);
}

/* Of this S(k), had this voltage acted since S(k-1). Apart: compiled once. */
__attribute__((noinline)) static struct phases expected_current(const struct drive *drive,
                                                                struct phases voltage)
{
    const struct estimate *x = &drive->estimator.estimate;
    const struct phases in_force = drive->actuation.in_force;
    const struct phases more = {voltage.a - in_force.a, voltage.b - in_force.b};

    return forced_current(&x->winding, x->next.current, more);
}

void standstill_angle_blank_sample(struct drive *drive, struct channels *winding)
{
    const num_t resistance = drive->estimator.estimate.winding.resistance;
    const struct phases expected = expected_current(drive, winding->voltage);

    standstill_pulses_sample(&drive->standstill.pulses, &drive->standstill.params, winding->current,
                             expected);
    winding->voltage.a -= num_mul(resistance, winding->current.a - expected.a);
    winding->voltage.b -= num_mul(resistance, winding->current.b - expected.b);
    winding->current = expected_current(drive, winding->voltage);
}

void standstill_angle_begin(struct drive *drive)
{
    if (standstill_pulses_blanks_sample(&drive->standstill.pulses, &drive->standstill.params)) {
        actuation_preset_loss(&drive->actuation, drive->standstill.loss_before_pulse);
    } else {
        drive->standstill.loss_before_pulse = drive->actuation.loss;
    }
}

void standstill_angle_rest(struct drive *drive)
{
    standstill_pulses_stop(&drive->standstill.pulses);
    drive->standstill.bias_of_motion = estimated_bias(drive);
}

struct phases standstill_angle_step(struct drive *drive, const struct estimate *estimate,
                                    struct dq integral, struct phases voltage)
{
    struct standstill_pulses *pulses = &drive->standstill.pulses;
    struct standstill_angle shown;

    if (drive->supervision.state != DRIVE_OPERATION_ENABLED || pulses->signal == NUM(0.0)) {
        standstill_angle_rest(drive);
        return voltage;
    }
    if (standstill_pulses_add(pulses, &drive->standstill.params, estimate->current,
                              drive->actuation.loss, &voltage)) {
        current_control_preset(&drive->current_control, integral);
    }
    if (standstill_pulses_result(pulses, &drive->standstill.params, &shown)) {
        preset_estimator(drive, &shown);
    }
    return voltage;
}
