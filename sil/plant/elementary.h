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

/* The whole number nearest to x, |x| <= 1e15; ties away from zero. */
double nearest_whole(double x);

/* Natural logarithm of x, 1e-300 < x < 1e300; relative error below 4e-15. */
double natural_logarithm(double x);

} // namespace plant

#endif
