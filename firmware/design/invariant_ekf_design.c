#include "firmware/design/invariant_ekf_design.h"

#include "firmware/design/elementary.h"
#include "firmware/design/motor_check.h"
#include "firmware/design/riccati.h"

/* States of the error model; in motion the first five. */
enum { I_D, I_Q, SPEED, ANGLE, LOAD, BIAS_D, BIAS_Q };
enum { STATES_MOTION = 5, STATES_HOLD = 7 };

/*
 * What the filter is told about the drive, in ratios that follow the motor. Random walks are
 * densities, so that they follow the control period too; errors of a sample are per sample.
 */
struct tuning {
    int states;
    int doublings;           /* of the Riccati equation */
    double back_emf;         /* at the design speed, of the supply */
    double i_d_A;            /* of the linearisation */
    double current_variance; /* of a measured current, of the rated current squared */
    double voltage_noise;    /* rms of a period's mean voltage, of the supply */
    double torque_noise;     /* white torque, of the rated torque, sqrt(s) */
    double load_walk;        /* of the rated torque, 1/sqrt(s) */
    double angle_walk;       /* electrical rad, 1/sqrt(s) */
    double bias_d, bias_q;   /* rms of the voltage biases, of the supply */
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
 * errors. In hold R, the largest of them, is covered by the bias states.
 */
#define SUPPLY_V        24.0
#define RATED_A         3.0
#define RATED_TORQUE_NM (0.157 * RATED_A)
#define BACK_EMF_V(w)   (0.157 * (w)) /* at w rad/s */

/* 2^11 periods settle the gains of every motor file to 1e-6 at 50 us and more. */
static const struct tuning motion_tuning = {
    .states = STATES_MOTION,
    .doublings = 11,
    .back_emf = BACK_EMF_V(5.0) / SUPPLY_V,
    .current_variance = 3.9e-5 / (RATED_A * RATED_A),
    .voltage_noise = 0.03 / SUPPLY_V,
    .torque_noise = 1.562e-5 / RATED_TORQUE_NM, /* 1e-3 rad/s per period */
    .load_walk = 0.1 / RATED_TORQUE_NM,         /* 1e-3 N m per period */
    .angle_walk = 0.5,                          /* 1e-4 rad mechanical per period */
};

/* The slowest mode of the hold's filter, load against displacement, decays with 4 1/s: 2^14. */
static const struct tuning hold_tuning = {
    .states = STATES_HOLD,
    .doublings = 14,
    .back_emf = BACK_EMF_V(1.0) / SUPPLY_V,
    .current_variance = 9.7e-6 / (RATED_A * RATED_A),
    .voltage_noise = 0.03 / SUPPLY_V,
    .torque_noise = 1.562e-5 / RATED_TORQUE_NM,
    .load_walk = 0.1 / RATED_TORQUE_NM,
    .angle_walk = 0.005, /* 1e-6 rad mechanical per period */
    .bias_d = 0.05 / SUPPLY_V,
    .bias_q = 0.02 / SUPPLY_V,
};

/* The fast hold expects ten times the variance of the load and a quarter of the bias in q. */
#define FAST_LOAD_WALK (0.316227766 / RATED_TORQUE_NM)
#define FAST_BIAS_Q    (0.005 / SUPPLY_V)

/* Speed at which the angle's odd gain acts in full, as a back-EMF of the supply. */
#define FULL_ANGLE_BACK_EMF (BACK_EMF_V(1.0) / SUPPLY_V)

/* Correlation times of the hold's voltage bias and of the fast hold's load estimate, s. */
#define BIAS_TIME_S      0.05
#define LOAD_LEAK_TIME_S 0.1
/*
 * Load and displacement cannot be told apart at rest, so an offset of a millivolt that is left in
 * the voltages would walk the load estimate away, by 12 mN m/s in the worst of eight runs, until
 * the hold lost the rotor. Forgotten within 2 s, it stays below a tenth of the rated torque.
 */
#define HOLD_LOAD_LEAK_TIME_S 2.0
/* R_est follows b_d / i_d with this rate, 1/s: slower than the bias that it empties. */
#define RESISTANCE_RATE 45.0

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
    if (tuning->states == STATES_HOLD) {
        a->at[I_D][BIAS_D] = -per_inductance;
        a->at[I_Q][BIAS_Q] = -per_inductance;
        a->at[BIAS_D][BIAS_D] = -period_s / BIAS_TIME_S;
        a->at[BIAS_Q][BIAS_Q] = -period_s / BIAS_TIME_S;
    }
}

