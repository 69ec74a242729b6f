#include "firmware/link/axis_motion.h"

#include "firmware/application/application.h"
#include "firmware/drive/board_limits.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_stream.h"
#include "firmware/link/axis_torque.h"
#include "firmware/link/link.h"

/* Bits of the controlword, in the modes that have them. */
enum { NEW_SET_POINT = 0x10, START_HOMING = 0x10, AT_ONCE = 0x20, RELATIVE = 0x40, HALT = 0x100 };

/* Bits of the statusword. */
enum { REACHED = 0x0400, LIMITED = 0x0800, OF_MODE = 0x1000, OFF = 0x2000 };

enum { QUICKLY = 2 }; /* option code of a halt */

enum { GIVEN_MAX_SPEED = 1 }; /* bit of what is given: the first of `defaults` */

/* A ramp's jerk phases: a quarter of it each, as the console's moves, but no shorter. */
static const float jerk_share = 0.25f;
static const float jerk_min_s = 2e-3f;

static struct axis_motion *motion_of(struct application *application)
{
    return &application->link->axis.motion;
}

static bool moves(const struct drive *drive)
{
    return interrupt_view_moves(drive) || command_queue_holds_any(&drive->commands);
}

bool axis_motion_is_free(const struct application *application)
{
    return application->link->axis.state != CIA402_OPERATION_ENABLED && !moves(&application->drive);
}

/* Not while the drive aligns: it takes no motion then. */
bool axis_motion_rests(const struct application *application)
{
    const struct drive *drive = &application->drive;

    return interrupt_view_state(drive) == DRIVE_OPERATION_ENABLED && !moves(drive);
}

/* ---- limits ---- */

/* Speeds and accelerations are in single precision, which the core computes by itself. */

/* Where the drive refuses, and a little less. */
float axis_motion_speed_limit(const struct application *application)
{
    const struct drive *drive = &application->drive;
    const float limit =
        0.999f * (float)board_limits_speed(&drive->settings, drive->board->facts).rad_s;
    const float given = AXIS_RAD_S_PER_RPM * (float)application->link->objects.max_speed_rpm;
    const bool is_given = (application->link->given & GIVEN_MAX_SPEED) != 0u;

    return is_given && given < limit ? given : limit;
}

/* Of what the supply drives: its voltage and the motor are not quite as stated. */
static const float supply_share = 0.9f;
static const float torque_share = 0.75f; /* of a torque, which comes in one step */

static struct supplied_current supplied(const struct application *application, float speed_rad_s)
{
    const struct drive *drive = &application->drive;

    return board_limits_current(&drive->settings, drive->board->facts, axis_size(speed_rad_s));
}

/* Of a current, where the drive refuses more, and a little less; some is always left. */
static float acceleration_of(const struct application *application, float current_A)
{
    const struct drive_settings *settings = &application->drive.settings;
    const float limit_A = (float)settings->current_limit_A;
    const float least_A = 0.01f * limit_A;
    const float given_A = current_A > least_A ? current_A : least_A;

    return 0.999f * axis_lesser(given_A, limit_A) * (float)settings->motor.torque_constant_Nm_A /
           (float)settings->motor.inertia_kgm2;
}

float axis_motion_acceleration_limit(const struct application *application, float speed_rad_s)
{
    return acceleration_of(application,
                           supply_share * supplied(application, speed_rad_s).braking_A);
}

int32_t axis_motion_braking_thousandths(const struct application *application, float speed_rad_s)
{
    return (int32_t)(1e3f * torque_share * supplied(application, speed_rad_s).braking_A /
                     (float)application->drive.settings.motor.rated_current_A);
}

float axis_motion_ramp_limit(const struct application *application, float from_rad_s,
                             float to_rad_s)
{
    const float from = axis_size(from_rad_s);
    const float to = axis_size(to_rad_s);
    /* the acceleration falls from half of a jerk phase before */
    const float rising_to = (1.0f - 0.5f * jerk_share) * to;
    const float rising_A = supply_share * supplied(application, rising_to).accelerating_A;

    return axis_lesser(acceleration_of(application, rising_A),
                       axis_motion_acceleration_limit(application, to > from ? to : from));
}

