/*
 * Elementary functions from + - * / only: the same bits from every compiler and processor, which a
 * library's do not promise.
 */
#ifndef STEADYSTEP_PLANT_ELEMENTARY_H
#define STEADYSTEP_PLANT_ELEMENTARY_H

#include <cstdint>
#include <cstring>

#include "sil/plant/phases.h"

namespace plant
{

constexpr double pi = 3.14159265358979323846;

/* (cos, sin) of an angle in rad, |angle| <= 2 pi; error below 4e-16. */
Phases unit_vector(double angle_rad);

/* A vector turned by an angle in rad; error below (angle / 4)^8, up to order 2 (angle / 2.9)^6. */
template <int order> inline Phases turned_by_little(Phases vector, double angle_rad)
{
    const double z = angle_rad * angle_rad;
    double cosine = 1.0 / 24.0;
    double sine = 1.0 / 120.0;
    if constexpr (order > 2) {
        cosine -= z * (1.0 / 720.0 - z * (1.0 / 40320.0));
        sine -= z * (1.0 / 5040.0);
    }
    const double zz = z * z;
    cosine = (1.0 - z * (1.0 / 2.0)) + zz * cosine;
    sine = angle_rad * ((1.0 - z * (1.0 / 6.0)) + zz * sine);
    return cosine * vector + sine * quarter_turn(vector);
}

/* The whole number nearest to x, |x| <= 1e15; ties away from zero. */
double nearest_whole(double x);

/* e^x, -700 < x <= 0; relative error below 1e-15. */
double falling_exponential(double x);

/*
 * What an exponential decay leaves after a span of time. Keeps the last answers: in a period most
 * dead times are alike, and what stands before the valley of the carrier comes again behind it.
 */
class Decay
{
  public:
    explicit Decay(double rate_per_s) : rate_per_s_(rate_per_s)
    {
    }

    struct Span {
        double time_s = 0.0;
        double left = 1.0;      /* of 1; less than e^-50: nothing */
        double constants = 0.0; /* 1 / (rate x time) */
    };
    const Span &over(double time_s)
    {
        constexpr std::uint64_t golden = 0x9e3779b97f4a7c15U;
        std::uint64_t bits = 0;
        std::memcpy(&bits, &time_s, sizeof bits);
        Span &span = kept_[(bits * golden) >> (64 - kept_bits)];
        if (span.time_s != time_s) {
            span = decay(time_s);
        }
        return span;
    }

  private:
    static constexpr int kept_bits = 6;

    Span decay(double time_s) const;

    double rate_per_s_;
    Span kept_[1 << kept_bits];
};

/* Natural logarithm of x, 1e-300 < x < 1e300; relative error below 4e-15. */
double natural_logarithm(double x);

} // namespace plant

#endif
