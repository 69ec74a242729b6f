#include "sil/plant/elementary.h"

#include <cstdint>
#include <cstring>

namespace plant
{

Phases unit_vector(double angle_rad)
{
    /* pi/2 in two parts, the first with 33 bits, so that multiples of it are exact. */
    constexpr double half_pi_high = 1.57079632673412561417e+00;
    constexpr double half_pi_low = 6.07710050650619224932e-11;
    const double quarters = nearest_whole(angle_rad * (2.0 / pi));
    const double r = (angle_rad - quarters * half_pi_high) - quarters * half_pi_low;
    const std::int64_t quarter = static_cast<std::int64_t>(quarters) & 3;

    /* Taylor series of cos r and (sin r) / r in z = r^2, |r| <= pi/4, side by side. */
    const double z = r * r;
    Phases sum = {1.0 / 20922789888000.0, -1.0 / 1307674368000.0};
    sum = sum * z + Phases{-1.0 / 87178291200.0, 1.0 / 6227020800.0};
    sum = sum * z + Phases{1.0 / 479001600.0, -1.0 / 39916800.0};
    sum = sum * z + Phases{-1.0 / 3628800.0, 1.0 / 362880.0};
    sum = sum * z + Phases{1.0 / 40320.0, -1.0 / 5040.0};
    sum = sum * z + Phases{-1.0 / 720.0, 1.0 / 120.0};
    sum = sum * z + Phases{1.0 / 24.0, -1.0 / 6.0};
    const double cosine = (sum[0] * z - 0.5) * z + 1.0;
    const double sine = r + sum[1] * z * r;

    /* Turned back by whole quarters, without a branch. */
    static constexpr Phases axes[5] = {
        {1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}, {1.0, 0.0}};
    return cosine * axes[quarter] + sine * axes[quarter + 1];
}

double nearest_whole(double x)
{
    constexpr double most = 1e15;
    const double clamped = x < most ? (x > -most ? x : -most) : most;
    return static_cast<double>(static_cast<std::int64_t>(clamped + (clamped < 0.0 ? -0.5 : 0.5)));
}

double falling_exponential(double x)
{
    /* 2^(n/32), 0 <= n < 32 */
    static constexpr double power_of_two[32] = {
        0x1.0000000000000p+0, 0x1.059b0d3158574p+0, 0x1.0b5586cf9890fp+0, 0x1.11301d0125b51p+0,
        0x1.172b83c7d517bp+0, 0x1.1d4873168b9aap+0, 0x1.2387a6e756238p+0, 0x1.29e9df51fdee1p+0,
        0x1.306fe0a31b715p+0, 0x1.371a7373aa9cbp+0, 0x1.3dea64c123422p+0, 0x1.44e086061892dp+0,
        0x1.4bfdad5362a27p+0, 0x1.5342b569d4f82p+0, 0x1.5ab07dd485429p+0, 0x1.6247eb03a5585p+0,
        0x1.6a09e667f3bcdp+0, 0x1.71f75e8ec5f74p+0, 0x1.7a11473eb0187p+0, 0x1.82589994cce13p+0,
        0x1.8ace5422aa0dbp+0, 0x1.93737b0cdc5e5p+0, 0x1.9c49182a3f090p+0, 0x1.a5503b23e255dp+0,
        0x1.ae89f995ad3adp+0, 0x1.b7f76f2fb5e47p+0, 0x1.c199bdd85529cp+0, 0x1.cb720dcef9069p+0,
        0x1.d5818dcfba487p+0, 0x1.dfc97337b9b5fp+0, 0x1.ea4afa2a490dap+0, 0x1.f50765b6e4540p+0,
    };
    /* x = n ln 2 / 32 + r, |r| < 0.011; ln 2 / 32 in two parts, the first with 33 bits. */
    constexpr double part_high = 0.021660849390173098;
    constexpr double part_low = 2.325192846878874e-12;
    const double least = -700.0;
    const double bounded = x > least ? x : least;
    const auto n = static_cast<std::int64_t>(bounded * 46.16624130844683 - 0.5);
    const double whole = static_cast<double>(n);
    const double r = (bounded - whole * part_high) - whole * part_low;

    const double z = r * r;
    const double even = 1.0 / 2.0 + z * (1.0 / 24.0 + z * (1.0 / 720.0));
    const double odd = 1.0 / 6.0 + z * (1.0 / 120.0);
    const double beyond_1 = r + z * (even + r * odd);
    const double fraction = power_of_two[n & 31];
    const std::uint64_t bits = static_cast<std::uint64_t>(1023 + (n >> 5)) << 52;
    double power = 0.0;
    std::memcpy(&power, &bits, sizeof power);
    return (fraction + fraction * beyond_1) * power;
}

Decay::Span Decay::decay(double time_s) const
{
    constexpr double forgotten = 50.0; /* time constants */
    const double age = time_s * rate_per_s_;
    return {time_s, age < forgotten ? falling_exponential(-age) : 0.0, 1.0 / age};
}

double natural_logarithm(double x)
{
    /* x = 2^exponent m with m in [sqrt(1/2), sqrt(2)): the exponent field is read from the bits. */
    constexpr std::uint64_t sqrt_half_bits = 0x3fe6a09e667f3bcdU;
    std::uint64_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    const std::int64_t exponent = static_cast<std::int64_t>(bits - sqrt_half_bits) >> 52;
    bits -= static_cast<std::uint64_t>(exponent) << 52;
    double m = 0.0;
    std::memcpy(&m, &bits, sizeof m);

    /* ln m = 2 artanh s, s = (m - 1) / (m + 1), |s| < 0.1716. */
    const double s = (m - 1.0) / (m + 1.0);
    const double z = s * s;
    double sum = 1.0 / 17.0;
    sum = sum * z + 1.0 / 15.0;
    sum = sum * z + 1.0 / 13.0;
    sum = sum * z + 1.0 / 11.0;
    sum = sum * z + 1.0 / 9.0;
    sum = sum * z + 1.0 / 7.0;
    sum = sum * z + 1.0 / 5.0;
    sum = sum * z + 1.0 / 3.0;
    constexpr double ln_2 = 0.69314718055994530942;
    return static_cast<double>(exponent) * ln_2 + 2.0 * (s + sum * z * s);
}

} // namespace plant
