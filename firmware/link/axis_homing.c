#include "firmware/link/axis_homing.h"

#include "firmware/application/application.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_homing_stop.h"
#include "firmware/link/axis_homing_switch.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/link.h"

enum { STOP_DOWN = -1, STOP_UP = -2, INDEX_DOWN = 33, INDEX_UP = 34, HERE_BEFORE = 35, HERE = 37 };

enum { START = 0x10 }; /* bit of the controlword */

enum { SETTLES_ms = 200 };

static const float sets_out_steps = 1.0f;

static const float index_travel_rad = 1.125f * 6.2831853f;

static const int8_t methods[LINK_HOMING_METHODS_IN_ALL] = {LINK_HOMING_METHODS};

int8_t axis_homing_method(uint8_t number)
{
    return methods[number - 1u];
}

bool axis_homing_is_method(int8_t method)
{
    for (size_t i = 0; i < sizeof methods; i++) {
        if (methods[i] == method) {
            return true;
        }
    }
    return false;
}

float axis_homing_full_step_rad(const struct application *application)
{
    return 1.5707963f / (float)application->drive.settings.motor.rotor_teeth;
}

/* The axis is so far beyond 607ch. */
static void set_position(struct application *application, double beyond_rad)
{
    const struct link_objects *objects = &application->link->objects;
    struct axis_motion *motion = &application->link->axis.motion;
    struct drive_command here = {
        .kind = DRIVE_COMMAND_SET_POSITION,
        .position_rad = beyond_rad + cia402_turned_unit_rad(objects, CIA402_POSITION_TURNED) *
                                         objects->home_offset,
    };

    motion->homed = cia402_command(application, &here);
    motion->not_homed = !motion->homed;
}

static bool shows_index(const struct drive *drive)
{
    return drive->settings.feedback == DRIVE_FEEDBACK_ENCODER &&
           drive->board->facts->has_encoder_index;
}

uint8_t axis_homing_methods(const struct application *application)
{
    return LINK_HOMING_METHODS_IN_ALL -
           (shows_index(&application->drive) ? 0 : LINK_HOMING_METHODS_ON_INDEX);
}

void axis_homing_give_up(struct application *application)
{
    axis_motion_brake(application, false);
    application->link->axis.motion.not_homed = true;
}

void axis_homing_go(struct application *application, enum drive_command_kind kind,
                    double position_rad, float speed_rad_s, uint32_t acceleration)
{
    if (!axis_motion_post(application, kind, position_rad, speed_rad_s, acceleration)) {
        axis_homing_give_up(application);
    }
}

void axis_homing_enter(struct application *application, enum homing_phase phase)
{
    struct axis_homing *homing = &application->link->axis.motion.homing;

    homing->phase = (uint8_t)phase;
    homing->ms = 0;
}

static void search(struct application *application, int8_t method)
{
    const struct link_objects *objects = &application->link->objects;
    struct axis_motion *motion = &application->link->axis.motion;
    const double unit_rad = cia402_turned_unit_rad(objects, CIA402_POSITION_TURNED);
    const bool up = method == STOP_UP || method == INDEX_UP;
    const bool index = method > 0;
    const float way = up == (unit_rad > 0.0) ? 1.0f : -1.0f;

    motion->not_homed = !(index ? shows_index(&application->drive)
                                : axis_homing_stop_shows(&application->drive.settings));
    if (motion->not_homed) {
        return;
    }
    motion->homing = (struct axis_homing){
        .way = way,
        .on_stop = !index,
        .phase = index ? HOMING_SETS_OUT : HOMING_SEEKS_STOP,
        .began_rad = cia402_signals(application)->theta_ref_rad,
    };
    axis_homing_go(application, DRIVE_COMMAND_VELOCITY, 0.0,
                   way * axis_motion_speed(application, objects->homing_speed),
                   objects->homing_acceleration);
}

void axis_homing_start(struct application *application)
{
    const int8_t method = application->link->objects.homing_method;
    struct axis_motion *motion = &application->link->axis.motion;

    if (motion->homing.phase != HOMING_ENDED) {
        return;
    }
    motion->homed = false;
    motion->limited = false;
    motion->barred = 0;
    if (method >= HERE_BEFORE) {
        set_position(application, 0.0);
    } else if (method >= AXIS_HOMING_SWITCH_FIRST && method <= AXIS_HOMING_SWITCH_LAST) {
        motion->not_homed = false;
        motion->not_homed = !axis_homing_switch_start(application, method) || motion->not_homed;
    } else {
        search(application, method);
    }
}

bool axis_homing_seeks_stop(const struct axis_homing *homing)
{
    return homing->on_stop && homing->phase != HOMING_ENDED;
}

bool axis_homing_seeks_switch(const struct axis_homing *homing)
{
    return homing->phase >= HOMING_SEEKS_SWITCH && homing->phase <= HOMING_CROSSES_SWITCH;
}

void axis_homing_end(struct application *application, double place_rad)
{
    application->link->axis.motion.homing.phase = HOMING_ENDED;
    set_position(application, cia402_signals(application)->theta_ref_rad - place_rad);
}

bool axis_homing_has_rested(struct application *application, uint16_t ms)
{
    struct axis_homing *homing = &application->link->axis.motion.homing;

    homing->ms = (uint16_t)(axis_motion_rests(application) ? homing->ms + 1u : 0u);
    return homing->ms >= ms;
}

static void go_to_index(struct application *application, int32_t count)
{
    const struct link_objects *objects = &application->link->objects;
    struct axis_homing *homing = &application->link->axis.motion.homing;

    homing->edge_rad = drive_position_at_count_rad(&application->drive, count);
    axis_homing_enter(application, HOMING_SETTLES);
    axis_homing_go(application, DRIVE_COMMAND_RETARGET, homing->edge_rad,
                   axis_motion_speed(application, objects->homing_zero_speed),
                   objects->quick_stop_deceleration);
}

/* A rotor that rests on the index may cross its edges either way before it is under way. */
static void look_for_index(struct application *application)
{
    const struct hal *board = application->drive.board;
    struct axis_homing *homing = &application->link->axis.motion.homing;
    const float gone_rad =
        homing->way * (float)(cia402_signals(application)->theta_ref_rad - homing->began_rad);
    int32_t count;

    if (homing->phase == HOMING_SETS_OUT) {
        if (gone_rad > sets_out_steps * axis_homing_full_step_rad(application)) {
            homing->phase = HOMING_AWAITS_INDEX;
            (void)board->encoder_index(
                board->context, homing->way > 0.0f ? HAL_INDEX_RISES : HAL_INDEX_FALLS, &count);
        }
    } else if (board->encoder_index(board->context, HAL_INDEX_PASSED, &count)) {
        go_to_index(application, count);
    } else if (gone_rad > index_travel_rad) {
        axis_homing_give_up(application);
    }
}

void axis_homing_look(struct application *application)
{
    const struct cia402 *axis = &application->link->axis;
    const struct axis_homing *homing = &axis->motion.homing;

    if (homing->phase == HOMING_ENDED) {
        return;
    }
    if ((axis->controlword & START) == 0u) {
        axis_motion_brake(application, false); /* interrupted */
    } else if (homing->on_stop) {
        axis_homing_stop_look(application);
    } else if (axis_homing_seeks_switch(homing)) {
        axis_homing_switch_look(application);
    } else if (homing->phase != HOMING_SETTLES) {
        look_for_index(application);
    } else if (axis_homing_has_rested(application, SETTLES_ms)) {
        axis_homing_end(application, homing->edge_rad);
    }
}
