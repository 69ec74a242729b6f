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

/* Before the control: raw samples and the board's own flags. */
enum drive_fault protection_check_samples(const struct protection_params *params,
                                          const struct hal_samples *samples);

/*
 * After the estimator: the estimate is finite and physical. A NaN or an infinity anywhere in it
 * reaches speed or load torque within the period, and fails every comparison.
 */
enum drive_fault protection_check_estimate(const struct protection_params *params,
                                           const struct estimate *estimate);

#endif
