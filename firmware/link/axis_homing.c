#include "firmware/link/axis_homing.h"

#include "firmware/application/application.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/link.h"

enum { STOP_DOWN = -1, STOP_UP = -2, INDEX_DOWN = 33, INDEX_UP = 34, HERE_BEFORE = 35, HERE = 37 };

enum { START = 0x10 }; /* bit of the controlword */

enum { BEARS_ms = 2, SETTLES_ms = 200 };

/* Full steps. */
static const float yield_steps = 0.25f;
static const float led_steps = 0.25f;
static const float follows_share = 0.5f;
static const float leave_steps = 1.0f;
static const float growing_share = 0.75f; /* of the torque */

static const float index_travel_rad = 1.125f * 6.2831853f;

bool axis_homing_is_method(int8_t method)
{
    return method == STOP_DOWN || method == STOP_UP || method == INDEX_DOWN || method == INDEX_UP ||
           method == HERE_BEFORE || method == HERE;
}

static float full_step_rad(const struct application *application)
{
    return 1.5707963f / (float)application->drive.settings.motor.rotor_teeth;
}

/* Of the axis: position_rad is here from now on. */
static void set_position(struct application *application, double position_rad)
{
    struct axis_motion *motion = &application->link->axis.motion;
    struct drive_command here = {.kind = DRIVE_COMMAND_SET_POSITION, .position_rad = position_rad};

    motion->homed = cia402_command(application, &here);
    motion->not_homed = !motion->homed;
}

static double offset_rad(const struct application *application)
{
    const struct link_objects *objects = &application->link->objects;

    return cia402_turned_unit_rad(objects, CIA402_POSITION_TURNED) * objects->home_offset;
}

/* A rotor that follows nothing shows no load, nor does an observer that has none. */
static bool shows_load(const struct drive_settings *settings)
{
    return settings->law != POSITION_LAW_MICROSTEPPING &&
           (settings->feedback != DRIVE_FEEDBACK_ENCODER ||
            settings->observer != DRIVE_OBSERVER_HIGH_GAIN);
}

static bool shows_index(const struct drive *drive)
{
    return drive->settings.feedback == DRIVE_FEEDBACK_ENCODER &&
           drive->board->facts->has_encoder_index;
}

static void search(struct application *application, int8_t method)
{
    const struct link_objects *objects = &application->link->objects;
    struct axis_motion *motion = &application->link->axis.motion;
    const double unit_rad = cia402_turned_unit_rad(objects, CIA402_POSITION_TURNED);
    const bool up = method == STOP_UP || method == INDEX_UP;
    const bool index = method > 0;
    const float way = up == (unit_rad > 0.0) ? 1.0f : -1.0f;
    struct drive_command velocity = {.kind = DRIVE_COMMAND_VELOCITY};

    motion->not_homed =
        !(index ? shows_index(&application->drive) : shows_load(&application->drive.settings)) ||
        !axis_motion_post(application, &velocity,
                          way * axis_motion_speed(application, objects->homing_speed),
                          objects->homing_acceleration);
    if (!motion->not_homed) {
        motion->homing = (struct axis_homing){
            .way = way,
            .phase = index ? HOMING_SETS_OUT : HOMING_SEARCHES,
            .began_rad = cia402_signals(application)->theta_ref_rad,
        };
    }
}

void axis_homing_start(struct application *application)
{
    const int8_t method = application->link->objects.homing_method;
    struct axis_motion *motion = &application->link->axis.motion;

    if (motion->homing.phase != HOMING_ENDED) {
        return;
    }
    motion->homed = false;
    if (method >= HERE_BEFORE) {
        set_position(application, offset_rad(application));
    } else {
        search(application, method);
    }
}

static void give_up(struct application *application)
{
    axis_motion_brake(application, false);
    application->link->axis.motion.not_homed = true;
}

