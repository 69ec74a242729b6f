#include "firmware/estimator/initial_position.h"

#include "firmware/numeric/arctangent.h"
#include "firmware/simulation.h"

#define QUARTER_TURN (1u << 30)

/* ---- design ---- */

/* Share of the nominal supply: the bus may sag, and duties end at 0.92. */
static const double voltage_share = 0.8;

/* Beyond a millisecond the rotor turns too far under an impulse. */
static const double impulse_max_s = 1e-3;

/* What may pass for an asymmetry: a code of the converter, or a bend of it or of the bridge. */
static const double bend = 1e-3;

/* Offsets are ten codes at most, a hundredth of an impulse. */
static const double quiet_share = 1e-2;

/* Of the supply; dividers of 1 % and the legs' dead times together are a quarter of it. */
static const double quiet_voltage_share = 0.02;

/* Five standard errors are 11 degrees electrical. */
static const double confidence_min = 5.0;

static const double current_bandwidth_rad_s = 60.0;
static const double resistance_bandwidth_rad_s = 300.0;
static const double ramps_of_hold = 5.0;

/* A rotor swings about the vector for some 10 ms. */
static const double quarter_s = 0.025;
static const double rest_s = 0.040;
static const double aligning_s = 0.075; /* behind the ramp, from anywhere */

/* What the offsets are the mean of, and what the bridge needs to settle before. */
static const double quiet_s = 6.4e-3;
static const double quiet_begin_s = 0.4e-3;

enum { ATTEMPTS = 2, REPETITIONS = 8 };

static bool is_published(const struct initial_position_params *params)
{
    return SERVES_SIMULATION && params->order == IMPULSE_ORDER_PUBLISHED;
}

static uint32_t impulses_of(const struct initial_position_params *params)
{
    return is_published(params) ? 4u : IMPULSES;
}

/* Length and voltage of an impulse that ends at `peak`; false: the supply does not get there. */
static bool design_impulse(struct initial_position_params *params, double period_s, double peak)
{
    const double resistance = num_to_double(params->model.nominal_resistance);
    const double admittance = num_to_double(params->model.nominal_admittance);
    double current = 0.0; /* of a voltage of one */

    for (uint32_t n = 1; n * period_s <= impulse_max_s; n++) {
        current += admittance * (1.0 - resistance * current);
        if (peak / current <= voltage_share) {
            params->impulse_periods = n;
            params->impulse_voltage = num_from_double(peak / current);
            return true;
        }
    }
    return false;
}

static void design_alignment(struct initial_position_params *params,
                             const struct motor_params *motor, const struct per_unit *base,
                             const struct initial_position_task *task)
{
    const double current = task->hold_current_A / base->current_A;
    const double magnet_flux =
        motor->torque_constant_Nm_A / motor->rotor_teeth / (base->voltage_V * task->period_s);

    params->alignment_current = num_from_double(current);
    params->current_ramp =
        num_from_double(current * task->period_s / (ramps_of_hold * task->hold_ramp_s));
    params->current_gain = coef_from_double(current_bandwidth_rad_s * task->period_s *
                                            num_to_double(params->model.nominal_resistance));
    params->resistance_gain =
        coef_from_double(resistance_bandwidth_rad_s * task->period_s / current);
    params->flux = coef_from_double(1.0 / magnet_flux);
    params->flux_per_current =
        coef_from_double(motor->inductance_H / task->period_s / base->resistance_ohm / magnet_flux);
    params->quarter_periods = (uint32_t)(quarter_s / task->period_s + 0.5);
    params->quarter_step = QUARTER_TURN / params->quarter_periods;
    params->rest_periods = (uint32_t)(rest_s / task->period_s + 0.5);
    params->aligning_periods =
        (uint32_t)((aligning_s + ramps_of_hold * task->hold_ramp_s) / task->period_s + 0.5);
}

double initial_position_peak_A(const struct initial_position_task *task)
{
    return INITIAL_POSITION_PEAK * (task->overcurrent_trip_A < task->current_range_A
                                        ? task->overcurrent_trip_A
                                        : task->current_range_A);
}

