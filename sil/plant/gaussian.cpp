#include "sil/plant/gaussian.h"

#include <cmath>

#include "sil/plant/elementary.h"

namespace plant
{

namespace
{

constexpr std::uint64_t golden = 0x9e3779b97f4a7c15U; /* 2^64 over the golden ratio, odd */

/* A bijection of 64 bits that scatters neighbours: a product carries every bit upwards, the fold
   brings the high half back down; three rounds make each input bit turn half the output bits. */
std::uint64_t scatter(std::uint64_t x)
{
    for (int round = 0; round < 3; round++) {
        x = (x ^ (x >> 32)) * golden;
    }
    return x ^ (x >> 32);
}

/* Uniform in (0, 1), 52 bits, never at the ends. */
double uniform(std::uint64_t bits)
{
    return (static_cast<double>(bits >> 12) + 0.5) * (1.0 / 4503599627370496.0);
}

} // namespace

std::uint64_t gaussian_key(std::uint64_t seed, std::uint64_t channel)
{
    return scatter(scatter(seed + golden) + channel);
}

double uniform_number(std::uint64_t key, std::uint64_t period)
{
    return uniform(scatter(key + period));
}

Phases gaussian_pair(std::uint64_t key, std::uint64_t period)
{
    /* Counter mode: one number per period and deviate. */
    const double radius_uniform = uniform(scatter(key + 2 * period));
    const double angle_uniform = uniform(scatter(key + 2 * period + 1));
    const double radius = std::sqrt(-2.0 * natural_logarithm(radius_uniform));
    return radius * unit_vector(2.0 * pi * angle_uniform - pi);
}

} // namespace plant