/* By so many full steps from where the stop or the index is. */
static void leave(struct application *application, float steps, bool found)
{
    const struct link_objects *objects = &application->link->objects;
    struct axis_homing *homing = &application->link->axis.motion.homing;
    struct drive_command back = {
        .kind = DRIVE_COMMAND_RETARGET,
        .position_rad =
            homing->bears_rad - (double)(homing->way * steps * full_step_rad(application)),
    };

    homing->phase = HOMING_LEAVES;
    homing->found = found;
    homing->ms = 0;
    if (!axis_motion_post(application, &back,
                          axis_motion_speed(application, objects->homing_zero_speed),
                          objects->quick_stop_deceleration)) {
        give_up(application);
    }
}

/* Where the rotor is. A stop that is struck leaves doubt for a while. */
static bool is_sure(const struct application *application)
{
    return interrupt_view_synchronism(&application->drive) == DRIVE_SYNCHRONISM_SURE;
}

static void look_for_stop(struct application *application)
{
    const struct link_objects *objects = &application->link->objects;
    const struct motor_params *motor = &application->drive.settings.motor;
    const struct drive_signals *now = cia402_signals(application);
    struct axis_homing *homing = &application->link->axis.motion.homing;
    const float way = homing->way;
    const float yield_rad = yield_steps * full_step_rad(application);
    const float torque_Nm = way * (float)now->load_torque_est_Nm;
    const float stop_Nm = 1e-3f * (float)objects->homing_torque * (float)motor->rated_current_A *
                          (float)motor->torque_constant_Nm_A;

    if (torque_Nm < growing_share * stop_Nm) {
        homing->bears_rad = now->theta_est_rad;
        homing->at_bears_rad = now->theta_ref_rad;
        homing->ms = 0;
    } else if (homing->ms < BEARS_ms) {
        homing->ms++;
    }
    const float on_rad = way * (float)(now->theta_est_rad - homing->bears_rad);
    const float led_rad = way * (float)(now->theta_ref_rad - homing->at_bears_rad);
    const float gone_rad = way * (float)(now->theta_ref_rad - homing->began_rad);

    if (on_rad > yield_rad || (homing->ms == 0u && !is_sure(application)) ||
        gone_rad > (float)cia402_unit_rad(objects) * (float)objects->homing_travel) {
        leave(application, leave_steps, false);
    } else if (homing->ms == BEARS_ms && torque_Nm > stop_Nm &&
               led_rad > led_steps * full_step_rad(application) &&
               on_rad < follows_share * led_rad) {
        leave(application, leave_steps, true);
    }
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
        if (gone_rad > leave_steps * full_step_rad(application)) {
            homing->phase = HOMING_AWAITS_INDEX;
            (void)board->encoder_index(
                board->context, homing->way > 0.0f ? HAL_INDEX_RISES : HAL_INDEX_FALLS, &count);
        }
    } else if (board->encoder_index(board->context, HAL_INDEX_PASSED, &count)) {
        homing->bears_rad = drive_position_at_count_rad(&application->drive, count);
        leave(application, 0.0f, true);
    } else if (gone_rad > index_travel_rad) {
        give_up(application);
    }
}

/* The hold draws the rotor to the reference before that is where it stands. */
static void settle(struct application *application)
{
    struct axis_motion *motion = &application->link->axis.motion;
    struct axis_homing *homing = &motion->homing;

    if (!axis_motion_rests(application)) {
        homing->ms = 0;
    } else if (++homing->ms == SETTLES_ms) {
        homing->phase = HOMING_ENDED;
        homing->found = homing->found && is_sure(application);
        motion->not_homed = !homing->found;
        if (homing->found) {
            set_position(application, offset_rad(application) +
                                          cia402_signals(application)->theta_ref_rad -
                                          homing->bears_rad);
        }
    }
}

void axis_homing_look(struct application *application)
{
    const struct cia402 *axis = &application->link->axis;
    const uint8_t phase = axis->motion.homing.phase;

    if (phase != HOMING_ENDED && (axis->controlword & START) == 0u) {
        axis_motion_brake(application, false); /* interrupted */
    } else if (phase == HOMING_SEARCHES) {
        look_for_stop(application);
    } else if (phase == HOMING_SETS_OUT || phase == HOMING_AWAITS_INDEX) {
        look_for_index(application);
    } else if (phase == HOMING_LEAVES) {
        settle(application);
    }
}
