#include "firmware/link/axis_stream.h"

#include "firmware/application/application.h"
#include "firmware/design/elementary.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/link.h"

enum { OWED_MAX = 3, IN_HAND = 2, MOST_IN_HAND = 6 };

/* In intervals of being late: the place of one that is overdue is taken; by how much what comes
   then must be early to be that one. */
#define OVERDUE         0.5f
#define OVERDUE_BY_SYNC 1.5f
#define NOT_LATE        (-0.25f)

/* In intervals: what of SYNC's arrival is jitter, and the most that a SYNC moves the phase. */
#define JITTER     0.25f
#define PHASE_GAIN (1.0f / 64.0f)

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

/* Beyond the time, of the drive's clock, at which the next set-point should have come, intervals.
 */
static float late(const struct application *application)
{
    const struct axis_stream *stream = &application->link->axis.stream;
    const int32_t periods = (int32_t)(interrupt_view_period(&application->drive) - stream->due);

    return (float)periods / (float)application->drive.planner.set_points.interval_periods;
}

static bool put(struct application *application, double position_rad)
{
    struct axis_stream *stream = &application->link->axis.stream;
    const float acceleration = axis_motion_acceleration_limit(application, 0.0f);
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
    stream->due += application->drive.planner.set_points.interval_periods;
    return true;
}

static void begin(struct application *application)
{
    struct axis_stream *stream = &application->link->axis.stream;

    stream->last_rad = drive_planned_end_rad(&application->drive);
    stream->asked_rad = stream->last_rad;
    for (int i = 0; i < (stream->by_sync ? IN_HAND + 1 : IN_HAND); i++) {
        (void)put(application, stream->last_rad);
    }
    stream->due = interrupt_view_period(&application->drive);
    stream->refused = !is_open(application);
    stream->owed = stream->refused ? 1 : 0;
}

/* Of the acceleration limit: what comes up to its target leaves as much for the rotor to follow. */
static const float closing_share = 0.5f;

/* Of set-points that get slower by `change` in each interval: the speed from which they come to
   rest within a way, `most` where that is no more. */
static float stopping_speed(float way_rad, float change, float T, float most)
{
    const float half = 0.5f * change, twice = 2.0f * change * way_rad / T;

    if (twice <= 0.0f) {
        return 0.0f;
    }
    return twice < most * (most + change)
               ? axis_lesser(most, (float)square_root((double)(half * half + twice)) - half)
               : most;
}

/* As far towards the target as speed and acceleration allow, so that it stops where the target
   does, and at a software limit. */
static double within_limits(struct application *application, double target_rad)
{
    const struct axis_stream *stream = &application->link->axis.stream;
    const float T = interval_s(application);
    const float most = axis_motion_speed_limit(application);
    const float before = (float)(stream->last_rad - stream->before_rad) / T;
    const float limit = axis_motion_ramp_limit(application, before, before);
    const float gentle =
        axis_lesser(limit, closing_share * axis_motion_acceleration_limit(application, 0.0f));
    const float slower = acceleration_share * limit * T;
    const float asked = (float)(target_rad - stream->last_rad) / T;
    const float of_target = (float)(target_rad - stream->asked_rad) / T;
    const float behind_rad = (float)(stream->asked_rad - stream->last_rad);
    const bool follows = behind_rad == 0.0f && axis_size(asked - before) <= slower;
    const float change = follows ? slower : gentle * T;
    const float closing = stopping_speed(axis_size(behind_rad), gentle * T, T, 2.0f * most);
    const float down_rad = (float)(stream->last_rad - axis_motion_limit_rad(application, -1.0f));
    const float up_rad = (float)(axis_motion_limit_rad(application, 1.0f) - stream->last_rad);
    float speed = axis_motion_limited(application, asked, of_target - closing, of_target + closing);

    speed = axis_motion_limited(application, speed, -stopping_speed(down_rad, gentle * T, T, most),
                                stopping_speed(up_rad, gentle * T, T, most));
    speed = axis_motion_limited(application, speed, before - (before > 0.0f ? slower : change),
                                before + (before < 0.0f ? slower : change));
    return speed == asked ? target_rad : stream->last_rad + (double)(T * speed);
}

/* Goes on to a position, or begins to; what stays needs no set-points. */
static void follow(struct application *application, double position_rad)
{
    struct axis_motion *motion = &application->link->axis.motion;
    struct axis_stream *stream = &application->link->axis.stream;
    const bool moves = position_rad != stream->last_rad || stream->last_rad != stream->before_rad;

    if (!moves && (stream->stays || !is_open(application))) {
        return;
    }
    stream->stays = false;
    if (!is_open(application) && axis_motion_rests(application)) {
        begin(application);
        motion->limited = motion->limited || stream->refused;
    }
    if (!is_open(application)) {
        return;
    }
    if (waiting(application) < MOST_IN_HAND) { /* else in a heap: the next one stands for it, too */
        motion->limited =
            !put(application, within_limits(application, position_rad)) || motion->limited;
        stream->asked_rad = position_rad;
        stream->stays = !moves;
    } else {
        stream->due += application->drive.planner.set_points.interval_periods;
    }
}

/* ---- with SYNC ---- */

static float within(float value, float most)
{
    return value > most ? most : value < -most ? -most : value;
}

