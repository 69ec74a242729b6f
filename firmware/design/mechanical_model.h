/*
 * The mechanics over one period with constant current and load, Bendjedia 2012 (18):
 *   [w; theta](k+1) = [a11 0; a21 1] [w; theta](k) + [b1; b2] i_q(k) + [e1; e2] T_L(k)
 * in a form that stays exact as Kv T / J goes to zero.
 */
#ifndef STEADYSTEP_MECHANICAL_MODEL_H
#define STEADYSTEP_MECHANICAL_MODEL_H

#include "firmware/motor/motor_params.h"

struct mechanical_model {
    double one_minus_a11; /* 1 - a11, without cancellation */
    double a21;           /* s */
    double b1, b2;        /* rad/s per A, rad per A */
    double e1, e2;        /* rad/s per N m, rad per N m */
};

struct mechanical_model mechanical_model_of(const struct motor_params *motor, double period_s);

#endif
