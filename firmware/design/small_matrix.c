#include "firmware/design/small_matrix.h"

#include "firmware/design/elementary.h"

#define EXPONENTIAL_ORDER 12

static void clear(int n, struct matrix *out)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            out->at[i][j] = 0.0;
        }
    }
}

/* row += factor source, the first `columns` of both: the inner loop of everything here. */
static void add_multiple(int columns, double factor, const double source[MATRIX_MAX],
                         double row[MATRIX_MAX])
{
    if (factor == 0.0) {
        return;
    }
    for (int j = 0; j < columns; j++) {
        row[j] += factor * source[j];
    }
}

void matrix_multiply(int n, const struct matrix *a, const struct matrix *b, struct matrix *out)
{
    clear(n, out);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            add_multiple(n, a->at[i][k], b->at[k], out->at[i]);
        }
    }
}

void matrix_weighted_product(int n, const struct matrix *a, const double weight[MATRIX_MAX],
                             const struct matrix *b, struct matrix *out)
{
    clear(n, out);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            add_multiple(n, a->at[k][i] * weight[k], b->at[k], out->at[i]);
        }
    }
}

void matrix_weighted_square(int n, const struct matrix *a, const double weight[MATRIX_MAX],
                            struct matrix *out)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            out->at[i][j] = 0.0;
        }
        for (int k = 0; k < n; k++) {
            add_multiple(i + 1, a->at[k][i] * weight[k], a->at[k], out->at[i]);
        }
    }
}

bool matrix_factor(int n, const struct matrix *a, struct matrix_factors *factors)
{
    struct matrix *lower = &factors->lower;
    bool positive_definite = true;

    for (int i = 0; i < n; i++) {
        double pivot = a->at[i][i];

        for (int j = 0; j < i; j++) {
            double scaled = a->at[i][j]; /* L_ij / weight_j */
            for (int k = 0; k < j; k++) {
                scaled -= lower->at[i][k] * lower->at[j][k];
            }
            lower->at[i][j] = scaled;
        }
        for (int j = 0; j < i; j++) {
            double scaled = lower->at[i][j];
            lower->at[i][j] = scaled * factors->weight[j];
            pivot -= scaled * lower->at[i][j];
        }
        factors->weight[i] = 1.0 / pivot;
        positive_definite = positive_definite && pivot > 0.0 && is_finite(factors->weight[i]);
    }
    return positive_definite;
}

void matrix_forward_solve(int n, const struct matrix_factors *factors, struct matrix *b)
{
    for (int i = 1; i < n; i++) {
        for (int k = 0; k < i; k++) {
            add_multiple(n, -factors->lower.at[i][k], b->at[k], b->at[i]);
        }
    }
}

bool matrix_invert(int n, const struct matrix *a, struct matrix_factors *factors,
                   struct matrix *inverse_lower, struct matrix *out)
{
    if (!matrix_factor(n, a, factors)) {
        return false;
    }
    clear(n, inverse_lower);
    for (int i = 0; i < n; i++) {
        inverse_lower->at[i][i] = 1.0;
    }
    matrix_forward_solve(n, factors, inverse_lower);
    matrix_weighted_product(n, inverse_lower, factors->weight, inverse_lower, out);
    return true;
}

void matrix_exponential(int n, const struct matrix *a, struct matrix *out)
{
    struct matrix sum;

    clear(n, &sum);
    for (int order = EXPONENTIAL_ORDER; order > 0; order--) {
        double reciprocal = 1.0 / order;

        for (int i = 0; i < n; i++) {
            sum.at[i][i] += 1.0;
        }
        clear(n, out);
        for (int i = 0; i < n; i++) {
            for (int k = 0; k < n; k++) {
                add_multiple(n, a->at[i][k] * reciprocal, sum.at[k], out->at[i]);
            }
        }
        sum = *out;
    }
    for (int i = 0; i < n; i++) {
        out->at[i][i] += 1.0;
    }
}
