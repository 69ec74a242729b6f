#include "firmware/drive/torque_constant.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"

#define WINDOW_PERIODS 128u
#define BACK_EMF_MIN   NUM(0.125) /* of the supply */
#define SHARE          0.25       /* of its way to what a window shows */
#define CHANGE_MAX     0.2
#define CHANGE_MIN     0.03

static void put_in_force(struct drive *drive, double change)
{
    const double period_s = drive->board->facts->control_period_s;
    struct motor_params motor = drive->settings.motor;
    struct drive_params *params = &drive->params;

    motor.torque_constant_Nm_A *= 1.0 + change;
    drive->base = per_unit_base(&motor, period_s);
    drive->torque_constant.in_force = change;

    const struct reference_params reference =
        reference_design(&drive->base, period_s, (struct creep_limits){0.0, 0.0});

    /* An interrupt in between has some of both, for a period. */
    params->model = motor_model_design(&motor, &drive->base, period_s,
                                       drive->board->facts->bridge_resistance_ohm);
    params->estimator.invariant_ekf.model = params->model;
    params->current_control.reactance = coef_from_double(per_unit_reactance(&drive->base, &motor));
    params->reference.speed = reference.speed;
    params->reference.speed_remainder = reference.speed_remainder;
    params->reference.acceleration = reference.acceleration;
    params->reference.jerk = reference.jerk;
}

static void begin(struct torque_constant *constant, struct position at, uint32_t period)
{
    constant->from = at;
    constant->begun = period;
    constant->travel = 0;
}

static void learn(struct drive *drive, struct position at)
{
    struct torque_constant *constant = &drive->torque_constant;
    const double turned = (double)position_distance(constant->from, at);
    const double shown = (double)constant->travel / turned * (1.0 + constant->in_force) - 1.0;
    const double learned = num_to_double(constant->change);
    const double change = learned + SHARE * (shown - learned);
    const double within = change > CHANGE_MAX    ? CHANGE_MAX
                          : change < -CHANGE_MAX ? -CHANGE_MAX
                                                 : change;
    const double off = within - constant->in_force;

    constant->change = num_from_double(within);
    if (off > CHANGE_MIN || off < -CHANGE_MIN) {
        put_in_force(drive, within);
    }
}

void torque_constant_background(struct drive *drive)
{
    struct torque_constant *constant = &drive->torque_constant;
    const uint32_t period = interrupt_view_period(drive);

    if (!LEARNS_TORQUE_CONSTANT ||
        !estimator_is(&drive->params.estimator, ESTIMATOR_INVARIANT_EKF) ||
        interrupt_view_state(drive) != DRIVE_OPERATION_ENABLED || period == constant->looked) {
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    const struct rotor rotor = drive->estimator.estimate.rotor;

    atomic_signal_fence(memory_order_seq_cst);
    if (period != interrupt_view_period(drive)) {
        return;
    }
    if (num_abs(rotor.speed) < BACK_EMF_MIN) {
        begin(constant, rotor.position, period);
    } else {
        const num_t turns = num_mul_coef(rotor.speed, drive->params.model.turns_per_speed);

        constant->travel += (int64_t)angle_from_turns(turns) * (int32_t)(period - constant->looked);
        if (period - constant->begun >= WINDOW_PERIODS) {
            learn(drive, rotor.position);
            begin(constant, rotor.position, period);
        }
    }
    constant->looked = period;
}