float axis_motion_torque_Nm(const struct application *application, float thousandths)
{
    const struct motor_params *motor = &application->drive.settings.motor;

    return 1e-3f * thousandths * (float)motor->rated_current_A * (float)motor->torque_constant_Nm_A;
}

float axis_motion_limited(struct application *application, float value, float least, float most)
{
    if (value >= least && value <= most) {
        return value;
    }
    motion_of(application)->limited = true;
    return value < least ? least : most;
}

static float units(const struct application *application)
{
    return (float)cia402_unit_rad(&application->link->objects);
}

/* What a default is a multiple of: hundredths of what the motor can and of a turn, units of the
   unit's own default. */
enum default_base { SPEED_rpm, SPEED, NO_LOAD_SPEED, ACCELERATION, TURN, UNIT };

#define DEFAULT(member, base, multiple)                                                            \
    {                                                                                              \
        (uint8_t) offsetof(struct link_objects, member), base, multiple                            \
    }

_Static_assert(sizeof(struct link_objects) <= UINT8_MAX, "an offset is a byte");

/* As the console's moves (default_move.h). */
static const struct {
    uint8_t at;
    uint8_t base; /* enum default_base */
    uint16_t multiple;
} defaults[] = {
    DEFAULT(max_speed_rpm, SPEED_rpm, 100),
    DEFAULT(profile_velocity, SPEED, 25),
    DEFAULT(profile_acceleration, ACCELERATION, 25),
    DEFAULT(profile_deceleration, ACCELERATION, 25),
    DEFAULT(quick_stop_deceleration, ACCELERATION, 50),
    DEFAULT(homing_speed, NO_LOAD_SPEED, 4),
    DEFAULT(homing_zero_speed, NO_LOAD_SPEED, 4),
    DEFAULT(homing_acceleration, ACCELERATION, 25),
    DEFAULT(homing_travel, TURN, 1000),
    DEFAULT(following_window, UNIT, 2048),
    DEFAULT(target_window, UNIT, 100),
};

enum { AXIS_DEFAULTS = sizeof defaults / sizeof defaults[0] };

/* A whole number of units, one at least. */
static uint32_t whole_units(float value)
{
    return value < 1.0f ? 1u : value < 4e9f ? (uint32_t)value : 4000000000u;
}

void axis_motion_put_defaults(struct application *application)
{
    struct link *link = application->link;
    const float unit_rad = units(application);
    const struct drive *drive = &application->drive;
    const float speed = 0.01f * axis_motion_speed_limit(application);
    const float bases[] = {
        [SPEED_rpm] = speed / AXIS_RAD_S_PER_RPM,
        [SPEED] = speed / unit_rad,
        [NO_LOAD_SPEED] =
            9.99e-3f * (float)no_load_speed_rad_s(&drive->settings, drive->board->facts) / unit_rad,
        [ACCELERATION] = 0.01f * axis_motion_acceleration_limit(application, 0.0f) / unit_rad,
        [TURN] = 0.062831853f / unit_rad,
        [UNIT] = 6.2831853f / 65536.0f / unit_rad,
    };

    for (size_t i = 0; i < AXIS_DEFAULTS; i++) {
        uint32_t *value = (void *)((uint8_t *)&link->objects + defaults[i].at);

        if ((link->given >> i & 1u) == 0u) {
            *value = whole_units((float)defaults[i].multiple * bases[defaults[i].base]);
        }
    }
}

void axis_motion_note_given(struct application *application, uint16_t at)
{
    for (size_t i = 0; i < AXIS_DEFAULTS; i++) {
        if (defaults[i].at == at) {
            application->link->given |= (uint16_t)(1u << i);
        }
    }
}

/* A steeper ramp ends as quickly as it began: by the jerk of a gentler one the speed would go on
   rising. */
static float jerk_to_end(struct axis_motion *motion, float jerk)
{
    const uint8_t steady_ms = 3; /* a command that begins takes less */

    if (motion->steady_ms >= steady_ms || motion->jerk < jerk) {
        motion->jerk = jerk;
    }
    motion->steady_ms = 0;
    return motion->jerk;
}

