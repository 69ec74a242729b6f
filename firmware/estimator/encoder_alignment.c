#include "firmware/estimator/encoder_alignment.h"

#include "firmware/design/elementary.h"
#include "firmware/design/hold_frequency.h"

/* On each way: seven angles at which the rotor is read, and one beside them where it turns. */
enum { ANGLES = ALIGNMENT_ANGLES, TURN = ANGLES + 1, MIDDLE = TURN / 2 };

/* For so many the rotor has to rest; with four times the inertia it is one. */
enum { LOOK_SWINGS = 2 };

#define OUTERMOST (15 << 27)

static const double turn = 4294967296.0;
static const double two_pi = 6.28318530717958647693;

/* Bounds in electrical turns. */
static const double error_turns = 3.0 / 360.0;
static const double error_counts = 0.75;
static const double rest_turns = 1.0 / 360.0;
static const double deviation_turns = 0.125;
static const double load_turns = 0.0625; /* 2 sin d = sin(d + 22.5 degrees): sin d = 0.33 */
static const double friction_turns = 0.03125;

/* What rounding and friction may leave of the difference between two means, in counts. */
static const double noise_counts = 0.3;

/* Of the error's bound, what one of the angles may make of it. */
static const double outlier_share = 0.6;
#define OUTLIER_OF_LOAD NUM(0.125) /* and of the displacement by a load */

static const double patience_swings = 40.0;
static const double current_tolerance = 0.1;

static struct alignment_hold design_held(const struct encoder_alignment_task *task,
                                         double current_A)
{
    const double held_rad_s = hold_frequency(task->motor, current_A);
    const struct held_angle_params lead = held_angle_design(two_pi / (held_rad_s * task->period_s));
    const double current = current_A / task->base->current_A;
    const uint32_t look = LOOK_SWINGS * lead.swing;

    return (struct alignment_hold){
        .current = num_from_double(current),
        .tolerance = num_from_double(current_tolerance * current),
        .look = look,
        .per_look = coef_small_from_double(1.0 / (double)look),
        .lead = lead,
    };
}

/*
 * Nearly a seventh of a turn: a whole number of sevenths of a count, but none of counts. So the
 * angles meet the count at seven different places.
 */
static int32_t design_spacing(double count_turns)
{
    const uint32_t counts_per_turn = (uint32_t)(1.0 / count_turns + 0.5);
    const uint32_t sevenths = counts_per_turn - (counts_per_turn % ANGLES == 0u ? 1u : 0u);

    return (int32_t)((double)sevenths * count_turns / ANGLES * turn);
}

struct encoder_alignment_params encoder_alignment_design(const struct encoder_alignment_task *task)
{
    const double teeth = (double)task->motor->rotor_teeth;
    const double count_turns = teeth / (double)task->counts_per_turn;
    const double rest_counts = rest_turns / count_turns;
    const double bound = larger(error_turns, error_counts * count_turns);
    struct encoder_alignment_params params = {
        .encoder = encoder_design(task->motor->rotor_teeth, task->counts_per_turn),
        .hold = {[ALIGNMENT_WEAK] = design_held(task, 0.5 * task->current_A),
                 [ALIGNMENT_STRONG] = design_held(task, task->current_A)},
        .spacing = design_spacing(count_turns),
        .interleave = (int32_t)(0.5 * count_turns / ANGLES * turn),
        .speed_per_turn = coef_from_double(1.0 / task->base->turns_per_period),
        .band = rest_counts > 1.0 ? (uint32_t)rest_counts : 1u,
        .settling = (uint32_t)(task->settling_s / task->period_s + 0.5),
        .deviation_max = num_from_double(deviation_turns + count_turns),
        .load_min = num_from_double(noise_counts * count_turns),
        .load_max = num_from_double(load_turns),
        .friction_max = num_from_double(friction_turns),
        .error_max = num_from_double(bound),
        .zero_error_max = num_from_double(bound - 0.5 * count_turns),
        .outlier_max = num_from_double(outlier_share * bound),
    };

