#include "firmware/design/invariant_ekf_design.h"

#include "firmware/design/elementary.h"
#include "firmware/design/motor_check.h"
#include "firmware/design/riccati.h"

/* States of the error model. */
enum { I_D, I_Q, SPEED, ANGLE, LOAD, STATES };

/*
 * What the filter is told about the drive, in ratios that follow the motor. Random walks are
 * densities, so that they follow the control period too; errors of a sample are per sample.
 */
struct tuning {
    int doublings;           /* of the Riccati equation */
    double back_emf;         /* at the design speed, of the supply */
    double i_d_A;            /* of the linearisation */
    double current_variance; /* of a measured current, of the rated current squared */
    double voltage_noise;    /* rms of a period's mean voltage, of the supply */
    double torque_noise;     /* white torque, of the rated torque, sqrt(s) */
    double load_walk;        /* of the rated torque, 1/sqrt(s) */
    double angle_walk;       /* electrical rad, 1/sqrt(s) */
};

/*
 * The values were found by simulation on the motor bendjedia-2012 (24 V, 3 A, Km 0.157,
 * J 15.62e-5, N 50, period 100 us): some 500 designs, each on 45 disturbed moves; the optimum is
 * flat. Each quotient below is a value found over that motor's base. Voltages go with the supply,
 * because the voltage measurement and the dead time do; the angle is seen in the back-EMF against
 * the voltage noise, so the design speed is a back-EMF.
 *
 * In motion the currents are trusted half as much as their noise (3 mA rms and a 12-bit step:
 * 9.7e-6 A^2) would allow, and the angle is given a walk of its own: both stand for parameter
 * errors. In hold R, the largest of them, is known.
 */
#define SUPPLY_V        24.0
#define RATED_A         3.0
#define RATED_TORQUE_NM (0.157 * RATED_A)
#define BACK_EMF_V(w)   (0.157 * (w)) /* at w rad/s */

/* 2^11 periods settle the gains of every motor file to 1e-6 at 50 us and more. */
static const struct tuning motion_tuning = {
    .doublings = 11,
    .back_emf = BACK_EMF_V(5.0) / SUPPLY_V,
    .current_variance = 3.9e-5 / (RATED_A * RATED_A),
    .voltage_noise = 0.03 / SUPPLY_V,
    .torque_noise = 1.562e-5 / RATED_TORQUE_NM, /* 1e-3 rad/s per period */
    .load_walk = 0.1 / RATED_TORQUE_NM,         /* 1e-3 N m per period */
    .angle_walk = 0.5,                          /* 1e-4 rad mechanical per period */
};

/* The slowest mode of the hold's filter, load against displacement, needs 2^14. */
static const struct tuning hold_tuning = {
    .doublings = 14,
    .back_emf = BACK_EMF_V(1.0) / SUPPLY_V,
    .current_variance = 9.7e-6 / (RATED_A * RATED_A),
    .voltage_noise = 0.03 / SUPPLY_V,
    .torque_noise = 1.562e-5 / RATED_TORQUE_NM,
    .load_walk = 0.1 / RATED_TORQUE_NM,
    .angle_walk = 0.005, /* 1e-6 rad mechanical per period */
};

/* A hold that follows a load step expects four times the variance of the load. */
#define FOLLOWING_LOAD_WALK (0.2 / RATED_TORQUE_NM)

/* Speed at which the angle's odd gain acts in full, as a back-EMF of the supply. */
#define FULL_ANGLE_BACK_EMF (BACK_EMF_V(1.0) / SUPPLY_V)

/*
 * How fast the voltage offset is moved towards what the innovation shows, 1/s. Most of an offset is
 * first taken for speed or load, so that it is found more slowly: in motion with 3 1/s at every
 * speed from 1 rad/s, in hold with 8 1/s, where no load is expected with 50 1/s. Its noise is then
 * 1 mV rms.
 */
