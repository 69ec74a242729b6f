#include "firmware/estimator/standstill_pulses.h"

#include "firmware/numeric/arctangent.h"

/* Share of the nominal supply: the hold needs some, and the bus may sag. */
static const double voltage_share = 0.8;

/* The hold's current is in and the rotor has come to rest. */
static const double rest_s = 0.020;

/* Of the first pulses; and what the largest change of the current may be above the change that a
   linear winding would show. */
#define FIRST_STRENGTH NUM(0.7)
static const double largest_share = 1.15;

/* For the hold to answer to what has been found. */
static const double pause_s = 0.004;

/*
 * Commanded are, with n periods a pulse: the pulse in periods 0...n-1, the hold in n, the return of
 * the pulse in n+1...2n. The current is sampled in period n+2, a period of hold behind the pulse:
 * what a filter before the voltage measurement has carried over into that is then in the sum of the
 * means. The return, and what is carried over behind it, has evened out by period 2n+3.
 */
static uint32_t sampled_in(const struct standstill_pulses_params *params)
{
    return params->pulse_periods + 2u;
}

static uint32_t last_blanked(const struct standstill_pulses_params *params)
{
    return 2u * params->pulse_periods + 3u;
}

/* Five periods in which estimator and control are undisturbed. */
static uint32_t last_period(const struct standstill_pulses_params *params)
{
    return last_blanked(params) + 5u;
}

void standstill_pulses_design(struct standstill_pulses_params *params,
                              const struct motor_model_params *model,
                              const struct motor_params *motor, const struct per_unit *base,
                              const struct standstill_pulses_task *task)
{
    const double admittance = num_to_double(model->nominal_admittance);
    const double resistance = num_to_double(model->nominal_resistance);
    const double wanted = (task->peak_A - task->hold_current_A) / base->current_A;
    const double twice = admittance * (2.0 - resistance * admittance);
    const bool one = wanted / admittance <= voltage_share;
    const double response = one ? admittance : twice;
    const double voltage = wanted / response < voltage_share ? wanted / response : voltage_share;
    const double pulse = voltage * response;
    const double share = pulse * base->current_A / task->impulse_peak_A;
    const double magnet_A =
        motor->torque_constant_Nm_A / ((double)motor->rotor_teeth * motor->inductance_H);

    params->voltage = num_from_double(voltage);
    params->signal = coef_from_double(share * share);
    params->per_response = coef_from_double(1.0 / pulse);
    params->pulse_periods = one ? 1u : 2u;
    params->largest_change = num_from_double(largest_share * pulse);
    params->current_max =
        num_from_double(task->current_max_A / base->current_A - largest_share * pulse);
    params->per_magnet = coef_from_double(base->current_A / magnet_A);
    params->per_period = coef_from_double(1.0 / (IMPULSES * (last_period(params) + 1u)));
    params->rest_periods = (uint32_t)((rest_s + task->hold_ramp_s) / task->period_s + 0.5);
    params->pause_periods = (uint32_t)(pause_s / task->period_s + 0.5);
}

static const struct phases nothing = {NUM(0.0), NUM(0.0)};

/* For the next sixteen. */
static void rest_from_pulses(struct standstill_pulses *pulses)
{
    pulses->at_rest = true;
    pulses->period = 0;
    pulses->number = 0;
    pulses->sum = nothing;
    pulses->current = nothing;
    pulses->mean = nothing;
    pulses->response = NUM(0.0);
    pulses->largest = NUM(0.0);
}

void standstill_pulses_stop(struct standstill_pulses *pulses)
{
    pulses->strength = FIRST_STRENGTH; /* what the iron does depends on the angle */
    rest_from_pulses(pulses);
}

void standstill_pulses_reset(struct standstill_pulses *pulses,
                             const struct standstill_pulses_params *params, num_t asymmetry)
{
    pulses->signal = num_mul_coef(asymmetry, params->signal);
    standstill_pulses_stop(pulses);
}

bool standstill_pulses_blanks_sample(const struct standstill_pulses *pulses,
                                     const struct standstill_pulses_params *params)
{
    return !pulses->at_rest && pulses->period >= 2u && pulses->period <= last_blanked(params);
}

void standstill_pulses_sample(struct standstill_pulses *pulses,
                              const struct standstill_pulses_params *params, struct phases current,
                              struct phases expected)
{
    num_t change;

    if (pulses->period != sampled_in(params)) {
        return;
    }
    if (impulse_of(pulses->number).in_b) {
        pulses->sum.b += current.b - expected.b;
        change = current.b - pulses->start.b;
    } else {
        pulses->sum.a += current.a - expected.a;
        change = current.a - pulses->start.a;
    }
    change = num_abs(change);
    pulses->response += num_mul_unit(change, UNIT(1.0 / IMPULSES));
    pulses->largest = change > pulses->largest ? change : pulses->largest;
}

/*
 * The hold behind a pulse: the bridge takes of its phase what it takes of the current that the
 * pulse has left, and not what the compensation expects of the hold's.
 */
