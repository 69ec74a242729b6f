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
    uint64_t fraction;
    int32_t turns;
    int32_t count; /* of the last sample; wraps */
};

/* counts_per_turn: of the shaft, more than the rotor's teeth. */
__attribute__((cold)) struct encoder_params encoder_design(int32_t rotor_teeth,
                                                           uint32_t counts_per_turn);

/* The rotor is at `position` while the counter shows `count`. */
void encoder_set(struct encoder *encoder, struct position position, int32_t count);

/* The rotor's position at a count if it is at `zero` where count 0 begins: the middle of it. */
struct position encoder_position(const struct encoder_params *params, struct position zero,
                                 int32_t count);

/* a b, without the library's product on a Cortex-M0+. */
static inline int64_t encoder_product(int32_t a, uint32_t b)
{
#if defined(__ARM_ARCH_6M__)
    const uint32_t a0 = (uint32_t)a & 0xffffu;
    const uint32_t a1 = (uint32_t)a >> 16;
    const uint32_t b0 = b & 0xffffu;
    const uint32_t b1 = b >> 16;
    const uint32_t first = a0 * b0;
    const uint32_t second = a1 * b0 + (first >> 16); /* cannot carry, nor can the next */
    const uint32_t third = a0 * b1 + (second & 0xffffu);
    const uint32_t upper = a1 * b1 + (second >> 16) + (third >> 16);

    return (int64_t)(((uint64_t)(a < 0 ? upper - b : upper) << 32) |
                     ((third << 16) | (first & 0xffffu)));
#else
    return (int64_t)a * b;
#endif
}

/* counts params->angle_per_count, modulo 2^64. */
static inline uint64_t encoder_travel(const struct encoder_params *params, int32_t counts)
{
    const uint32_t high = (uint32_t)(params->angle_per_count >> 32);

    return (uint64_t)encoder_product(counts, (uint32_t)params->angle_per_count) +
           ((uint64_t)((uint32_t)counts * high) << 32);
}

/* One period on; less than half an electrical turn. */
static inline struct position encoder_step(struct encoder *encoder,
                                           const struct encoder_params *params, int32_t count)
{
    const int32_t counts = (int32_t)((uint32_t)count - (uint32_t)encoder->count);
    const uint64_t travel = encoder_travel(params, counts);
    const uint64_t fraction = encoder->fraction + travel;

    const uint32_t carry =
        (uint32_t)((int64_t)travel >> 63) + (fraction < encoder->fraction ? 1u : 0u);

    encoder->turns = (int32_t)((uint32_t)encoder->turns + carry); /* 2^31 goes round */
    encoder->fraction = fraction;
    encoder->count = count;
    return (struct position){encoder->turns, (angle_t)(fraction >> 32)};
}

#endif
