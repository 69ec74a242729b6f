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

static num_t mean(int32_t sum, coef_t per_code)
{
    return num_mul(num_from_code(sum, per_code), NUM(1.0 / OFFSET_SAMPLES));
}

enum offset_calibration measurement_calibrate(struct measurement *measurement,
                                              const struct measurement_params *params,
                                              const struct hal_samples *samples)
{
    int32_t *sum = measurement->sum;

    sum[0] += samples->current_a - params->current_zero_code;
    sum[1] += samples->current_b - params->current_zero_code;
    sum[2] += samples->phase_voltage_a;
    sum[3] += samples->phase_voltage_b;
    if (++measurement->samples < OFFSET_SAMPLES) {
        return OFFSETS_PENDING;
    }
    for (int channel = 0; channel < 4; channel++) {
        if (sum[channel] > OFFSET_CODES_MAX * OFFSET_SAMPLES ||
            sum[channel] < -OFFSET_CODES_MAX * OFFSET_SAMPLES) {
            return OFFSETS_OUT_OF_RANGE;
        }
    }
    measurement->offset.current.a = mean(sum[0], params->current);
    measurement->offset.current.b = mean(sum[1], params->current);
    measurement->offset.voltage.a = mean(sum[2], params->phase_voltage);
    measurement->offset.voltage.b = mean(sum[3], params->phase_voltage);
    return OFFSETS_FOUND;
}