    params.patience =
        params.settling +
        (uint32_t)(patience_swings * (double)params.hold[ALIGNMENT_WEAK].lead.swing + 0.5);
    return params;
}

static void look_anew(struct encoder_alignment *alignment)
{
    alignment->looked = 0u;
}

static void go_to(struct encoder_alignment *alignment, int32_t target)
{
    held_angle_lead_to(&alignment->held, target);
    alignment->periods = 0u;
    look_anew(alignment);
}

/* From here on the rotor's travel is counted. */
static void anchor(struct encoder_alignment *alignment, int32_t count)
{
    alignment->count = count;
    alignment->count_offset = alignment->held.offset;
}

void encoder_alignment_start(struct encoder_alignment *alignment, int32_t count)
{
    alignment->stage = ALIGNMENT_ALIGNING;
    alignment->way = ALIGNMENT_UP_WEAK;
    alignment->stop = 0u;
    held_angle_start(&alignment->held);
    alignment->deviation = 0;
    alignment->rotor = 0;
    alignment->zero = NUM(0.0);
    for (int way = 0; way < ALIGNMENT_WAYS; way++) {
        alignment->deviation_on_way[way] = NUM(0.0);
    }
    for (int angle = 0; angle < ANGLES; angle++) {
        alignment->zero_at[angle] = NUM(0.0);
    }
    go_to(alignment, 0);
    anchor(alignment, count);
}

static bool leads_up(enum encoder_alignment_way way)
{
    return way == ALIGNMENT_UP_WEAK || way == ALIGNMENT_UP_STRONG || way == ALIGNMENT_UP_WEAK_AGAIN;
}

/* Of the present way and stop. */
static int32_t angle_of_stop(const struct encoder_alignment *alignment,
                             const struct encoder_alignment_params *params)
{
    const int32_t number = (int32_t)alignment->stop;

    if (leads_up(alignment->way)) {
        return number == TURN ? OUTERMOST : (number - MIDDLE) * params->spacing;
    }
    return number == TURN ? -OUTERMOST : (MIDDLE - number) * params->spacing + params->interleave;
}

/* How far the rotor is beyond the held angle, seen from where its travel began. */
static int32_t deviation(const struct encoder_alignment *alignment,
                         const struct encoder_alignment_params *params, int32_t count)
{
    const int32_t counts = (int32_t)((uint32_t)count - (uint32_t)alignment->count);
    const angle_t travelled = (angle_t)(encoder_travel(&params->encoder, counts) >> 32);

    return (int32_t)(travelled -
                     ((uint32_t)alignment->held.offset - (uint32_t)alignment->count_offset));
}

/* One period of the look at the rotor: the mean of its deviation over a swing. */
static void look(struct encoder_alignment *alignment, const struct encoder_alignment_params *params,
                 int32_t count)
{
    const coef_t per_look = encoder_alignment_hold(alignment, params)->per_look;

    if (alignment->looked == 0u) {
        alignment->lowest = count;
        alignment->highest = count;
        alignment->mean = NUM(0.0);
    }
    if ((int32_t)((uint32_t)count - (uint32_t)alignment->lowest) < 0) {
        alignment->lowest = count;
    }
    if ((int32_t)((uint32_t)count - (uint32_t)alignment->highest) > 0) {
        alignment->highest = count;
    }
    alignment->deviation = deviation(alignment, params, count);
    alignment->mean += num_mul_small_nearest(turns_from_angle(alignment->deviation), per_look);
    alignment->looked++;
}

/* A count more once it has been waited for: the hold that damps by counts may keep a rotor in them.
 */
static bool still(const struct encoder_alignment *alignment,
                  const struct encoder_alignment_params *params)
{
    const uint32_t band = params->band + (alignment->periods > params->patience / 8u ? 1u : 0u);

    return (uint32_t)alignment->highest - (uint32_t)alignment->lowest <= band;
}

