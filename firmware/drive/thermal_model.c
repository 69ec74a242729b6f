#include "firmware/drive/thermal_model.h"

#include "firmware/design/elementary.h"

/* Beyond any current that the protection lets pass. */
#define CURRENT_MAX NUM(5.0)

#define LOOK_SHARE_INVERSE 32.0

static const double copper_per_K = 0.00393;
static const double rated_rise_K = 80.0;

static const double reference_K = 298.15;
static const double zero_C_K = 273.15;

void winding_heat_look(struct winding_heat *winding, struct phases current)
{
    const num_t phase[2] = {num_limit(current.a, CURRENT_MAX), num_limit(current.b, CURRENT_MAX)};

    for (int i = 0; i < 2; i++) {
        winding->sum[i] +=
            num_mul_unit(num_mul(phase[i], phase[i]), UNIT(1.0 / LOOK_SHARE_INVERSE));
    }
    winding->looks++;
}

/* Implicit, so that it is stable for any time constant. */
void winding_heat_pass(struct winding_heat *winding, double span_s, double time_constant_s,
                       double rated_square)
{
    const double share = span_s / (time_constant_s + span_s);

    for (int i = 0; i < 2 && winding->looks > 0u; i++) {
        const double mean =
            num_to_double(winding->sum[i]) * LOOK_SHARE_INVERSE / (double)winding->looks;
        const double heat = (double)winding->heat[i];

        winding->heat[i] = (float)(heat + share * (mean / rated_square - heat));
        winding->sum[i] = NUM(0.0);
    }
    winding->looks = 0;
}

void winding_heat_begin(struct winding_heat *winding, double ratio)
{
    const double heat = smaller((ratio - 1.0) / (copper_per_K * rated_rise_K), 1.0);

    for (int i = 0; i < 2; i++) {
        winding->heat[i] = (float)larger((double)winding->heat[i], heat);
    }
}

bool bridge_thermometer_read(struct bridge_thermometer *thermometer, uint32_t code, uint32_t codes)
{
    const uint32_t margin = codes / 128u; /* below -55 and above 200 degrees Celsius */
    const double log_ratio = (double)thermometer->log_ratio;

    if (code < margin || code > codes - margin) {
        return false;
    }
    const double ratio = (double)code / (double)(codes - code);

    thermometer->log_ratio = (float)(log_ratio - 1.0 + ratio * exponential(-log_ratio));
    return true;
}

double bridge_thermometer_C(const struct bridge_thermometer *thermometer, double beta_K)
{
    return 1.0 / (1.0 / reference_K + (double)thermometer->log_ratio / beta_K) - zero_C_K;
}
