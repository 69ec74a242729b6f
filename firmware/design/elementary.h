/*
 * Elementary functions of the start-up design code, in double, from + - x / alone: the same bits
 * from every compiler and core.
 */
#ifndef STEADYSTEP_ELEMENTARY_H
#define STEADYSTEP_ELEMENTARY_H

#include <stdbool.h>

#define DEGREES_PER_RAD 57.29577951308232

/* e^x, relative error below 2 ulp for |x| <= 700; x beyond is taken as +-700. */
double exponential(double x);

/*
 * (e^x - 1) / x and (e^x - 1 - x) / x^2, continued to 1 and 1/2 at x = 0: the integrals of a
 * first-order lag over one period, without the cancellation of their textbook forms.
 * Relative error below 4 ulp (phi1) and 16 ulp (phi2) for |x| <= 700.
 */
double exponential_phi1(double x);
double exponential_phi2(double x);

/* Square root, relative error below 2 ulp; 0 of what is not above 0. */
double square_root(double x);

/* True for every number but infinities and NaN. */
bool is_finite(double x);

#endif
