#include "firmware/drive/drive.h"

#include "firmware/control/modulation_limit.h"
#include "firmware/design/elementary.h"
#include "firmware/design/mechanical_control_design.h"
#include "firmware/design/text.h"
#include "firmware/drive/board_limits.h"
#include "firmware/drive/coefficients.h"
#include "firmware/drive/default_settings.h"
#include "firmware/drive/estimator_design.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/law_design.h"
#include "firmware/drive/phase_balancing.h"
#include "firmware/drive/synchronism.h"
#include "firmware/interface/parts_carried.h"
#include "firmware/interface/simulation_only.h"

_Static_assert((int)ENCODER_CARRIED == (int)ESTIMATORS_READ_ENCODER,
               "the settings of an encoder are carried where it is read");

/* Up to where the hold takes its frame along; nothing but this estimator knows a led rotor. */
static struct creep_limits creep_limits(const struct drive_settings *settings)
{
    if (!settings->hold_at_rest || settings->estimator != DRIVE_ESTIMATOR_INVARIANT_EKF) {
        return (struct creep_limits){0.0, 0.0};
    }
    return (struct creep_limits){
        hold_creep_speed(&settings->motor, settings->hold_current_A),
        hold_creep_acceleration(&settings->motor, settings->hold_current_A)};
}

static void design_detent_compensation(struct drive *drive, const struct drive_settings *settings,
                                       double period_s)
{
    const struct detent_compensation_task detent = {
        .motor = &settings->motor,
        .base = &drive->base,
        .period_s = period_s,
        .observer_bandwidth_rad_s = settings->observer_bandwidth_rad_s,
        .counts_per_turn =
            reads_encoder(settings) ? drive->board->facts->encoder_counts_per_turn : 0u,
    };
    struct learned_parameters learned;

    drive->params.path.detent_learning = settings->detent_learning;
    drive->params.detent = detent_compensation_design(&detent);
    detent_compensation_set(&drive->detent, &drive->params.detent, &drive->base,
                            parameter_store_read(drive->board, &learned)
                                ? learned.detent_torque_Nm
                                : settings->detent_torque_Nm);
}

static bool design_law(struct drive *drive, const struct drive_settings *settings, double period_s,
                       char error[DRIVE_ERROR_TEXT])
{
    if (ESTIMATORS_READ_ENCODER) {
        design_detent_compensation(drive, settings, period_s);
    }
    drive->params.position_law = settings->law;
    return law_design(drive, settings, &drive->params.law, error);
}

/* Shares of the overcurrent trip: of a pulse on the hold, and on the hold under load. */
static const double standstill_peak = 0.8;
static const double standstill_max = 0.94;

static bool design_detection(struct drive *drive, const struct drive_settings *settings,
                             double period_s, char error[DRIVE_ERROR_TEXT])
{
    const struct hal_facts *facts = drive->board->facts;
    const struct initial_position_task task = {
        .period_s = period_s,
        .zero_delay = facts->zero_delay,
        .order = settings->initial_position == DRIVE_INITIAL_POSITION_PUBLISHED_IMPULSES
                     ? IMPULSE_ORDER_PUBLISHED
                     : IMPULSE_ORDER_PALINDROMIC,
        .current_A_per_code = facts->current_A_per_code,
        .current_range_A = facts->current_A_per_code * (double)facts->current_zero_code,
        .overcurrent_trip_A = settings->overcurrent_trip_A,
        .hold_current_A = settings->hold_current_A,
        .hold_ramp_s = settings->hold_ramp_s,
    };

    const struct standstill_pulses_task pulses = {
        .period_s = period_s,
        .peak_A = standstill_peak * task.overcurrent_trip_A,
        .current_max_A = standstill_max * task.overcurrent_trip_A,
        .impulse_peak_A = initial_position_peak_A(&task),
        .hold_current_A = settings->hold_current_A,
        .hold_ramp_s = settings->hold_ramp_s,
    };

    drive->params.path.standstill_pulses = settings->standstill_pulses;
    drive->params.path.prepares_input =
        drive->params.path.infers_voltage || settings->standstill_pulses;
    standstill_pulses_design(&drive->standstill.params, &drive->params.model, &settings->motor,
                             &drive->base, &pulses);
    standstill_pulses_reset(&drive->standstill.pulses, &drive->standstill.params, NUM(0.0));
    drive->params.enabling.detects_position =
        settings->initial_position != DRIVE_INITIAL_POSITION_ASSUMED;
    return !drive->params.enabling.detects_position ||
           initial_position_design(&drive->enabling.detection_params, &drive->params.model,
                                   &settings->motor, &drive->base, &task, error);
}

