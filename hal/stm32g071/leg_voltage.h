/*
 * Mean phase voltages of a period from RC-filtered leg voltages, sampled LEG_VOLTAGE_SAMPLES times
 * a period; the last sample is at the peak S(k).
 *
 * A divider with its capacitor gives v with  u = v + tau dv/dt  of the leg's voltage u, so that
 * over a period T that ends at S(k)
 *
 *     mean u = mean v + (tau / T) (v(k) - v(k-1))                                     exactly.
 *
 * The mean of v is the trapezoid over samples v_0 = v(k-1), v_1 ... v_8 = v(k):
 *
 *     8 mean u = v_1 + ... + v_8 + (8 tau / T - 1/2) (v_8 - v_0)
 *
 * The divider's time constant is chosen as tau = 3/16 T = 18.75 us, which makes the factor 1.
 * A window that is shifted by a microsecond or two has the same mean: around the peaks the legs are
 * low, so that it loses nothing and gains nothing.
 *
 * What is left: the trapezoid takes the 8th harmonic of the legs (80 kHz, up to 1.9 V) for a mean.
 * The filter damps it to a ninth and turns it by 84 degrees, so that at the peak it would be
 * sampled near its zero. The plus legs are sampled 1.25 and 0.75 us before the peak, the minus legs
 * as long after it; the harmonics of the two legs of a phase are opposite, and what the shifts add
 * cancels. Below 45 mV remain, and none at a duty of one half. A time constant off by one percent
 * costs one percent of tau du/dt: 3 mV at 45 rad/s, 7 V and 50 teeth.
 */
#ifndef STEADYSTEP_STM32G071_LEG_VOLTAGE_H
#define STEADYSTEP_STM32G071_LEG_VOLTAGE_H

#include <stdint.h>

enum { LEG_VOLTAGE_SAMPLES = 8 };

/* Codes of a period, two to a word: 9 x 4095 < 2^16. */
struct leg_voltages {
    uint32_t plus_sum, plus_last;   /* of v_1...v_8, v_8; low half A+, high half B+ */
    uint32_t minus_sum, minus_last; /* low half B-, high half A- */
};

struct leg_voltage_mean {
    int32_t end_a, end_b; /* v_8 of leg plus less leg minus, of the last period */
};

struct phase_voltage_codes {
    int16_t a, b; /* rounded; a code is two codes of a leg */
};

static inline struct phase_voltage_codes leg_voltage_mean_step(struct leg_voltage_mean *mean,
                                                               const struct leg_voltages *legs)
{
    const uint32_t plus = legs->plus_sum + legs->plus_last;
    const uint32_t minus = legs->minus_sum + legs->minus_last;
    const int32_t sum_a = (int32_t)(plus & 0xffffu) - (int32_t)(minus >> 16) - mean->end_a;
    const int32_t sum_b = (int32_t)(plus >> 16) - (int32_t)(minus & 0xffffu) - mean->end_b;

    mean->end_a = (int32_t)(legs->plus_last & 0xffffu) - (int32_t)(legs->minus_last >> 16);
    mean->end_b = (int32_t)(legs->plus_last >> 16) - (int32_t)(legs->minus_last & 0xffffu);
    return (struct phase_voltage_codes){(int16_t)((sum_a + 8) >> 4), (int16_t)((sum_b + 8) >> 4)};
}

#endif
