#include "firmware/drive/phase_balance.h"

#include "firmware/design/hold_frequency.h"
#include "firmware/numeric/quotient.h"

static const double two_pi = 6.28318530717958647693;

/* At 45 degrees each phase has 0.71 of the hold's current. */
static const double current_share_min = 0.35;

/* The means of so many samples leave a twentieth of their noise, over whole swings. */
static const double look_s = 0.04;

/* 2.8 degrees: a friction of 1.7 % of the holding torque, in a hold of half the rated current. */
#define BEYOND 0x02000000

#define QUARTER_TURN 0x40000000u
#define EIGHTH_TURN  0x20000000u

struct phase_balance_params phase_balance_design(const struct phase_balance_task *task)
{
    const double held_rad_s = hold_frequency(task->motor, task->hold_current_A);
    const struct held_angle_params lead = held_angle_design(two_pi / (held_rad_s * task->period_s));
    const uint32_t samples = (uint32_t)(look_s / task->period_s + 0.5);
    const uint32_t look = lead.swing * ((samples + lead.swing - 1u) / lead.swing);

    return (struct phase_balance_params){
        .lead = lead,
        .look = look,
        .per_look = coef_small_from_double(1.0 / (double)look),
        .speed_per_turn = coef_from_double(1.0 / task->base->turns_per_period),
        .current_min =
            num_from_double(current_share_min * task->hold_current_A / task->base->current_A),
    };
}

/* An eighth of a turn takes two swings, the little beyond half of one, and there are some periods
   of rounding and of passing from stage to stage. */
uint32_t phase_balance_periods(const struct phase_balance_params *params)
{
    const uint32_t led = 4u * params->lead.swing + params->lead.swing;
    const uint32_t settling = 3u * params->lead.swing;

    return led + settling + params->look + 64u;
}

void phase_balance_start(struct phase_balance *balance, angle_t held)
{
    const angle_t between = (held & ~(QUARTER_TURN - 1u)) + EIGHTH_TURN;

    balance->stage = PHASES_LED;
    balance->periods = 0u;
    balance->mean = (struct channels){{NUM(0.0), NUM(0.0)}, {NUM(0.0), NUM(0.0)}};
    balance->imbalance = NUM(0.0);
    held_angle_start(&balance->held);
    held_angle_lead_to(&balance->held, (int32_t)(between - held));
}

static void look(struct channels *mean, const struct channels *winding, coef_t share)
{
    mean->current.a += num_mul_small_nearest(winding->current.a, share);
    mean->current.b += num_mul_small_nearest(winding->current.b, share);
    mean->voltage.a += num_mul_small_nearest(winding->voltage.a, share);
    mean->voltage.b += num_mul_small_nearest(winding->voltage.b, share);
}

/* From the means; false: beyond what is sound. */
static bool compare(struct phase_balance *balance, const struct phase_balance_params *params)
{
    const struct phases current = balance->mean.current;
    const struct phases voltage = balance->mean.voltage;
    const num_t a = num_mul(voltage.a, current.b);
    const num_t b = num_mul(voltage.b, current.a);

    balance->sum = num_abs(a + b);
    balance->difference = a + b < NUM(0.0) ? b - a : a - b;
    return num_abs(current.a) > params->current_min && num_abs(current.b) > params->current_min &&
           num_abs(balance->difference) < num_mul(balance->sum, NUM(2.0 * PHASE_IMBALANCE_MAX));
}

static enum phase_balance_event go_on(struct phase_balance *balance)
{
    balance->stage++;
    balance->periods = 0u;
    return PHASES_GO_ON;
}

static enum phase_balance_event settle(struct phase_balance *balance,
                                       const struct phase_balance_params *params)
{
    balance->held.moved = 0;
    if (balance->periods <= params->lead.swing) {
        return PHASES_GO_ON;
    }
    if (balance->stage == PHASES_SETTLING_BEYOND) {
        held_angle_lead_to(&balance->held, 0);
    }
    return go_on(balance);
}

static enum phase_balance_event end_look(struct phase_balance *balance,
                                         const struct phase_balance_params *params)
{
    (void)go_on(balance);
    return compare(balance, params) ? PHASES_GO_ON : PHASES_TOO_DIFFERENT;
}

static enum phase_balance_event lead_back(struct phase_balance *balance)
{
    (void)go_on(balance);
    held_angle_lead_to(&balance->held, balance->held.offset > 0 ? -BEYOND : BEYOND);
    balance->imbalance = quotient(balance->difference, balance->sum);
    return num_abs(balance->imbalance) < NUM(PHASE_IMBALANCE_MAX) ? PHASES_COMPARED
                                                                  : PHASES_TOO_DIFFERENT;
}

static bool is_led(enum phase_balance_stage stage)
{
    return stage == PHASES_LED || stage == PHASES_LED_BACK || stage == PHASES_LED_TO_FINAL;
}

/* Not by a switch: its helper would lie in flash. */
enum phase_balance_event phase_balance_step(struct phase_balance *balance,
                                            const struct phase_balance_params *params,
                                            const struct channels *winding)
{
    const enum phase_balance_stage stage = balance->stage;

    balance->periods++;
    if (stage == PHASES_LOOKED_AT) {
        look(&balance->mean, winding, params->per_look);
        return balance->periods < params->look ? PHASES_GO_ON : end_look(balance, params);
    }
    if (stage == PHASES_DIVIDED) {
        return lead_back(balance);
    }
    if (stage == PHASES_BALANCED) {
        return PHASES_AT_FINAL;
    }
    if (is_led(stage)) {
        return held_angle_step(&balance->held, &params->lead) ? go_on(balance) : PHASES_GO_ON;
    }
    return settle(balance, params);
}
