/*
 * Pulse-width modulation of two H-bridges: phase voltages to the times high of four legs.
 *
 * The legs of a phase switch at (1 + m)/2 and (1 - m)/2 with m = u / bus, |m| <= 0.92, which
 * leaves a 4 us window around the counter peak in which all four low sides conduct. The
 * reciprocal of the measured bus voltage is tracked by one Newton step a period, without division.
 */
#ifndef STEADYSTEP_MODULATOR_H
#define STEADYSTEP_MODULATOR_H

#include "firmware/control/modulation_limit.h"
#include "firmware/motor/park.h"

struct modulator_params {
    int32_t half_period_counts;
    int32_t middle_counts;    /* of a leg, at no voltage */
    int32_t swing_counts;     /* about the middle, at MODULATION_MAX */
    coef_t counts;            /* modulation to counts of one leg */
    coef_t voltage_per_count; /* at nominal bus */
};

struct modulator {
    num_t bus; /* measured, per-unit */
    num_t bus_reciprocal;
};

/* Times high per half period of the two legs of a phase, timer counts. */
struct leg_pair {
    uint16_t plus;
    uint16_t minus;
};

struct modulation {
    struct leg_pair a;
    struct leg_pair b;
    struct phases voltage; /* what the legs command at the present bus voltage */
};

__attribute__((cold)) struct modulator_params modulator_design(uint32_t half_period_counts);

void modulator_reset(struct modulator *modulator);

/*
 * Takes the bus voltage of S(k), 0.5...1.9 of nominal: beyond it the protection opens the bridge.
 * After any other value it finds back.
 */
void modulator_track_bus(struct modulator *modulator, num_t bus);

/* Largest voltage vector that can be commanded in any direction. */
num_t modulator_voltage_limit(const struct modulator *modulator);

/* `voltage` of at most a few times the bus. */
struct modulation modulator_step(const struct modulator *modulator,
                                 const struct modulator_params *params, struct phases voltage);

#endif
