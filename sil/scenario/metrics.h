/*
 * Figures of merit of a run over a window of time; evaluation.h finds them.
 *
 * Position error is reference - true, estimate error true - estimate, speed and load torque errors
 * true - estimate. `max` and `final` are magnitudes; `final` belongs to the last row of the window.
 * A figure that has no value (an estimate that is not finite, a load step never followed, an empty
 * window) is NaN, and no bound holds for it.
 */
#ifndef STEADYSTEP_SCENARIO_METRICS_H
#define STEADYSTEP_SCENARIO_METRICS_H

#include <limits>
#include <string>
#include <vector>

namespace scenario
{

/* What the figures need to know besides the rows. */
struct MetricSettings {
    int rotor_teeth = 50;
    double settling_band_rad = 2e-3;
};

struct Metrics {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();

    double position_error_max_rad = none;
    double position_error_rms_rad = none;
    double position_error_final_rad = none;
    double position_error_steady_rad = none; /* mean over the later half of the cruise, signed */
    double lag_s = none;                     /* that by the reference's cruise speed */
    double position_ripple_rms_rad = none;   /* of the error about its mean */
    double estimate_error_max_rad = none;
    double estimate_error_rms_rad = none;
    double estimate_error_final_rad = none;
    double speed_error_max_rad_s = none;
    double speed_error_rms_rad_s = none;
    double load_torque_error_max_Nm = none;
    double load_torque_error_rms_Nm = none;
    double load_torque_error_final_Nm = none;
    double load_torque_t90_s = none; /* from a load step until 90 % of it is estimated; longest */
    double overshoot_rad = none;     /* beyond the target, once the reference stands there */
    double settling_time_s = none;   /* end of reference motion until the error stays in the band */
    double current_peak_A = none;    /* of either phase */
    double current_rms_A = none;     /* of one phase: root of the mean of (i_a^2 + i_b^2) / 2 */
    /* Of the measured q current about its mean over the 2 ms around each row, where these lie in
       the window: what the control loop
       makes of noise, as heat and sound, without what a move or a load needs. */
    double current_ripple_rms_A = none;
    double voltage_peak_V = none; /* likewise, of the period means */
    double voltage_rms_V = none;
    double voltage_q_peak_to_peak_V = none; /* as commanded, rotor frame */
    double voltage_q_ripple_V = none;       /* rms about its mean */
    double slip_full_steps = none; /* largest change of the estimate error since the window began,
                                      in full steps (90 degrees electrical), rounded */
    double resistance_estimate_error_ratio = none; /* |R^ - R| / R in the last row */
    double synchronism_worst = none; /* 0 sure, 1 doubtful, 2 stalled, 3 lost; the drive's */
    /* These are of no row: who has seen the run sets them (result.cpp). */
    double enabling_time_s = none;           /* of the command, as it acts, to the drive ready */
    double enabling_motion_max_rad = none;   /* of the true rotor from where it stood, until then */
    double enabling_displacement_rad = none; /* what is left of it then */
    double commands_refused = none;          /* of the timeline */
    double commands_dropped = none;

    std::string fault = "none"; /* the first in the window, as drive_fault_name spells it */
};

struct MetricField {
    const char *name;
    double Metrics::*value;
};

/* All numbers of Metrics, in order; `fault` is the only text. */
const std::vector<MetricField> &metric_fields();

} // namespace scenario

#endif
