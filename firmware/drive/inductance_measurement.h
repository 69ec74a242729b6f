/*
 * The inductance of a winding whose rotor is held, from steps of its current.
 *
 * A d current turns no rotor that stands along it. So at the odd 45 degrees at which the phases are
 * compared (phase_balance.h) the hold's current swings to and fro about its mean, and each period
 * obeys the model of the winding (motor/motor_model.h),
 *
 *   i(k) - i(k-1) = b (u(k) - R i(k-1)),   b = (1 - exp(-T R/L)) / R = T/L - ...
 *
 * with u(k) the mean voltage of the period that ends at S(k). Summed from each step of the
 * reference to the next, with the sign s of the step:
 *
 *   b / b' = b F / D,   D = sum s (change of i),   F = sum s (u - R i)
 *
 * with b as it is known and b' as it is, whatever the current control made of the step. As many
 * steps up as down: an offset leaves the sums, and so does most of what R is off by.
 *
 * Iron that turns with the flux takes a current of its own at each turn. Of a motor with a small
 * magnet flux beside L i that would be a tenth and more of a swing. It takes nearly as much of a
 * small swing as of a large one: so D and F are those of large swings less those of small ones.
 *
 * The inductance is that of both phases, of iron that is as saturated as the hold saturates it,
 * less what hysteresis still takes: what the estimator needs is a little more.
 */
#ifndef STEADYSTEP_INDUCTANCE_MEASUREMENT_H
#define STEADYSTEP_INDUCTANCE_MEASUREMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/motor/motor_model.h"
#include "firmware/motor/per_unit.h"

struct inductance_measurement_params {
    uint32_t half;      /* periods from step to step; 0: nothing is measured */
    num_t small, large; /* amplitudes of the current */
};

struct inductance_measurement {
    uint32_t steps;   /* of the reference, that have come */
    uint32_t periods; /* since */
    num_t level;      /* of the current's reference, beside the hold's */
    num_t begin;      /* current at the step */
    num_t before;     /* current of the last period */
    num_t change;     /* D, of a large step less a small one, halved */
    num_t flux;       /* F */
    bool complete;    /* to be put in force */
};

/* `look_periods`: of the phases' comparison, in which it ends; 0: nothing is measured. */
struct inductance_measurement_params inductance_measurement_design(const struct per_unit *base,
                                                                   double hold_current_A,
                                                                   uint32_t look_periods);

void inductance_measurement_start(struct inductance_measurement *measurement);

/* One period, with voltage and current along the hold's; true: the current's reference is `level`
   beside the hold's from now on. */
bool inductance_measurement_step(struct inductance_measurement *measurement,
                                 const struct inductance_measurement_params *params,
                                 num_t resistance, num_t voltage, num_t current);

/* By what share the inductance is above that of an admittance b; 1 if that is more, or the current
   has not followed. */
num_t inductance_measurement_result(const struct inductance_measurement *measurement,
                                    const struct inductance_measurement_params *params,
                                    num_t admittance);

#endif
