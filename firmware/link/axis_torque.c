#include "firmware/link/axis_torque.h"

#include "firmware/application/application.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/link.h"

/* Of the drive's limit: what the drive takes as the largest speed at least, and some more. */
static const float speed_share_min = 2e-3f;

/* A limit that is rounded up the drive would refuse. */
static const float just_below = 0.999999f;

bool axis_torque_is_carried(const struct application *application)
{
    return ESTIMATORS_READ_ENCODER &&
           application->drive.settings.feedback == DRIVE_FEEDBACK_ENCODER;
}

/* Thousandths of the rated torque in N m, cut at the current limit. */
static float target_Nm(struct application *application)
{
    const struct drive_settings *settings = &application->drive.settings;
    const float constant = (float)settings->motor.torque_constant_Nm_A;
    const float most = just_below * constant * (float)settings->current_limit_A;
    const float rated = constant * (float)settings->motor.rated_current_A;

    return axis_motion_limited(
        application, 1e-3f * rated * (float)application->link->objects.target_torque, -most, most);
}

static float most_rad_s(const struct application *application)
{
    const float asked = AXIS_RAD_S_PER_RPM * (float)application->link->objects.max_speed_rpm;
    const float limit = axis_motion_speed_limit(application);
    const float least = speed_share_min * limit;

    return asked > limit ? limit : asked < least ? least : asked;
}

/* Pushes on, or coasts, towards a limit that is no further than the way to stop; and from then on
   until it points away. */
static bool stays_at_limit(struct application *application, float torque_Nm)
{
    struct axis_motion *motion = &application->link->axis.motion;
    const float speed = (float)cia402_signals(application)->omega_est_rad_s;
    const float way = torque_Nm != 0.0f ? torque_Nm : speed;

    if (interrupt_view_torque(&application->drive) && speed * way >= 0.0f && way != 0.0f &&
        axis_motion_nears_limit(application, speed, way)) {
        axis_motion_brake(application, true);
        motion->at_limit = true;
        motion->way = way;
    }
    motion->at_limit = motion->at_limit && motion->way * torque_Nm >= 0.0f;
    return motion->at_limit;
}

/* More than a thousandth of the rated torque less than was asked for: the speed is at its limit. */
static bool is_cut(struct application *application, float torque_Nm)
{
    const struct motor_params *motor = &application->drive.settings.motor;
    const float share =
        (float)cia402_signals(application)->i_q_ref_A / (float)motor->rated_current_A -
        torque_Nm / (float)(motor->torque_constant_Nm_A * motor->rated_current_A);

    return share > 1e-3f || share < -1e-3f;
}

static bool is_in_force(const struct application *application, float torque_Nm, float speed_rad_s)
{
    const struct axis_motion *motion = &application->link->axis.motion;

    return interrupt_view_torque(&application->drive) && torque_Nm == motion->torque_Nm &&
           speed_rad_s == motion->most_rad_s;
}

void axis_torque_background(struct application *application)
{
    struct axis_motion *motion = &application->link->axis.motion;
    const bool was_limited = motion->limited;
    struct drive_command command = {.kind = DRIVE_COMMAND_TORQUE};

    if (motion->halted || application->io.stop != MACHINE_STOP_NONE ||
        command_queue_holds_any(&application->drive.commands)) {
        return;
    }
    motion->limited = false;

    const float torque_Nm = target_Nm(application);
    const float speed_rad_s = most_rad_s(application);

    if (stays_at_limit(application, torque_Nm)) {
        motion->limited = true;
    } else if (is_in_force(application, torque_Nm, speed_rad_s)) {
        motion->limited = motion->limited || is_cut(application, torque_Nm);
    } else {
        command.torque_Nm = (double)torque_Nm;
        command.speed_rad_s = (double)speed_rad_s;
        motion->torque_Nm = torque_Nm;
        motion->most_rad_s = speed_rad_s;
        motion->limited = !cia402_command(application, &command) || motion->limited || was_limited;
    }
}
