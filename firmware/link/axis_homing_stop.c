#include "firmware/link/axis_homing_stop.h"

#include "firmware/application/application.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/state_machine.h"
#include "firmware/link/axis_homing.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/link.h"

enum { GROWS_ms = 2, RESTS_ms = 120, FAILURES = 8, TOUCHES = 2 };

/* Full steps. */
static const float under_way_steps = 4.0f;
static const float yield_steps = 0.25f;
static const float led_steps = 0.25f;
static const float follows_share = 0.5f;
static const float agree_steps = 0.15f;
static const float leave_steps = 1.0f;
static const float back_steps = 8.0f;
static const float further_back_steps = 11.0f; /* every other time */

static const float growing_share = 0.75f; /* of the torque */

/* Of the speed 6099h, 2, by failures: a heavy rotor is thrown less by less of it, the back-EMF of a
   light one is seen in more. */
static const float speed_shares[FAILURES] = {1.0f, 0.5f, 1.5f, 1.0f, 0.5f, 1.5f, 1.0f, 1.5f};

/* Of the creep in which a hold leads the rotor. In little more than that a light rotor stands at
   each detent that a load helps. */
static const float back_off_creeps = 0.5f;
static const float approach_creeps = 2.75f;
static const float creep_ramp_s = 0.1f;

static struct axis_homing *homing_of(struct application *application)
{
    return &application->link->axis.motion.homing;
}

static float greater(float a, float b)
{
    return a > b ? a : b;
}

/* A rotor that follows nothing shows no load, nor does an observer that has none. */
bool axis_homing_stop_shows(const struct drive_settings *settings)
{
    return settings->law != POSITION_LAW_MICROSTEPPING &&
           (settings->feedback != DRIVE_FEEDBACK_ENCODER ||
            settings->observer != DRIVE_OBSERVER_HIGH_GAIN);
}

/* The rotor is not where it is estimated. A stop that is struck leaves doubt for a while. */
static bool is_lost(const struct application *application)
{
    const struct drive *drive = &application->drive;

    return interrupt_view_synchronism(drive) > DRIVE_SYNCHRONISM_DOUBTFUL ||
           lead_watch_rotor_is_left(&drive->lead_watch);
}

/* Up to where a hold leads the rotor, rad/s; 0: nowhere. */
static float creep_rad_s(const struct drive *drive)
{
    return (float)num_to_double(drive->params.reference.creep_speed) *
           (float)drive->base.speed_rad_s;
}

static float step_rad(const struct application *application)
{
    return application->link->axis.motion.homing.way * axis_homing_full_step_rad(application);
}

/* Full steps on the way from where the search began, of a place, and the place. */
static float steps_to(const struct application *application, double place_rad)
{
    const float away_rad = (float)(place_rad - application->link->axis.motion.homing.began_rad);

    return away_rad / step_rad(application);
}

static double place_at_rad(const struct application *application, float steps)
{
    return application->link->axis.motion.homing.began_rad +
           (double)(steps * step_rad(application));
}

/* To this place, away from the stop. */
static void creep_to(struct application *application, float steps)
{
    const struct link_objects *objects = &application->link->objects;
    const float creep = back_off_creeps * creep_rad_s(&application->drive);
    float speed = axis_motion_speed(application, objects->homing_zero_speed);
    uint32_t acceleration = objects->quick_stop_deceleration;

    if (creep > 0.0f && creep < speed) { /* a hold leads the rotor */
        speed = creep;
        acceleration = (uint32_t)(creep / creep_ramp_s / (float)cia402_unit_rad(objects));
    }
    axis_homing_enter(application, HOMING_BACKS_OFF);
    axis_homing_go(application, DRIVE_COMMAND_RETARGET, place_at_rad(application, steps), speed,
                   acceleration);
}

/* With an encoder the rotor is where it is counted: one approach shows the stop, or that there is
   none. */
static bool is_counted(const struct application *application)
{
    return application->drive.settings.feedback == DRIVE_FEEDBACK_ENCODER;
}

static void catch_rotor(struct application *application)
{
    axis_homing_enter(application, HOMING_CATCHES);
    if (!is_counted(application)) {
        state_machine_ask_to_realign(&application->drive);
    }
}

/* This approach has. What one before has found still holds, if another finds it again. */
static void fail(struct application *application)
{
    struct axis_homing *homing = homing_of(application);

    homing->touches = homing->touches > 0u ? 1 : 0;
    if (is_counted(application)) {
        homing->failures = FAILURES;
        creep_to(application, homing->furthest - leave_steps);
    } else {
        homing->failures++;
        catch_rotor(application);
    }
}

/* The stop is where the rotor has come furthest before: pressed against it, it induces nothing, and
   its estimate drifts. */
