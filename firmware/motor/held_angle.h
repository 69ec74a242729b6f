/*
 * The angle of a hold that leads its rotor from place to place while the drive is enabled.
 *
 * Its speed rises and falls evenly, from rest to an eighth of an electrical turn per swing of the
 * held rotor within one swing, 2 pi / sqrt(N Km i / J): that excites no other swing.
 */
#ifndef STEADYSTEP_HELD_ANGLE_H
#define STEADYSTEP_HELD_ANGLE_H

#include <stdbool.h>

#include "firmware/numeric/angle.h"

struct held_angle_params {
    uint32_t swing;       /* periods of one, undamped */
    int32_t speed;        /* the largest, per period */
    int32_t acceleration; /* per period */
};

struct held_angle {
    int32_t offset; /* from where the rotor is to stand in the end, -1/2...1/2 turn */
    int32_t target;
    int32_t speed;    /* magnitude, per period */
    int32_t stopping; /* distance in which it comes to rest */
    int32_t moved;    /* in this period */
};

/* `swing_periods`: cut to 8...1e6. */
struct held_angle_params held_angle_design(double swing_periods);

/* Where it stands it is to stand in the end. */
void held_angle_start(struct held_angle *angle);

/* From rest. */
void held_angle_lead_to(struct held_angle *angle, int32_t target);

/* One period towards the target; true: it is there. */
bool held_angle_step(struct held_angle *angle, const struct held_angle_params *params);

/* In electrical turns per period. */
static inline num_t held_angle_turned(const struct held_angle *angle)
{
    return turns_from_angle(angle->moved);
}

#endif