bool axis_motion_post(struct application *application, enum drive_command_kind kind,
                      double position_rad, float speed_rad_s, uint32_t acceleration_units)
{
    const float present = (float)cia402_signals(application)->omega_ref_rad_s;
    const float acceleration =
        axis_motion_limited(application, units(application) * (float)acceleration_units, 1e-3f,
                            axis_motion_ramp_limit(application, present, speed_rad_s));
    const float jerk_s = jerk_share * axis_size(speed_rad_s) / acceleration;
    const float jerk = jerk_to_end(motion_of(application),
                                   acceleration / (jerk_s > jerk_min_s ? jerk_s : jerk_min_s));
    motion_of(application)->acceleration = acceleration;
    struct drive_command command = {
        .kind = kind,
        .position_rad = position_rad,
        .speed_rad_s = (double)speed_rad_s,
        .acceleration_rad_s2 = (double)acceleration,
        .jerk_rad_s3 = (double)jerk,
    };

    return cia402_command(application, &command);
}

float axis_motion_speed(struct application *application, uint32_t speed_units)
{
    return axis_motion_limited(application, units(application) * (float)speed_units, 1e-6f,
                               axis_motion_speed_limit(application));
}

void axis_motion_brake(struct application *application, bool quickly)
{
    const struct link_objects *objects = &application->link->objects;
    const uint32_t deceleration =
        quickly ? objects->quick_stop_deceleration : objects->profile_deceleration;
    struct drive_command stop = {.kind = DRIVE_COMMAND_STOP};

    motion_of(application)->speed_rad_s = 0.0f;
    motion_of(application)->at_limit = false;
    motion_of(application)->homing.phase = HOMING_ENDED;
    if (moves(&application->drive) &&
        !axis_motion_post(application, DRIVE_COMMAND_VELOCITY, 0.0, 0.0f, deceleration)) {
        (void)cia402_command(application, &stop);
    }
    motion_of(application)->brakes = deceleration;
}

/* The supply drives the more, the slower it has become: by a quarter, the stop gets steeper. */
void axis_motion_brake_on(struct application *application)
{
    struct axis_motion *motion = motion_of(application);
    const uint32_t brakes = motion->brakes;

    if (brakes == 0u || command_queue_holds_any(&application->drive.commands)) {
        return;
    }
    if (!interrupt_view_moves(&application->drive)) {
        motion->brakes = 0;
        return;
    }
    const float present = (float)cia402_signals(application)->omega_ref_rad_s;
    const float deceleration = axis_lesser(units(application) * (float)brakes,
                                           axis_motion_acceleration_limit(application, present));

    if (deceleration > 1.25f * motion->acceleration) {
        (void)axis_motion_post(application, DRIVE_COMMAND_VELOCITY, 0.0, 0.0f, brakes);
        motion->brakes = brakes;
    }
}

void axis_motion_start(struct application *application)
{
    struct link *link = application->link;

    link->axis.mode = link->objects.mode;
    *motion_of(application) = (struct axis_motion){
        .target_rad = cia402_signals(application)->theta_ref_rad,
        .reached = true,
        .halted = (link->axis.controlword & HALT) != 0u,
    };
    motion_of(application)->begun_rad = motion_of(application)->target_rad;
    link->axis.stream.last_rad = motion_of(application)->target_rad;
    link->axis.stream.before_rad = motion_of(application)->target_rad;
    link->axis.stream.by_sync = false;
}

void axis_motion_end_at_switch(struct application *application, bool up)
{
    struct axis_motion *motion = motion_of(application);

    motion->not_homed = motion->not_homed || motion->homing.phase != HOMING_ENDED;
    motion->limited = true;
    motion->waits = false;
    motion->pending = false;
    axis_motion_brake(application, true);
    motion->barred = up ? 1 : -1;
}

bool axis_motion_is_barred(struct application *application, float way)
{
    struct axis_motion *motion = motion_of(application);

    if ((float)motion->barred * way < 0.0f) {
        motion->barred = 0;
    }
    motion->limited = motion->limited || motion->barred != 0;
    return motion->barred != 0;
}

/* ---- profile position ---- */