static bool solve(const struct motor_params *motor, double period_s, const struct tuning *tuning,
                  struct riccati_solution *solution)
{
    double rated_torque = motor->torque_constant_Nm_A * motor->rated_current_A;
    double current_per_voltage = period_s / motor->inductance_H * motor->supply_V;
    double bias_renewal = 1.0 - square(exponential(-period_s / BIAS_TIME_S));
    double current = square(tuning->voltage_noise * current_per_voltage);
    struct riccati_problem problem = {
        .states = tuning->states,
        .doublings = tuning->doublings,
        .process_noise =
            {
                [I_D] = current,
                [I_Q] = current,
                [SPEED] =
                    square(tuning->torque_noise * rated_torque / motor->inertia_kgm2) * period_s,
                [ANGLE] = square(tuning->angle_walk / motor->rotor_teeth) * period_s,
                [LOAD] = square(tuning->load_walk * rated_torque) * period_s,
                [BIAS_D] = square(tuning->bias_d * motor->supply_V) * bias_renewal,
                [BIAS_Q] = square(tuning->bias_q * motor->supply_V) * bias_renewal,
            },
        .measurement_noise = tuning->current_variance * square(motor->rated_current_A),
    };
    struct matrix model;

    error_model(motor, period_s, tuning, &model);
    matrix_exponential(tuning->states, &model, &problem.transition);
    return riccati_solve(&problem, solution);
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
        .load_decay = 1.0,
    };
    return gains_plausible(gains) || design_refuse(error, no_gain);
}

bool invariant_ekf_hold_design(const struct motor_params *motor, double period_s,
                               double hold_current_A, enum invariant_ekf_hold hold,
                               struct invariant_ekf_gains *gains, char error[DESIGN_ERROR_TEXT])
{
    bool fast = hold == INVARIANT_EKF_HOLD_FAST;
    struct tuning tuning = hold_tuning;
    struct riccati_solution solution;

    if (!motor_check(motor, period_s, error) ||
        !design_require_positive(error, "hold current", hold_current_A, "A")) {
        return false;
    }
    tuning.i_d_A = hold_current_A;
    if (fast) {
        tuning.load_walk = FAST_LOAD_WALK;
        tuning.bias_q = FAST_BIAS_Q;
    }
    if (!solve(motor, period_s, &tuning, &solution)) {
        return design_refuse(error, no_gain);
    }
    *gains = (struct invariant_ekf_gains){
        .k_current_d = solution.gain[I_D][I_D],
        .k_current_q = solution.gain[I_Q][I_Q],
        .k_speed_q_rad_As = solution.gain[SPEED][I_Q],
        .k_angle_q_rad_A = solution.gain[ANGLE][I_Q],
        .k_load_q_Nm_A = solution.gain[LOAD][I_Q],
        .angle_d_full_speed_rad_s = speed_of_back_emf(motor, FULL_ANGLE_BACK_EMF),
        .k_bias_d_V_A = solution.gain[BIAS_D][I_D],
        .k_bias_q_V_A = solution.gain[BIAS_Q][I_Q],
        .bias_decay = exponential(-period_s / BIAS_TIME_S),
        .load_decay = exponential(-period_s / (fast ? LOAD_LEAK_TIME_S : HOLD_LOAD_LEAK_TIME_S)),
        .k_resistance_ohm_AV = RESISTANCE_RATE * period_s / square(hold_current_A),
    };
    return gains_plausible(gains) || design_refuse(error, no_gain);
}
