#include "firmware/design/modes.h"

#include "firmware/design/complex_number.h"
#include "firmware/design/elementary.h"

/* Simple roots converge quadratically, in some ten steps from anywhere; pairs of equal real ones
   by half a digit a step, to a distance of 1e-8. */
enum { ROOT_STEPS = 60 };
static const double root_tolerance = 1e-24; /* squared, of the largest step */

/* x^n + coefficient[n-1] x^(n-1) + ... + coefficient[0] of a. */
static void characteristic_polynomial(int n, const struct matrix *a, double coefficient[MATRIX_MAX])
{
    struct matrix sum = {{{0.0}}};
    struct matrix next;

    for (int i = 0; i < n; i++) {
        sum.at[i][i] = 1.0;
    }
    for (int k = 1; k <= n; k++) {
        double trace = 0.0;

        matrix_multiply(n, a, &sum, &next);
        for (int i = 0; i < n; i++) {
            trace += next.at[i][i];
        }
        coefficient[n - k] = -trace / k;
        for (int i = 0; i < n; i++) {
            next.at[i][i] += coefficient[n - k];
        }
        sum = next;
    }
}

static struct complex_number value_at(int n, const double coefficient[MATRIX_MAX],
                                      struct complex_number x)
{
    struct complex_number sum = {1.0, 0.0};

    for (int i = n - 1; i >= 0; i--) {
        sum = complex_product(sum, x);
        sum.re += coefficient[i];
    }
    return sum;
}

/* One step of each root: off by the polynomial over its distances from the others. Returns the
   square of the largest step. */
static double refine(int n, const double coefficient[MATRIX_MAX],
                     struct complex_number root[MATRIX_MAX])
{
    double largest = 0.0;

    for (int i = 0; i < n; i++) {
        struct complex_number others = {1.0, 0.0};

        for (int j = 0; j < n; j++) {
            if (j != i) {
                others = complex_product(others, complex_difference(root[i], root[j]));
            }
        }
        if (complex_square_of_size(others) > 0.0) {
            const struct complex_number step =
                complex_quotient(value_at(n, coefficient, root[i]), others);

            root[i].re -= step.re;
            root[i].im -= step.im;
            if (complex_square_of_size(step) > largest) {
                largest = complex_square_of_size(step);
            }
        }
    }
    return largest;
}

static void roots_of(int n, const double coefficient[MATRIX_MAX],
                     struct complex_number root[MATRIX_MAX])
{
    const struct complex_number turn = {0.4, 0.9}; /* no root of unity, no real number */
    struct complex_number guess = {1.0, 0.0};

    for (int i = 0; i < n; i++) {
        root[i] = guess;
        guess = complex_product(guess, turn);
    }
    for (int step = 0; step < ROOT_STEPS; step++) {
        if (refine(n, coefficient, root) <= root_tolerance) {
            return;
        }
    }
}

double modes_damping(int n, const struct matrix *a, double period_s, double slow_rad_s)
{
    const double slow = slow_rad_s * period_s;
    double coefficient[MATRIX_MAX];
    struct complex_number root[MATRIX_MAX];
    struct matrix change = *a; /* z - 1: exact where a is near one */
    double least = 1.0;

    for (int i = 0; i < n; i++) {
        change.at[i][i] -= 1.0;
    }
    characteristic_polynomial(n, &change, coefficient);
    roots_of(n, coefficient, root);
    for (int i = 0; i < n; i++) {
        const struct complex_number above = {root[i].re + 2.0, root[i].im};
        const struct complex_number s = complex_quotient(root[i], above); /* s T/2 */
        const double size = square_root(complex_square_of_size(s));
        const double damping = size > 0.5 * slow ? -s.re / size : 1.0;

        if (!(damping >= least)) {
            least = damping;
        }
    }
    return least;
}
