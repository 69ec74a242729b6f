#include "firmware/drive/measurement.h"

struct measurement_params measurement_design(const struct hal_facts *facts,
                                             const struct per_unit *base)
{
    struct measurement_params params;

    params.current = coef_from_double(facts->current_A_per_code / base->current_A * NUM_CODE_SCALE);
    params.phase_voltage =
        coef_from_double(facts->phase_voltage_V_per_code / base->voltage_V * NUM_CODE_SCALE);
    params.bus_voltage = coef_from_double(facts->bus_V_per_code / base->voltage_V * NUM_CODE_SCALE);
    params.current_zero_code = facts->current_zero_code;
    return params;
}

void measurement_reset(struct measurement *measurement)
{
    const struct measurement zero = {0};

    *measurement = zero;
}