#define BIAS_RATE_MOTION 14.0
#define BIAS_RATE_HOLD   65.0
/* Likewise of the resistance in hold; nothing else answers to nu_d there. */
#define RESISTANCE_RATE 45.0
/*
 * A quiet hold returns to its load in 30 ms. Left alone, a millivolt of offset would walk the
 * estimate away by 12 mN m/s. What noise makes of the load in that time is 2 mN m rms, a seventh
 * of the step; a load that stays unseen moves the rotor by 1.3 mrad.
 */
#define LOAD_RETURN_TIME_S 0.03
#define LOAD_STEP          (0.015 / RATED_TORQUE_NM)
/* The settled load is the mean of the estimate over this time. */
#define LOAD_SETTLE_TIME_S 2e-3

static double square(double x)
{
    return x * x;
}

static double speed_of_back_emf(const struct motor_params *motor, double back_emf)
{
    return back_emf * motor->supply_V / motor->torque_constant_Nm_A;
}

/* The header's error model times the period; its exponential is the transition. */
static void error_model(const struct motor_params *motor, double period_s,
                        const struct tuning *tuning, struct matrix *a)
{
    double per_inductance = period_s / motor->inductance_H;
    double per_inertia = period_s / motor->inertia_kgm2;
    double km = motor->torque_constant_Nm_A;
    double electrical = motor->rotor_teeth * speed_of_back_emf(motor, tuning->back_emf);

    *a = (struct matrix){{{0.0}}};
    a->at[I_D][I_D] = -per_inductance * motor->resistance_ohm;
    a->at[I_D][I_Q] = period_s * electrical;
    a->at[I_D][ANGLE] = per_inductance * km * electrical;
    a->at[I_Q][I_D] = -period_s * electrical;
    a->at[I_Q][I_Q] = -per_inductance * motor->resistance_ohm;
    a->at[I_Q][SPEED] = -per_inductance * km;
    a->at[SPEED][I_Q] = per_inertia * km;
    a->at[SPEED][SPEED] = -per_inertia * motor->viscous_friction_Nms_rad;
    a->at[SPEED][ANGLE] = -per_inertia * km * motor->rotor_teeth * tuning->i_d_A;
    a->at[SPEED][LOAD] = -per_inertia;
    a->at[ANGLE][SPEED] = period_s;
}

static bool solve(const struct motor_params *motor, double period_s, const struct tuning *tuning,
                  struct riccati_solution *solution)
{
    double rated_torque = motor->torque_constant_Nm_A * motor->rated_current_A;
    double current_per_voltage = period_s / motor->inductance_H * motor->supply_V;
    double current = square(tuning->voltage_noise * current_per_voltage);
    struct riccati_problem problem = {
        .states = STATES,
        .doublings = tuning->doublings,
        .process_noise =
            {
                [I_D] = current,
                [I_Q] = current,
                [SPEED] =
                    square(tuning->torque_noise * rated_torque / motor->inertia_kgm2) * period_s,
                [ANGLE] = square(tuning->angle_walk / motor->rotor_teeth) * period_s,
                [LOAD] = square(tuning->load_walk * rated_torque) * period_s,
            },
        .measurement_noise = tuning->current_variance * square(motor->rated_current_A),
    };
    struct matrix model;

    error_model(motor, period_s, tuning, &model);
    matrix_exponential(STATES, &model, &problem.transition);
    return riccati_solve(&problem, solution);
}

/*
 * Voltage that one ampere of steady innovation stands for, when a share of `k_current` of it is
 * corrected each period: V (1 - (1 - k) a) / b with a = exp(-T R/L) and b = (1 - a)/R.
 */
static double voltage_per_innovation(const struct motor_params *motor, double period_s,
                                     double k_current)
{
    const double a = exponential(-period_s * motor->resistance_ohm / motor->inductance_H);

    return motor->resistance_ohm * (1.0 - (1.0 - k_current) * a) / (1.0 - a);
}

static const char no_gain[] = "estimator gains: none that make sense for this motor and period";