static struct phases behind(struct impulse impulse, struct phases hold, struct phases loss)
{
    const num_t a = num_abs(loss.a), b = num_abs(loss.b);
    const struct phases taken = impulse_phases(impulse, a > b ? a : b);

    if (impulse.in_b) {
        hold.b += loss.b + taken.b;
    } else {
        hold.a += loss.a + taken.a;
    }
    return hold;
}

/* By a tenth, until the largest change is at most the one that is allowed, and not much below. */
static void shrink(struct standstill_pulses *pulses, const struct standstill_pulses_params *params)
{
    if (pulses->largest > params->largest_change) {
        pulses->strength -= num_mul_unit(pulses->strength, UNIT(0.1));
    }
}

/* Sixteen pulses in both phases have shown that there is room. */
static void grow(struct standstill_pulses *pulses, const struct standstill_pulses_params *params)
{
    if (pulses->largest < num_mul_unit(params->largest_change, UNIT(0.85))) {
        pulses->strength =
            num_limit(pulses->strength + num_mul_unit(pulses->strength, UNIT(0.1)), NUM(1.0));
    }
}

static bool leave_room(const struct standstill_pulses_params *params, struct phases current)
{
    return num_abs(current.a) < params->current_max && num_abs(current.b) < params->current_max;
}

/* Apart: a law that holds without pulses keeps its registers. */
__attribute__((noinline)) bool standstill_pulses_add(struct standstill_pulses *pulses,
                                                     const struct standstill_pulses_params *params,
                                                     struct phases current, struct phases loss,
                                                     struct phases *voltage)
{
    const struct impulse impulse = impulse_of(pulses->number);
    const struct phases pulse = impulse_phases(impulse, num_mul(params->voltage, pulses->strength));
    const uint32_t n = params->pulse_periods;
    const uint32_t period = pulses->period++;

    if (pulses->at_rest) {
        if (period >= params->rest_periods && leave_room(params, current)) {
            pulses->at_rest = false;
            pulses->period = 0;
        }
        return false;
    }
    if (period == 0u && !leave_room(params, current)) { /* the load has grown meanwhile */
        shrink(pulses, params);
        rest_from_pulses(pulses);
        return false;
    }
    pulses->mean.a += num_mul_coef(current.a, params->per_period);
    pulses->mean.b += num_mul_coef(current.b, params->per_period);
    if (period == 0u) {
        pulses->command = *voltage;
    }
    if (period == 1u) {
        pulses->start = current;
        pulses->current.a += current.a;
        pulses->current.b += current.b;
    }
    if (period < n) {
        voltage->a = pulses->command.a + pulse.a;
        voltage->b = pulses->command.b + pulse.b;
    } else if (period == n) {
        *voltage = behind(impulse, pulses->command, loss);
    } else if (period <= 2u * n) {
        voltage->a = pulses->command.a - pulse.a;
        voltage->b = pulses->command.b - pulse.b;
    } else if (period == last_period(params)) {
        pulses->period = 0;
        pulses->number++;
    }
    return period >= 1u && period <= 2u * n;
}

/* What the magnet has of the sum, if the whole has this signal. */
static struct phases of_magnet(const struct standstill_pulses *pulses,
                               const struct standstill_pulses_params *params, struct phases held,
                               num_t signal)
{
    const num_t per_current = num_mul_coef(signal, params->per_magnet);

    return (struct phases){pulses->sum.a - num_mul(per_current, held.a),
                           pulses->sum.b - num_mul(per_current, held.b)};
}

static num_t length_of(struct phases x)
{
    return num_sqrt(num_mul(x.a, x.a) + num_mul(x.b, x.b));
}

bool standstill_pulses_result(struct standstill_pulses *pulses,
                              const struct standstill_pulses_params *params,
                              struct standstill_angle *shown)
{
    if (pulses->number < IMPULSES) {
        return false;
    }
    const struct phases held = {num_mul_unit(pulses->current.a, UNIT(1.0 / IMPULSES)),
                                num_mul_unit(pulses->current.b, UNIT(1.0 / IMPULSES))};
    /* A smaller pulse shows less, with its square. */
    const num_t size = num_limit(num_mul_coef(pulses->response, params->per_response), NUM(1.4));
    const num_t signal = num_mul(pulses->signal, num_mul(size, size));
    const struct phases first = of_magnet(pulses, params, held, signal);
    const num_t difference = length_of(first) - signal;
    /* What the magnet is longer than expected, the whole signal is: 1 / (1 + i_d / I_f) of it. */
    const num_t whole = signal + num_mul_unit(difference, UNIT(0.7));
    const struct phases magnet = of_magnet(pulses, params, held, whole);

    shown->angle = angle_of_vector(magnet.a, magnet.b);
    shown->current = pulses->mean;
    shrink(pulses, params);
    grow(pulses, params);
    rest_from_pulses(pulses);
    pulses->period = params->rest_periods - params->pause_periods;
    /* A disturbance has another size. */
    return num_abs(difference) < num_mul_unit(signal, UNIT(0.4));
}
