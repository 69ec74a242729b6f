/* Raw converter codes of one sample set to per-unit, with the offsets found while enabling. */
#ifndef STEADYSTEP_MEASUREMENT_H
#define STEADYSTEP_MEASUREMENT_H

#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"
#include "firmware/numeric/coefficients.h"
#include "hal/hal.h"

struct measurement_params {
    coef_t current;       /* per code */
    coef_t phase_voltage; /* per code */
    coef_t bus_voltage;   /* per code */
    int32_t current_zero_code;
};

#define MEASUREMENT_PARAMS_COEFFICIENTS(X)                                                         \
    X(current, measured_current)                                                                   \
    X(phase_voltage, measured_phase_voltage)                                                       \
    X(bus_voltage, measured_bus_voltage)
COEFFICIENTS(measurement_params, MEASUREMENT_PARAMS_COEFFICIENTS)

struct measurement {
    struct channels offset; /* of the four channels that are zeroed: offset_calibration.h */
    coef_t current_a;       /* per code; as the board has them, until the phases are balanced */
    coef_t current_b;
};

#define MEASUREMENT_COEFFICIENTS(X) X(current_a, measured_current) X(current_b, measured_current)
COEFFICIENTS(measurement, MEASUREMENT_COEFFICIENTS)

struct sample_set {
    struct channels winding;
    num_t bus;
    int32_t encoder_count;
};

__attribute__((cold)) struct measurement_params measurement_design(const struct hal_facts *facts,
                                                                   const struct per_unit *base);

void measurement_reset(struct measurement *measurement, const struct measurement_params *params);

static inline void measurement_add_voltage_offset(struct measurement *measurement,
                                                  struct phases more)
{
    measurement->offset.voltage.a += more.a;
    measurement->offset.voltage.b += more.b;
}

/* The currents, their offsets with them, by 1 + d + d^2 / 2 and 1 - d + d^2 / 2: phase_balance.h.
 */
__attribute__((noinline)) void measurement_balance(struct measurement *measurement,
                                                   num_t imbalance);

static inline void measurement_set_offset(struct measurement *measurement, struct channels offset)
{
    measurement->offset = offset;
}

static inline num_t measurement_bus(const struct measurement_params *params,
                                    const struct hal_samples *samples)
{
    return num_from_code(samples->bus_voltage, KNOWN(measurement_params, params)->bus_voltage);
}

/* Of the same two currents alone; for the background. */
__attribute__((noinline)) struct phases measurement_current(const struct measurement *measurement,
                                                            const struct measurement_params *params,
                                                            uint16_t code_a, uint16_t code_b);

static inline __attribute__((always_inline)) struct sample_set
measurement_step(const struct measurement *measurement, const struct measurement_params *params,
                 const struct hal_samples *samples)
{
    const struct measurement *scale = KNOWN(measurement, measurement);
    const struct measurement_params *scales = KNOWN(measurement_params, params);
    const struct channels *offset = &measurement->offset;
    const int32_t code_a = samples->current_a - params->current_zero_code;
    const int32_t code_b = samples->current_b - params->current_zero_code;
    struct sample_set now;

    now.winding.current.a = num_from_code(code_a, scale->current_a) - offset->current.a;
    now.winding.current.b = num_from_code(code_b, scale->current_b) - offset->current.b;
    now.winding.voltage.a =
        num_from_code(samples->phase_voltage_a, scales->phase_voltage) - offset->voltage.a;
    now.winding.voltage.b =
        num_from_code(samples->phase_voltage_b, scales->phase_voltage) - offset->voltage.b;
    now.bus = measurement_bus(params, samples);
    now.encoder_count = samples->encoder_count;
    return now;
}

#endif
