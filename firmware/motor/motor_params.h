/* Parameters of a two-phase hybrid stepper in SI units, as a motor file states them. */
#ifndef STEADYSTEP_MOTOR_PARAMS_H
#define STEADYSTEP_MOTOR_PARAMS_H

#include <stdint.h>

/*
 * Model (Bendjedia 2012 (1)-(3), sign of the back-EMF of phase b corrected):
 *   L di_a/dt = u_a - R i_a + Km w sin(N theta)
 *   L di_b/dt = u_b - R i_b - Km w cos(N theta)
 *   J dw/dt   = Km (-i_a sin(N theta) + i_b cos(N theta)) - Kv w - T_L
 */
struct motor_params {
    double resistance_ohm;           /* R > 0, one phase */
    double inductance_H;             /* L > 0, one phase */
    double torque_constant_Nm_A;     /* Km > 0, equals the back-EMF constant in V s/rad */
    double viscous_friction_Nms_rad; /* Kv >= 0 */
    double inertia_kgm2;             /* J > 0, rotor and rigid load */
    double rated_current_A;          /* > 0, per phase, peak of the sine */
    double supply_V;                 /* > 0, nominal bus voltage */
    int32_t rotor_teeth;             /* N > 0: pole pairs, electrical turns per turn */
};

#endif