/* The rotor stands, in the mean of the look or by what has been found, `turns` beyond the hold. */
static void place(struct encoder_alignment *alignment, num_t by_count)
{
    alignment->rotor = (int32_t)((uint32_t)alignment->held.offset + (uint32_t)alignment->deviation -
                                 (uint32_t)angle_from_turns(by_count));
}

/*
 * How far a lasting load turns the rotor at the stronger current, from `change` at the weaker. What
 * may be rounding and friction is none; that passes into all of it, without a step.
 */
static num_t displacement(const struct encoder_alignment_params *params, num_t change)
{
    const num_t beyond = change - num_limit(change, params->load_min);
    const num_t shown = num_limit(beyond + num_half(beyond), num_abs(change));
    const num_t quarter = num_mul(shown, NUM(1.5707963267948966));
    const num_t radian = quarter + quarter + quarter + quarter;

    return shown - num_mul(shown, num_mul(radian, radian));
}

/* Of the angles' zeros the one that is furthest from their mean: what it adds to that. */
static num_t outlier(const struct encoder_alignment *alignment)
{
    num_t sum = NUM(0.0);
    num_t worst = NUM(0.0);

    for (int i = 0; i < ANGLES; i++) {
        sum += alignment->zero_at[i];
    }
    const num_t mean = num_mul(sum, NUM(1.0 / ANGLES));

    for (int i = 0; i < ANGLES; i++) {
        const num_t beside = num_abs(alignment->zero_at[i] - mean);

        worst = beside > worst ? beside : worst;
    }
    return worst;
}

/* No angle contradicts the others. Under load, where the spring is weaker, detent torque cancels
 * less. */
static bool angles_agree(const struct encoder_alignment *alignment,
                         const struct encoder_alignment_params *params, num_t change)
{
    return outlier(alignment) < params->outlier_max + num_mul(num_abs(change), OUTLIER_OF_LOAD);
}

/* No load has come or gone on the way. */
static bool ways_agree(const struct encoder_alignment *alignment,
                       const struct encoder_alignment_params *params, num_t lag, num_t weak_lag)
{
    const num_t *mean = alignment->deviation_on_way;
    const num_t up = mean[ALIGNMENT_UP_WEAK_AGAIN] - mean[ALIGNMENT_UP_WEAK];
    const num_t down = mean[ALIGNMENT_DOWN_WEAK_AGAIN] - mean[ALIGNMENT_DOWN_WEAK];

    return num_abs(weak_lag - lag - lag) < params->error_max &&
           num_half(num_abs(up)) < params->zero_error_max &&
           num_half(num_abs(down)) < params->zero_error_max;
}

/* The zero from all means; false: they contradict each other, or load or friction is too large. */
static bool conclude(struct encoder_alignment *alignment,
                     const struct encoder_alignment_params *params)
{
    const num_t *mean = alignment->deviation_on_way;
    const num_t weak_up = num_half(mean[ALIGNMENT_UP_WEAK] + mean[ALIGNMENT_UP_WEAK_AGAIN]);
    const num_t weak_down = num_half(mean[ALIGNMENT_DOWN_WEAK] + mean[ALIGNMENT_DOWN_WEAK_AGAIN]);
    const num_t strong = num_half(mean[ALIGNMENT_UP_STRONG] + mean[ALIGNMENT_DOWN_STRONG]);
    const num_t weak = num_half(weak_up + weak_down);
    const num_t lag = num_half(mean[ALIGNMENT_DOWN_STRONG] - mean[ALIGNMENT_UP_STRONG]);
    const num_t weak_lag = num_half(weak_down - weak_up);

    alignment->zero = strong - displacement(params, weak - strong);
    return num_abs(weak - strong) < params->load_max && num_abs(lag) < params->friction_max &&
           ways_agree(alignment, params, lag, weak_lag) &&
           angles_agree(alignment, params, weak - strong);
}

