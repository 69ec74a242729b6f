/*
 * What heat does to the motor's winding and to the bridge.
 *
 * Winding, of each phase for itself:
 *
 *   tau dh/dt = (i / I_rated)^2 - h,     h = 1: the heat of the rated current
 *
 * A data sheet's rated current flows in both phases at once and for ever. So each phase bears it
 * whatever the other does, and at standstill one of them may carry all there is. From cold an
 * overload of k x I_rated reaches h after tau ln(k^2 / (k^2 - h)).
 *
 * Resistance is no factor of the heat: rated, the winding is hot already, and what R is off by (30
 * % are nothing unusual) would derate a motor at its rated current. But against the same winding's
 * cold resistance, measured by the same drive, it is a thermometer: copper, 0.393 %/K, and a rise
 * of 80 K at the rated current, as data sheets have it. That is where the model may begin.
 *
 * Bridge: an NTC resistor to ground, with its own value at 25 degrees Celsius to the converter's
 * supply,
 *
 *   code / (codes - code) = r = exp(B (1/T - 1/298.15 K)).
 */
#ifndef STEADYSTEP_THERMAL_MODEL_H
#define STEADYSTEP_THERMAL_MODEL_H

#include "firmware/motor/park.h"

struct winding_heat {
    float heat[2]; /* h of phases a and b */
    num_t sum[2];  /* of squares in per-unit, a 32nd of each */
    uint32_t looks;
};

/* Looks of which winding_heat_pass makes a mean: 64 at most. */
void winding_heat_look(struct winding_heat *winding, struct phases current);

/* A span of time passes; `rated_square`: of the rated current in per-unit. Without a look since the
   last nothing is known of it. */
void winding_heat_pass(struct winding_heat *winding, double span_s, double time_constant_s,
                       double rated_square);

/* At least what a resistance says that has risen to `ratio` of the cold one; 1 at most. */
void winding_heat_begin(struct winding_heat *winding, double ratio);

/* Of the hotter phase. */
static inline double winding_heat_most(const struct winding_heat *winding)
{
    return (double)(winding->heat[0] > winding->heat[1] ? winding->heat[0] : winding->heat[1]);
}

struct bridge_thermometer {
    float log_ratio; /* ln r, found by a step of Newton's method at each reading */
};

/* A reading; false: no NTC gives this code, it is shorted or open. */
bool bridge_thermometer_read(struct bridge_thermometer *thermometer, uint32_t code, uint32_t codes);

/* Degrees Celsius, within 0.1 K some ten readings behind a change. */
double bridge_thermometer_C(const struct bridge_thermometer *thermometer, double beta_K);

#endif
