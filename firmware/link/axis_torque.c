#include "firmware/link/axis_torque.h"

#include "firmware/application/application.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/link.h"

bool axis_torque_is_carried(const struct application *application)
{
    return reads_encoder(&application->drive.settings);
}

/* What brakes a fast rotor follows its speed in steps, of thousandths. */
enum { BRAKING_STEP = 16 };

/* The target, cut at the current limit and, where it brakes, at what the supply drives, in
   thousandths of the rated torque. */
static int32_t limited_target(struct application *application)
{
    const int32_t target = application->link->objects.target_torque;
    const float speed = (float)cia402_signals(application)->omega_est_rad_s;
    int32_t most = cia402_thousandths(application, 0x6072);

    if ((float)target * speed < 0.0f) {
        const int32_t left = axis_motion_braking_thousandths(application, speed);
        const int32_t step = left < BRAKING_STEP ? BRAKING_STEP : left - left % BRAKING_STEP;

        most = left < most ? step : most;
    }
    application->link->axis.motion.limited = target > most || target < -most;
    return target > most ? most : target < -most ? -most : target;
}

/* Pushes on, or coasts, towards a limit that is no further than the way to stop; and from then on
   until it points away. */
static bool stays_at_limit(struct application *application, float torque)
{
    struct axis_motion *motion = &application->link->axis.motion;
    const float speed = (float)cia402_signals(application)->omega_est_rad_s;
    const float way = torque != 0.0f ? torque : speed;

    if (interrupt_view_torque(&application->drive) &&
        axis_motion_nears_limit(application, speed * way > 0.0f ? speed : 0.0f, way)) {
        axis_motion_brake(application, true);
        motion->at_limit = true;
        motion->way = way;
    }
    motion->at_limit = motion->at_limit && (torque == 0.0f || motion->way * torque > 0.0f);
    return axis_motion_is_barred(application, torque) || motion->at_limit;
}

/* By more than a thousandth and what rounds: the speed is at its limit. */
static bool is_cut(struct application *application, int32_t target)
{
    const int32_t off = cia402_thousandths(application, 0x6074) - target;

    return off > 1 || off < -1;
}

static void command_torque(struct application *application, int32_t target)
{
    struct axis_motion *motion = &application->link->axis.motion;
    const uint32_t rpm = application->link->objects.max_speed_rpm;
    const float most = axis_motion_speed_limit(application);
    const float speed = AXIS_RAD_S_PER_RPM * (float)rpm;
    struct drive_command command = {
        .kind = DRIVE_COMMAND_TORQUE,
        .torque_Nm = (double)axis_motion_torque_Nm(application, (float)target),
        .speed_rad_s = (double)(speed < most ? speed : most),
    };

    motion->limited = !cia402_command(application, &command) || motion->limited;
    motion->target = (int16_t)target;
    motion->max_speed_rpm = rpm;
}

void axis_torque_background(struct application *application)
{
    const struct link *link = application->link;
    struct axis_motion *motion = &application->link->axis.motion;

    if (motion->halted || command_queue_holds_any(&application->drive.commands)) {
        return;
    }
    const bool was_limited = motion->limited;
    const int32_t target = limited_target(application);

    if (stays_at_limit(application, (float)target)) {
        motion->limited = true;
    } else if (interrupt_view_torque(&application->drive) && target == motion->target &&
               link->objects.max_speed_rpm == motion->max_speed_rpm) {
        motion->limited = motion->limited || is_cut(application, target);
    } else {
        motion->limited = motion->limited || was_limited;
        command_torque(application, target);
    }
}
