/*
 * Parameters of a two-phase hybrid stepper in SI units, as a motor file states them; each is a row
 * of interface/settings_table.h.
 */
#ifndef STEADYSTEP_MOTOR_PARAMS_H
#define STEADYSTEP_MOTOR_PARAMS_H

#include <stdint.h>

#include "firmware/interface/settings_table.h"

/*
 * Model (Bendjedia 2012 (1)-(3), sign of the back-EMF of phase b corrected):
 *   L di_a/dt = u_a - R i_a + Km w sin(N theta)
 *   L di_b/dt = u_b - R i_b - Km w cos(N theta)
 *   J dw/dt   = Km (-i_a sin(N theta) + i_b cos(N theta)) - Kv w - T_L
 */
#define MOTOR_REAL_MEMBER(index, member, unit, least, most, sentence)  double member;
#define MOTOR_COUNT_MEMBER(index, member, unit, least, most, sentence) int32_t member;
struct motor_params {
    MOTOR_SETTINGS(MOTOR_REAL_MEMBER, MOTOR_COUNT_MEMBER)
};
#undef MOTOR_REAL_MEMBER
#undef MOTOR_COUNT_MEMBER

#endif
