/*
 * Electrical angles and positions.
 *
 * An angle is a 32-bit binary fraction of an electrical turn: it wraps as angles do, with a
 * resolution of 1.5e-9 rad. A position is whole electrical turns plus such a fraction, so that no
 * resolution is lost after a million turns. Both are integers in every number format.
 */
#ifndef STEADYSTEP_ANGLE_H
#define STEADYSTEP_ANGLE_H

#include <stdint.h>

#include "firmware/numeric/num.h"

typedef uint32_t angle_t; /* 2^32 is one electrical turn */

struct position {
    int32_t turns;    /* whole electrical turns, towards minus infinity */
    angle_t fraction; /* rest, 0...1 turn */
};

/* Largest difference of positions that position_difference distinguishes, electrical turns. */
#define POSITION_DIFFERENCE_MAX 15.0

/* Both parts as one number, in 2^-32 turn; wraps as the turns do. */
static inline uint64_t angle_of_position(struct position p)
{
    return ((uint64_t)(uint32_t)p.turns << 32) | p.fraction;
}

static inline struct position position_of_angle(uint64_t angle)
{
    return (struct position){(int32_t)(uint32_t)(angle >> 32), (angle_t)angle};
}

/* Between coordinates whose zeros are `offset` apart; goes round as the turns do. */
static inline struct position position_plus(struct position p, struct position offset)
{
    return position_of_angle(angle_of_position(p) + angle_of_position(offset));
}

static inline struct position position_minus(struct position p, struct position offset)
{
    return position_of_angle(angle_of_position(p) - angle_of_position(offset));
}

/* Adds a signed angle of less than half a turn, in 2^-32 turn. */
static inline struct position position_add(struct position p, int32_t angle)
{
    return position_of_angle(angle_of_position(p) + (uint64_t)(int64_t)angle);
}

/* Of a way in 2^-32 turn, exact; the shorter one around 2^32 turns, where positions go round. */
static inline int64_t position_distance(struct position from, struct position to)
{
    return (int64_t)(angle_of_position(to) - angle_of_position(from));
}

/* a - b in electrical turns, saturated at +-POSITION_DIFFERENCE_MAX. */
static inline num_t position_difference(struct position a, struct position b)
{
    const int32_t limit = (int32_t)POSITION_DIFFERENCE_MAX;
    int64_t difference = position_distance(b, a);
    const int32_t whole = (int32_t)(difference >> 32);

    /* One comparison: what is below -limit wraps to a large number. */
    if (RARE((uint32_t)whole + (uint32_t)limit >= 2u * (uint32_t)limit)) {
        difference = (whole < 0 ? -(int64_t)limit : (int64_t)limit) * ((int64_t)1 << 32);
    }
#if STEADYSTEP_NUM == NUM_FIXED
    return (num_t)(difference >> (32 - NUM_FRACTION_BITS));
#elif STEADYSTEP_NUM == NUM_FLOAT
    /* 2^-27 turn; a 32-bit number, because a 64-bit conversion is a library call on the M4F. */
    return (num_t)(int32_t)(difference >> 5) * NUM(1.0 / 134217728.0);
#else
    return (num_t)difference * NUM(1.0 / 4294967296.0);
#endif
}

/* Signed angle of less than half a turn, in electrical turns. */
static inline num_t turns_from_angle(int32_t angle)
{
#if STEADYSTEP_NUM == NUM_FIXED
    return angle >> (32 - NUM_FRACTION_BITS);
#else
    return num_from_2_32(angle);
#endif
}

/* Electrical turns to an angle. In fixed point the caller vouches for less than half a turn. */
static inline int32_t angle_from_turns(num_t turns)
{
#if STEADYSTEP_NUM == NUM_FIXED
    return num_shift_left(turns, 32 - NUM_FRACTION_BITS);
#else
    return num_to_2_32(turns);
#endif
}

/* The same for any number, limited to half a turn. */
static inline int32_t angle_from_any_turns(num_t turns)
{
#if STEADYSTEP_NUM == NUM_FIXED
    turns = num_limit(turns, NUM(0.499));
#endif
    return angle_from_turns(turns);
}

/* Start-up and telemetry only. Mechanical rad, |rad| < 2^31 electrical turns. */
__attribute__((cold)) struct position position_from_rad(double rad, int32_t rotor_teeth);
__attribute__((cold)) double position_to_rad(struct position p, int32_t rotor_teeth);

#endif