bool initial_position_design(struct initial_position_params *params,
                             const struct motor_model_params *model,
                             const struct motor_params *motor, const struct per_unit *base,
                             const struct initial_position_task *task,
                             char error[DESIGN_ERROR_TEXT])
{
    const double peak_A = initial_position_peak_A(task);
    const double floor_A =
        task->current_A_per_code > bend * peak_A ? task->current_A_per_code : bend * peak_A;

    params->model = *model;
    params->order = task->order;
    params->lag = task->zero_delay ? 0u : 1u;
    if (!design_impulse(params, task->period_s, peak_A / base->current_A)) {
        return design_refuse_limit(
            error, (struct refusal){.quantity = "current of an initial position impulse",
                                    .value = peak_A,
                                    .relation = "reached within",
                                    .limit = impulse_max_s,
                                    .unit = "A",
                                    .reason = "a lower overcurrent_trip_A shortens it"});
    }
    const double impulses = impulses_of(params);
    const double floor = floor_A / base->current_A * impulses / 2.0;
    const double response = peak_A / base->current_A * impulses / 2.0 / IMPULSES;

    params->quiet_begin = (uint32_t)(quiet_begin_s / task->period_s + 0.5);
    params->quiet_periods = (uint32_t)(quiet_s / task->period_s + 0.5);
    params->per_quiet_period = UNIT(1.0 / params->quiet_periods);
    params->quiet_max = num_from_double(quiet_share * peak_A / base->current_A);
    params->quiet_voltage_max = num_from_double(quiet_voltage_share);
    params->listened_max = num_from_double(0.9 * NUM_MAX / params->quiet_periods);
    params->floor_squared = num_from_double(floor * floor);
    params->response_min = num_from_double(0.5 * response);
    params->response_max = num_from_double(1.6 * response);
    params->per_response = coef_from_double(1.0 / response);
    params->certainty = coef_from_double(confidence_min * confidence_min);
    design_alignment(params, motor, base, task);
    return true;
}

/* ---- impulses ---- */

static const struct phases nothing = {NUM(0.0), NUM(0.0)};

static const struct sincos no_turn = {UNIT(1.0), UNIT(0.0)};

static void enter(struct initial_position *detection, enum initial_position_stage stage)
{
    detection->stage = stage;
    detection->periods = 0;
}

void initial_position_start(struct initial_position *detection,
                            const struct initial_position_params *params, angle_t final_angle)
{
    const struct phases none = {NUM(0.0), NUM(0.0)};

    /* Field by field: the interrupt has no memory functions of this size (tests/target). */
    detection->current_offset = none;
    detection->voltage_offset = none;
    detection->impulse = 0;
    detection->expected = none;
    for (int round = 0; round < IMPULSE_ROUNDS; round++) {
        detection->round[round] = none;
    }
    detection->response = none;
    detection->repetitions = 0;
    detection->final_angle = final_angle;
    detection->direction = 0;
    detection->current_reference = NUM(0.0);
    detection->voltage = NUM(0.0);
    detection->resistance = NUM(0.0);
    detection->flux = none;
    detection->current_before = none;
    detection->attempts = 0;
    detection->by_impulses = false;
    detection->angle = 0;
    detection->asymmetry = NUM(0.0);
    detection->uncertainty = NUM(0.0);
    winding_set_resistance(&detection->winding, &params->model, params->model.nominal_resistance);
    enter(detection, INITIAL_POSITION_QUIET);
}

static void add(struct phases *sum, struct phases x, num_t limit)
{
    sum->a += num_headroom(x.a, limit);
    sum->b += num_headroom(x.b, limit);
}

static struct phases difference(struct phases x, struct phases y)
{
    return (struct phases){x.a - y.a, x.b - y.b};
}

/* A square, of what has a reasonable size. */
static num_t square(num_t x)
{
    const num_t limited = num_limit(x, NUM(1.9));

    return num_mul(limited, limited);
}

static num_t length_squared(struct phases x)
{
    return square(x.a) + square(x.b);
}

