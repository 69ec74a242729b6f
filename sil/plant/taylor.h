/* What a Taylor-series integrator needs of power series in tau, 0 <= tau <= 1. */
#ifndef STEADYSTEP_PLANT_TAYLOR_H
#define STEADYSTEP_PLANT_TAYLOR_H

#include "sil/plant/in_place.h"

namespace plant
{

/*
 * Coefficient k of the product of two series: the sum of x[m] y[k - m]. The outermost terms are the
 * latest to be known and are added last.
 */
template <int k, typename X, typename Y> inline auto cauchy_product(const X *x, const Y *y)
{
    if constexpr (k == 0) {
        return x[0] * y[0];
    } else if constexpr (k == 1) {
        return x[0] * y[1] + x[1] * y[0];
    } else {
        return cauchy_product<k - 2>(x + 1, y + 1) + (x[0] * y[k] + x[k] * y[0]);
    }
}

/* The same of a series with itself. */
template <int k, typename X> inline auto cauchy_square(const X *x)
{
    if constexpr (k == 0) {
        return x[0] * x[0];
    } else if constexpr (k == 1) {
        return 2.0 * x[0] * x[1];
    } else {
        return cauchy_square<k - 2>(x + 1) + 2.0 * x[0] * x[k];
    }
}

/*
 * The sum of x[k] power and what follows, power being h^k. Ascending: each term is added as soon as
 * it is known. A recursion, because a compiler unrolls a loop only at its highest level.
 */
template <int order, int k, typename X, typename Time>
IN_PLACE X terms_from(X total, const X *x, Time h, Time power)
{
    total += x[k] * power;
    if constexpr (k < order) {
        return terms_from<order, k + 1>(total, x, h, power * h);
    } else {
        return total;
    }
}

/* The series at t = h. */
template <int order, typename X, typename Time> IN_PLACE X value(const X *x, Time h)
{
    return terms_from<order, 1>(x[0], x, h, h);
}

template <int order, int k, typename X, typename Time>
IN_PLACE X integrals_from(X total, const X *x, Time h, Time power)
{
    total += x[k] * (power * (1.0 / (k + 1)));
    if constexpr (k < order) {
        return integrals_from<order, k + 1>(total, x, h, power * h);
    } else {
        return total;
    }
}

/* Its integral over 0...h. */
template <int order, typename X, typename Time> IN_PLACE X integral(const X *x, Time h)
{
    return integrals_from<order, 1>(x[0] * h, x, h, h * h);
}

/* The integral of x - x[0] over 0...h. */
template <int order, typename X, typename Time> IN_PLACE X integral_of_change(const X *x, Time h)
{
    const Time power = h * h;
    const X total = x[1] * (power * 0.5);
    if constexpr (order > 1) {
        return integrals_from<order, 2>(total, x, h, power * h);
    } else {
        return total;
    }
}

/* The integral of its square over 0...h, to the order of the series. */
template <int order, int k = 0, typename X> inline X integral_of_square(const X *x, double h)
{
    X total = cauchy_product<k>(x, x) * (1.0 / (k + 1));
    if constexpr (k < order) {
        total += integral_of_square<order, k + 1>(x, h);
    }
    return total * h;
}

/*
 * Where a polynomial x that is >= 0 at 0 and < 0 at h, where it has the value at_h, becomes
 * negative: Newton's method from the chord's zero, kept inside a shrinking bracket. In [0, h].
 */
template <int order> inline double falling_zero(const double *x, double h, double at_h)
{
    /* Newton doubles the digits: after a change this small, rounding is all that is left. */
    const double last_change = 1e-8 * h;
    double low = 0.0, high = h;
    double t = h * x[0] / (x[0] - at_h);
    for (int iteration = 0; iteration < 60; iteration++) {
        double value = x[order], slope = 0.0;
        for (int k = order - 1; k >= 0; k--) {
            slope = slope * t + value;
            value = value * t + x[k];
        }
        (value < 0.0 ? high : low) = t;
        double next = slope < 0.0 ? t - value / slope : low;
        if (!(next > low && next < high)) {
            next = 0.5 * (low + high);
        }
        const double change = next - t;
        t = next;
        if (change < last_change && change > -last_change) {
            break;
        }
    }
    return t;
}

} // namespace plant

#endif
