/* What opens the bridge at once: watched in every control interrupt, in this order. */
#ifndef STEADYSTEP_PROTECTION_H
#define STEADYSTEP_PROTECTION_H

#include "firmware/drive/drive_interface.h"
#include "firmware/drive/measurement.h"
#include "firmware/estimator/estimate.h"

struct protection_params {
    num_t overcurrent;
    num_t bus_min;
    num_t bus_max;
    num_t speed_limit;
    num_t load_torque_limit;
};

struct protection_params protection_design(const struct per_unit *base,
                                           const struct drive_settings *settings);

/* Before the control: samples and the board's own flags. */
enum drive_fault protection_check_samples(const struct protection_params *params,
                                          const struct sample_set *now, uint32_t flags);

/* After the control: the estimate is finite and physical. A NaN fails every comparison. */
enum drive_fault protection_check_estimate(const struct protection_params *params,
                                           const struct estimate *estimate);

#endif
