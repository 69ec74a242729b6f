#include "firmware/drive/phase_watch.h"

#include "firmware/control/position_law_dispatch.h"
#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/state_machine.h"
#include "firmware/numeric/trig.h"

/* Noise is six sigma of a noisy board, or 2 % of the rated current. Looks and gaps are of samples,
   whatever their period: how far apart a current is looked at, and for how many one look stands. */
#define NOISE_CODES       8u
#define NOISE_SHARE       0.02
#define LOOK_PERIODS      4u /* from look to look, or up to five more in turn */
#define LOOKS_APART       6u
#define LOOKS             4u       /* two currents of a moving rotor can be the same */
#define LAG_S             12.8e-3  /* a fault carries the estimate away within less */
#define GAP_PERIODS       14u      /* of one voltage, as it was at the look */
#define PUSHED_MAX        NUM(1.0) /* twice the rated current */
#define MISSED            3u
#define GONE_LOOKS        2u
#define PUSHED_GONE       NUM(0.25)
#define LOOKS_MAX         7u
#define MISSED_MAX        15u
#define SAME_MAX          112u
#define SAME_MISSED       16u
#define MISSED_SAME       2u /* one may be of the period in which it moved */
#define SAME_OTHER_MAX    8u /* of a converter that is alive */
#define SLOW_TURNS        NUM(1.0 / (LOOK_PERIODS * SAME_MAX))
#define WRONG_LOOKS       8u /* with a wrong voltage, less RIGHT_COUNTS times those without */
#define RIGHT_COUNTS      2u
#define VOLTAGE_ERROR     0.05 /* of the supply */
#define COUNTS_ERROR      2.0
#define RESISTANCE_ERROR  NUM(0.6)   /* what a winding that warms up or is not known may have */
#define CURRENT_DEVIATION NUM(0.075) /* of twice the rated current */
#define CURRENT_GONE      NUM(0.1)
#define CURRENT_MIN       NUM(0.025)
#define FAST_TURNS        NUM(0.0625)

static const double two_pi = 6.283185307179586476925;

struct phase_watch_params phase_watch_design(const struct per_unit *base,
                                             const struct hal_facts *facts,
                                             const struct drive_settings *settings)
{
    const uint16_t codes =
        (uint16_t)(NOISE_SHARE * settings->motor.rated_current_A / facts->current_A_per_code);
    double voltage = VOLTAGE_ERROR;

    if (reads_encoder(settings)) {
        voltage += COUNTS_ERROR * two_pi / (double)facts->encoder_counts_per_turn *
                   settings->observer_bandwidth_rad_s / base->speed_rad_s;
    }
    return (struct phase_watch_params){
        .voltage_error = num_from_double(voltage),
        .lag_looks = (uint16_t)(LAG_S / (LOOK_PERIODS * facts->control_period_s) + 0.5),
        .noise_codes = codes > NOISE_CODES ? codes : NOISE_CODES,
    };
}

static bool stands(uint16_t at, uint16_t code, const struct phase_watch_params *params)
{
    const int away = (int)code - (int)at;

    return away <= (int)params->noise_codes && -away <= (int)params->noise_codes;
}

_Static_assert(DRIVE_FAULT_OPEN_PHASE_A + 1 == (int)DRIVE_FAULT_OPEN_PHASE_B &&
                   DRIVE_FAULT_CURRENT_SENSOR_A + 1 == (int)DRIVE_FAULT_CURRENT_SENSOR_B,
               "phase b behind phase a");

/* Whether the current stands where it did; else it begins anew. */
static bool goes_on(struct phase_watch *watch, const struct phase_watch_params *params,
                    const struct phase_look *look, int phase, uint32_t passed)
{
    if (passed <= GAP_PERIODS && stands(watch->code[phase], look->code[phase], params)) {
        return true;
    }
    watch->code[phase] = look->code[phase];
    watch->wanted[phase] = look->wanted[phase];
    watch->count[phase].looks = 0;
    watch->count[phase].missed = 0;
    watch->pushed[phase] = NUM(0.0);
    return false;
}

/* strays: its reference is another one than when it came to stand. */
static void count_look(struct phase_count *count, bool strays)
{
    if (count->looks < LOOKS_MAX) {
        count->looks++;
    }
    if (strays && count->missed < MISSED_MAX) {
        count->missed++;
    } else if (!strays && count->missed > 0u) {
        count->missed--;
    }
}

