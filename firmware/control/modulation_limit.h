/* How much of the bus the bridges give. */
#ifndef STEADYSTEP_MODULATION_LIMIT_H
#define STEADYSTEP_MODULATION_LIMIT_H

/* Largest |u| / bus of a phase, whose legs are high for (1 +- u / bus) / 2 of the period: leaves
   the low state (hal.h) around the counter peak. 0.92 of 4 us at 10 kHz, 0.84 at 20 kHz. */
static inline double modulation_max(double low_state_s, double period_s)
{
    return 1.0 - 2.0 * low_state_s / period_s;
}

/* Less of the bus than this leaves too little to control with. */
#define MODULATION_MAX_LEAST 0.6

#endif
