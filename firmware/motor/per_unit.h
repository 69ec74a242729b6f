/*
 * Per-unit base of a drive. With the voltage base over the torque constant as speed base and the
 * torque constant times the current base as torque base, back-EMF equals speed and torque equals
 * q current in per-unit, and most gains of the model become one.
 */
#ifndef STEADYSTEP_PER_UNIT_H
#define STEADYSTEP_PER_UNIT_H

#include "firmware/motor/motor_params.h"

struct per_unit {
    double current_A;           /* twice the rated current */
    double voltage_V;           /* nominal supply */
    double speed_rad_s;         /* voltage_V / Km: no-load speed at full voltage */
    double torque_Nm;           /* Km current_A */
    double acceleration_rad_s2; /* torque_Nm / J */
    double resistance_ohm;      /* voltage_V / current_A */
    double rad_per_turn;        /* mechanical rad of one electrical turn, 2 pi / N */
    double turns_per_period;    /* electrical turns per control period at base speed */
    double ratio;               /* 1: of what has no unit */
};

struct per_unit per_unit_base(const struct motor_params *motor, double period_s);

/* N L: reactance of a phase over the speed, both in per-unit. */
double per_unit_reactance(const struct per_unit *base, const struct motor_params *motor);

#endif
