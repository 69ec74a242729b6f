#include "firmware/drive/measurement.h"

struct measurement_params measurement_design(const struct hal_facts *facts,
                                             const struct per_unit *base)
{
    struct measurement_params params;

    params.current =
        coef_large_from_double(facts->current_A_per_code / base->current_A * NUM_CODE_SCALE);
    params.phase_voltage =
        coef_large_from_double(facts->phase_voltage_V_per_code / base->voltage_V * NUM_CODE_SCALE);
    params.bus_voltage =
        coef_large_from_double(facts->bus_V_per_code / base->voltage_V * NUM_CODE_SCALE);
    params.current_zero_code = facts->current_zero_code;
    measurement_params_fit_coefficients(&params);
    return params;
}

void measurement_reset(struct measurement *measurement, const struct measurement_params *params)
{
    const struct phases none = {NUM(0.0), NUM(0.0)}; /* of both at once a call clears them */

    measurement->offset.current = none;
    measurement->offset.voltage = none;
    measurement->current_a = params->current;
    measurement->current_b = params->current;
}

void measurement_balance(struct measurement *measurement, num_t imbalance)
{
    const num_t square = num_half(num_mul(imbalance, imbalance));
    const num_t more = square + imbalance;
    const num_t less = square - imbalance;

    measurement->current_a = coef_more(measurement->current_a, more);
    measurement->current_b = coef_more(measurement->current_b, less);
    measurement->offset.current.a += num_mul(measurement->offset.current.a, more);
    measurement->offset.current.b += num_mul(measurement->offset.current.b, less);
}

struct phases measurement_current(const struct measurement *measurement,
                                  const struct measurement_params *params, uint16_t code_a,
                                  uint16_t code_b)
{
    const struct phases offset = measurement->offset.current;

    return (struct phases){
        num_from_code(code_a - params->current_zero_code, measurement->current_a) - offset.a,
        num_from_code(code_b - params->current_zero_code, measurement->current_b) - offset.b};
}
