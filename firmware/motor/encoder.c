#include "firmware/motor/encoder.h"

/* teeth 2^64 / counts, by long division of two words: 64 bits do not hold the numerator. */
struct encoder_params encoder_design(int32_t rotor_teeth, uint32_t counts_per_turn)
{
    const uint64_t teeth = (uint64_t)rotor_teeth % counts_per_turn;
    const uint64_t high = (teeth << 32) / counts_per_turn;
    const uint64_t rest = (teeth << 32) % counts_per_turn;
    const struct encoder_params params = {(high << 32) + (rest << 32) / counts_per_turn};

    return params;
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

    return (struct position){zero.turns + (int32_t)(position >> 32), (angle_t)position};
}
