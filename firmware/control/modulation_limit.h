/* How much of the bus the bridges give. */
#ifndef STEADYSTEP_MODULATION_LIMIT_H
#define STEADYSTEP_MODULATION_LIMIT_H

/* Largest |u| / bus of a phase: leaves a 4 us window at 10 kHz in which all four low sides conduct.
 */
#define MODULATION_MAX 0.92

#endif