double axis_motion_target(struct application *application)
{
    const struct link *link = application->link;
    struct axis_motion *motion = motion_of(application);
    const bool relative =
        link->axis.mode == CIA402_PROFILE_POSITION && (link->axis.controlword & RELATIVE) != 0u;
    const double unit_rad = cia402_turned_unit_rad(&link->objects, CIA402_POSITION_TURNED);
    const double asked = (double)link->objects.target_position;
    const double reference = cia402_signals(application)->theta_ref_rad / unit_rad;
    const int32_t least = link->objects.position_least, most = link->objects.position_most;
    double target = asked;

    if (relative) {
        target += motion->target_rad / unit_rad;
    } else if (link->axis.mode == CIA402_PROFILE_POSITION) {
        target += cia402_wraps(reference);
    } else if (least == INT32_MIN || most == INT32_MAX) { /* the nearest one */
        target += cia402_wraps(reference - asked);
    }
    if (target < (double)least && least != INT32_MIN) {
        motion->limited = true;
        target = (double)least;
    } else if (target > (double)most && most != INT32_MAX) {
        motion->limited = true;
        target = (double)most;
    }
    return unit_rad * target;
}

static struct axis_profile profile_now(const struct application *application)
{
    const struct link_objects *objects = &application->link->objects;

    return (struct axis_profile){.speed = objects->profile_velocity,
                                 .acceleration =
                                     objects->profile_deceleration < objects->profile_acceleration
                                         ? objects->profile_deceleration
                                         : objects->profile_acceleration};
}

static void take_set_point(struct application *application)
{
    struct axis_motion *motion = motion_of(application);

    if (motion->waits && (application->link->axis.controlword & AT_ONCE) == 0u) {
        return; /* one is acknowledged already */
    }
    if (motion->waits) {
        motion->target_rad = motion->begun_rad; /* a relative one goes on from there */
    }
    motion->limited = false;
    motion->barred = 0;
    motion->target_rad = axis_motion_target(application);
    motion->waiting = profile_now(application);
    motion->waits = true;
    motion->at_once = (application->link->axis.controlword & AT_ONCE) != 0u;
    motion->acknowledged = true;
    motion->reached = false;
    motion->in_window_ms = 0;
}

static void go(struct application *application, double position_rad, struct axis_profile profile)
{
    struct axis_motion *motion = motion_of(application);
    const float speed = axis_motion_speed(application, profile.speed);

    motion->limited = !axis_motion_post(application, DRIVE_COMMAND_RETARGET, position_rad, speed,
                                        profile.acceleration) ||
                      motion->limited;
}

void axis_motion_go(struct application *application, double position_rad)
{
    go(application, position_rad, profile_now(application));
}

/* A set-point begins when the one before has ended, or at once. A halt ends none. */
static void go_to_target(struct application *application)
{
    struct axis_motion *motion = motion_of(application);
    const bool ended = !motion->pending && (motion->halted || axis_motion_rests(application));

    if (motion->waits && (motion->at_once || ended)) {
        motion->waits = false;
        motion->begun_rad = motion->target_rad;
        motion->begun = motion->waiting;
        motion->pending = true;
    }
    if (motion->pending && !motion->halted) {
        motion->pending = false;
        go(application, motion->begun_rad, motion->begun);
    }
}

/* ---- profile velocity ---- */

/* What reverses does, too. */
static bool slows(float before, float speed)
{
    return before > 0.0f ? speed < before : speed > before && before < 0.0f;
}

/* The limits' presets are none. */
double axis_motion_limit_rad(const struct application *application, float way)
{
    const struct link_objects *objects = &application->link->objects;
    const double unit_rad = cia402_turned_unit_rad(objects, CIA402_POSITION_TURNED);
    const bool up = (way > 0.0f) == (unit_rad > 0.0);
    const int32_t end = up ? objects->position_most : objects->position_least;

    if (end == (up ? INT32_MAX : INT32_MIN)) {
        return way > 0.0f ? 1e9 : -1e9;
    }
    return unit_rad * (double)end;
}

/* How far the reference may go on in the direction of a speed, rad. */
static float room_rad(struct application *application, float speed, double *end_rad)
{
    *end_rad = axis_motion_limit_rad(application, speed);
    const float room = (float)(*end_rad - cia402_signals(application)->theta_ref_rad);

    return speed > 0.0f ? room : -room;
}

/* More than it takes from a speed to rest, rad: a ramp still ends before, and commands take time.
 */
static float stopping_rad(struct application *application, float speed, uint32_t deceleration_units)
{
    const float command_s = 0.01f;
    const float acceleration = axis_lesser(units(application) * (float)deceleration_units,
                                           axis_motion_acceleration_limit(application, speed));
    const float ramp_s = speed / acceleration;

    return speed * (0.5f * ramp_s + 1.5f * (jerk_share * ramp_s + jerk_min_s) + command_s);
}

