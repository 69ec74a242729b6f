#include "firmware/drive/estimator_design.h"

#include <stddef.h>

#include "firmware/design/text.h"
#include "firmware/drive/default_settings.h"
#include "firmware/drive/encoder_aligning.h"

#define BEGINS_WITH_ITS_ESTIMATE(constant, name)                                                   \
    _Static_assert(offsetof(struct name, estimate) == 0, #name);

ESTIMATORS(BEGINS_WITH_ITS_ESTIMATE)

static bool design_high_gain_observer(struct drive *drive, const struct drive_settings *settings,
                                      double period_s, char error[DRIVE_ERROR_TEXT])
{
    struct estimator_params *params = &drive->params.estimator;
    const struct high_gain_observer_task task = {
        .base = &drive->base,
        .encoder = &params->encoder_observer.encoder,
        .period_s = period_s,
        .epsilon_s = settings->high_gain_epsilon_s,
        .speed_limit_rad_s = settings->speed_limit_rad_s,
    };

    params->kind = ESTIMATOR_HIGH_GAIN_OBSERVER;
    return high_gain_observer_design(&params->high_gain_observer, &drive->params.model, &task,
                                     error);
}

/* Each estimator's design apart: its locals are not on the stack below the others' deepest call. */
__attribute__((noinline)) static bool
design_encoder_observers(struct drive *drive, const struct drive_settings *settings,
                         double period_s, char error[DRIVE_ERROR_TEXT])
{
    struct estimator_params *params = &drive->params.estimator;
    const double current_A =
        settings->encoder_zero_known
            ? settings->hold_current_A
            : encoder_aligning_current_A(settings, hold_task_of(settings, period_s));
    const struct encoder_observer_task task = {
        .base = &drive->base,
        .rotor_teeth = settings->motor.rotor_teeth,
        .counts_per_turn = drive->board->facts->encoder_counts_per_turn,
        .period_s = period_s,
        .bandwidth_rad_s = settings->observer_bandwidth_rad_s,
        .resistance_adaptation_s =
            settings->resistance_adaptation ? settings->hold_on_enable_s / 8.0 : 0.0,
        .hold_current_A = current_A,
    };

    params->kind = ESTIMATOR_ENCODER_OBSERVER;
    if (!encoder_observer_design(&params->encoder_observer, &drive->params.model, &task, error)) {
        return false;
    }
    encoder_aligning_design(drive, settings, period_s, current_A);
    return !SERVES_SIMULATION || settings->observer != DRIVE_OBSERVER_HIGH_GAIN ||
           design_high_gain_observer(drive, settings, period_s, error);
}

__attribute__((noinline)) static bool design_steady_state_ekf(struct drive *drive,
                                                              const struct drive_settings *settings,
                                                              double period_s,
                                                              char error[DRIVE_ERROR_TEXT])
{
    struct estimator_params *params = &drive->params.estimator;
    struct steady_state_ekf_gains gains;

    if (!steady_state_ekf_design(&settings->motor, period_s, &gains, error)) {
        return false;
    }
    params->kind = ESTIMATOR_STEADY_STATE_EKF;
    params->steady_state_ekf = steady_state_ekf_scale(&drive->params.model, &drive->base, &gains);
    return true;
}

/* The gains are those of hold_current_A; less of it makes a softer spring. */
__attribute__((noinline)) static bool fit_hold(const struct hal_facts *facts,
                                               const struct drive_settings *settings,
                                               struct invariant_ekf_hold_gains *gains,
                                               char error[DRIVE_ERROR_TEXT])
{
    const double period_s = facts->control_period_s;
    struct text refusal = text_in(error, DRIVE_ERROR_TEXT);
    struct hold_task hold = hold_task_of(settings, period_s);
    char limit[DESIGN_ERROR_TEXT];

    invariant_ekf_bear_offset(period_s, drive_blind_speed_rad_s(settings, facts), gains);
    if (!hold_estimator_check(&hold, gains, error)) {
        return false;
    }
    hold.hold_current_A = settings->idle_current_A;
    if (settings->idle_current_A == settings->hold_current_A) {
        return true;
    }
    if (hold_control_check(&hold, limit) && hold_estimator_check(&hold, gains, limit)) {
        return true;
    }
    text_put(&refusal, "idle_current_A: ");
    text_put(&refusal, limit);
    return false;
}

/* As it is sampled, or as it is commanded and what the bridge takes of that. */
static bool voltage_is_known(const struct drive *drive, const struct drive_settings *settings)
{
    return settings->bridge_loss_compensation ||
           (settings->voltage_source == DRIVE_VOLTAGE_MEASURED &&
            drive->board->facts->has_phase_voltages);
}

__attribute__((noinline)) static bool design_invariant_ekf(struct drive *drive,
                                                           const struct drive_settings *settings,
                                                           double period_s,
                                                           char error[DRIVE_ERROR_TEXT])
{
    const struct motor_params *motor = &settings->motor;
    const double current_A = settings->hold_current_A;
    struct estimator_params *params = &drive->params.estimator;
    struct invariant_ekf_gains moving;
    struct invariant_ekf_hold_gains holding;

    if (!invariant_ekf_motion_design(motor, period_s, &moving, error) ||
        !invariant_ekf_motion_check(motor, period_s, &moving, error)) {
        return false;
    }
    drive_feed_watchdog(drive);
    if (!invariant_ekf_settled_hold_design(motor, period_s, current_A, &holding, error)) {
        return false;
    }
    drive_feed_watchdog(drive);
    if (!invariant_ekf_load_step_hold_design(motor, period_s, current_A, &holding, error)) {
        return false;
    }
    drive_feed_watchdog(drive);
    if (settings_ask_for_hold(settings) &&
        !fit_hold(drive->board->facts, settings, &holding, error)) {
        return false;
    }
    if (settings->resistance_adaptation && voltage_is_known(drive, settings)) {
        invariant_ekf_find_angle_in_step(&moving, &holding);
    }
    if (!settings->resistance_adaptation) {
        holding.quiet.k_resistance_ohm_A2 = 0.0;
        holding.following.k_resistance_ohm_A2 = 0.0;
        holding.unloaded.k_resistance_ohm_A2 = 0.0;
    }
    params->kind = ESTIMATOR_INVARIANT_EKF;
    params->invariant_ekf =
        invariant_ekf_scale(&drive->params.model, &drive->base, &moving, &holding);
    return true;
}

bool estimator_design(struct drive *drive, const struct drive_settings *settings,
                      char error[DRIVE_ERROR_TEXT])
{
    const double period_s = drive->board->facts->control_period_s;
    const struct position position = axis_kept_position(drive);
    const struct estimator_start start = {.position = position,
                                          .encoder_position = position,
                                          .resistance = drive->params.model.nominal_resistance};
    if (settings->feedback == DRIVE_FEEDBACK_ENCODER && !ESTIMATORS_READ_ENCODER) {
        return design_refuse(error, "feedback = encoder: this image is for a board without one");
    }
    const bool designed = settings->feedback == DRIVE_FEEDBACK_ENCODER
                              ? design_encoder_observers(drive, settings, period_s, error)
                          : settings->estimator == DRIVE_ESTIMATOR_STEADY_STATE_EKF
                              ? design_steady_state_ekf(drive, settings, period_s, error)
                              : design_invariant_ekf(drive, settings, period_s, error);

    if (!designed) {
        return false;
    }
    estimator_begin(&drive->estimator, &drive->params.estimator, &start);
    return true;
}
