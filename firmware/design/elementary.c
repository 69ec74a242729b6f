#include "firmware/design/elementary.h"

#include <stdint.h>

#define EXPONENT_MAX 700.0

/* 2^k, assembled from its bits; |k| <= 1022. */
static double power_of_two(int k)
{
    union {
        uint64_t bits;
        double value;
    } number = {.bits = (uint64_t)(1023 + k) << 52};

    return number.value;
}

/*
 * sum of m! x^i / (i + m)! for i = 0...terms: m = 0, 1, 2 gives e^x, phi1 and 2 phi2. Horner form,
 * innermost term first.
 */
static double factorial_series(double x, int m, int terms)
{
    double sum = 1.0;

    for (int i = terms; i > 0; i--) {
        sum = 1.0 + x * sum / (double)(i + m);
    }
    return sum;
}

double exponential(double x)
{
    /* ln 2 in two parts: the first has 21 trailing zero bits, so k times it is exact. */
    const double ln2_high = 6.93147180369123816490e-01;
    const double ln2_low = 1.90821492927058770002e-10;
    const double log2_e = 1.44269504088896338700;

    x = larger(smaller(x, EXPONENT_MAX), -EXPONENT_MAX);
    int k = (int)(x * log2_e + (x < 0.0 ? -0.5 : 0.5));
    double remainder = (x - k * ln2_high) - k * ln2_low; /* |remainder| <= ln(2) / 2 */
    return factorial_series(remainder, 0, 14) * power_of_two(k);
}

double exponential_phi1(double x)
{
    if (x > -0.5 && x < 0.5) {
        return factorial_series(x, 1, 15);
    }
    return (exponential(x) - 1.0) / x;
}

double exponential_phi2(double x)
{
    if (x > -1.0 && x < 1.0) {
        return 0.5 * factorial_series(x, 2, 18);
    }
    return (exponential_phi1(x) - 1.0) / x;
}

/* Heron's rule from half the exponent: five steps take 0.06 to below 1e-16. */
double square_root(double x)
{
    union {
        double value;
        uint64_t bits;
    } root = {.value = x};

    if (!(x > 0.0) || !is_finite(x)) {
        return x > 0.0 ? x : 0.0;
    }
    root.bits = (root.bits >> 1) + ((uint64_t)1023 << 51);
    for (int step = 0; step < 5; step++) {
        root.value = 0.5 * (root.value + x / root.value);
    }
    return root.value;
}

double alternating_series(double y, int n, int terms)
{
    double sum = 1.0;

    for (int k = n + 2 * (terms - 1); k >= n; k -= 2) {
        sum = 1.0 - y / (double)(k * (k + 1)) * sum;
    }
    return sum;
}

double smaller(double a, double b)
{
    return a < b ? a : b;
}

double larger(double a, double b)
{
    return a > b ? a : b;
}

double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

bool is_finite(double x)
{
    double difference = x - x;

    return difference == 0.0;
}