/* What a step differs from the one before, of a motion that the drive can follow: between targets
   that jump the parabola would pass both. */
static float curve_of(const struct application *application)
{
    const struct axis_stream *stream = &application->link->axis.stream;
    const float T = interval_s(application);

    return within(stream->step_rad - stream->step_before_rad,
                  axis_motion_acceleration_limit(application, 0.0f) * T * T);
}

/* Up to the latest target; of a motion, as long as the next one is overdue, beyond. */
static void advance(struct application *application)
{
    struct axis_stream *stream = &application->link->axis.stream;

    while (stream->ahead + (float)stream->owed <= (float)OWED_MAX &&
           (stream->ahead <= 0.0f ||
            (stream->last_rad != stream->before_rad && late(application) > OVERDUE_BY_SYNC))) {
        const float curve = stream->ahead < 0.0f ? curve_of(application) : 0.0f;
        const float step_rad = stream->step_rad + 0.5f * (stream->ahead + 1.0f) * curve;

        follow(application, stream->target_rad + (double)(stream->ahead * step_rad));
        stream->ahead += 1.0f;
    }
}

void axis_stream_sync(struct application *application)
{
    struct axis_stream *stream = &application->link->axis.stream;

    stream->at_sync = true;
    stream->target_before_rad = stream->target_rad;
    stream->step_before_rad = stream->step_rad;
    stream->target_rad += (double)stream->step_rad;
    stream->owed =
        (uint8_t)(stream->owed + (stream->by_sync && stream->owed < UINT8_MAX ? 1u : 0u));
    stream->ahead -= 1.0f;
    if (is_open(application)) {
        const float off = late(application) + stream->ahead;

        stream->ahead -= PHASE_GAIN * within(off - within(off, JITTER), 1.0f);
    }
}

static void take_with_sync(struct application *application)
{
    struct axis_stream *stream = &application->link->axis.stream;

    if (!stream->by_sync || !is_open(application)) {
        stream->by_sync = true;
        stream->ahead = 0.0f;
        stream->target_before_rad = stream->last_rad;
        stream->step_before_rad = 0.0f;
    }
    stream->target_rad = application->link->axis.motion.target_rad;
    stream->step_rad = (float)(stream->target_rad - stream->target_before_rad);
    stream->owed = 0;
    advance(application);
}

/* ---- on reception ---- */

static void take_at_once(struct application *application)
{
    struct axis_stream *stream = &application->link->axis.stream;

    stream->by_sync = false;
    stream->ahead = 0.0f;
    if (stream->owed > 0u && late(application) < NOT_LATE) {
        stream->owed--; /* the one whose place was taken */
        return;
    }
    stream->owed = 0;
    stream->due = interrupt_view_period(&application->drive);
    follow(application, application->link->axis.motion.target_rad);
}

static void make_up(struct application *application)
{
    struct axis_stream *stream = &application->link->axis.stream;
    const double step_rad = stream->last_rad - stream->before_rad;

    if (step_rad != 0.0 && stream->owed < OWED_MAX && late(application) > OVERDUE &&
        waiting(application) < MOST_IN_HAND) {
        const bool follows = stream->asked_rad == stream->last_rad;
        if (put(application, within_limits(application, stream->last_rad + step_rad))) {
            stream->owed++;
            stream->asked_rad = follows ? stream->last_rad : stream->asked_rad;
        }
    }
}

/* ---- both ---- */

/* Behind a limit switch no target is any further. */
static void stay_within_switch(struct application *application)
{
    struct axis_motion *motion = &application->link->axis.motion;
    const double end_rad = axis_motion_rests(application)
                               ? drive_planned_end_rad(&application->drive)
                               : cia402_signals(application)->theta_ref_rad;

    if (axis_motion_is_barred(application, (float)(motion->target_rad - end_rad))) {
        motion->target_rad = end_rad;
    }
}

void axis_stream_take(struct application *application)
{
    struct axis_motion *motion = &application->link->axis.motion;

    motion->limited = false;
    motion->target_rad = axis_motion_target(application);
    stay_within_switch(application);
    if (motion->halted) {
        return;
    }
    if (application->link->axis.stream.at_sync) {
        take_with_sync(application);
    } else {
        take_at_once(application);
    }
}

bool axis_stream_follows(const struct axis_stream *stream)
{
    return stream->owed == 0u && stream->ahead <= 1.0f;
}

/* The targets have ended, and the axis rests beside the last one: goes there, once. */
static void end(struct application *application)
{
    struct axis_stream *stream = &application->link->axis.stream;
    const struct axis_motion *motion = &application->link->axis.motion;

    if (stream->last_rad != motion->target_rad && !motion->halted && !stream->refused &&
        motion->barred == 0 && late(application) > (float)OWED_MAX &&
        axis_motion_rests(application)) {
        stream->last_rad = motion->target_rad;
        stream->before_rad = motion->target_rad;
        axis_motion_go(application, motion->target_rad);
    }
}

void axis_stream_background(struct application *application)
{
    if (!is_open(application)) {
        end(application);
        return;
    }
    if (application->link->axis.stream.at_sync) {
        return; /* a controlword of this SYNC may come before the target */
    }
    if (application->link->axis.stream.by_sync) {
        advance(application);
    } else {
        make_up(application);
    }
}