/* An inductance that is off by dL errs the voltage in d by dL di_d/dt. Without an encoder that
   looks like an angle of dL di_d/dt / (N Km w), as long as the rotor is slow. In the time of
   the ramp in, the angle at the start of a motion is a tenth further off; in 1.5 times that, a load
   that steps there is seen a tenth later. */
static double ramp_out_s(const struct drive_settings *settings)
{
    return (settings->feedback == DRIVE_FEEDBACK_SENSORLESS ? 1.25 : 1.0) * settings->hold_ramp_s;
}

/* At a tenth the hold loses the reference motor under 60 % of what it could bear; of sixty others
   none is lost. */
static const double idle_share_min = 0.2;

static bool check_idle_current(const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT])
{
    if (settings->standstill_pulses && settings->idle_current_A < settings->hold_current_A) {
        return design_refuse(error, "idle_current_A: hold_current_A sizes standstill_pulses");
    }
    return design_require_within(error, "idle_current_A", settings->idle_current_A,
                                 idle_share_min * settings->hold_current_A,
                                 settings->hold_current_A, "A", "a fifth of hold_current_A to all");
}

static bool design_hold(struct drive *drive, const struct drive_settings *settings, double period_s,
                        char error[DRIVE_ERROR_TEXT])
{
    const struct hold_task hold = hold_task_of(settings, period_s);
    double damping_As_rad;

    if (!check_idle_current(settings, error) ||
        !hold_damping_design(&hold, &damping_As_rad, error) ||
        (settings_ask_for_hold(settings) && !hold_control_check(&hold, error))) {
        return false;
    }
    const struct standstill_hold_task task = {
        .current_A = settings->hold_current_A,
        .motion_current_A = settings->motion_current_A,
        .ramp_s = settings->hold_ramp_s,
        .ramp_out_s = ramp_out_s(settings),
        .delay_s = settings->hold_delay_s,
        .enters_at_rest = settings->hold_at_rest,
        .current_limit_A = settings->current_limit_A,
        .damping_As_rad = damping_As_rad,
        .period_s = period_s,
    };
    drive->params.hold = standstill_hold_design(&drive->base, &task);
    drive->idle_params = idle_current_design(settings, &drive->base, period_s);
    return true;
}

/* In supply / Km: no motor drives itself that fast, and its square still fits (numeric/num.h). */
static const double speed_in_range = 4.0;

/* Sampling ends what the model can follow: a quarter of an electrical turn in a period. A law
   without current control ends before; what is given beyond its limit it refuses itself. */
static double speed_limit(const struct drive_settings *settings, const struct per_unit *base)
{
    const double wanted = settings->speed_limit_rad_s;
    const double limit = smaller(speed_in_range, 0.24 / base->turns_per_period) * base->speed_rad_s;

    if (settings->law == POSITION_LAW_STMMS &&
        wanted == default_speed_limit_rad_s(&settings->motor)) {
        return smaller(wanted, smaller(winding_lag_speed_max(&settings->motor), limit));
    }
    return smaller(wanted, limit);
}

void drive_feed_watchdog(struct drive *drive)
{
    const uint32_t period = interrupt_view_period(drive);

    if (period != drive->fed_in) {
        drive->fed_in = period;
        drive->board->watchdog_feed(drive->board->context);
    }
}

