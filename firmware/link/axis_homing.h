/*
 * Homing, mode 6. Methods 35 and 37: the axis is at 607ch where it stands. Methods 33 and 34: it
 * goes down, or up, until the encoder's index passes. There is 607ch, and the rotor comes to rest
 * there. The place is one edge of the index, whichever the direction: the one that rises upwards
 * and falls downwards, at the count that hardware has kept. It is looked for from a full step on,
 * and for 9/8 of a turn in all; then there is none, a homing error. Methods 17 to 30: it looks for
 * a switch, axis_homing_switch.h. Methods -1 and -2: it goes down, or up, until a hard stop bears
 * it, axis_homing_stop.h.
 */
#ifndef STEADYSTEP_AXIS_HOMING_H
#define STEADYSTEP_AXIS_HOMING_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/interface/drive_interface.h"

struct application;

enum homing_phase {
    HOMING_ENDED,        /* or not begun */
    HOMING_SETS_OUT,     /* for the index */
    HOMING_AWAITS_INDEX, /* to pass */
    HOMING_SEEKS_SWITCH,
    HOMING_LEAVES_SWITCH,
    HOMING_CROSSES_SWITCH, /* at the edge that it homes on */
    HOMING_SEEKS_STOP,
    HOMING_CATCHES,   /* a rotor that the stop may have thrown */
    HOMING_BACKS_OFF, /* from the stop */
    HOMING_SETTLES
};

struct axis_homing {
    double began_rad; /* of the reference: the search */
    double edge_rad;  /* of the index or the switch */
    /* In full steps on the way from where the search began: */
    float from;     /* of the reference: this approach to the stop */
    float led_from; /* of the reference, as the load began to grow */
    float free;     /* of the rotor, likewise */
    float furthest; /* of the rotor, before that, in this approach */
    float place;    /* the stop as far as it is known */

    float way;        /* 1 up, -1 down, of the motor */
    uint16_t ms;      /* for which the reference rests, or the load has grown */
    uint8_t phase;    /* enum homing_phase */
    uint8_t failures; /* approaches that have not found the stop */
    uint8_t touches;  /* that have, in a row and at one place */
    bool doubtful;    /* the synchronism, as the load began to grow */
    bool on_stop;
    bool comes_on; /* the switch, where that is crossed */
    bool turned;   /* at a limit switch */
    /* Under way to the edge: what has been left beyond its other end while it still went on the old
       way is come back to first. */
    bool before_edge;
    uint8_t input; /* the switch, HAL_INPUT_... */
    float crosses; /* the way on which it is crossed, 1 or -1 */
};

/* Whether 6098h may have this value. */
bool axis_homing_is_method(int8_t method);

/* How many of those in 60e3h the drive has: those on an index are its last two. */
uint8_t axis_homing_methods(const struct application *application);

/* One of these, from 1 on. */
int8_t axis_homing_method(uint8_t number);

/* Begins by 6098h. */
void axis_homing_start(struct application *application);

/* Background, once in a millisecond, in the mode. */
void axis_homing_look(struct application *application);

/* Whether it is about a hard stop, which may throw the rotor. */
bool axis_homing_seeks_stop(const struct axis_homing *homing);

/* Whether it looks for a switch: a limit switch is one, or turns it. */
bool axis_homing_seeks_switch(const struct axis_homing *homing);

/* ---- for its ways ---- */

__attribute__((noinline)) float axis_homing_full_step_rad(const struct application *application);

void axis_homing_enter(struct application *application, enum homing_phase phase);

/* Posts this command, with a speed in rad/s and an acceleration in units, or gives up. */
void axis_homing_go(struct application *application, enum drive_command_kind kind,
                    double position_rad, float speed_rad_s, uint32_t acceleration);

/* Whether the reference has rested for so long. */
bool axis_homing_has_rested(struct application *application, uint16_t ms);

/* At rest: that place, rad, is 607ch. */
void axis_homing_end(struct application *application, double place_rad);

/* To rest, with a homing error. */
void axis_homing_give_up(struct application *application);

#endif
