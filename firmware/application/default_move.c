#include "firmware/application/default_move.h"

#include "firmware/design/elementary.h"
static const double periods_max = 1073741824.0; /* 2^30, the longest move */
static const double ramp_min_s = 10e-3;

/* Down to a whole number of periods, 0...2^30; NaN to 0. */
static double down(double x)
{
    return x > 0.0 ? (double)(uint32_t)smaller(x, periods_max) : 0.0;
}

/* Up to one. */
static double up(double x)
{
    const double below = down(x);

    return below < x ? below + 1.0 : below;
}

/* Newton's iteration from above, until it no longer falls. */
static double root_of(double x)
{
    double root = larger(x, 1.0);

    for (;;) {
        const double next = 0.5 * (root + x / root);

        if (!(next < root)) {
            return root;
        }
        root = next;
    }
}

void default_move_times(struct drive_command *command, const struct default_move_task *task)
{
    const struct drive_settings *settings = task->settings;
    const struct motor_params *motor = &settings->motor;
    const double T = task->period_s;
    const double distance = magnitude(task->distance_rad);
    const double speed =
        0.25 * smaller(motor->supply_V / motor->torque_constant_Nm_A, settings->speed_limit_rad_s);
    const double acceleration = 0.25 * settings->current_limit_A * motor->torque_constant_Nm_A /
                                motor->inertia_kgm2; /* mean of a ramp, 3/4 of its peak */
    double ramp = down(command->ramp_s / T + 0.5);

    if (!task->ramp_given) {
        ramp = task->duration_given
                   ? 0.25 * command->duration_s / T
                   : larger(smaller(speed / acceleration, root_of(distance / acceleration)),
                            ramp_min_s) /
                         T;
        ramp = up(ramp);
        command->ramp_s = ramp * T;
    }
    if (!task->duration_given) {
        command->duration_s = up(larger(distance / speed / T + ramp, 2.0 * ramp)) * T;
    }
    if (!task->jerk_given) {
        command->jerk_s = larger(down(0.25 * ramp), 1.0) * T;
    }
}
