#include "firmware/drive/protection.h"

#include "firmware/drive/board_limits.h"

/* No load that the motor could hold twice over is taken for real. */
static const double load_torque_limit = 2.0;

/* An initial error makes the high-gain observer's estimates peak beyond any physical range. */
static double estimate_limit(const struct drive_settings *settings, double limit)
{
    const bool peaks = settings->feedback == DRIVE_FEEDBACK_ENCODER &&
                       settings->observer == DRIVE_OBSERVER_HIGH_GAIN;

    return peaks ? NUM_MAX : limit;
}

/* A bound in converter codes; what no code can reach is never reached. */
__attribute__((noinline)) static int32_t codes(double value, double per_code)
{
    const double count = value / per_code;

    return count < 65535.0 ? (int32_t)count : 65535;
}

struct protection_params protection_design(const struct per_unit *base,
                                           const struct hal_facts *facts,
                                           const struct drive_settings *settings)
{
    const double supply_V = settings->motor.supply_V;
    const int32_t trip = codes(settings->overcurrent_trip_A, facts->current_A_per_code);
    const int32_t bus_code_min = codes(BUS_VOLTAGE_MIN * supply_V, facts->bus_V_per_code);
    const struct protection_params params = {
        .current_codes = {facts->current_zero_code - trip, 2 * trip},
        .bus_codes = {bus_code_min,
                      codes(BUS_VOLTAGE_MAX * supply_V, facts->bus_V_per_code) - bus_code_min},
        .speed_limit = num_from_double(
            estimate_limit(settings, settings->speed_limit_rad_s / base->speed_rad_s)),
        .load_torque_limit = num_from_double(estimate_limit(settings, load_torque_limit)),
    };
    return params;
}

enum drive_fault protection_check_samples(const struct protection_params *params,
                                          const struct hal_samples *samples)
{
    if (samples->flags != 0u) {
        return (samples->flags & HAL_FLAG_OVERCURRENT_TRIP) != 0u ? DRIVE_FAULT_HARDWARE_OVERCURRENT
                                                                  : DRIVE_FAULT_DEADLINE_MISSED;
    }
    if (code_is_beyond(params->current_codes, samples->current_a) ||
        code_is_beyond(params->current_codes, samples->current_b)) {
        return DRIVE_FAULT_OVERCURRENT;
    }
    return protection_passes(params, samples) ? DRIVE_FAULT_NONE : DRIVE_FAULT_BUS_VOLTAGE;
}
