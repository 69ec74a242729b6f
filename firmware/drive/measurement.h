/* Raw converter codes of one sample set to per-unit, with the offsets found while enabling. */
#ifndef STEADYSTEP_MEASUREMENT_H
#define STEADYSTEP_MEASUREMENT_H

#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"
#include "hal/hal.h"

/* Sample sets averaged for the offsets: noise and quantisation fall to a twentieth. */
#define OFFSET_SAMPLES 512

/* An offset above this many codes is a defect, not an offset. */
#define OFFSET_CODES_MAX 64

struct measurement_params {
    coef_t current;       /* per code */
    coef_t phase_voltage; /* per code */
    coef_t bus_voltage;   /* per code */
    int32_t current_zero_code;
};

/* The four zeroed channels. */
struct channels {
    struct phases current;
    struct phases voltage;
};

struct measurement {
    struct channels offset;
    int32_t sum[4]; /* of codes, while calibrating: currents, voltages */
    uint32_t samples;
};

struct sample_set {
    struct phases current;
    struct phases voltage; /* mean over the past period */
    num_t bus;
    int32_t encoder_count;
};

struct measurement_params measurement_design(const struct hal_facts *facts,
                                             const struct per_unit *base);

void measurement_reset(struct measurement *measurement);

struct sample_set measurement_step(const struct measurement *measurement,
                                   const struct measurement_params *params,
                                   const struct hal_samples *samples);

enum offset_calibration { OFFSETS_PENDING, OFFSETS_FOUND, OFFSETS_OUT_OF_RANGE };

/* One period of calibration with the bridge off. */
enum offset_calibration measurement_calibrate(struct measurement *measurement,
                                              const struct measurement_params *params,
                                              const struct hal_samples *samples);

#endif