static void touch(struct application *application)
{
    struct axis_homing *homing = homing_of(application);
    const float moved = homing->furthest - homing->place;

    if (is_counted(application)) {
        homing->touches = TOUCHES;
        homing->place = homing->free;
        creep_to(application, homing->place - leave_steps);
        return;
    }
    if (homing->touches > 0u && (moved > agree_steps || -moved > agree_steps)) {
        homing->failures++;
        homing->touches = 0;
    }
    homing->place = homing->touches > 0u ? homing->furthest - 0.5f * moved : homing->furthest;
    homing->touches++;
    catch_rotor(application);
}

/* The rotor as it is, and where it has come furthest, before the stop bears it. */
static void follow(struct axis_homing *homing, float rotor, float reference, bool free, bool sure)
{
    if (free) {
        homing->doubtful = !sure;
        homing->free = rotor;
        homing->furthest = greater(homing->furthest, rotor);
        homing->led_from = reference;
        homing->ms = 0;
    } else if (homing->ms < GROWS_ms) {
        homing->ms++;
    }
}

static void seek(struct application *application)
{
    const struct link_objects *objects = &application->link->objects;
    const struct drive_signals *now = cia402_signals(application);
    struct axis_homing *homing = homing_of(application);
    const float travel_rad = (float)cia402_unit_rad(objects) * (float)objects->homing_travel;
    const float stop_Nm = axis_motion_torque_Nm(application, (float)objects->homing_torque);
    const float torque_Nm = homing->way * (float)now->load_torque_est_Nm;
    const float rotor = steps_to(application, now->theta_est_rad);
    const float reference = steps_to(application, now->theta_ref_rad);
    const bool free =
        torque_Nm < growing_share * stop_Nm || reference - homing->from < under_way_steps;

    follow(homing, rotor, reference, free, now->synchronism == DRIVE_SYNCHRONISM_SURE);

    const float on = rotor - homing->free;
    const float led = reference - homing->led_from;
    const bool came = is_counted(application) ||
                      homing->furthest - homing->from > follows_share * under_way_steps;
    const bool stands = homing->ms == GROWS_ms && torque_Nm > stop_Nm && led > led_steps &&
                        on < follows_share * led;

    if (reference * axis_homing_full_step_rad(application) > travel_rad) {
        axis_homing_give_up(application);
    } else if (on > yield_steps || is_lost(application) ||
               (stands && (homing->doubtful || !came))) {
        fail(application);
    } else if (stands) {
        touch(application);
    }
}

static void approach(struct application *application)
{
    const struct link_objects *objects = &application->link->objects;
    struct axis_homing *homing = homing_of(application);
    const float asked =
        speed_shares[homing->failures] * axis_motion_speed(application, objects->homing_zero_speed);
    const float least = approach_creeps * creep_rad_s(&application->drive);
    const float speed = axis_lesser(greater(asked, least), axis_motion_speed_limit(application));

    axis_homing_enter(application, HOMING_SEEKS_STOP);
    homing->from = steps_to(application, cia402_signals(application)->theta_ref_rad);
    homing->furthest = homing->from;
    axis_homing_go(application, DRIVE_COMMAND_VELOCITY, 0.0, homing->way * speed,
                   objects->homing_acceleration);
}

/* Between here and where the axis began the nearest place of a full step of the motor, at which the
   detent torque is nil: a light rotor that starts beside it is not where the hold takes it to be,
   and the next detent stops it. */
static float at_full_step(struct application *application, float steps)
{
    const float zero = steps_to(application, cia402_signals(application)->motor_zero_rad);

    return zero + (float)(int32_t)(steps - zero);
}

/* The rotor rests at the stop. Each approach begins elsewhere: what it finds is not of where it
   began. */
static void back_off(struct application *application)
{
    const struct axis_homing *homing = homing_of(application);
    const float here = steps_to(application, cia402_signals(application)->theta_ref_rad);
    const bool further = ((homing->failures + homing->touches) & 1u) != 0u;

    creep_to(application,
             homing->touches == TOUCHES
                 ? homing->place - leave_steps
                 : at_full_step(application, here - (further ? further_back_steps : back_steps)));
}

/* The rotor rests where the next approach begins, or where it has left the stop. */
static void settle(struct application *application)
{
    const struct axis_homing *homing = homing_of(application);

    if (homing->touches == TOUCHES) {
        axis_homing_end(application, place_at_rad(application, homing->place));
    } else if (homing->failures >= FAILURES) {
        axis_homing_give_up(application);
    } else {
        approach(application);
    }
}

void axis_homing_stop_look(struct application *application)
{
    const uint8_t phase = homing_of(application)->phase;

    if (phase == HOMING_SEEKS_STOP) {
        seek(application);
    } else if (!axis_homing_has_rested(application, RESTS_ms)) {
        return;
    } else if (phase == HOMING_CATCHES) {
        if (homing_of(application)->failures > FAILURES) { /* nor can it be led back */
            axis_homing_give_up(application);
        } else {
            back_off(application);
        }
    } else if (phase == HOMING_SETTLES) {
        settle(application);
    } else if (is_lost(application)) {
        fail(application);
    } else {
        axis_homing_enter(application, HOMING_SETTLES);
    }
}
