/*
 * Elementary functions from + - * / only: the same bits from every compiler and processor, which a
 * library's do not promise.
 */
#ifndef STEADYSTEP_PLANT_ELEMENTARY_H
#define STEADYSTEP_PLANT_ELEMENTARY_H

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
    cosine = 1.0 - z * (1.0 / 2.0 - z * cosine);
    sine = angle_rad * (1.0 - z * (1.0 / 6.0 - z * sine));
    return cosine * vector + sine * quarter_turn(vector);
}

/* The whole number nearest to x, |x| <= 1e15; ties away from zero. */
double nearest_whole(double x);

/* e^x, -700 < x <= 0; relative error below 1e-15. */
double falling_exponential(double x);

/* Natural logarithm of x, 1e-300 < x < 1e300; relative error below 4e-15. */
double natural_logarithm(double x);

} // namespace plant

#endif
