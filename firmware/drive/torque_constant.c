#include "firmware/drive/torque_constant.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/inductance.h"
#include "firmware/drive/interrupt_view.h"

#define WINDOW_S     12.8e-3
#define BACK_EMF_MIN NUM(0.03125) /* of the supply */
#define SHARE        0.25         /* of its way to what a window shows */
#define CHANGE_MIN   NUM(0.03)

/* Of what the interrupt reads, what goes by the torque constant. */
static void renew(struct drive_params *params, const struct motor_model_params *model,
                  coef_t reactance, const struct reference_params *reference)
{
    params->model = *model;
    params->estimator.invariant_ekf.model = *model;
    params->current_control.reactance = reactance;
    current_control_params_fit_coefficients(&params->current_control);
    params->reference.speed = reference->speed;
    params->reference.speed_remainder = reference->speed_remainder;
    params->reference.acceleration = reference->acceleration;
    params->reference.jerk = reference->jerk;
}

static void put_in_force(struct drive *drive, num_t change)
{
    const struct hal_facts *facts = drive->board->facts;
    const double period_s = facts->control_period_s;
    struct motor_params motor = drive->settings.motor;

    motor.torque_constant_Nm_A *= 1.0 + num_to_double(change);
    motor.inductance_H = inductance_in_force_H(drive);
    drive->base = per_unit_base(&motor, period_s);
    drive->torque_constant.in_force = change;

    const struct motor_model_params model =
        motor_model_design(&motor, &drive->base, period_s, facts->bridge_resistance_ohm);
    const struct reference_params reference =
        reference_design(&drive->base, period_s, (struct creep_limits){0.0, 0.0});
    const coef_t reactance = current_control_reactance(&motor, &drive->base);

    hal_defer_interrupts(drive->board, true);
    renew(&drive->params, &model, reactance, &reference);
    hal_defer_interrupts(drive->board, false);
}

void torque_constant_put(struct drive *drive, num_t change)
{
    const num_t off = change - drive->torque_constant.in_force;

    drive->torque_constant.change = change;
    if (num_abs(off) > CHANGE_MIN &&
        estimator_is(&drive->params.estimator, ESTIMATOR_INVARIANT_EKF)) {
        put_in_force(drive, change);
    }
}

static void begin(struct torque_constant *constant, struct position at, uint32_t period)
{
    constant->from = at;
    constant->begun = period;
    constant->travel = 0;
}

static void learn(struct drive *drive, struct position at)
{
    const struct torque_constant *constant = &drive->torque_constant;
    const double turned = (double)position_distance(constant->from, at);
    const double shown =
        (double)constant->travel / turned * (1.0 + num_to_double(constant->in_force)) - 1.0;
    const double learned = num_to_double(constant->change);
    const double change = learned + SHARE * (shown - learned);
    const double within = change > TORQUE_CONSTANT_CHANGE_MAX    ? TORQUE_CONSTANT_CHANGE_MAX
                          : change < -TORQUE_CONSTANT_CHANGE_MAX ? -TORQUE_CONSTANT_CHANGE_MAX
                                                                 : change;

    torque_constant_put(drive, num_from_double(within));
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
        if (period - constant->begun >= drive_periods_in(drive, (num_real)WINDOW_S)) {
            learn(drive, rotor.position);
            begin(constant, rotor.position, period);
        }
    }
    constant->looked = period;
}
