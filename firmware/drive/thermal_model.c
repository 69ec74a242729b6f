#include "firmware/drive/thermal_model.h"

#include "firmware/design/elementary.h"

/* Five times the rated current, beyond which no phase is for long. */
#define CURRENT_MAX NUM(2.5)

/* Copper, of a rise of 80 K. */
static const num_real rated_rise = (num_real)(0.00393 * 80.0);

static const num_real reference_K = (num_real)298.15;
static const num_real zero_C_K = (num_real)273.15;

void winding_heat_look(struct winding_heat *winding, struct phases current)
{
    const num_t phase[2] = {current.a, current.b};

    for (int i = 0; i < 2; i++) {
        const num_t factor = num_headroom(phase[i], CURRENT_MAX);

        winding->sum[i] += num_mul_unit(num_mul(factor, factor), UNIT(1.0 / WINDING_LOOKS));
    }
    winding->looks++;
}

/* Implicit, so that it is stable for any time constant. The rated current is a half in per-unit. */
void winding_heat_pass(struct winding_heat *winding, num_real span_s, num_real time_constant_s)
{
    const coef_t share = coef_from_double((double)(span_s / (time_constant_s + span_s)));

    for (int i = 0; i < 2; i++) {
        const num_t given_off =
            num_mul_unit(winding->phase[i], UNIT(1.0 / WINDING_LOOKS)) * winding->looks;

        winding->phase[i] += num_mul_coef(4 * winding->sum[i] - given_off, share);
        winding->sum[i] = NUM(0.0);
    }
    winding->looks = 0;
}

void winding_heat_begin(struct winding_heat *winding, num_real ratio)
{
    const num_real rise = (ratio - 1) / rated_rise;
    const num_t heat = num_from_double((double)(rise < 1 ? rise : 1));

    for (int i = 0; i < 2; i++) {
        winding->phase[i] = winding->phase[i] > heat ? winding->phase[i] : heat;
    }
}

uint32_t bridge_temperature_code(num_real bridge_C, num_real beta_K, uint32_t codes)
{
    const num_real exponent = beta_K / reference_K - beta_K / (bridge_C + zero_C_K);

    return (uint32_t)((num_real)codes / (1 + (num_real)exponential((double)exponent)));
}
