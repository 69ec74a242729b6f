#include "firmware/drive/default_settings.h"

#include "firmware/design/elementary.h"
#include "firmware/design/feedback_linearisation_design.h"
#include "firmware/design/loop_bandwidth.h"
#include "firmware/design/mechanical_control_design.h"
#include "firmware/drive/board_limits.h"
#include "firmware/interface/parts_carried.h"

/* Of the rated current; half of it with pulses, which need the difference up to the trip for
   theirs, and with the paper's filter, whose own hold has half. */
#define HOLD_CURRENT_SHARE      1.0
#define HOLD_CURRENT_SHARE_HALF 0.5

/* Where the hold does not bear that: down to 6 % of it. */
#define HOLD_CURRENT_STEP  0.7
#define HOLD_CURRENT_STEPS 8

/* The position law has come to rest; the longer it waits for the hold, the further an estimate that
   sees no back-EMF has drifted. */
#define HOLD_DELAY_MAX_S 0.015
#define HOLD_DELAY_SWING 4.2 /* 1/w_h */

/* Microstepping leads its rotor and follows nothing. */
static double following_error(const struct drive_settings *settings)
{
    return settings->law == POSITION_LAW_MICROSTEPPING
               ? 0.0
               : FOLLOWING_ERROR_TURNS * 6.283185307179586 / settings->motor.rotor_teeth;
}

__attribute__((noinline)) static void put(double *setting, double value)
{
    if (*setting != *setting) {
        *setting = value;
    }
}

static bool fast(const struct drive_settings *settings)
{
    return settings->law == POSITION_LAW_FEEDBACK_LINEARISATION &&
           settings->feedback == DRIVE_FEEDBACK_ENCODER;
}

static double law_bandwidth_max(const struct drive_settings *settings, double period_s)
{
    switch (settings->law) {
    case POSITION_LAW_FEEDBACK_LINEARISATION:
        return LINEARISED_LAW_BANDWIDTH_PERIOD_MAX / period_s;
    case POSITION_LAW_STMMS: /* without current control the winding's lag counts, too */
        return smaller(mechanical_control_bandwidth_max(period_s),
                       winding_lag_bandwidth_max(&settings->motor));
    case POSITION_LAW_STMMS_PLUS:
    case POSITION_LAW_FOC:
        return mechanical_control_bandwidth_max(period_s);
    default:
        return settings->current_bandwidth_rad_s / CURRENT_OVER_POSITION_BANDWIDTH_MIN;
    }
}

/*
 * Behind a spring that gives the law's gain acts on the rotor alone: there it is as designed.
 *
 * An inductance that is off by dL feigns a speed dL / Km di_q/dt, and the law answers a speed with
 * i_q = 2 w0 J / Km of it: a loop of dL / L (w0 / w_em)^2 and more. So without an encoder it is no
 * quicker than the winding swings.
 */
static double law_bandwidth_wanted(const struct drive_settings *settings)
{
    const bool stiff = settings->law == POSITION_LAW_FEEDBACK_LINEARISATION ||
                       settings->law == POSITION_LAW_STATE_FEEDBACK;
    const double rigid_rad_s = fast(settings) ? 900.0 : stiff ? 300.0 : 200.0;
    const double wanted_rad_s = 0.01 * settings->rotor_inertia_percent * rigid_rad_s;

    return settings->feedback == DRIVE_FEEDBACK_SENSORLESS
               ? smaller(wanted_rad_s, electromechanical_frequency(&settings->motor))
               : wanted_rad_s;
}

static bool bears(const struct drive_settings *settings, double period_s, double hold_current_A)
{
    struct hold_task task = hold_task_of(settings, period_s);
    char limit[DESIGN_ERROR_TEXT];
    double damping_As_rad;

    task.hold_current_A = hold_current_A;
    return !hold_damping_design(&task, &damping_As_rad, limit) || /* refused for itself, then */
           hold_control_check(&task, limit);
}

__attribute__((noinline)) static double hold_current_wanted(const struct drive_settings *settings)
{
    const bool half =
        settings->standstill_pulses || settings->estimator == DRIVE_ESTIMATOR_STEADY_STATE_EKF;
    const double share = half ? HOLD_CURRENT_SHARE_HALF : HOLD_CURRENT_SHARE;
    const double wanted_A = share * settings->motor.rated_current_A;
    const double trip_A = HOLD_TRIP_SHARE * settings->overcurrent_trip_A;

    return trip_A < wanted_A ? trip_A : wanted_A; /* a trip that follows is a NaN still */
}

/*
 * A d current draws the rotor to its estimate as to the frame of a hold. A sensorless motor needs
 * that whose rated current makes more than so many times the flux of its magnet, N L I / Km: what
 * an inductance is off by, and iron, turns its estimate as many times as far.
 */
#define MOTION_CURRENT_FROM  3.0
#define MOTION_CURRENT_SHARE 0.375

