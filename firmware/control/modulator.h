/*
 * Pulse-width modulation of two H-bridges: phase voltages to the times high of four legs.
 *
 * The legs of a phase switch at (1 + m)/2 and (1 - m)/2 with m = u / bus, within a limit that
 * leaves a window around the counter peak in which all four low sides conduct (modulation_limit.h).
 * The reciprocal of the measured bus voltage is tracked by one Newton step a period, without
 * division.
 */
#ifndef STEADYSTEP_MODULATOR_H
#define STEADYSTEP_MODULATOR_H

#include "firmware/motor/park.h"
#include "firmware/numeric/coefficients.h"

struct modulator_params {
    int32_t half_period_counts;
    int32_t middle_counts;    /* of a leg, at no voltage */
    int32_t swing_counts;     /* about the middle, at the largest modulation */
    unit_t max;               /* the largest modulation */
    coef_t counts;            /* modulation to counts of one leg */
    coef_t voltage_per_count; /* at nominal bus */
};

#define MODULATOR_PARAMS_COEFFICIENTS(X)                                                           \
    X(counts, modulator_counts)                                                                    \
    X(voltage_per_count, modulator_voltage_per_count)
COEFFICIENTS(modulator_params, MODULATOR_PARAMS_COEFFICIENTS)

struct modulator {
    num_t bus; /* measured, per-unit */
    num_t bus_reciprocal;
};

/* Times high per half period of the two legs of a phase, timer counts. */
struct leg_pair {
    int32_t plus;
    int32_t minus;
};

struct modulation {
    struct leg_pair a;
    struct leg_pair b;
    struct phases voltage; /* what the legs command at the present bus voltage */
};

__attribute__((cold)) struct modulator_params modulator_design(uint32_t half_period_counts,
                                                               double max);

void modulator_reset(struct modulator *modulator);

/* Any bus voltage, while nothing is modulated: for show. */
static inline void modulator_see_bus(struct modulator *modulator, num_t bus)
{
    modulator->bus = bus;
}

/*
 * Takes the bus voltage of S(k), 0.5...1.9 of nominal: beyond it the protection opens the bridge,
 * and nothing is modulated. It finds back after any jump:
 *
 * r <- r (2 - v r) squares the error at each step as long as 0 < v r < 2; kept from falling below
 * its range, r comes back into that even if the bus jumps by more than twofold. It never exceeds
 * 1/v, the maximum of the parabola, so the least bus bounds it.
 */
static inline void modulator_track_bus(struct modulator *modulator, num_t bus)
{
    const num_t reciprocal = modulator->bus_reciprocal;
    const num_t next = num_mul(reciprocal, NUM(2.0) - num_mul(bus, reciprocal));

    modulator->bus = bus;
    modulator->bus_reciprocal = RARE(next < NUM(0.5)) ? NUM(0.5) : next;
}

/* Largest voltage vector that can be commanded in any direction. */
static inline num_t modulator_voltage_limit(const struct modulator *modulator,
                                            const struct modulator_params *params)
{
    return num_mul_unit(modulator->bus, params->max);
}

/* By how many counts the two legs leave their middle, the one up and the other down. */
static inline int32_t modulator_swing(const struct modulator *modulator,
                                      const struct modulator_params *params, num_t voltage)
{
    const int32_t limit = params->swing_counts;
    const int32_t swing = counts_from_num(num_mul(voltage, modulator->bus_reciprocal),
                                          KNOWN(modulator_params, params)->counts);

    /* One comparison: what is below -limit wraps to a large number. */
    if (RARE((uint32_t)swing + (uint32_t)limit > 2u * (uint32_t)limit)) {
        return swing < 0 ? -limit : limit;
    }
    return swing;
}

static inline struct leg_pair modulator_legs(const struct modulator_params *params, int32_t swing)
{
    const int32_t plus = params->middle_counts + swing;
    const struct leg_pair legs = {plus, params->half_period_counts - plus};

    return legs;
}

static inline num_t modulator_voltage(const struct modulator *modulator,
                                      const struct modulator_params *params, int32_t swing)
{
    const num_t m = num_from_code(swing, KNOWN(modulator_params, params)->voltage_per_count);

    return num_mul(m, modulator->bus);
}

/* `voltage` of at most a few times the bus. */
__attribute__((always_inline)) static inline struct modulation
modulator_step(const struct modulator *modulator, const struct modulator_params *params,
               struct phases voltage)
{
    const int32_t swing_a = modulator_swing(modulator, params, voltage.a);
    const int32_t swing_b = modulator_swing(modulator, params, voltage.b);
    const struct modulation out = {
        .a = modulator_legs(params, swing_a),
        .b = modulator_legs(params, swing_b),
        .voltage = {modulator_voltage(modulator, params, swing_a),
                    modulator_voltage(modulator, params, swing_b)},
    };
    return out;
}

#endif
