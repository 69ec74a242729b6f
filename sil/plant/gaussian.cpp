#include "sil/plant/gaussian.h"

#include <cmath>

#include "sil/plant/elementary.h"

namespace plant
{

namespace
{

/* A bijection of 64 bits in which every input bit changes every output bit with probability 1/2:
   multiply by an odd constant, fold the high half into the low one, three times. */
std::uint64_t mix(std::uint64_t x)
{
    for (int round = 0; round < 3; round++) {
        x = (x ^ (x >> 32)) * 0xd6e8feb86659fd93U;
    }
    return x ^ (x >> 32);
}

/* Uniform in (0, 1), 52 bits, never at the ends. */
double uniform(std::uint64_t bits)
{
    return (static_cast<double>(bits >> 12) + 0.5) * (1.0 / 4503599627370496.0);
}

} // namespace

Phases gaussian_pair(std::uint64_t seed, std::uint64_t channel, std::uint64_t period)
{
    /* Counter mode: the key of (seed, channel), then one number per period and deviate. */
    const std::uint64_t key = mix(mix(seed + 0x9e3779b97f4a7c15U) + channel);
    const double radius_uniform = uniform(mix(key + 2 * period));
    const double angle_uniform = uniform(mix(key + 2 * period + 1));
    const double radius = std::sqrt(-2.0 * natural_logarithm(radius_uniform));
    return radius * unit_vector(2.0 * pi * angle_uniform - pi);
}

} // namespace plant
