#include "firmware/link/axis_stream.h"

#include "firmware/application/application.h"
#include "firmware/design/elementary.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/link.h"

enum { OWED_MAX = 3, IN_HAND = 2, MOST_IN_HAND = 6 };

/* In intervals: behind the last target one is overdue; behind the time of one whose place was taken
   what comes is not that one any more. */
#define OVERDUE 1.5f
#define LATE    0.75f

/* A set-point's acceleration is checked by differences that are rounded. */
static const float acceleration_share = 0.99f;

static const float jerk_s = 2e-3f; /* of what brings it to rest when no target comes */

static float interval_s(const struct application *application)
{
    const struct link_objects *objects = &application->link->objects;
    float interval = (float)objects->interval;

    for (int8_t exponent = objects->interval_exponent; exponent < 0; exponent++) {
        interval *= 0.1f;
    }
    return interval;
}

static bool is_open(const struct application *application)
{
    return application->drive.planner.set_points_open;
}

static uint32_t waiting(const struct application *application)
{
    return set_points_waiting(&application->drive.planner.set_points);
}

/* The last target has come, or should have. */
static float since_s(const struct application *application)
{
    const struct link *link = application->link;

    return 1e-6f * (float)link_since(link, link->axis.stream.fed_us);
}

static bool put(struct application *application, double position_rad)
{
    struct axis_stream *stream = &application->link->axis.stream;
    const float acceleration = axis_motion_acceleration_limit(application);
    struct drive_command point = {.kind = DRIVE_COMMAND_SET_POINT,
                                  .position_rad = position_rad,
                                  .interval_s = (double)interval_s(application),
                                  .acceleration_rad_s2 = (double)acceleration,
                                  .jerk_rad_s3 = (double)(acceleration / jerk_s)};

    if (!cia402_command(application, &point)) {
        return false;
    }
    stream->before_rad = stream->last_rad;
    stream->last_rad = position_rad;
    return true;
}

static void begin(struct application *application)
{
    struct axis_stream *stream = &application->link->axis.stream;

    stream->owed = 0;
    stream->last_rad = drive_planned_end_rad(&application->drive);
    for (int i = 0; i < IN_HAND; i++) {
        (void)put(application, stream->last_rad);
    }
}

/* As far towards the target as speed and acceleration allow. */
static double within_limits(struct application *application, double target_rad)
{
    const struct axis_stream *stream = &application->link->axis.stream;
    const float T = interval_s(application);
    const float most = axis_motion_speed_limit(application);
    const float change = acceleration_share * axis_motion_acceleration_limit(application) * T;
    const float before = (float)(stream->last_rad - stream->before_rad) / T;
    const float asked = (float)(target_rad - stream->last_rad) / T;
    float speed = axis_motion_limited(application, asked, -most, most);

    speed = axis_motion_limited(application, speed, before - change, before + change);
    return speed == asked ? target_rad : stream->last_rad + (double)(T * speed);
}

void axis_stream_take(struct application *application)
{
    struct axis_motion *motion = &application->link->axis.motion;
    struct axis_stream *stream = &application->link->axis.stream;

    motion->limited = false;
    motion->target_rad = axis_motion_target(application);

    const double target_rad = motion->target_rad;
    const bool moved = target_rad != stream->last_rad || stream->last_rad != stream->before_rad;

    if (motion->halted || (!moved && (stream->stays || !is_open(application)))) {
        return;
    }
    stream->stays = !moved;
    if (!is_open(application) && axis_motion_rests(application)) {
        begin(application);
    }
    if (!is_open(application)) {
        return;
    }
    if (stream->owed > 0u && since_s(application) < LATE * interval_s(application)) {
        stream->owed--; /* the one whose place was taken */
        return;
    }
    stream->owed = 0;
    stream->fed_us = application->link->now_us;
    if (waiting(application) >= MOST_IN_HAND) {
        return; /* came in a heap: the next one stands for it, too */
    }
    motion->limited = !put(application, within_limits(application, target_rad)) || motion->limited;
}

void axis_stream_background(struct application *application)
{
    struct axis_stream *stream = &application->link->axis.stream;
    const double step_rad = stream->last_rad - stream->before_rad;
    const float interval = interval_s(application);

    if (is_open(application) && step_rad != 0.0 && stream->owed < OWED_MAX &&
        since_s(application) > OVERDUE * interval &&
        put(application, stream->last_rad + step_rad)) {
        stream->owed++;
        stream->fed_us += (uint32_t)(1e6f * interval);
    }
}
