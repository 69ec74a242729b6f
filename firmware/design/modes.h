/*
 * How well the modes of a small sampled system are damped: its characteristic polynomial in
 * z - 1 (Faddeev and Le Verrier), all its roots at once (Durand and Kerner), and each root's
 * damping ratio in s = 2/T (z - 1)/(z + 1), whose phase is that of ln(z)/T within 1 % up to a
 * frequency of 0.5 per period. + - x / and the square root only.
 */
#ifndef STEADYSTEP_MODES_H
#define STEADYSTEP_MODES_H

#include "firmware/design/small_matrix.h"

/*
 * Smallest damping ratio, -1...1, of the modes of x+ = a x with n states, sampled with period_s;
 * modes slower than slow_rad_s do not count; 1 if none is left. NaN for what is not finite.
 */
double modes_damping(int n, const struct matrix *a, double period_s, double slow_rad_s);

#endif
