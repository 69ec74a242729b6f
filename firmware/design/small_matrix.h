/*
 * Square matrices of up to seven states, double, sized at compile time: no heap, no
 * variable-length array. `n` is the dimension in use; the rest of a matrix is not touched.
 * An output must not alias an input. Zero factors are skipped: a product of software doubles
 * costs ten times the test.
 */
#ifndef STEADYSTEP_SMALL_MATRIX_H
#define STEADYSTEP_SMALL_MATRIX_H

#include <stdbool.h>

enum { MATRIX_MAX = 7 };

struct matrix {
    double at[MATRIX_MAX][MATRIX_MAX]; /* [row][column] */
};

/* out = a b */
void matrix_multiply(int n, const struct matrix *a, const struct matrix *b, struct matrix *out);

/* out = a^T diag(weight) b */
void matrix_weighted_product(int n, const struct matrix *a, const double weight[MATRIX_MAX],
                             const struct matrix *b, struct matrix *out);

/* Lower half of a^T diag(weight) a; the upper half of `out` is not touched. */
void matrix_weighted_square(int n, const struct matrix *a, const double weight[MATRIX_MAX],
                            struct matrix *out);

/* A symmetric positive definite matrix L diag(1 / weight) L^T: Cholesky's, without its roots. */
struct matrix_factors {
    struct matrix lower;       /* L below its diagonal of ones; the rest is not used */
    double weight[MATRIX_MAX]; /* > 0 */
};

/* Reads the lower half of a. False if a is not positive definite to working precision. */
bool matrix_factor(int n, const struct matrix *a, struct matrix_factors *factors);

/* b becomes L^-1 b, so that b^T a^-1 b of the old b is the weighted square of the new. */
void matrix_forward_solve(int n, const struct matrix_factors *factors, struct matrix *b);

/* out = a^-1, symmetric; reads the lower half of a. It leaves a's factors and L^-1. False as
   matrix_factor. */
bool matrix_invert(int n, const struct matrix *a, struct matrix_factors *factors,
                   struct matrix *inverse_lower, struct matrix *out);

/*
 * out = e^a by its Taylor series to order 12 in Horner form, for a = (model) x (period) of a period
 * that is short against every time constant: truncation below 1e-13 for a spectral radius up to
 * 1/2.
 */
void matrix_exponential(int n, const struct matrix *a, struct matrix *out);

#endif
