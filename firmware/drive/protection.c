#include "firmware/drive/protection.h"

/* Share of the nominal supply; the sensing saturates at 1.3. */
static const double bus_min = 0.5;
static const double bus_max = 1.29;

/* No load that the motor could hold twice over is taken for real. */
static const double load_torque_limit = 2.0;

/* A bound in converter codes; what no code can reach is never reached. */
static int32_t codes(double value, double per_code)
{
    const double count = value / per_code;

    return count < 65535.0 ? (int32_t)count : 65535;
}

struct protection_params protection_design(const struct per_unit *base,
                                           const struct hal_facts *facts,
                                           const struct drive_settings *settings)
{
    const double supply_V = settings->motor.supply_V;
    const struct protection_params params = {
        .current_zero_code = facts->current_zero_code,
        .overcurrent_codes = codes(settings->overcurrent_trip_A, facts->current_A_per_code),
        .bus_code_min = codes(bus_min * supply_V, facts->bus_V_per_code),
        .bus_code_max = codes(bus_max * supply_V, facts->bus_V_per_code),
        .speed_limit = num_from_double(settings->speed_limit_rad_s / base->speed_rad_s),
        .load_torque_limit = num_from_double(load_torque_limit),
    };
    return params;
}

/* One comparison: a code below -limit wraps to a large number. */
static bool beyond(int32_t codes, int32_t limit)
{
    return (uint32_t)(codes + limit) > 2u * (uint32_t)limit;
}

enum drive_fault protection_check_samples(const struct protection_params *params,
                                          const struct hal_samples *samples)
{
    if (samples->flags != 0u) {
        return (samples->flags & HAL_FLAG_OVERCURRENT_TRIP) != 0u ? DRIVE_FAULT_HARDWARE_OVERCURRENT
                                                                  : DRIVE_FAULT_DEADLINE_MISSED;
    }
    if (beyond(samples->current_a - params->current_zero_code, params->overcurrent_codes) ||
        beyond(samples->current_b - params->current_zero_code, params->overcurrent_codes)) {
        return DRIVE_FAULT_OVERCURRENT;
    }
    if (samples->bus_voltage < params->bus_code_min ||
        samples->bus_voltage > params->bus_code_max) {
        return DRIVE_FAULT_BUS_VOLTAGE;
    }
    return DRIVE_FAULT_NONE;
}

enum drive_fault protection_check_estimate(const struct protection_params *params,
                                           const struct estimate *estimate)
{
    const bool physical = num_abs(estimate->rotor.speed) < params->speed_limit &&
                          num_abs(estimate->rotor.load_torque) < params->load_torque_limit;

    return physical ? DRIVE_FAULT_NONE : DRIVE_FAULT_ESTIMATE_RANGE;
}