static double motion_current(const struct drive_settings *settings)
{
    const struct motor_params *motor = &settings->motor;
    const double flux_Vs = motor->rotor_teeth * motor->inductance_H * motor->rated_current_A;

    return settings->feedback == DRIVE_FEEDBACK_SENSORLESS &&
                   flux_Vs > MOTION_CURRENT_FROM * motor->torque_constant_Nm_A
               ? MOTION_CURRENT_SHARE * motor->rated_current_A
               : 0.0;
}

static bool holds_at_times(const struct drive_settings *settings)
{
    return settings_ask_for_hold(settings) || !settings->encoder_zero_known;
}

/* With the default law of an encoder 2000, else 1500, and twice what a stiff hold swings with. */
static double current_bandwidth(const struct drive_settings *settings, double period_s)
{
    const double hold_current_A = settings->hold_current_A == settings->hold_current_A
                                      ? settings->hold_current_A
                                      : hold_current_wanted(settings);
    const double swing =
        holds_at_times(settings) ? 2.0 * hold_frequency(&settings->motor, hold_current_A) : 0.0;
    const double least = fast(settings) ? 2000.0 : 1500.0;

    return smaller(larger(swing, least), CURRENT_BANDWIDTH_PERIOD_MAX / period_s);
}

/*
 * A count more, which may be but noise, moves the observed load by J (1 - p)^3 / T^2 of its angle;
 * the current that bears it is to take no more than this share of the supply to change within a
 * period. With 1 - p as w_o T.
 */
#define COUNT_VOLTAGE_SHARE 0.5

static double cube_root(double x)
{
    double root = 1.0;

    for (int i = 0; i < 64; i++) {
        root -= (root - x / (root * root)) / 3.0;
    }
    return root;
}

static double count_bandwidth_max(const struct motor_params *motor, double period_s,
                                  uint32_t counts_per_turn)
{
    const double count_rad = 6.283185307179586 / (double)counts_per_turn;
    const double current_A = COUNT_VOLTAGE_SHARE * motor->supply_V * period_s / motor->inductance_H;

    return cube_root(motor->torque_constant_Nm_A * current_A /
                     (motor->inertia_kgm2 * count_rad * period_s));
}

/*
 * The back-EMF is fed forward as the observer has the speed. An observer that is slow against the
 * rotor's swing with its winding says it too late: a torque along the speed. And a detent torque of
 * 5 to 8 % of the holding torque throws a rotor off its hills as fast as 0.75 to 0.95 of the
 * frequency with which half the rated current holds it.
 */
#define WINDING_SWING_SHARE  0.8
#define DETENT_CURRENT_SHARE 0.5

static double swing_bandwidth(const struct motor_params *motor)
{
    const double winding = WINDING_SWING_SHARE * electromechanical_frequency(motor);
    const double detent = hold_frequency(motor, DETENT_CURRENT_SHARE * motor->rated_current_A);

    return larger(winding, detent);
}

static double observer_bandwidth(const struct drive_settings *settings, double period_s,
                                 uint32_t counts_per_turn)
{
    const double swing = swing_bandwidth(&settings->motor);
    const double least = fast(settings) ? 1400.0 : 1000.0;
    const double wanted = smaller(larger(swing, least), ENCODER_OBSERVER_PERIOD_MAX / period_s);

    return !ENCODER_CARRIED || counts_per_turn == 0u
               ? wanted
               : smaller(wanted, count_bandwidth_max(&settings->motor, period_s, counts_per_turn));
}

/* The hold current is the rated current, or what of it the hold's own check passes. */
bool default_settings_step(struct default_settings_search *search, struct drive_settings *settings,
                           double period_s, uint32_t encoder_counts_per_turn)
{
    const bool given = settings->hold_current_A == settings->hold_current_A;

    if (search->refused == 0) {
        put(&settings->current_bandwidth_rad_s, current_bandwidth(settings, period_s));
        put(&settings->law_bandwidth_rad_s,
            smaller(law_bandwidth_wanted(settings), law_bandwidth_max(settings, period_s)));
        put(&settings->observer_bandwidth_rad_s,
            observer_bandwidth(settings, period_s, encoder_counts_per_turn));
        search->hold_current_A = hold_current_wanted(settings);
    }
    if (!given && search->refused < HOLD_CURRENT_STEPS &&
        !bears(settings, period_s, search->hold_current_A)) {
        search->hold_current_A *= HOLD_CURRENT_STEP;
        search->refused++;
        return false;
    }
    put(&settings->following_error_rad, following_error(settings));
    put(&settings->hold_current_A, search->hold_current_A);
    put(&settings->idle_current_A, settings->hold_current_A);
    put(&settings->motion_current_A, motion_current(settings));
    put(&settings->hold_delay_s,
        smaller(HOLD_DELAY_MAX_S,
                HOLD_DELAY_SWING / hold_frequency(&settings->motor, settings->hold_current_A)));
    put(&settings->hold_bandwidth_rad_s, hold_bandwidth(&settings->motor, settings->hold_current_A,
                                                        settings->current_bandwidth_rad_s));
    return true;
}

void default_settings_apply(struct drive_settings *settings, double period_s,
                            uint32_t encoder_counts_per_turn)
{
    struct default_settings_search search = {.refused = 0};

    while (!default_settings_step(&search, settings, period_s, encoder_counts_per_turn)) {
    }
}
