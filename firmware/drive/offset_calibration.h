/*
 * The converters' offsets, found while the drive is enabled, in two stages of 512 samples:
 *
 *   1. Bridge off: no current can flow, so what the current channels read is offset. The voltage
 *      channels may read the back-EMF of a rotor that turns.
 *   2. Bridge on, all legs at half duty: the sensors as they work in operation, with the switching
 *      that shifts amplifiers and the half bus that uneven dividers turn into a voltage. The
 *      phase voltage is 0, so what the voltage channels read is offset. A current may flow: of a
 *      rotor that is turned, through the shorted windings; or of the delay between the two legs
 *      of a phase, bus x delay / period / R.
 *
 * So the voltages take stage 2. A current takes it if it differs from stage 1 by more than that
 * delay explains; else the difference i may flow, and R i of what the phase's voltage channel reads
 * in stage 2 is no offset. If i was offset after all, current and voltage are off by i and R i, and
 * either way u - R i, the back-EMF at rest, is 0.
 *
 * What a current channel's codes scatter by in stage 1 is its noise. One that has some is
 * distinguished from one that is stuck (phase_watch.h). Two codes in turn are no sign of it: a mean
 * between them shows them for next to none.
 *
 * Calibration fails if an offset is too large to be one, or if what is read in stage 2 varies, or a
 * current lies further from stage 1, than a sensor's would: the rotor is being turned.
 */
#ifndef STEADYSTEP_OFFSET_CALIBRATION_H
#define STEADYSTEP_OFFSET_CALIBRATION_H

#include "firmware/interface/drive_interface.h"
#include "firmware/drive/measurement.h"

/* Sample sets averaged in a stage, however long a period is: noise and quantisation fall to a
   twentieth. */
#define OFFSET_SAMPLES 512

/* An offset above this many codes of 12 bits is a defect, not an offset. */
#define OFFSET_CODES_MAX 64

/* Of stage 2 until amplifiers, filters of the legs and the slowest windings have settled. */
#define OFFSET_SETTLING_us 20000

/* Codes of 12 bits: what the switching may shift a current's offset by, beside what flows, and how
   far the samples of stage 2 may lie from those of its beginning, in the mean, beside twice as far
   as in stage 1, which is noise. */
#define OFFSET_SHIFT_CODES_MAX     12
#define OFFSET_DEVIATION_CODES_MAX 1

/* Percent of a code: mean deviation from the nearest code to their mean, less half of the mean's
   own, from which on samples are noisy. A mean between two codes makes 25 of it without noise; 0.8
   codes rms make 47 and more wherever it lies, 0.5 codes 32 at most. */
#define OFFSET_NOISE_PERCENT 40

enum {
    OFFSET_CHANNELS = 4,
    OFFSET_REFERENCE_SAMPLES = OFFSET_SAMPLES / 8, /* the beginning of a stage */
    OFFSET_PERIODS = 2 * OFFSET_SAMPLES + OFFSET_SETTLING_us / 100 + 1, /* of both, at 10 kHz */
};

struct offset_calibration_params {
    int32_t settling_samples;
    /* of sums of codes of a current, between the stages */
    int32_t delay;         /* what the delay between two legs explains */
    int32_t shift_max;     /* what a sensor's offset may differ by */
    int32_t deviation_max; /* sum of magnitudes */
    coef_t drop;           /* voltage at the winding's resistance, per code of current */
    num_t drop_resistance;
};

struct offset_channel {
    int32_t sum;                    /* of codes, this stage */
    int32_t reference;              /* mean code of the stage's beginning */
    int32_t deviation;              /* sum of magnitudes, from the reference */
    int32_t sum_off, deviation_max; /* of stage 1, for stage 2 */
    int32_t flowing;                /* of a current in stage 2, which is no offset: sum of codes */
};

struct offset_calibration {
    struct offset_channel channel[OFFSET_CHANNELS]; /* currents, voltages */
    int32_t samples;                                /* of this stage; up to 0: settling */
    bool bridge_on;                                 /* stage 2 */
    uint8_t noisy;                                  /* a bit of each channel that was in stage 1 */
};

struct offset_calibration_params offset_calibration_design(const struct hal_facts *facts,
                                                           const struct motor_params *motor,
                                                           const struct per_unit *base);

void offset_calibration_reset(struct offset_calibration *calibration);

enum offset_result { OFFSETS_PENDING, OFFSETS_FOUND, OFFSETS_OUT_OF_RANGE };

/* From the period behind the last sample's on: what follows costs enough by itself. */
static inline bool offset_calibration_is_done(const struct offset_calibration *calibration)
{
    return calibration->samples == OFFSET_SAMPLES;
}

/*
 * What is to be added to the offsets of the voltages once the resistance is known: the currents
 * that may have flowed while these were read had been given the drop at the winding's as it was
 * known.
 */
struct phases offset_calibration_drop_error(const struct offset_calibration *calibration,
                                            const struct offset_calibration_params *params,
                                            const struct measurement_params *scales,
                                            num_t resistance);

/* One period, unless it is done: `offset` is set unless more are pending, out of range as it was
   read, to be shown. The bridge is to be on with all legs at half duty as soon as bridge_on is set.
   Apart: compiled into its caller, it would be made large. */
__attribute__((noinline)) enum offset_result
offset_calibration_step(struct offset_calibration *calibration,
                        const struct offset_calibration_params *params,
                        const struct measurement_params *scales, const struct hal_samples *samples,
                        struct channels *offset);

#endif
