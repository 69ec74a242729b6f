/* What opens the bridge at once: watched in every control interrupt, in this order. */
#ifndef STEADYSTEP_PROTECTION_H
#define STEADYSTEP_PROTECTION_H

#include "firmware/interface/drive_interface.h"
#include "firmware/estimator/estimate.h"
#include "hal/hal.h"

/* Converter codes from low to low + width, both allowed. */
struct code_range {
    int32_t low;
    int32_t width;
};

struct protection_params {
    struct code_range current_codes;
    struct code_range bus_codes;
    num_t speed_limit;
    num_t load_torque_limit;
};

__attribute__((cold)) struct protection_params
protection_design(const struct per_unit *base, const struct hal_facts *facts,
                  const struct drive_settings *settings);

/* One comparison: a code below the range wraps to a large number. */
static inline bool code_is_beyond(struct code_range range, int32_t code)
{
    return (uint32_t)(code - range.low) > (uint32_t)range.width;
}

/* Before the control: raw samples and the board's own flags; false: there is a fault. */
static inline bool protection_passes(const struct protection_params *params,
                                     const struct hal_samples *samples)
{
    return samples->flags == 0u && !code_is_beyond(params->current_codes, samples->current_a) &&
           !code_is_beyond(params->current_codes, samples->current_b) &&
           !code_is_beyond(params->bus_codes, samples->bus_voltage);
}

/* Which. */
enum drive_fault protection_check_samples(const struct protection_params *params,
                                          const struct hal_samples *samples);

/*
 * After the estimator: the estimate is finite and physical. A NaN or an infinity anywhere in it
 * reaches speed or load torque within the period, and fails every comparison.
 */
static inline bool protection_trusts(const struct protection_params *params,
                                     const struct estimate *estimate)
{
    return !RARE(!(num_abs(estimate->rotor.speed) < params->speed_limit)) &&
           !RARE(!(num_abs(estimate->rotor.load_torque) < params->load_torque_limit));
}

#endif