static struct phases divide(struct phases sum, unit_t share)
{
    return (struct phases){num_mul_unit(sum.a, share), num_mul_unit(sum.b, share)};
}

static void begin_alignment(struct initial_position *detection,
                            const struct initial_position_params *params)
{
    detection->direction = detection->final_angle;
    detection->resistance = params->model.nominal_resistance;
    enter(detection, INITIAL_POSITION_ALIGNING);
}

/* The rotor turns still: all over again, but not for ever. */
static void wait_for_rest(struct initial_position *detection,
                          const struct initial_position_params *params)
{
    detection->current_offset = detection->voltage_offset = nothing;
    if (++detection->repetitions == REPETITIONS) {
        begin_alignment(detection, params);
        return;
    }
    detection->response = nothing;
    for (int round = 0; round < IMPULSE_ROUNDS; round++) {
        detection->round[round] = nothing;
    }
    detection->impulse = 0;
    enter(detection, INITIAL_POSITION_QUIET);
}

static bool lies_within(struct phases x, num_t limit)
{
    return num_abs(x.a) < limit && num_abs(x.b) < limit;
}

/* Currents and voltages that are measured while there are none. */
static void listen(struct initial_position *detection, const struct initial_position_params *params,
                   struct phases current, struct phases voltage)
{
    if (detection->periods >= params->quiet_begin) {
        add(&detection->current_offset, current, params->listened_max);
        add(&detection->voltage_offset, voltage, params->listened_max);
    }
    if (++detection->periods == params->quiet_begin + params->quiet_periods) {
        detection->current_offset = divide(detection->current_offset, params->per_quiet_period);
        detection->voltage_offset = divide(detection->voltage_offset, params->per_quiet_period);
        if (!lies_within(detection->voltage_offset, params->quiet_voltage_max)) {
            enter(detection, INITIAL_POSITION_NOT_FOUND);
        } else if (lies_within(detection->current_offset, params->quiet_max)) {
            enter(detection, INITIAL_POSITION_IMPULSES);
        } else {
            wait_for_rest(detection, params);
        }
    }
}

static struct impulse present_impulse(const struct initial_position *detection,
                                      const struct initial_position_params *params)
{
    if (is_published(params)) {
        return (struct impulse){.in_b = detection->impulse >= 2u,
                                .negative = detection->impulse % 2u == 1u};
    }
    return impulse_of(detection->impulse);
}

/* The sample at the end of an impulse. */
static void take_peak(struct initial_position *detection, struct impulse impulse,
                      struct phases current)
{
    const num_t measured = impulse.in_b ? current.b : current.a;
    const num_t expected = impulse.in_b ? detection->expected.b : detection->expected.a;
    struct phases *round = &detection->round[impulse.round];

    *(impulse.in_b ? &round->b : &round->a) += measured - expected;
    *(impulse.in_b ? &detection->response.b : &detection->response.a) +=
        num_mul_unit(num_abs(measured), UNIT(1.0 / IMPULSES));
}

/* Neither open nor shorted. */
static bool winding_responds(const struct initial_position_params *params, num_t response)
{
    return response > params->response_min && response < params->response_max;
}

/* The rounds differ by as much as their sum is uncertain. */
static void evaluate(struct initial_position *detection,
                     const struct initial_position_params *params)
{
    const struct phases *round = detection->round;
    const struct phases sum = {round[0].a + round[1].a, round[0].b + round[1].b};
    const num_t asymmetry = length_squared(sum);
    num_t error = params->floor_squared;

    if (!is_published(params)) {
        error += length_squared(difference(round[0], round[1]));
    }
    detection->asymmetry = num_sqrt(asymmetry);
    detection->uncertainty = num_sqrt(error);
    if (!winding_responds(params, detection->response.a) ||
        !winding_responds(params, detection->response.b)) {
        enter(detection, INITIAL_POSITION_NOT_FOUND);
    } else if (asymmetry > num_mul_coef(error, params->certainty)) {
        detection->by_impulses = true;
        detection->angle = angle_of_vector(sum.a, sum.b);
        enter(detection, INITIAL_POSITION_FOUND);
    } else if (asymmetry > num_mul_coef(params->floor_squared, params->certainty)) {
        wait_for_rest(detection, params); /* the iron shows something, but not the same each time */
    } else {
        begin_alignment(detection, params);
    }
}