/* What its voltage would have changed since the last look. */
static num_t pushed_on(num_t pushed, num_t push, uint32_t passed)
{
    for (; passed > 0u && num_abs(pushed) <= PUSHED_MAX; passed--) {
        pushed += push;
    }
    return pushed;
}

/* Looks in a row with the very same code, up to SAME_MAX; none if it says nothing: of a rotor that
   rests without a hold, and of codes that need not scatter. Returns whether it begins anew. */
static bool count_same(struct phase_count *count, uint8_t code, bool says)
{
    if (code == count->last && count->same < SAME_MAX && says) {
        count->same++;
        return false;
    }
    count->last = code;
    count->same = 0u;
    return true;
}

/* Whether a converter that gives one code is dead, as the motor does not stand. */
static bool goes_elsewhere(const struct phase_look *look, uint8_t resistance)
{
    const uint8_t moved = (uint8_t)(look->resistance - resistance + look->eighth);

    return look->held ? look->settled && moved > 2u * look->eighth : look->turns;
}

/* gone: a hold's current that is asked for; flows: there is one. */
static bool is_sure(const struct phase_count *count, num_t pushed, bool gone, bool flows, bool fast)
{
    return (count->looks >= (fast ? LOOKS_MAX : LOOKS) && pushed > PUSHED_MAX) ||
           (count->looks >= GONE_LOOKS && pushed > PUSHED_GONE && gone) ||
           (count->same >= SAME_MISSED && count->missed >= MISSED_SAME && flows);
}

/* Takes the code; keeps the resistance while both codes change, and where a row begins anew. */
static void take_code(struct phase_watch *watch, const struct phase_look *look, int phase,
                      bool alive)
{
    struct phase_count *count = &watch->count[phase];
    const bool counts_anew = alive || count->same == SAME_MAX;

    if (count_same(count, (uint8_t)look->code[phase],
                   look->held || look->turns || look->noisy[phase]) &&
        counts_anew) {
        watch->resistance = (uint8_t)look->resistance;
    }
}

/* A rotor that turns takes a phase's voltage through zero, where none is wrong by much. Returns
   whether it is sure. What is suspected is one store: the control interrupt reads it. */
static bool judge_voltage(struct phase_watch *watch, bool wrong, uint32_t passed, uint8_t suspected)
{
    if (passed > GAP_PERIODS) {
        watch->wrong = 0u;
    }
    if (wrong) {
        watch->wrong = (uint8_t)(watch->wrong + (watch->wrong < WRONG_LOOKS));
    } else {
        watch->wrong = watch->wrong > RIGHT_COUNTS ? (uint8_t)(watch->wrong - RIGHT_COUNTS) : 0u;
    }
    watch->suspected = wrong ? (uint8_t)DRIVE_FAULT_VOLTAGE_SENSOR : suspected;
    return watch->wrong == WRONG_LOOKS;
}

/* current: one that flows, or is said to */
static uint8_t name_of(int phase, bool current)
{
    return (uint8_t)((current ? DRIVE_FAULT_CURRENT_SENSOR_A : DRIVE_FAULT_OPEN_PHASE_A) + phase);
}

enum drive_fault phase_watch_step(struct phase_watch *watch,
                                  const struct phase_watch_params *params,
                                  const struct phase_look *look)
{
    const uint32_t passed = look->period - watch->period;
    enum drive_fault fault = DRIVE_FAULT_NONE;
    uint8_t suspected = DRIVE_FAULT_NONE;
    num_t furthest = NUM(0.0);

    watch->period = look->period;
    watch->apart = (uint8_t)((watch->apart + 1u) % LOOKS_APART);
    for (int phase = 0; phase < 2; phase++) {
        struct phase_count *count = &watch->count[phase];
        const bool alive = watch->count[1 - phase].same < SAME_OTHER_MAX; /* the other one */
        const bool flows = look->flows[phase];
        const bool strays = num_abs(look->wanted[phase] - watch->wanted[phase]) > CURRENT_MIN;
        bool gone = look->held && !flows && num_abs(look->wanted[phase]) > CURRENT_GONE;

        take_code(watch, look, phase, alive);
        if (goes_on(watch, params, look, phase, passed)) {
            watch->pushed[phase] = pushed_on(watch->pushed[phase], look->push[phase], passed);
            count_look(count, strays);
        } else {
            gone = gone && !strays && count->followed;
        }
        count->followed = look->off[phase] < CURRENT_DEVIATION;

        const bool dead = count->same == SAME_MAX && look->noisy[phase];
        const uint8_t name = name_of(phase, flows || dead);

        if ((gone || count->missed >= MISSED) && look->off[phase] >= furthest) {
            furthest = look->off[phase];
            suspected = name;
        }
        if (dead ||
            (is_sure(count, num_abs(watch->pushed[phase]), gone, flows, look->fast) &&
             !(look->fast && watch->count[1 - phase].looks >= LOOKS)) ||
            (count->same == SAME_MAX && alive && goes_elsewhere(look, watch->resistance))) {
            fault = (enum drive_fault)name;
        }
    }
    if (judge_voltage(watch, look->voltage_wrong, passed, suspected)) {
        fault = DRIVE_FAULT_VOLTAGE_SENSOR;
    }
    return fault;
}

