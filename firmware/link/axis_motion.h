/* The modes of CiA 402, in state OPERATION ENABLED, as commands of the drive. */
#ifndef STEADYSTEP_AXIS_MOTION_H
#define STEADYSTEP_AXIS_MOTION_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/interface/drive_interface.h"

struct application;

static inline float axis_size(float value)
{
    return value < 0.0f ? -value : value;
}

static inline float axis_lesser(float a, float b)
{
    return a < b ? a : b;
}

/* What has been given none has a share of what the motor can, in the units of the factor group. */
void axis_motion_put_defaults(struct application *application);

/* The member of struct link_objects with this offset has been given a value. */
void axis_motion_note_given(struct application *application, uint16_t at);

/* OPERATION ENABLED begins. */
void axis_motion_start(struct application *application);

/* Bits of the controlword that have risen. */
void axis_motion_control(struct application *application, uint16_t risen);

/* Background, all the time; once in a millisecond: windows. */
void axis_motion_background(struct application *application);
void axis_motion_look(struct application *application);

/* To rest, with the quick stop's deceleration or the profile's. */
void axis_motion_brake(struct application *application, bool quickly);

/* Background, once in a millisecond, in whatever state: a stop goes on. */
void axis_motion_brake_on(struct application *application);

/* With the profile's speed and acceleration. */
void axis_motion_go(struct application *application, double position_rad);

/* A target position has come: of cyclic synchronous position. */
void axis_motion_cycle(struct application *application);

/* The target position in rad, within the software limits. */
double axis_motion_target(struct application *application);

/* What the drive can, and 6080h allows, rad/s. */
float axis_motion_speed_limit(const struct application *application);

/* What the current limit and, at a speed, the supply leave, rad/s^2: to brake from there. */
float axis_motion_acceleration_limit(const struct application *application, float speed_rad_s);

/* Of a ramp from a speed to another one: what it takes at its end and to brake. */
float axis_motion_ramp_limit(const struct application *application, float from_rad_s,
                             float to_rad_s);

/* That current in thousandths of the rated one: a torque that brakes is no larger. */
int32_t axis_motion_braking_thousandths(const struct application *application, float speed_rad_s);

/* Whether nothing is in operation nor in motion: units and directions may change. */
bool axis_motion_is_free(const struct application *application);

/* A limit switch on the way of the motion, up or down of the motor: to rest, and from then on no
   further that way until something else is asked for. */
void axis_motion_end_at_switch(struct application *application, bool up);

/* Whether a switch has ended the motion on this way, by its sign; another way is free again. */
bool axis_motion_is_barred(struct application *application, float way);

/* Of thousandths of the rated torque. */
float axis_motion_torque_Nm(const struct application *application, float thousandths);

/* Cut to limits, which shows in the statusword. */
float axis_motion_limited(struct application *application, float value, float least, float most);

/* A speed in units as rad/s, cut to what the drive can. */
float axis_motion_speed(struct application *application, uint32_t speed_units);

/* Posts a command that goes to `speed_rad_s`, with jerk; false: the drive refuses it. */
bool axis_motion_post(struct application *application, enum drive_command_kind kind,
                      double position_rad, float speed_rad_s, uint32_t acceleration_units);

/* The software limit on this way, up or down of the motor by its sign; of none beyond all. */
double axis_motion_limit_rad(const struct application *application, float way);

/* Whether a software limit on this way, up or down by its sign, is no further than what it takes to
   stop from the speed with 6085h. */
bool axis_motion_nears_limit(struct application *application, float speed_rad_s, float way);

/* Whether the reference rests and nothing waits. */
bool axis_motion_rests(const struct application *application);

/* Bits 10 to 13 of the statusword. */
uint16_t axis_motion_status(struct application *application);

#endif