/*
 * Period 0: the bridge goes on, without voltage. Periods 1...n: the impulse is commanded; it acts
 * `lag` periods later. Its last sample taken, the bridge opens: the diodes bring the current to
 * zero faster than it came, and keep it there.
 */
static struct initial_position_output give_impulse(struct initial_position *detection,
                                                   const struct initial_position_params *params,
                                                   struct phases current, struct phases voltage)
{
    const uint32_t period = detection->periods++;
    const uint32_t begin = 1u + params->lag;
    const uint32_t end = begin + params->impulse_periods;
    const struct impulse impulse = present_impulse(detection, params);
    struct initial_position_output output = {.bridge_on = period < end, .voltage = nothing};

    if (period <= begin) {
        detection->expected = nothing;
    } else if (period <= end) {
        detection->expected = predict_current(&params->model, &detection->winding,
                                              detection->expected, NUM(0.0), no_turn, voltage);
    }
    if (period == end) {
        take_peak(detection, impulse, current);
    }
    if (period > 0u) {
        output.voltage =
            impulse_phases(impulse, period > params->impulse_periods ? -params->impulse_voltage
                                                                     : params->impulse_voltage);
    }
    if (period == end + params->impulse_periods) {
        detection->periods = 0;
        if (++detection->impulse == impulses_of(params)) {
            evaluate(detection, params);
        }
    }
    return output;
}

double initial_position_confidence(const struct initial_position *detection)
{
    return num_to_double(detection->asymmetry) / num_to_double(detection->uncertainty);
}

/* 1/(1 + e)^2 = 1 - 2 e + 3 e^2 - ..., where e is below 0.2. */
num_t initial_position_full_asymmetry(const struct initial_position *detection,
                                      const struct initial_position_params *params)
{
    const num_t response = num_half(detection->response.a + detection->response.b);
    const num_t excess =
        num_limit(num_mul_coef(response, params->per_response) - NUM(1.0), NUM(0.2));

    return detection->asymmetry -
           num_mul(detection->asymmetry,
                   excess + excess - num_mul(NUM(3.0), num_mul(excess, excess)));
}

/* ---- alignment ---- */

/* Turns the vector evenly by a quarter from `from`, and rests. */
static void turn_vector(struct initial_position *detection,
                        const struct initial_position_params *params, angle_t from, bool onwards)
{
    const uint32_t turned = detection->periods < params->quarter_periods
                                ? params->quarter_step * detection->periods
                                : QUARTER_TURN;

    detection->direction = onwards ? from + turned : from - turned;
}

/* The magnet's flux has turned from the offset by a quarter to the final angle; all in units of
 * that flux. */
static bool rotor_has_followed(const struct initial_position *detection,
                               const struct initial_position_params *params, struct phases current)
{
    const struct sincos final_angle = sincos_of(detection->final_angle);
    const struct phases change = difference(current, detection->current_before);
    const struct phases turned = {num_from_unit(final_angle.cos) + num_from_unit(final_angle.sin),
                                  num_from_unit(final_angle.sin) - num_from_unit(final_angle.cos)};
    const struct phases error = {
        detection->flux.a - num_mul_coef(change.a, params->flux_per_current) - turned.a,
        detection->flux.b - num_mul_coef(change.b, params->flux_per_current) - turned.b};

    return length_squared(error) < NUM(2.0 * 0.4 * 0.4);
}

