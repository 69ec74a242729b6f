#include "firmware/drive/offset_calibration.h"

static int32_t whole(double value)
{
    return (int32_t)(value < 1e9 ? value : 1e9);
}

struct offset_calibration_params offset_calibration_design(const struct hal_facts *facts,
                                                           const struct motor_params *motor,
                                                           const struct per_unit *base)
{
    const double share = facts->leg_delay_s / facts->control_period_s;
    const double resistance_ohm = motor->resistance_ohm + facts->bridge_resistance_ohm;
    const double delay_codes = motor->supply_V * share / resistance_ohm / facts->current_A_per_code;
    const double finer = (double)facts->converter_codes / 4096.0;
    const double shift_codes = OFFSET_SHIFT_CODES_MAX * finer + delay_codes;
    const double drop_V = motor->resistance_ohm * facts->current_A_per_code;

    return (struct offset_calibration_params){
        .settling_samples = whole(OFFSET_SETTLING_us * 1e-6 / facts->control_period_s + 0.5),
        .delay = whole(delay_codes * OFFSET_SAMPLES),
        .shift_max = whole(shift_codes * OFFSET_SAMPLES),
        .deviation_max = whole(OFFSET_DEVIATION_CODES_MAX * finer * OFFSET_SAMPLES),
        .drop = coef_large_from_double(drop_V / base->voltage_V * NUM_CODE_SCALE),
        .drop_resistance = num_from_double(motor->resistance_ohm / base->resistance_ohm),
    };
}

void offset_calibration_reset(struct offset_calibration *calibration)
{
    /* Member by member: a whole structure is cleared by a call of memset. */
    for (int n = 0; n < OFFSET_CHANNELS; n++) {
        struct offset_channel *channel = &calibration->channel[n];

        channel->sum = 0;
        channel->reference = 0;
        channel->deviation = 0;
        channel->sum_off = 0;
        channel->deviation_max = 0;
        channel->flowing = 0;
    }
    calibration->samples = 0;
    calibration->bridge_on = false;
    calibration->noisy = 0u;
}

static int32_t magnitude(int32_t value)
{
    return value < 0 ? -value : value;
}

static int32_t to_nearest(int32_t sum, int32_t count)
{
    return (sum < 0 ? sum - count / 2 : sum + count / 2) / count;
}

static void add(struct offset_calibration *calibration, const int32_t code[OFFSET_CHANNELS])
{
    const int32_t samples = ++calibration->samples;

    for (int n = 0; n < OFFSET_CHANNELS; n++) {
        struct offset_channel *channel = &calibration->channel[n];

        channel->sum += code[n];
        if (samples <= 0) {
            channel->sum = 0;
            channel->deviation = 0;
        } else if (samples == OFFSET_REFERENCE_SAMPLES) {
            channel->reference = to_nearest(channel->sum, OFFSET_REFERENCE_SAMPLES);
        } else if (samples > OFFSET_REFERENCE_SAMPLES) {
            channel->deviation += magnitude(code[n] - channel->reference);
        }
    }
}

static bool is_too_large(const struct offset_calibration_params *params, int32_t sum)
{
    return magnitude(sum) > OFFSET_CODES_MAX / OFFSET_DEVIATION_CODES_MAX * params->deviation_max;
}

/* Whether what a channel has read is that of a sensor. Leaves the sum that counts, and after stage
   1 what stage 2 is compared with: a voltage may differ by anything, and takes stage 2. */
static bool judge(struct offset_channel *channel, const struct offset_calibration_params *params,
                  bool is_current, bool bridge_on)
{
    if (is_too_large(params, channel->sum)) {
        return false;
    }
    if (bridge_on) {
        const int32_t difference = channel->sum - channel->sum_off;
        const int32_t shift = magnitude(difference);

        if ((is_current && shift > params->shift_max) ||
            channel->deviation > channel->deviation_max) {
            return false;
        }
        if (!is_current || shift > params->delay) {
            return true;
        }
        channel->sum = channel->sum_off;
        channel->flowing = difference;
    } else {
        channel->sum_off = channel->sum;
        channel->deviation_max = params->deviation_max + 2 * channel->deviation;
    }
    return true;
}

