#include "sil/scenario/metrics.h"

namespace scenario
{

const std::vector<MetricField> &metric_fields()
{
    static const std::vector<MetricField> fields = {
        {"position_error_max_rad", &Metrics::position_error_max_rad},
        {"position_error_rms_rad", &Metrics::position_error_rms_rad},
        {"position_error_final_rad", &Metrics::position_error_final_rad},
        {"position_error_steady_rad", &Metrics::position_error_steady_rad},
        {"lag_s", &Metrics::lag_s},
        {"position_ripple_rms_rad", &Metrics::position_ripple_rms_rad},
        {"estimate_error_max_rad", &Metrics::estimate_error_max_rad},
        {"estimate_error_rms_rad", &Metrics::estimate_error_rms_rad},
        {"estimate_error_final_rad", &Metrics::estimate_error_final_rad},
        {"speed_error_max_rad_s", &Metrics::speed_error_max_rad_s},
        {"speed_error_rms_rad_s", &Metrics::speed_error_rms_rad_s},
        {"load_torque_error_max_Nm", &Metrics::load_torque_error_max_Nm},
        {"load_torque_error_rms_Nm", &Metrics::load_torque_error_rms_Nm},
        {"load_torque_error_final_Nm", &Metrics::load_torque_error_final_Nm},
        {"load_torque_t90_s", &Metrics::load_torque_t90_s},
        {"overshoot_rad", &Metrics::overshoot_rad},
        {"settling_time_s", &Metrics::settling_time_s},
        {"current_peak_A", &Metrics::current_peak_A},
        {"current_rms_A", &Metrics::current_rms_A},
        {"current_ripple_rms_A", &Metrics::current_ripple_rms_A},
        {"voltage_peak_V", &Metrics::voltage_peak_V},
        {"voltage_rms_V", &Metrics::voltage_rms_V},
        {"voltage_q_peak_to_peak_V", &Metrics::voltage_q_peak_to_peak_V},
        {"voltage_q_ripple_V", &Metrics::voltage_q_ripple_V},
        {"slip_full_steps", &Metrics::slip_full_steps},
        {"resistance_estimate_error_ratio", &Metrics::resistance_estimate_error_ratio},
        {"synchronism_worst", &Metrics::synchronism_worst},
        {"enabling_time_s", &Metrics::enabling_time_s},
        {"enabling_motion_max_rad", &Metrics::enabling_motion_max_rad},
        {"enabling_displacement_rad", &Metrics::enabling_displacement_rad},
        {"commands_refused", &Metrics::commands_refused},
        {"commands_dropped", &Metrics::commands_dropped},
    };
    return fields;
}

} // namespace scenario