bool drive_learned(const struct drive *drive, struct learned_parameters *learned)
{
    if (!ESTIMATORS_READ_ENCODER || !drive->params.path.detent_learning) {
        return false;
    }
    detent_compensation_get(&drive->detent, &drive->base, learned->detent_torque_Nm);
    return true;
}

void drive_put_learned(struct drive *drive, const struct learned_parameters *learned)
{
    if (ESTIMATORS_READ_ENCODER) {
        detent_compensation_set(&drive->detent, &drive->params.detent, &drive->base,
                                learned->detent_torque_Nm);
    }
}

/* What the image has been left without (firmware/simulation.h). */
static bool check_simulation(const struct drive_settings *settings, const struct hal_facts *facts,
                             char error[DRIVE_ERROR_TEXT])
{
    struct text refusal = text_in(error, DRIVE_ERROR_TEXT);

    if (SERVES_SIMULATION) {
        return true;
    }
    const char *setting =
        facts->zero_delay ? "a board without delay" : simulation_only_setting(settings);

    if (setting == NULL) {
        return true;
    }
    text_put(&refusal, setting);
    text_put(&refusal, ": for simulation, this image has nothing of that");
    return false;
}

bool drive_carries_law(enum position_law law)
{
    return position_law_is_carried(law);
}

static bool check_law(const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT])
{
    struct text refusal = text_in(error, DRIVE_ERROR_TEXT);

    if (position_law_is_carried(settings->law)) {
        return true;
    }
    text_put(&refusal, "law = ");
    text_put(&refusal, drive_law_name(settings->law));
    text_put(&refusal, ": this image does not carry it; get law lists those that it does");
    return false;
}

bool drive_init(struct drive *drive, const struct hal *board, const struct drive_settings *settings,
                char error[DRIVE_ERROR_TEXT])
{
    static const struct drive powered_down = {
        .supervision = {.state = DRIVE_SWITCH_ON_DISABLED, .period = UINT32_MAX},
        .fed_in = UINT32_MAX};

    *drive = powered_down;
    drive->board = board;
    const bool accepted = drive_design(drive, settings, error);

    planner_init(drive);
    return accepted;
}

static struct following_error_params design_following_error(const struct drive *drive,
                                                            double period_s)
{
    const bool encoder = reads_encoder(&drive->settings);
    const struct following_error_task task = {
        .base = &drive->base,
        .period_s = period_s,
        .limit_rad = encoder ? drive->settings.following_error_rad : 0.0,
    };

    return following_error_design(&task);
}

/* What was given, and what follows. */
static bool settle_settings(struct drive *drive, const struct drive_settings *given,
                            char error[DRIVE_ERROR_TEXT])
{
    const struct hal_facts *facts = drive->board->facts;
    struct drive_settings *settings = &drive->settings;
    struct default_settings_search search = {.refused = 0};

    if (!drive_settings_check(given, error) || !check_simulation(given, facts, error) ||
        !check_law(given, error)) {
        return false;
    }
    *settings = *given;
    while (!default_settings_step(&search, settings, facts->control_period_s,
                                  facts->encoder_counts_per_turn)) {
        drive_feed_watchdog(drive);
    }
    drive_feed_watchdog(drive);
    if (!board_limits_apply(settings, facts, error)) {
        return false;
    }
    drive->base = per_unit_base(&settings->motor, facts->control_period_s);
    settings->speed_limit_rad_s = speed_limit(settings, &drive->base);
    settings->following_error_rad = smaller(settings->following_error_rad,
                                            FOLLOWING_ERROR_TURNS_MAX * drive->base.rad_per_turn);
    return true;
}

