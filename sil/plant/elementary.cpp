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
    /* x = n ln 2 + r, |r| < 0.35; ln 2 in two parts, the first with 33 bits. */
    constexpr double ln_2_high = 6.93147180369123816490e-01;
    constexpr double ln_2_low = 1.90821492927058770002e-10;
    const double least = -700.0;
    const double bounded = x > least ? x : least;
    const bool small = x > -0.34; /* n = 0, without the conversions that find it */
    const double n = small ? 0.0 : nearest_whole(bounded * 1.44269504088896340736);
    const double r = (bounded - n * ln_2_high) - n * ln_2_low;

    /* Taylor series of the even and the odd part in z = r^2, side by side. */
    const double z = r * r;
    Phases sum = {1.0 / 479001600.0, 1.0 / 6227020800.0};
    sum = sum * z + Phases{1.0 / 3628800.0, 1.0 / 39916800.0};
    sum = sum * z + Phases{1.0 / 40320.0, 1.0 / 362880.0};
    sum = sum * z + Phases{1.0 / 720.0, 1.0 / 5040.0};
    sum = sum * z + Phases{1.0 / 24.0, 1.0 / 120.0};
    sum = sum * z + Phases{1.0 / 2.0, 1.0 / 6.0};
    const double exponential = 1.0 + (r + z * (sum[0] + r * sum[1]));
    if (small) {
        return exponential;
    }
    const std::uint64_t bits = static_cast<std::uint64_t>(1023 + static_cast<std::int64_t>(n))
                               << 52;
    double power = 0.0;
    std::memcpy(&power, &bits, sizeof power);
    return exponential * power;
}

Decay::Span Decay::decay(double time_s) const
{
    constexpr double forgotten = 50.0; /* time constants */
    const double age = time_s * rate_per_s_;
    return {time_s, age < forgotten ? falling_exponential(-age) : 0.0,
            (1.0 / rate_per_s_) / time_s};
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