bool axis_motion_nears_limit(struct application *application, float speed_rad_s, float way)
{
    double end_rad;

    return room_rad(application, way, &end_rad) <=
           stopping_rad(application, axis_size(speed_rad_s),
                        application->link->objects.quick_stop_deceleration);
}

/* Where a software limit is near, the motion ends there, as one to a position does; beyond it
   `speed` becomes 0. true: nothing else is to be commanded. */
static bool ends_at_limit(struct application *application, float *speed)
{
    struct axis_motion *motion = motion_of(application);
    double limit_rad;
    const float asked = axis_size(*speed);
    const float present = axis_size((float)cia402_signals(application)->omega_ref_rad_s);
    const float most = asked > present ? asked : present;
    const float room = room_rad(application, *speed, &limit_rad);

    if (*speed == 0.0f ||
        room > stopping_rad(application, most, application->link->objects.profile_deceleration)) {
        return false;
    }
    motion->limited = true;
    if (motion->at_limit && motion->target_rad == limit_rad) {
        return true;
    }
    if (room <= 0.0f) {
        *speed = 0.0f;
        return false;
    }
    if (!command_queue_holds_any(&application->drive.commands) &&
        axis_motion_post(application, DRIVE_COMMAND_RETARGET, limit_rad,
                         0.98f * most, /* a plan at its own limit is a soft one */
                         application->link->objects.profile_deceleration)) {
        motion->at_limit = true;
        motion->target_rad = limit_rad;
        motion->speed_rad_s = *speed;
    }
    return true;
}

static void go_at_speed(struct application *application)
{
    const struct link_objects *objects = &application->link->objects;
    struct axis_motion *motion = motion_of(application);
    const float most = axis_motion_speed_limit(application);
    const float before = motion->speed_rad_s;
    float speed = 0.0f;

    motion->limited = false;
    if (!motion->halted) {
        speed = axis_motion_limited(application,
                                    (float)cia402_turned_unit_rad(objects, CIA402_VELOCITY_TURNED) *
                                        (float)objects->target_velocity,
                                    -most, most);
    }
    if (objects->target_velocity == 0) {
        motion->barred = 0;
    }
    if (axis_motion_is_barred(application, speed)) {
        speed = 0.0f;
    }
    if (ends_at_limit(application, &speed)) {
        return;
    }
    if ((speed != motion->speed_rad_s || motion->at_limit) &&
        !command_queue_holds_any(&application->drive.commands)) {
        if (axis_motion_post(application, DRIVE_COMMAND_VELOCITY, 0.0, speed,
                             slows(before, speed) ? objects->profile_deceleration
                                                  : objects->profile_acceleration)) {
            motion->speed_rad_s = speed;
            motion->at_limit = false;
        } else {
            motion->limited = true;
        }
    }
}

/* ---- all ---- */

static void halt(struct application *application, bool quickly)
{
    struct axis_motion *motion = motion_of(application);

    motion->pending = motion->pending || (motion->barred == 0 && !axis_motion_rests(application));
    motion->halted = true;
    axis_motion_brake(application, quickly);
}

void axis_motion_control(struct application *application, uint16_t risen)
{
    struct cia402 *axis = &application->link->axis;
    struct axis_motion *motion = &axis->motion;
    const bool halted = (axis->controlword & HALT) != 0u;

    if (halted && !motion->halted) {
        halt(application, application->link->objects.halt_option == QUICKLY);
    }
    motion->halted = halted;
    if ((risen & NEW_SET_POINT) != 0u && axis->mode == CIA402_PROFILE_POSITION) {
        take_set_point(application);
    } else if ((risen & START_HOMING) != 0u && axis->mode == CIA402_HOMING) {
        if (halted) {
            motion->homed = false;
        } else {
            axis_homing_start(application);
        }
    }
}

/* A mode begins at rest. */
static bool changes_mode(struct application *application)
{
    struct link *link = application->link;

    if (link->objects.mode == link->axis.mode) { /* begun, or asked for again */
        motion_of(application)->halted = (link->axis.controlword & HALT) != 0u;
        return false;
    }
    if (axis_motion_rests(application)) {
        axis_motion_start(application);
    } else if (!motion_of(application)->halted) {
        halt(application, false);
    }
    return true;
}