void phase_watch_forget(struct phase_watch *watch)
{
    watch->suspected = DRIVE_FAULT_NONE;
    watch->wrong = 0u;
}

bool phase_watch_chatters(const struct drive *drive)
{
    const enum position_law law = drive->params.position_law;

    return position_law_gives_voltage(law) && law != POSITION_LAW_FEEDBACK_LINEARISATION;
}

static num_t push(const struct drive *drive, num_t current, num_t voltage, num_t emf)
{
    const num_t drop = num_mul(drive->estimator.estimate.winding.resistance, current);
    const num_t left = voltage - drop - emf;
    const num_t sure = num_abs(left) - drive->phase_watch_params.voltage_error -
                       num_mul(RESISTANCE_ERROR, num_abs(drop));
    const num_t size = sure > NUM(0.0) ? num_mul_coef(sure, drive->params.model.rate) : NUM(0.0);

    return left < NUM(0.0) && phase_watch_chatters(drive) ? -size : size;
}

/* What is measured, in the frame of the control; a voltage law has no reference of it. */
static bool follows(const struct drive *drive, struct phase_look *look, struct phases current)
{
    const struct sincos frame = drive->hold.active
                                    ? drive->hold.frame
                                    : sincos_of(drive->estimator.estimate.rotor.position.fraction);
    const struct phases wanted = inverse_park(drive->current_reference, frame);

    if (position_law_gives_voltage(drive->params.position_law) && !drive->hold.active) {
        return false;
    }
    look->wanted[0] = wanted.a;
    look->wanted[1] = wanted.b;
    look->off[0] = num_abs(wanted.a - current.a);
    look->off[1] = num_abs(wanted.b - current.b);
    return look->off[0] < CURRENT_DEVIATION && look->off[1] < CURRENT_DEVIATION;
}

/* Against the voltage of S(k+1)...S(k+2). Without an encoder of the reference, as far beside it as
   the rotor has been of late: an estimator finds a rotor for any current. */
static struct phases back_emf(const struct drive *drive)
{
    const struct rotor *rotor = &drive->estimator.estimate.rotor;
    const struct reference_sample *reference = &drive->reference.next; /* at S(k+1) */
    const bool encoder = reads_encoder(&drive->settings);
    const num_t speed = encoder ? rotor->speed : reference->speed;
    const num_t turn = num_mul_coef(speed, drive->params.model.turns_per_speed);
    const angle_t begin = encoder ? rotor->position.fraction + (angle_t)angle_from_turns(turn)
                                  : reference->position.fraction + (angle_t)drive->phase_watch.lag;

    return inverse_park((struct dq){NUM(0.0), speed},
                        sincos_of(begin + (angle_t)angle_from_turns(num_half(turn))));
}

/* Up to S(k+1). A torque constant that is not the model's leaves the rotor a quarter turn beside
   its reference in motion, where it feeds forward a speed that is not the estimate's. */
static void track_lag(struct phase_watch *watch, const struct drive *drive)
{
    const int32_t looks = drive->phase_watch_params.lag_looks;
    const angle_t at = drive->estimator.estimate.next.position.fraction;
    const angle_t lag = at - drive->reference.next.position.fraction;

    /* A turn is no overflow: the sum wraps. */
    const int32_t nearer = (int32_t)(lag - (angle_t)watch->lag) / looks;

    watch->lag = (int32_t)((angle_t)watch->lag + (angle_t)nearer);
}