static bool is_noisy(const struct offset_channel *channel)
{
    const int32_t samples = OFFSET_SAMPLES - OFFSET_REFERENCE_SAMPLES;
    const int32_t beside = magnitude(channel->sum - OFFSET_SAMPLES * channel->reference);
    const int32_t explained = beside * samples / (2 * OFFSET_SAMPLES);

    return 100 * (channel->deviation - explained) >= OFFSET_NOISE_PERCENT * samples;
}

/* The last sample of a stage has been added. */
static bool end_stage(struct offset_calibration *calibration,
                      const struct offset_calibration_params *params)
{
    for (int n = 0; n < OFFSET_CHANNELS; n++) {
        if (!judge(&calibration->channel[n], params, n < 2, calibration->bridge_on)) {
            return false;
        }
        if (!calibration->bridge_on && is_noisy(&calibration->channel[n])) {
            calibration->noisy |= (uint8_t)(1u << n);
        }
    }
    if (!calibration->bridge_on) {
        calibration->bridge_on = true;
        calibration->samples = -params->settling_samples;
    }
    return true;
}

/* In whole codes, if the sum is larger than num_from_code_sum takes: of a finer converter, or as
   what is too large is shown. */
__attribute__((noinline)) static num_t mean_offset(int32_t sum, coef_t per_code)
{
    if (magnitude(sum) > OFFSET_CODES_MAX * OFFSET_SAMPLES) {
        return num_from_code(sum / OFFSET_SAMPLES, per_code);
    }
    return num_mul(num_from_code_sum(sum, per_code), NUM(1.0 / OFFSET_SAMPLES));
}

struct phases offset_calibration_drop_error(const struct offset_calibration *calibration,
                                            const struct offset_calibration_params *params,
                                            const struct measurement_params *scales,
                                            num_t resistance)
{
    const num_t error = params->drop_resistance - resistance;

    return (struct phases){
        num_mul(mean_offset(calibration->channel[0].flowing, scales->current), error),
        num_mul(mean_offset(calibration->channel[1].flowing, scales->current), error)};
}

static void find(const struct offset_calibration *calibration,
                 const struct offset_calibration_params *params,
                 const struct measurement_params *scales, struct channels *offset)
{
    offset->current.a = mean_offset(calibration->channel[0].sum, scales->current);
    offset->current.b = mean_offset(calibration->channel[1].sum, scales->current);
    offset->voltage.a = mean_offset(calibration->channel[2].sum, scales->phase_voltage) -
                        mean_offset(calibration->channel[0].flowing, params->drop);
    offset->voltage.b = mean_offset(calibration->channel[3].sum, scales->phase_voltage) -
                        mean_offset(calibration->channel[1].flowing, params->drop);
}

enum offset_result offset_calibration_step(struct offset_calibration *calibration,
                                           const struct offset_calibration_params *params,
                                           const struct measurement_params *scales,
                                           const struct hal_samples *samples,
                                           struct channels *offset)
{
    const int32_t code[OFFSET_CHANNELS] = {
        samples->current_a - scales->current_zero_code,
        samples->current_b - scales->current_zero_code,
        samples->phase_voltage_a,
        samples->phase_voltage_b,
    };

    add(calibration, code);
    if (calibration->samples < OFFSET_SAMPLES) {
        return OFFSETS_PENDING;
    }

    const bool sound = end_stage(calibration, params);

    if (sound && calibration->samples < OFFSET_SAMPLES) { /* the second stage follows */
        return OFFSETS_PENDING;
    }
    find(calibration, params, scales, offset);
    return sound ? OFFSETS_FOUND : OFFSETS_OUT_OF_RANGE;
}
