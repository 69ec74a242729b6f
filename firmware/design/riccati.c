#include "firmware/design/riccati.h"

/* The blocks of the trajectory's information matrix; of symmetric ones the lower half counts. */
struct trajectory {
    struct matrix inner;  /* D */
    struct matrix newest; /* E */
    struct matrix link;   /* B */
};

static void every_period(const struct riccati_problem *problem, struct trajectory *trajectory)
{
    int n = problem->states;
    double information[MATRIX_MAX] = {0.0}; /* Q^-1 */

    for (int i = 0; i < n; i++) {
        information[i] = 1.0 / problem->process_noise[i];
    }
    matrix_weighted_square(n, &problem->transition, information, &trajectory->inner);
    for (int i = 0; i < n; i++) {
        trajectory->inner.at[i][i] += information[i];
        for (int j = 0; j < n; j++) {
            trajectory->newest.at[i][j] = i == j ? information[i] : 0.0;
            trajectory->link.at[i][j] = information[i] * problem->transition.at[i][j];
        }
    }
    for (int i = 0; i < RICCATI_OUTPUTS; i++) {
        trajectory->inner.at[i][i] += 1.0 / problem->measurement_noise;
    }
}

static void subtract_lower_half(int n, const struct matrix *a, struct matrix *from)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            from->at[i][j] -= a->at[i][j];
        }
    }
}

/* What is needed of the states that one doubling eliminates. */
struct elimination {
    struct matrix_factors factors; /* D = L diag(1 / weight) L^T */
    struct matrix backward;        /* L^-1 B^T */
    struct matrix *product;        /* lower half of B D^-1 B^T */
};

/* E' of the header. False if D is not positive definite. */
static bool eliminate_before_newest(int n, struct trajectory *trajectory, struct elimination *e)
{
    if (!matrix_factor(n, &trajectory->inner, &e->factors)) {
        return false;
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            e->backward.at[i][j] = trajectory->link.at[j][i];
        }
    }
    matrix_forward_solve(n, &e->factors, &e->backward);
    matrix_weighted_square(n, &e->backward, e->factors.weight, e->product);
    subtract_lower_half(n, e->product, &trajectory->newest);
    return true;
}

/* D' and B' of the header. */
static void eliminate_between_inner(int n, struct trajectory *trajectory, struct elimination *e)
{
    subtract_lower_half(n, e->product, &trajectory->inner);
    matrix_forward_solve(n, &e->factors, &trajectory->link);
    matrix_weighted_square(n, &trajectory->link, e->factors.weight, e->product);
    subtract_lower_half(n, e->product, &trajectory->inner);
    matrix_weighted_product(n, &e->backward, e->factors.weight, &trajectory->link, e->product);
    trajectory->link = *e->product;
}

/* (10) */
static void kalman_gain(const struct riccati_problem *problem, struct riccati_solution *solution)
{
    const struct matrix *p = &solution->covariance;
    double s00 = p->at[0][0] + problem->measurement_noise;
    double s01 = p->at[0][1];
    double s11 = p->at[1][1] + problem->measurement_noise;
    double reciprocal = 1.0 / (s00 * s11 - s01 * s01);

    for (int i = 0; i < problem->states; i++) {
        solution->gain[i][0] = (p->at[i][0] * s11 - p->at[i][1] * s01) * reciprocal;
        solution->gain[i][1] = (p->at[i][1] * s00 - p->at[i][0] * s01) * reciprocal;
    }
}

bool riccati_solve(const struct riccati_problem *problem, struct riccati_solution *solution)
{
    int n = problem->states;
    struct trajectory trajectory;
    struct elimination elimination;

    elimination.product = &solution->covariance; /* which is made last */
    every_period(problem, &trajectory);
    if (!eliminate_before_newest(n, &trajectory, &elimination)) {
        return false;
    }
    for (int i = 1; i < problem->doublings; i++) {
        eliminate_between_inner(n, &trajectory, &elimination);
        if (!eliminate_before_newest(n, &trajectory, &elimination)) {
            return false;
        }
    }
    if (!matrix_invert(n, &trajectory.newest, &elimination.factors, &elimination.backward,
                       &solution->covariance)) {
        return false;
    }
    kalman_gain(problem, solution);
    return true;
}
