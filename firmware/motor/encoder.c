#include "firmware/motor/encoder.h"

/* teeth 2^64 / counts, bit by bit: 64 bits do not hold the numerator. */
struct encoder_params encoder_design(int32_t rotor_teeth, uint32_t counts_per_turn)
{
    uint64_t rest = (uint32_t)rotor_teeth % counts_per_turn;
    uint64_t quotient = 0;

    for (int bit = 0; bit < 64; bit++) {
        rest += rest;
        quotient += quotient;
        if (rest >= counts_per_turn) {
            rest -= counts_per_turn;
            quotient++;
        }
    }
    return (struct encoder_params){quotient};
}

void encoder_set(struct encoder *encoder, struct position position, int32_t count)
{
    encoder->turns = position.turns;
    encoder->fraction = (uint64_t)position.fraction << 32;
    encoder->count = count;
}

struct position encoder_position(const struct encoder_params *params, struct position zero,
                                 int32_t count)
{
    const uint32_t high = (uint32_t)(params->angle_per_count >> 32);
    const uint32_t low = (uint32_t)params->angle_per_count;
    const int64_t travel =
        encoder_product(count, high) + (encoder_product(count, low) >> 32) + (int64_t)(high >> 1);
    const int64_t position = travel + zero.fraction;

    return (struct position){(int32_t)((uint32_t)zero.turns + (uint32_t)(position >> 32)),
                             (angle_t)position};
}
