#include "firmware/drive/protection.h"

/* Share of the nominal supply; the sensing saturates at 1.3. */
static const double bus_min = 0.5;
static const double bus_max = 1.29;

/* No load that the motor could hold twice over is taken for real. */
static const double load_torque_limit = 2.0;

struct protection_params protection_design(const struct per_unit *base,
                                           const struct drive_settings *settings)
{
    struct protection_params params;

    params.overcurrent = num_from_double(settings->overcurrent_trip_A / base->current_A);
    params.bus_min = num_from_double(bus_min);
    params.bus_max = num_from_double(bus_max);
    params.speed_limit = num_from_double(settings->speed_limit_rad_s / base->speed_rad_s);
    params.load_torque_limit = num_from_double(load_torque_limit);
    return params;
}

static bool within(num_t value, num_t limit)
{
    return value < limit && -value < limit;
}

enum drive_fault protection_check_samples(const struct protection_params *params,
                                          const struct sample_set *now, uint32_t flags)
{
    if ((flags & HAL_FLAG_OVERCURRENT_TRIP) != 0u) {
        return DRIVE_FAULT_HARDWARE_OVERCURRENT;
    }
    if ((flags & HAL_FLAG_DEADLINE_MISSED) != 0u) {
        return DRIVE_FAULT_DEADLINE_MISSED;
    }
    if (!within(now->current.a, params->overcurrent) ||
        !within(now->current.b, params->overcurrent)) {
        return DRIVE_FAULT_OVERCURRENT;
    }
    if (now->bus < params->bus_min || now->bus > params->bus_max) {
        return DRIVE_FAULT_BUS_VOLTAGE;
    }
    return DRIVE_FAULT_NONE;
}

enum drive_fault protection_check_estimate(const struct protection_params *params,
                                           const struct estimate *estimate)
{
    const bool physical = within(estimate->rotor.speed, params->speed_limit) &&
                          within(estimate->rotor.load_torque, params->load_torque_limit) &&
                          within(estimate->current.a, NUM(4.0)) &&
                          within(estimate->current.b, NUM(4.0));

    return physical ? DRIVE_FAULT_NONE : DRIVE_FAULT_ESTIMATE_RANGE;
}
