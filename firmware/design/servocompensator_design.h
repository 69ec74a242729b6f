/*
 * Conditional servocompensator of Seshagiri and Khalil (9), sampled and in modal coordinates.
 *
 *   d sigma/dt = (S - J K) sigma + mu J sat(s/mu)
 *
 * From mu sat(s/mu) less K sigma to K sigma this is p(z)/q(z) - 1, where q has the harmonics of the
 * reference on the unit circle and p the eigenvalues asked for, placed in z: exact for any period.
 * Its partial fractions are one integrator and one rotation a harmonic,
 *
 *   x0 += r0 u,   x_h = e^(j h w0 T) x_h + 2 r_h u,   K sigma = x0 + sum Re x_h
 *
 * with the residue r at each pole as its input, so that every state is counted as K sigma is. (In
 * companion form K spans seven decades.)
 *
 * Eigenvalues: the paper's pattern -1, -2 +- j, with two harmonics -3 +- j besides, times the decay
 * rate. The decay rate must be no less than a quarter of w0, or what is left of the loop's gain at
 * w0 does not carry it (as the reproduction showed: a slow limit cycle).
 */
#ifndef STEADYSTEP_SERVOCOMPENSATOR_DESIGN_H
#define STEADYSTEP_SERVOCOMPENSATOR_DESIGN_H

#include "firmware/design/refusal.h"

enum { SERVOCOMPENSATOR_HARMONICS_MAX = 2 };

/* Of the highest harmonic, per period: fifty samples in a cycle. */
#define SERVOCOMPENSATOR_ROTATION_MAX 0.125

struct servocompensator_mode {
    double sine; /* of h w0 T */
    double one_minus_cosine;
    double input_re;
    double input_im;
};

struct servocompensator_design {
    double input; /* of the integrator */
    struct servocompensator_mode mode[SERVOCOMPENSATOR_HARMONICS_MAX];
};

struct servocompensator_task {
    double period_s;
    double frequency_rad_s; /* w0 */
    double decay_1_s;       /* of the slowest eigenvalue */
    int harmonics;          /* 1 or 2 */
};

/* false: w0 is too high for the period, the limit in error. */
bool servocompensator_design(const struct servocompensator_task *task,
                             struct servocompensator_design *design, char error[DESIGN_ERROR_TEXT]);

#endif