/* What the gains of every motor have in common; a NaN has it not. */
static bool gains_plausible(const struct invariant_ekf_gains *gains)
{
    return gains->k_current_d > 0.0 && gains->k_current_d < 1.0 && gains->k_current_q > 0.0 &&
           gains->k_current_q < 1.0 && gains->k_speed_q_rad_As < 0.0 &&
           gains->k_load_q_Nm_A > 0.0 && is_finite(gains->k_speed_q_rad_As) &&
           is_finite(gains->k_load_q_Nm_A) && is_finite(gains->k_angle_q_rad_A);
}

bool invariant_ekf_motion_design(const struct motor_params *motor, double period_s,
                                 struct invariant_ekf_gains *gains, char error[DESIGN_ERROR_TEXT])
{
    struct riccati_solution solution;

    if (!motor_check(motor, period_s, error)) {
        return false;
    }
    if (!solve(motor, period_s, &motion_tuning, &solution)) {
        return design_refuse(error, no_gain);
    }
    *gains = (struct invariant_ekf_gains){
        .k_current_d = solution.gain[I_D][I_D],
        .k_current_q = solution.gain[I_Q][I_Q],
        .k_speed_q_rad_As = solution.gain[SPEED][I_Q],
        .k_angle_d_rad_A = solution.gain[ANGLE][I_D],
        .k_angle_q_rad_A = solution.gain[ANGLE][I_Q],
        .k_load_q_Nm_A = solution.gain[LOAD][I_Q],
        .angle_d_full_speed_rad_s = speed_of_back_emf(motor, FULL_ANGLE_BACK_EMF),
        .k_bias_d_V_A = -BIAS_RATE_MOTION * period_s *
                        voltage_per_innovation(motor, period_s, solution.gain[I_D][I_D]),
    };
    return gains_plausible(gains) || design_refuse(error, no_gain);
}

bool invariant_ekf_hold_design(const struct motor_params *motor, double period_s,
                               double hold_current_A, enum invariant_ekf_hold hold,
                               struct invariant_ekf_gains *gains, char error[DESIGN_ERROR_TEXT])
{
    const bool following = hold == INVARIANT_EKF_HOLD_FOLLOWING;
    struct tuning tuning = hold_tuning;
    struct riccati_solution solution;

    if (!motor_check(motor, period_s, error) ||
        !design_require_positive(error, "hold current", hold_current_A, "A")) {
        return false;
    }
    tuning.i_d_A = hold_current_A;
    if (following) {
        tuning.load_walk = FOLLOWING_LOAD_WALK;
    }
    if (!solve(motor, period_s, &tuning, &solution)) {
        return design_refuse(error, no_gain);
    }
    const double k_current = solution.gain[I_D][I_D];
    const double voltage = voltage_per_innovation(motor, period_s, k_current);

    *gains = (struct invariant_ekf_gains){
        .k_current_d = k_current,
        .k_current_q = solution.gain[I_Q][I_Q],
        .k_speed_q_rad_As = solution.gain[SPEED][I_Q],
        .k_angle_q_rad_A = solution.gain[ANGLE][I_Q],
        .k_load_q_Nm_A = solution.gain[LOAD][I_Q],
        .angle_d_full_speed_rad_s = speed_of_back_emf(motor, FULL_ANGLE_BACK_EMF),
        .k_bias_q_V_A = following ? 0.0 : -BIAS_RATE_HOLD * period_s * voltage,
        .k_resistance_ohm_A2 = -RESISTANCE_RATE * period_s * voltage / square(hold_current_A),
        .load_return = following ? 0.0 : 1.0 - exponential(-period_s / LOAD_RETURN_TIME_S),
        .load_settle = following ? 1.0 - exponential(-period_s / LOAD_SETTLE_TIME_S) : 0.0,
        .load_step_Nm = LOAD_STEP * motor->torque_constant_Nm_A * motor->rated_current_A,
    };
    return gains_plausible(gains) || design_refuse(error, no_gain);
}
