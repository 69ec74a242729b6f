#include "firmware/link/axis_homing_switch.h"

#include "firmware/application/application.h"
#include "firmware/design/elementary.h"
#include "firmware/link/axis_homing.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/link.h"

enum { LIMIT_ABOVE = 18 }; /* the last method on a limit switch */

/* Of a method: in which direction of the axis it looks for the switch, in which it crosses the
   edge, and whether the switch is active behind that. */
enum { LOOKS_UP = 1, CROSSES_UP = 2, COMES_ON = 4 };

static const uint8_t courses[] = {
    CROSSES_UP,                       /* 17 */
    LOOKS_UP,                         /* 18 */
    LOOKS_UP,                         /* 19 */
    LOOKS_UP | CROSSES_UP | COMES_ON, /* 20 */
    CROSSES_UP,                       /* 21 */
    COMES_ON,                         /* 22 */
    LOOKS_UP,                         /* 23 */
    LOOKS_UP | CROSSES_UP | COMES_ON, /* 24 */
    LOOKS_UP | COMES_ON,              /* 25 */
    LOOKS_UP | CROSSES_UP,            /* 26 */
    CROSSES_UP,                       /* 27 */
    COMES_ON,                         /* 28 */
    CROSSES_UP | COMES_ON,            /* 29 */
    0,                                /* 30 */
};

static struct axis_homing *homing_of(struct application *application)
{
    return &application->link->axis.motion.homing;
}

static uint8_t limit_of(float way)
{
    return way > 0.0f ? HAL_INPUT_LIMIT_PLUS : HAL_INPUT_LIMIT_MINUS;
}

/* From here. */
static void go(struct application *application, enum homing_phase phase, float way, uint32_t speed,
               uint32_t acceleration)
{
    struct axis_homing *homing = homing_of(application);

    axis_homing_enter(application, phase);
    homing->way = way;
    homing->before_edge = false;
    homing->began_rad = cia402_signals(application)->theta_ref_rad;
    axis_homing_go(application, DRIVE_COMMAND_VELOCITY, 0.0,
                   way * axis_motion_speed(application, speed), acceleration);
}

static void look_for_it(struct application *application, float way, uint32_t acceleration)
{
    go(application, HOMING_SEEKS_SWITCH, way, application->link->objects.homing_speed,
       acceleration);
}

static void go_on(struct application *application)
{
    const struct link_objects *objects = &application->link->objects;
    struct axis_homing *homing = homing_of(application);

    if (homing->phase == HOMING_CROSSES_SWITCH) {
        axis_homing_enter(application, HOMING_SETTLES);
        axis_homing_go(application, DRIVE_COMMAND_VELOCITY, 0.0, 0.0f,
                       objects->homing_acceleration);
    } else if (homing->phase == HOMING_SEEKS_SWITCH && homing->comes_on) {
        go(application, HOMING_LEAVES_SWITCH, -homing->crosses, objects->homing_zero_speed,
           objects->homing_acceleration);
    } else {
        go(application, HOMING_CROSSES_SWITCH, homing->crosses, objects->homing_zero_speed,
           objects->homing_acceleration);
    }
}

void axis_homing_switch_look(struct application *application)
{
    const struct link_objects *objects = &application->link->objects;
    const struct drive_signals *now = cia402_signals(application);
    struct axis_homing *homing = homing_of(application);
    const uint32_t active = machine_io_active(application);
    const bool seeks = homing->phase == HOMING_SEEKS_SWITCH;
    const bool awaits_on = seeks || (homing->phase == HOMING_CROSSES_SWITCH && homing->comes_on);
    const bool on = (active & homing->input) != 0u;
    const bool at_limit = (active & limit_of(homing->way)) != 0u;
    const double travel_rad = cia402_unit_rad(objects) * (double)objects->homing_travel;

    if (((machine_io_seen(application) & homing->input) != 0u) != awaits_on) {
        homing->edge_rad = now->theta_est_rad;
    }
    if (on != awaits_on && now->omega_ref_rad_s * (double)homing->way > 0.0) {
        homing->before_edge = true;
    }
    if (on == awaits_on && (seeks || homing->before_edge)) {
        go_on(application);
    } else if (at_limit && seeks && !homing->turned) {
        homing->turned = true;
        look_for_it(application, -homing->way, objects->quick_stop_deceleration);
    } else if (at_limit || magnitude(now->theta_ref_rad - homing->began_rad) > travel_rad) {
        axis_homing_give_up(application);
    }
}

bool axis_homing_switch_start(struct application *application, int8_t method)
{
    const struct link_objects *objects = &application->link->objects;
    struct axis_homing *homing = homing_of(application);
    const uint8_t course = courses[method - AXIS_HOMING_SWITCH_FIRST];
    const float up = cia402_turned_unit_rad(objects, CIA402_POSITION_TURNED) > 0.0 ? 1.0f : -1.0f;
    const float way = (course & LOOKS_UP) != 0u ? up : -up;
    const uint8_t input = method <= LIMIT_ABOVE ? limit_of(way) : HAL_INPUT_HOME;

    if (((uint32_t)application->chosen.inputs_used & input) == 0u) {
        return false;
    }
    *homing = (struct axis_homing){
        .phase = HOMING_SEEKS_SWITCH,
        .way = way,
        .began_rad = cia402_signals(application)->theta_ref_rad,
        .crosses = (course & CROSSES_UP) != 0u ? up : -up,
        .input = input,
        .comes_on = (course & COMES_ON) != 0u,
    };
    axis_homing_switch_look(application); /* it may be there already, or a limit */
    if (homing->phase == HOMING_SEEKS_SWITCH && !homing->turned) {
        look_for_it(application, way, objects->homing_acceleration);
    }
    return true;
}