static void design_positions(struct enabling_params *enabling,
                             const struct drive_settings *settings)
{
    const int32_t teeth = settings->motor.rotor_teeth;
    const double error_rad = settings->initial_angle_error_rad;

    enabling->initial_position = position_from_rad(settings->initial_angle_rad + error_rad, teeth);
    enabling->encoder_zero_known = reads_encoder(settings) && settings->encoder_zero_known;
    enabling->encoder_zero = position_from_rad(settings->encoder_zero_rad, teeth);
    enabling->encoder_zero_assumed =
        position_from_rad(settings->encoder_zero_rad + error_rad, teeth);
}

bool drive_design(struct drive *drive, const struct drive_settings *given,
                  char error[DRIVE_ERROR_TEXT])
{
    const struct hal_facts *facts = drive->board->facts;
    const struct drive_settings *settings = &drive->settings;
    const double period_s = facts->control_period_s;
    const bool begins_anew = axis_begins_anew(settings, given);
    struct drive_params *params = &drive->params;

    if (!settle_settings(drive, given, error)) {
        return false;
    }
    design_positions(&params->enabling, settings);
    if (begins_anew) { /* before what the encoder counts by changes */
        axis_begin(drive);
    }
    params->measurement = measurement_design(facts, &drive->base);
    params->model =
        motor_model_design(&settings->motor, &drive->base, period_s, facts->bridge_resistance_ohm);
    params->reference = reference_design(&drive->base, period_s, creep_limits(settings));
    params->current_control = current_control_design(&settings->motor, &drive->base, period_s,
                                                     settings->current_bandwidth_rad_s);
    belt_watch_design(drive, given);
    drive->torque_constant = (struct torque_constant){.in_force = NUM(0.0)};
    drive->enabling.inductance_change = NUM(0.0);
    params->modulator = modulator_design(facts->pwm_half_period_counts,
                                         modulation_max(facts->low_state_s, period_s));
    params->protection = protection_design(&drive->base, facts, &drive->settings);
    brake_design(&drive->brake, settings, facts);
    params->following = design_following_error(drive, period_s);
    thermal_watch_design(drive);
    drive->phase_watch_params = phase_watch_design(&drive->base, facts, settings);
    params->enabling.calibrates_offsets = settings->calibrate_offsets;
    drive->enabling.calibration_params =
        offset_calibration_design(facts, &settings->motor, &drive->base);
    params->path.feed_forward = settings->feed_forward;
    params->path.zero_delay = facts->zero_delay;
    params->path.bridge_loss_compensation = settings->bridge_loss_compensation;
    params->path.infers_voltage =
        settings->voltage_source == DRIVE_VOLTAGE_COMMANDED || !facts->has_phase_voltages;
    params->bridge_loss =
        bridge_loss_design(&settings->motor, &drive->base, period_s,
                           settings->bridge_loss_compensation ? facts->dead_time_s : 0.0);
    params->path.general = position_law_gives_voltage(settings->law) || settings->detent_learning ||
                           settings->standstill_pulses || params->path.infers_voltage ||
                           params->path.zero_delay || !settings->bridge_loss_compensation ||
                           !settings->feed_forward || reads_encoder(settings) ||
                           settings->estimator != DRIVE_ESTIMATOR_INVARIANT_EKF;
    params->enabling.initial_load_torque =
        num_from_double(settings->initial_load_torque_Nm / drive->base.torque_Nm);
    params->enabling.hold_on_enable_periods =
        settings->hold_on_enable ? (uint32_t)(settings->hold_on_enable_s / period_s + 0.5) : 0u;
    params->enabling.balance_periods = phase_balancing_design(drive, settings, period_s);
    modulator_reset(&drive->modulator);
    planned_end_init(drive);
    if (!estimator_design(drive, settings, error)) {
        return false;
    }
    drive_feed_watchdog(drive);
    synchronism_design(drive, settings);
    if (!design_law(drive, &drive->settings, period_s, error) ||
        !design_hold(drive, settings, period_s, error) ||
        !design_detection(drive, &drive->settings, period_s, error) ||
        !coefficients_fit(drive, error)) {
        return false;
    }
    torque_constant_put(drive, num_from_double(settings->initial_torque_constant_change));
    return true;
}