static void end_stage(struct initial_position *detection,
                      const struct initial_position_params *params, struct phases current)
{
    switch (detection->stage) {
    case INITIAL_POSITION_ALIGNING:
        enter(detection, INITIAL_POSITION_OFFSET);
        break;
    case INITIAL_POSITION_OFFSET:
        detection->flux = nothing;
        detection->current_before = current;
        enter(detection, INITIAL_POSITION_FINAL);
        break;
    default:
        if (rotor_has_followed(detection, params, current)) {
            detection->angle = detection->final_angle;
            enter(detection, INITIAL_POSITION_FOUND);
        } else if (++detection->attempts == ATTEMPTS) {
            enter(detection, INITIAL_POSITION_NOT_FOUND);
        } else {
            enter(detection, INITIAL_POSITION_OFFSET);
        }
    }
}

/* Adds, within limits that nothing reaches but from samples that are out of order. */
static void grow(num_t *sum, num_t by, num_t limit)
{
    *sum = num_limit(*sum + num_limit(by, limit), limit);
}

/* Resistance at rest at the offset, flux on the way to the final angle. */
static void measure(struct initial_position *detection,
                    const struct initial_position_params *params, struct phases current,
                    struct phases voltage, num_t along)
{
    if (detection->stage == INITIAL_POSITION_FINAL) {
        const struct phases magnet = {voltage.a - num_mul(current.a, detection->resistance),
                                      voltage.b - num_mul(current.b, detection->resistance)};

        grow(&detection->flux.a, num_mul_coef(magnet.a, params->flux), NUM(8.0));
        grow(&detection->flux.b, num_mul_coef(magnet.b, params->flux), NUM(8.0));
    } else if (detection->stage == INITIAL_POSITION_OFFSET &&
               detection->periods > params->quarter_periods + params->rest_periods / 2u) {
        const num_t across_winding = park(voltage, sincos_of(detection->direction)).d;

        grow(&detection->resistance,
             num_mul_coef(across_winding - num_mul(along, detection->resistance),
                          params->resistance_gain),
             NUM(8.0));
    }
}

static struct initial_position_output align(struct initial_position *detection,
                                            const struct initial_position_params *params,
                                            struct phases current, struct phases voltage)
{
    const struct sincos direction = sincos_of(detection->direction);
    const num_t along = park(current, direction).d;
    const uint32_t length = detection->stage == INITIAL_POSITION_ALIGNING
                                ? params->aligning_periods
                                : params->quarter_periods + params->rest_periods;

    measure(detection, params, current, voltage, along);
    detection->current_reference = num_clamp(detection->current_reference + params->current_ramp,
                                             NUM(0.0), params->alignment_current);
    grow(&detection->voltage,
         num_mul_coef(detection->current_reference - along, params->current_gain), NUM(2.0));
    if (detection->stage == INITIAL_POSITION_OFFSET) {
        turn_vector(detection, params, detection->final_angle, true);
    } else if (detection->stage == INITIAL_POSITION_FINAL) {
        turn_vector(detection, params, detection->final_angle + QUARTER_TURN, false);
    }
    if (++detection->periods == length) {
        end_stage(detection, params, current);
    }
    return (struct initial_position_output){
        .bridge_on = true,
        .compensated = true,
        .voltage = inverse_park((struct dq){detection->voltage, NUM(0.0)}, direction)};
}

struct initial_position_output initial_position_step(struct initial_position *detection,
                                                     const struct initial_position_params *params,
                                                     struct phases current, struct phases voltage)
{
    const struct phases driven = difference(current, detection->current_offset);
    const struct phases driving = difference(voltage, detection->voltage_offset);

    switch (detection->stage) {
    case INITIAL_POSITION_QUIET:
        listen(detection, params, current, voltage);
        return (struct initial_position_output){.bridge_on = true, .voltage = nothing};
    case INITIAL_POSITION_IMPULSES:
        return give_impulse(detection, params, driven, driving);
    case INITIAL_POSITION_ALIGNING:
    case INITIAL_POSITION_OFFSET:
    case INITIAL_POSITION_FINAL:
        return align(detection, params, driven, driving);
    case INITIAL_POSITION_FOUND:
    case INITIAL_POSITION_NOT_FOUND:
        break;
    }
    return (struct initial_position_output){.bridge_on = false, .voltage = nothing};
}