/* Electrical turns in a period. */
static bool is_faster(const struct drive *drive, num_t turns)
{
    return num_abs(num_mul_coef(drive->estimator.estimate.rotor.speed,
                                drive->params.model.turns_per_speed)) > turns;
}

/* Per-unit below 8: three times that of a winding which takes all of the supply is 6. */
static uint16_t counts_of(num_t resistance)
{
    const num_t sixteenth = num_half(num_half(num_half(num_half(resistance))));

    return (uint16_t)((angle_t)angle_from_turns(sixteenth) >> 18);
}

static void look_at(struct phase_look *look, const struct drive *drive)
{
    const uint16_t code_a = drive->current_codes.a;
    const uint16_t code_b = drive->current_codes.b;
    const struct phases current =
        measurement_current(&drive->measurement, &drive->params.measurement, code_a, code_b);
    const struct phases emf = back_emf(drive);
    const struct actuation *actuation = &drive->actuation;

    look->code[0] = code_a;
    look->code[1] = code_b;
    if (!follows(drive, look, current)) {
        look->push[0] = push(drive, current.a, actuation->command.a + actuation->loss.a, emf.a);
        look->push[1] = push(drive, current.b, actuation->command.b + actuation->loss.b, emf.b);
    }
    look->larger = num_abs(current.b) > num_abs(current.a);
    look->flows[0] = num_abs(current.a) > CURRENT_MIN;
    look->flows[1] = num_abs(current.b) > CURRENT_MIN;
    look->noisy[0] = (drive->enabling.calibration.noisy & 1u) != 0u;
    look->noisy[1] = (drive->enabling.calibration.noisy & 2u) != 0u;
    look->voltage_wrong = num_abs(actuation->loss.a) >= ACTUATION_LOSS_MAX ||
                          num_abs(actuation->loss.b) >= ACTUATION_LOSS_MAX;
    look->held = drive->hold.active;
    look->settled = drive->synchronism.monitor.held >= drive->synchronism.params.settled_blocks;
    look->turns = is_faster(drive, SLOW_TURNS);
    look->fast = is_faster(drive, FAST_TURNS);
    look->resistance = counts_of(drive->estimator.estimate.winding.resistance);
    look->eighth = counts_of(drive->params.model.nominal_resistance) / 8u;
}

/* A hold whose winding shows a resistance that none has: its current is not what is measured. */
static enum drive_fault judge_resistance(const struct drive *drive, const struct phase_look *look)
{
    const struct motor_model_params *model = &drive->params.model;
    const num_t resistance = drive->estimator.estimate.winding.resistance;

    if (!drive->hold.active ||
        (resistance > model->resistance_min && resistance < model->resistance_max)) {
        return DRIVE_FAULT_NONE;
    }
    return look->larger == 0 ? DRIVE_FAULT_CURRENT_SENSOR_A : DRIVE_FAULT_CURRENT_SENSOR_B;
}

/* Never at the same place of what repeats itself. From a sixteenth of an electrical turn in a
   period on half a turn may pass from look to look, and a current that goes through zero stands;
   at two ninths of it what is seen four and five periods apart stands for ever. */
static uint32_t interval(const struct drive *drive)
{
    const uint32_t more = drive->phase_watch.apart;

    if (is_faster(drive, FAST_TURNS)) {
        return LOOK_PERIODS + more;
    }
    return phase_watch_chatters(drive) ? LOOK_PERIODS + more % 2u : LOOK_PERIODS;
}

void phase_watch_background(struct drive *drive)
{
    struct phase_look look = {.period = interrupt_view_period(drive)};
    enum drive_fault fault;

    if (interrupt_view_state(drive) != DRIVE_OPERATION_ENABLED) {
        phase_watch_forget(&drive->phase_watch);
        return;
    }
    if (look.period - drive->phase_watch.period < interval(drive) ||
        has_zero_delay(&drive->params.path)) {
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    look_at(&look, drive);
    atomic_signal_fence(memory_order_seq_cst);
    if (look.period != interrupt_view_period(drive)) {
        return; /* an interrupt has come in between */
    }
    track_lag(&drive->phase_watch, drive);
    fault = phase_watch_step(&drive->phase_watch, &drive->phase_watch_params, &look);
    if (fault == DRIVE_FAULT_NONE) {
        fault = judge_resistance(drive, &look);
    }
    if (fault != DRIVE_FAULT_NONE) {
        state_machine_ask_for_fault(drive, fault);
    }
}