void axis_motion_background(struct application *application)
{
    struct cia402 *axis = &application->link->axis;

    if (changes_mode(application)) {
        return;
    }
    if (axis->mode == CIA402_PROFILE_POSITION) {
        go_to_target(application);
        axis->motion.acknowledged =
            axis->motion.waits ||
            (axis->motion.acknowledged && (axis->controlword & NEW_SET_POINT) != 0u);
    } else if (axis->mode == CIA402_PROFILE_VELOCITY) {
        go_at_speed(application);
    } else if (axis->mode == CIA402_CYCLIC_POSITION) {
        axis_stream_background(application);
    } else if (axis->mode == CIA402_CYCLIC_TORQUE) {
        axis_torque_background(application);
    }
}

void axis_motion_cycle(struct application *application)
{
    const struct cia402 *axis = &application->link->axis;

    if (axis->state == CIA402_OPERATION_ENABLED && axis->mode == CIA402_CYCLIC_POSITION) {
        axis_stream_take(application);
    }
}

/* Milliseconds in a row, up to `most`. */
static bool lasts(uint16_t *ms, bool so, uint16_t most)
{
    *ms = (uint16_t)(so ? *ms + (*ms < most ? 1u : 0u) : 0u);
    return so && *ms >= most;
}

void axis_motion_look(struct application *application)
{
    const struct link *link = application->link;
    struct axis_motion *motion = motion_of(application);
    const struct drive_signals *now = cia402_signals(application);
    const float unit_rad = units(application);
    const float speed = (float)now->omega_ref_rad_s;
    const float off_rad = axis_size((float)(now->theta_ref_rad - now->theta_est_rad));
    const float away_rad = axis_size((float)(motion->target_rad - now->theta_est_rad));
    const bool there = !motion->waits && axis_motion_rests(application) &&
                       away_rad <= unit_rad * (float)link->objects.target_window;

    motion->steady_ms = (uint8_t)(speed != motion->reference_rad_s ? 0
                                  : motion->steady_ms < UINT8_MAX  ? motion->steady_ms + 1
                                                                   : UINT8_MAX);
    motion->reference_rad_s = speed;
    if (link->axis.mode == CIA402_HOMING) {
        axis_homing_look(application);
    }
    motion->reached = lasts(&motion->in_window_ms, there, link->objects.target_ms);
    motion->off = lasts(&motion->off_ms, off_rad > unit_rad * (float)link->objects.following_window,
                        link->objects.following_ms);
}

/* At the speed that was asked for, by the reference. */
static bool at_speed(struct application *application)
{
    const struct axis_motion *motion = motion_of(application);
    const float off = (float)cia402_signals(application)->omega_ref_rad_s - motion->speed_rad_s;
    const float least = 1e-5f + 1e-3f * axis_size(motion->speed_rad_s);

    return axis_size(off) <= least && !command_queue_holds_any(&application->drive.commands);
}

uint16_t axis_motion_status(struct application *application)
{
    const struct cia402 *axis = &application->link->axis;
    const struct axis_motion *motion = &axis->motion;
    const bool rests = axis_motion_rests(application);
    bool reached = motion->halted ? rests : motion->reached;
    bool of_mode = motion->acknowledged;
    bool off = motion->off;

    if (axis->mode == CIA402_PROFILE_VELOCITY) {
        reached = at_speed(application);
        of_mode = rests;
        off = false;
    } else if (axis->mode == CIA402_HOMING) {
        reached = motion->homing.phase == HOMING_ENDED && rests;
        of_mode = motion->homed && rests;
        off = motion->not_homed;
    } else if (axis->mode == CIA402_CYCLIC_POSITION) {
        of_mode = !motion->halted && axis_stream_follows(&axis->stream);
    } else if (axis->mode == CIA402_CYCLIC_TORQUE) {
        reached = motion->halted && rests;
        of_mode = interrupt_view_torque(&application->drive);
        off = false;
    }
    return (uint16_t)((reached ? REACHED : 0u) | (motion->limited ? LIMITED : 0u) |
                      (of_mode ? OF_MODE : 0u) | (off ? OFF : 0u));
}
