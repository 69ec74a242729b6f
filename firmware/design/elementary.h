/*
 * Elementary functions of the start-up design code, in double, from + - x / alone: the same bits
 * from every compiler and core.
 */
#ifndef STEADYSTEP_ELEMENTARY_H
#define STEADYSTEP_ELEMENTARY_H

#include <stdbool.h>

#define DEGREES_PER_RAD 57.29577951308232

/* e^x, relative error below 2 ulp for |x| <= 700; x beyond is taken as +-700. */
__attribute__((noinline)) double exponential(double x);

/*
 * (e^x - 1) / x and (e^x - 1 - x) / x^2, continued to 1 and 1/2 at x = 0: the integrals of a
 * first-order lag over one period, without the cancellation of their textbook forms.
 * Relative error below 4 ulp (phi1) and 16 ulp (phi2) for |x| <= 700.
 */
__attribute__((noinline)) double exponential_phi1(double x);
double exponential_phi2(double x);

/* Square root, relative error below 2 ulp; 0 of what is not above 0. */
double square_root(double x);

/*
 * 1 - y/(n (n + 1)) (1 - y/((n + 2)(n + 3)) (1 - ...)), `terms` of them: of y = x^2, times x for
 * n = 2, the sine; for n = 1 the cosine; times y/2 for n = 3, 1 - cosine.
 */
__attribute__((noinline)) double alternating_series(double y, int n, int terms);

/* Not inlined: a call is shorter than a comparison of software doubles. */
__attribute__((noinline)) double smaller(double a, double b);
__attribute__((noinline)) double larger(double a, double b);
__attribute__((noinline)) double magnitude(double x);

/* True for every number but infinities and NaN. */
__attribute__((noinline)) bool is_finite(double x);

#endif
