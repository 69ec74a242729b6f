/*
 * The drive profile, CiA 402 (IEC 61800-7-201): its state machine on the drive's own, and the modes
 * profile position (1), profile velocity (3), homing (6), cyclic
 * synchronous position (8) and, with an encoder, torque (10), on the drive's own commands
 * (axis_motion.c).
 *
 * Where enabling belongs: "switch on" begins it, SWITCHED ON shows once the bridge is on, and
 * OPERATION ENABLED, if that was asked for, when the drive is ready, 0.35 to 0.45 s behind "switch
 * on" without an encoder. From SWITCHED ON on the rotor is held, and drawn in before.
 */
#ifndef STEADYSTEP_CIA402_H
#define STEADYSTEP_CIA402_H

#include "firmware/interface/drive_interface.h"
#include "firmware/link/axis_homing.h"
#include "firmware/link/axis_stream.h"
#include "firmware/link/objects.h"

/* By their bits of the statusword. */
enum cia402_state {
    CIA402_SWITCH_ON_DISABLED = 0x40,
    CIA402_READY_TO_SWITCH_ON = 0x21,
    CIA402_SWITCHED_ON = 0x23,
    CIA402_OPERATION_ENABLED = 0x27,
    CIA402_QUICK_STOP_ACTIVE = 0x07,
    CIA402_FAULT = 0x08
};

enum cia402_mode {
    CIA402_PROFILE_POSITION = 1,
    CIA402_PROFILE_VELOCITY = 3,
    CIA402_HOMING = 6,
    CIA402_CYCLIC_POSITION = 8,
    CIA402_CYCLIC_TORQUE = 10
};

struct application;

/* Of a set-point as it came, in units: 6081h, and for both ends the lesser of 6083h and 6084h. */
struct axis_profile {
    uint32_t speed, acceleration;
};

/* What the motion of a mode goes by: axis_motion.c. */
struct axis_motion {
    struct axis_homing homing;
    double target_rad;                  /* of the last set-point */
    double begun_rad;                   /* of the one that has begun last */
    struct axis_profile waiting, begun; /* theirs */
    float speed_rad_s;                  /* as commanded last, of profile velocity */
    float reference_rad_s;              /* a millisecond ago */
    float jerk;                         /* of what is in motion */
    float way;                          /* by its sign to the limit at which a torque has ended */
    uint32_t max_speed_rpm;             /* of the torque commanded last */
    uint32_t brakes;    /* deceleration in units of the stop that is under way; 0: of none */
    float acceleration; /* of the command posted last, rad/s^2 */
    int16_t target;     /* that, in thousandths */
    uint16_t in_window_ms, off_ms;
    int8_t barred;     /* the way on which a limit switch has ended the motion: 1 up, -1 down */
    uint8_t steady_ms; /* for so long the reference's speed has been constant */
    bool waits;        /* a set-point has not begun */
    bool at_once;      /* it preempts what is in motion */
    bool pending;      /* the one that has begun is to be gone to, when no halt is */
    bool acknowledged; /* bit 12 of profile position */
    bool reached;
    bool limited; /* a limit has cut what was asked for */
    bool off;     /* beyond the following error window */
    bool homed;
    bool not_homed; /* refused, or nothing was found */
    bool halted;
    bool at_limit; /* of profile velocity and torque: goes to a software limit, or is there */
};

struct cia402 {
    uint16_t controlword;
    uint8_t state;       /* enum cia402_state */
    int8_t mode;         /* in force */
    bool asked;          /* enabling has begun on behalf of "switch on" */
    bool refused;        /* by the drive; until the controlword changes */
    bool lost;           /* the connection: off as soon as the reference rests */
    uint32_t moved_in;   /* period in which the reference has moved last */
    uint32_t signals_in; /* period of `signals` */
    struct axis_motion motion;
    struct axis_stream stream;
    struct drive_signals signals;
};

/* The channel opens: as the drive is. */
void cia402_start(struct application *application);

/* A controlword has come. */
void cia402_control(struct application *application, uint16_t word);

/* Background, all the time; once in a millisecond. */
void cia402_background(struct application *application);
void cia402_look(struct application *application);

/* Whoever commands the drive is heard no more: stops, then switches off. */
void cia402_lose(struct application *application);

/* A node that is reset: stops, then switches off; a fault ends. */
void cia402_switch_off(struct application *application);

/* The objects of CiA 402 that code answers for. */
void cia402_ask(struct application *application, const struct object *object, uint8_t *value);

/* What the drive shows in the present period. */
const struct drive_signals *cia402_signals(struct application *application);

/* A position unit of the factor group in rad of the motor, without a sign. */
double cia402_unit_rad(const struct link_objects *objects);

/* 6072h and 6074h: the largest torque and the demand, in thousandths of the rated one. */
int32_t cia402_thousandths(struct application *application, uint16_t index);

/* Bits of 607eh: what is counted against the motor's own direction. */
enum { CIA402_POSITION_TURNED = 0x80, CIA402_VELOCITY_TURNED = 0x40 };

/* Positions of 32 bits wrap: what of so many units is a multiple of 2^32, the nearest one. */
double cia402_wraps(double units);

/* A unit of either in rad of the motor, negative where it is turned. */
double cia402_turned_unit_rad(const struct link_objects *objects, uint8_t turned);

/* Asks the drive for a command at once. false: refused. */
bool cia402_command(struct application *application, struct drive_command *command);

#endif
