#include "firmware/interface/drive_interface.h"

#include "firmware/drive/default_settings.h"

bool drive_hold_bearing_of(const struct drive_settings *given, double period_s,
                           double blind_speed_rad_s, struct drive_hold_bearing *bearing,
                           char error[DRIVE_ERROR_TEXT])
{
    struct drive_settings settings = *given;
    const struct motor_params *motor = &settings.motor;
    struct invariant_ekf_gains moving;
    struct invariant_ekf_hold_gains holding;

    default_settings_apply(&settings, period_s, 0u);

    const struct hold_task task = hold_task_of(&settings, period_s);
    const double torque_Nm = hold_torque_Nm(motor, settings.hold_current_A);

    if (!invariant_ekf_motion_design(motor, period_s, &moving, error) ||
        !invariant_ekf_motion_check(motor, period_s, &moving, error) ||
        !invariant_ekf_hold_design(motor, period_s, settings.hold_current_A, &holding, error) ||
        !hold_estimator_check(&task, &holding, error) || !hold_control_check(&task, error)) {
        return false;
    }
    invariant_ekf_bear_offset(period_s, blind_speed_rad_s, &holding);
    *bearing = (struct drive_hold_bearing){
        .current_A = settings.hold_current_A,
        .heat_W = hold_heat_W(motor, settings.hold_current_A),
        .torque_Nm = torque_Nm,
        .load_step_Nm = HOLD_LOAD_STEP_SHARE * torque_Nm,
        .noticed_step_Nm = holding.load_step_Nm / hold_step_shown(&task, &holding.quiet),
        .creep_speed_rad_s = hold_creep_speed(motor, settings.hold_current_A),
        .motion_current_A = settings.motion_current_A,
        .thrown_deg = invariant_ekf_thrown_deg(motor, period_s, &moving),
        .drop_deg = hold_drop_angle_deg(&task),
    };
    return true;
}

double drive_law_stiffness_Nm_rad(const struct drive_settings *given, double period_s,
                                  uint32_t counts_per_turn)
{
    struct drive_settings settings = *given;

    default_settings_apply(&settings, period_s, counts_per_turn);
    return settings.motor.inertia_kgm2 * settings.law_bandwidth_rad_s *
           settings.law_bandwidth_rad_s;
}
