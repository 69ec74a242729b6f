/*
 * What heat does to the motor's winding and to the bridge.
 *
 * Winding, of each phase for itself:
 *
 *   tau dh/dt = (i / I_rated)^2 - h,     h = 1: the heat of the rated current
 *
 * A data sheet's rated current flows in both phases at once and for ever. So each phase bears it
 * whatever the other does, and at standstill one of them may carry all there is. From cold an
 * overload of k x I_rated comes to h after tau ln(k^2 / (k^2 - h)).
 *
 * The resistance is no factor of the heat: rated, the winding is hot already, and what a drive is
 * wrong about R (30 % are nothing unusual) would derate a motor at its rated current. But against
 * the same winding's cold resistance, as measured by the same drive, it is a thermometer: copper,
 * 0.393 %/K, and a rise of 80 K at the rated current, as data sheets have it. That is where the
 * model may begin.
 *
 * Bridge: an NTC resistor to ground, with its own value at 25 degrees Celsius to the converter's
 * supply,
 *
 *   code / (codes - code) = r = exp(B (1/T - 1/298.15 K)).
 */
#ifndef STEADYSTEP_THERMAL_MODEL_H
#define STEADYSTEP_THERMAL_MODEL_H

#include "firmware/motor/park.h"

#define WINDING_LOOKS 32 /* at most, of a span */

struct winding_heat {
    num_t phase[2]; /* h of a and b */
    num_t sum[2];   /* of squares in per-unit, 1/WINDING_LOOKS of each */
    uint8_t looks;
};

/* One of a span's looks at the currents. */
void winding_heat_look(struct winding_heat *winding, struct phases current);

/* A span passes, as much of it as was looked at. */
void winding_heat_pass(struct winding_heat *winding, num_real span_s, num_real time_constant_s);

/* At least what a resistance says that has risen to `ratio` of the cold one; 1 at most. */
void winding_heat_begin(struct winding_heat *winding, num_real ratio);

/* Of the hotter phase. */
static inline num_t winding_heat_most(const struct winding_heat *winding)
{
    return winding->phase[0] > winding->phase[1] ? winding->phase[0] : winding->phase[1];
}

/* Of the bridge at this temperature: the hotter, the less. */
uint32_t bridge_temperature_code(num_real bridge_C, num_real beta_K, uint32_t codes);

/* An NTC that is shorted or open: beyond 200 or below -55 degrees Celsius. */
static inline bool bridge_temperature_is_implausible(uint32_t code, uint32_t codes)
{
    const uint32_t margin = codes / 128u;

    return code - margin > codes - 2u * margin;
}

#endif
