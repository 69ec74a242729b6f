/*
 * Steady state of the Kalman filter of a constant system,
 *   x(k+1) = F x(k) + w,  y(k) = [x0 x1] + v,
 * the fixed point of Bendjedia 2012 (9), (10), (12).
 *
 * Method: the information matrix of a whole trajectory is block-tridiagonal. Its diagonal blocks
 * are D = Q^-1 + H^T R^-1 H + F^T Q^-1 F, the blocks below them -B with B = Q^-1 F, and its last
 * one, of the newest state, predicted and not yet measured, E = Q^-1. Eliminating every second
 * state leaves a trajectory of the same form and twice the step,
 *   E' = E - B D^-1 B^T,  D' = D - B D^-1 B^T - B^T D^-1 B,  B' = B D^-1 B,
 * and E tends quadratically to P(k+1|k)^-1, the past being eliminated from it (cyclic reduction;
 * Meini, Math. Comp. 71, 2002). Half the work of the usual doubling on (F, G, P), every factor
 * positive definite. Loss of digits: cond(Q^-1 P) of the slow modes; 1e-5 of a gain at worst in
 * the seven-state hold designs, 1e-9 in the others.
 */
#ifndef STEADYSTEP_RICCATI_H
#define STEADYSTEP_RICCATI_H

#include <stdbool.h>

#include "firmware/design/small_matrix.h"

enum { RICCATI_OUTPUTS = 2 }; /* the first two states, the currents i_d and i_q, are measured */

struct riccati_problem {
    int states;                       /* 2...MATRIX_MAX */
    int doublings;                    /* the filter runs 2^doublings periods */
    struct matrix transition;         /* F */
    double process_noise[MATRIX_MAX]; /* diagonal of Q, variance per period, > 0 */
    double measurement_noise;         /* R = measurement_noise I, > 0 */
};

struct riccati_solution {
    struct matrix covariance;                 /* P(k+1|k), before the correction */
    double gain[MATRIX_MAX][RICCATI_OUTPUTS]; /* K = P H^T (H P H^T + R)^-1, (10) */
};

/*
 * Every state must be observable through the first two. False if a block loses its positive
 * definiteness: numbers beyond double precision or not finite.
 */
bool riccati_solve(const struct riccati_problem *problem, struct riccati_solution *solution);

#endif
