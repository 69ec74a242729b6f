/*
 * Quadrature counts to an electrical position, without rounding that adds up: a count is kept in
 * 2^-64 electrical turn, so a million turns of 50 teeth and 2^30 counts lose 10^-8 turn.
 */
#ifndef STEADYSTEP_ENCODER_H
#define STEADYSTEP_ENCODER_H

#include "firmware/motor/motor_params.h"
#include "firmware/numeric/angle.h"

struct encoder_params {
    uint64_t angle_per_count; /* 2^-64 electrical turn */
};

struct encoder {
    int32_t turns;
    uint64_t fraction;
    int32_t count; /* of the last sample; wraps */
};

/* counts_per_turn: of the shaft, more than the rotor's teeth. */
struct encoder_params encoder_design(int32_t rotor_teeth, uint32_t counts_per_turn);

/* The rotor is at `position` while the counter shows `count`. */
void encoder_set(struct encoder *encoder, struct position position, int32_t count);

/* The rotor's position at a count if it is at `zero` where count 0 begins: the middle of it. */
struct position encoder_position(const struct encoder_params *params, struct position zero,
                                 int32_t count);

/* One period on; less than half an electrical turn. */
static inline struct position encoder_step(struct encoder *encoder,
                                           const struct encoder_params *params, int32_t count)
{
    const int32_t counts = (int32_t)((uint32_t)count - (uint32_t)encoder->count);
    const uint64_t travel = (uint64_t)(int64_t)counts * params->angle_per_count;
    const uint64_t fraction = encoder->fraction + travel;

    encoder->turns += (int32_t)((int64_t)travel >> 63) + (fraction < encoder->fraction ? 1 : 0);
    encoder->fraction = fraction;
    encoder->count = count;
    return (struct position){encoder->turns, (angle_t)(fraction >> 32)};
}

#endif