/* The rotor is at rest at a stop, and led to the next one. */
static void next_stop(struct encoder_alignment *alignment,
                      const struct encoder_alignment_params *params)
{
    if (alignment->stop < TURN) {
        alignment->stop++;
    } else {
        alignment->stop = 1u;
        alignment->way++;
    }
    if (alignment->way < ALIGNMENT_WAYS) {
        go_to(alignment, angle_of_stop(alignment, params));
    } else {
        alignment->stage = conclude(alignment, params) ? ALIGNMENT_ENDING : ALIGNMENT_NOT_FOUND;
        go_to(alignment, 0);
    }
}

static enum encoder_alignment_event fail(struct encoder_alignment *alignment)
{
    alignment->stage = ALIGNMENT_NOT_FOUND;
    return ALIGNMENT_FAILS;
}

/*
 * Until the rotor first rests nobody knows its angle, and the hold damps by a speed whose estimate
 * goes by that. So after each swing the rotor is taken to have swung about the held angle.
 */
static enum encoder_alignment_event align(struct encoder_alignment *alignment,
                                          const struct encoder_alignment_params *params,
                                          int32_t count)
{
    if (alignment->looked < encoder_alignment_hold(alignment, params)->look) {
        return ALIGNMENT_GOES_ON;
    }
    place(alignment, alignment->mean);
    anchor(alignment, count);
    look_anew(alignment);
    if (!still(alignment, params)) {
        return ALIGNMENT_PLACES;
    }
    if (alignment->held.target == 0) {
        go_to(alignment, -OUTERMOST);
    } else {
        alignment->stage = ALIGNMENT_SWEEPING;
        next_stop(alignment, params);
    }
    return ALIGNMENT_PLACES;
}

/* What has been read at a stop. */
static void take(struct encoder_alignment *alignment)
{
    const enum encoder_alignment_way way = alignment->way;
    const uint32_t angle = leads_up(way) ? alignment->stop - 1u : ANGLES - alignment->stop;
    const num_t share = num_mul(alignment->mean, NUM(1.0 / ANGLES));

    alignment->deviation_on_way[way] += share;
    if (!encoder_alignment_weak(way)) {
        alignment->zero_at[angle] += share;
    } else {
        alignment->zero_at[angle] -= num_half(num_half(share));
    }
}

/* Looks until the rotor has rested for a swing; there it is read. */
static enum encoder_alignment_event read(struct encoder_alignment *alignment,
                                         const struct encoder_alignment_params *params,
                                         num_t current)
{
    const struct alignment_hold *hold = encoder_alignment_hold(alignment, params);

    if (!still(alignment, params) || !(num_abs(current - hold->current) < hold->tolerance)) {
        look_anew(alignment);
    }
    if (alignment->looked < hold->look) {
        return ALIGNMENT_GOES_ON;
    }
    if (!(num_abs(alignment->mean) < params->deviation_max)) {
        return fail(alignment);
    }
    if (alignment->stage == ALIGNMENT_ENDING) {
        alignment->stage = ALIGNMENT_FOUND;
        place(alignment, alignment->zero);
        return ALIGNMENT_PLACES;
    }
    if (alignment->stop < TURN) {
        take(alignment);
    }
    next_stop(alignment, params);
    return alignment->stage == ALIGNMENT_NOT_FOUND ? ALIGNMENT_FAILS : ALIGNMENT_GOES_ON;
}

enum encoder_alignment_event encoder_alignment_step(struct encoder_alignment *alignment,
                                                    const struct encoder_alignment_params *params,
                                                    int32_t count, num_t current)
{
    const struct alignment_hold *hold = encoder_alignment_hold(alignment, params);
    const uint32_t settling = alignment->stage == ALIGNMENT_ENDING ? params->settling : 0u;

    if (++alignment->periods > params->patience) {
        return fail(alignment);
    }
    if (!held_angle_step(&alignment->held, &hold->lead) || alignment->periods < settling) {
        return ALIGNMENT_GOES_ON;
    }
    look(alignment, params, count);
    return alignment->stage == ALIGNMENT_ALIGNING ? align(alignment, params, count)
                                                  : read(alignment, params, current);
}
