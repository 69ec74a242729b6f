#include "firmware/design/invariant_ekf_design.h"

#include "firmware/design/elementary.h"
#include "firmware/design/hold_frequency.h"
#include "firmware/design/motor_check.h"
#include "firmware/design/riccati.h"

/* States of the error model. */
enum { I_D, I_Q, SPEED, ANGLE, LOAD, STATES };

/*
 * What the filter assumes of the drive, in ratios that follow the motor. Random walks are
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
    double current_walk;     /* of the rated current, in walks of the load */
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
 *
 * The control steps the current of a hold with each change of the load's estimate. An inductance
 * that is not the model's makes of each step an innovation, and of that the next change: the
 * current walks with the load. Left out, two of three random motors are unstable where the
 * inductance is a tenth less than their file says. It stands for what the voltage's noise stands
 * for, too: whichever is more counts.
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
    .current_walk = 0.4,
    .angle_walk = 0.005, /* 1e-6 rad mechanical per period */
};

/* A hold that follows a load step expects six times the variance of the load; with 16 times it
   swings where the inductance is a tenth off and saturation 20 %. */
#define LOAD_STEP_WALK (0.25 / RATED_TORQUE_NM)

/* Speed at which the angle's odd gain acts in full, as a back-EMF of the supply. */
#define FULL_ANGLE_BACK_EMF (BACK_EMF_V(1.0) / SUPPLY_V)

/*
 * How fast the voltage offset is moved towards what the innovation shows, 1/s. Most of an offset is
 * first taken for speed or load, so that it is found more slowly: in motion with 3 1/s at every
 * speed from 1 rad/s, in hold, where no load is expected, with 50 1/s. Its noise is then 1 mV rms.
 */
#define BIAS_RATE_MOTION   14.0
#define BIAS_RATE_UNLOADED 65.0
/* Likewise of the resistance in hold; nothing else answers to nu_d there. */
#define RESISTANCE_RATE 45.0
/*
 * A settled hold returns to its load in 3/w_h: 11 ms with the motor above, 2 to 3 ms with a bare
 * rotor, which swings out as much sooner. Left alone, a millivolt of offset would walk the estimate
 * away by 12 mN m/s on the motor above. What lasts of the way is an offset, which is found with
 * this damping. Quicker, a load step is not distinguished from its return; slower, sensors that
 * differ by 1 % make a step of the current look like one of the load.
 */
#define RETURN_SWING   3.0
#define RETURN_DAMPING 1.4
/* A change of the load by so many times the noise of its estimate is a step, within these shares of
   the rated torque, 3.2 and 5.3 %: a rotor that half the rated current holds against one that is
   not noticed stands 1/24 and 1/15 of a full step away. */
#define LOAD_STEP_NOISE 16.0
#define LOAD_STEP_MIN   (0.015 / RATED_TORQUE_NM)
#define LOAD_STEP_MAX   (0.025 / RATED_TORQUE_NM)
/* Offsets of both phases add up to 1.41 of one, in the worst angle. */
#define BOTH_PHASES 1.5
/* A load step is followed until the rotor has swung out, in units of 1/w_h. */
#define FOLLOWING_SWING 8.0
/* Behind the gains that follow a load step the hold returns to the load found, for a while, unless
   the load changes by twice a step: a hold that followed each drift at once would follow its own
   compensation around. */
#define REST_S 0.010
/* What a hold takes for its resistance is offsets along its d current, too: by so much of the
   resistance the q current's drop is unknown. 1.75 to 2.5 % serve. */
#define HELD_RESISTANCE_ERROR 0.02
/* A rotor that is drawn into place from where it was assumed not to be comes to rest within this.
 */
#define SWING_S 0.050
/* The settled load is the mean of the estimate over this time. */
#define LOAD_SETTLE_TIME_S 5e-4

static uint32_t periods(double time_s, double period_s)
{
    return (uint32_t)(time_s / period_s + 0.5);
}

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
    double current_walk = tuning->current_walk * tuning->load_walk * motor->rated_current_A;
    double current = larger(square(tuning->voltage_noise * current_per_voltage),
                            square(current_walk) * period_s);
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

/* Load step, of the rated torque, that a motor has to bear in motion. */
#define BORNE_LOAD_STEP 0.25

/* Within this a throw has reached its peak, or the motor is slow enough to be seen. */
#define THROW_S 0.1

double invariant_ekf_thrown_rad(const struct motor_params *motor, double period_s,
                                const struct invariant_ekf_gains *gains, double load_step_Nm)
{
    const double km = motor->torque_constant_Nm_A;
    const double decay = exponential(-period_s * motor->resistance_ohm / motor->inductance_H);
    const double admittance = (1.0 - decay) / motor->resistance_ohm;
    const double per_inertia = period_s / motor->inertia_kgm2;
    const double k_current = 0.5 * (gains->k_current_d + gains->k_current_q);
    double current = 0.0; /* of the estimate, beside the truth, as the others */
    double speed = 0.0;
    double angle = 0.0;
    double load = -load_step_Nm;
    double peak = 0.0;

    for (uint32_t k = periods(THROW_S, period_s); k > 0u && angle >= 0.98 * peak; k--) {
        const double mean_speed = speed + 0.5 * per_inertia * (km * current - load);
        const double next_current = decay * current - admittance * km * mean_speed;
        const double torque_Nm =
            0.5 * km * (current + next_current) - load - motor->viscous_friction_Nms_rad * speed;
        const double next_speed = speed + per_inertia * torque_Nm;

        angle += 0.5 * period_s * (speed + next_speed) - gains->k_angle_q_rad_A * next_current;
        speed = next_speed - gains->k_speed_q_rad_As * next_current;
        load -= gains->k_load_q_Nm_A * next_current;
        current = (1.0 - k_current) * next_current;
        peak = larger(angle, peak);
    }
    return peak * motor->rotor_teeth;
}

double invariant_ekf_thrown_deg(const struct motor_params *motor, double period_s,
                                const struct invariant_ekf_gains *gains)
{
    const double step_Nm = BORNE_LOAD_STEP * motor->torque_constant_Nm_A * motor->rated_current_A;

    return DEGREES_PER_RAD * invariant_ekf_thrown_rad(motor, period_s, gains, step_Nm);
}

bool invariant_ekf_motion_check(const struct motor_params *motor, double period_s,
                                const struct invariant_ekf_gains *gains,
                                char error[DESIGN_ERROR_TEXT])
{
    const double thrown_deg = invariant_ekf_thrown_deg(motor, period_s, gains);

    return thrown_deg <= ANGLE_ERROR_MAX_DEG ||
           design_refuse_limit(
               error,
               (struct refusal){
                   .quantity = "load_step_angle_error",
                   .value = thrown_deg,
                   .relation = "at most",
                   .limit = ANGLE_ERROR_MAX_DEG,
                   .unit = "degrees electrical",
                   .reason = "of 25 % of the rated torque: too little back-EMF for this supply"});
}

/*
 * The Kalman gain takes a part of each innovation for noise, and with it the flux that the rotor
 * has crossed: of a motor with little back-EMF two thirds, of which a load step leaves as much
 * behind as displacement. So the angle follows the flux instead: what voltage the innovation stands
 * for, integrated, is Km times the angle. A step then leaves nothing behind, and the loop is damped
 * no less. The current model has the back-EMF of the speed at the period's begin, the angle goes by
 * the mean speed: so half a period of what the innovation adds to the speed is the angle's, too.
 */
static double flux_angle_gain(const struct motor_params *motor, double period_s, double k_current,
                              double k_speed_q)
{
    return -voltage_per_innovation(motor, period_s, k_current) * period_s /
               motor->torque_constant_Nm_A +
           0.5 * period_s * k_speed_q;
}

/* Gains that the holds have in common, of a load that walks by `load_walk`. */
static bool hold_gains(const struct motor_params *motor, double period_s, double hold_current_A,
                       double load_walk, struct invariant_ekf_gains *gains)
{
    struct tuning tuning = hold_tuning;
    struct riccati_solution solution;

    tuning.i_d_A = hold_current_A;
    tuning.load_walk = load_walk;
    if (!solve(motor, period_s, &tuning, &solution)) {
        return false;
    }
    const double k_current_d = solution.gain[I_D][I_D];
    const double k_current_q = solution.gain[I_Q][I_Q];

    *gains = (struct invariant_ekf_gains){
        .k_current_d = k_current_d,
        .k_current_q = k_current_q,
        .k_speed_q_rad_As = solution.gain[SPEED][I_Q],
        .k_angle_q_rad_A = flux_angle_gain(motor, period_s, 0.5 * (k_current_d + k_current_q),
                                           solution.gain[SPEED][I_Q]),
        .k_load_q_Nm_A = solution.gain[LOAD][I_Q],
        .angle_d_full_speed_rad_s = speed_of_back_emf(motor, FULL_ANGLE_BACK_EMF),
        .k_resistance_ohm_A2 = -RESISTANCE_RATE * period_s *
                               voltage_per_innovation(motor, period_s, k_current_d) /
                               square(hold_current_A),
    };
    return gains_plausible(gains);
}

/*
 * The settled hold returns on the line on which load and displacement balance, J w_h^2 theta =
 * -T_L, which no innovation distinguishes: so it makes none of its own, and swings against nothing.
 */
static void let_return(const struct motor_params *motor, double period_s, double hold_current_A,
                       struct invariant_ekf_gains *settled)
{
    const double stiffness_Nm_rad =
        motor->rotor_teeth * motor->torque_constant_Nm_A * hold_current_A;
    const double way_rad_Nm = 1.0 / stiffness_Nm_rad;
    const double time_s = RETURN_SWING / hold_frequency(motor, hold_current_A);

    settled->load_return = 1.0 - exponential(-period_s / time_s);
    settled->angle_return_rad_Nm = settled->load_return * way_rad_Nm;
    settled->bias_return_V_Nm =
        period_s / square(2.0 * RETURN_DAMPING * time_s) * motor->torque_constant_Nm_A * way_rad_Nm;
}

/*
 * The smallest change of a settled load that is taken for a step. Its estimate has the noise that
 * the voltage's makes of the flux while the load returns, RETURN_SWING / w_h: as an angle over Km,
 * as a torque on the hold's spring.
 */
static double load_step_Nm(const struct motor_params *motor, double period_s, double hold_current_A)
{
    const double rated_Nm = motor->torque_constant_Nm_A * motor->rated_current_A;
    const double periods = 0.5 * RETURN_SWING / (hold_frequency(motor, hold_current_A) * period_s);
    const double flux_Vs =
        hold_tuning.voltage_noise * motor->supply_V * period_s * square_root(periods);
    const double step_Nm = LOAD_STEP_NOISE * motor->rotor_teeth * hold_current_A * flux_Vs;

    return larger(LOAD_STEP_MIN * rated_Nm, smaller(LOAD_STEP_MAX * rated_Nm, step_Nm));
}

/* Where in a settled hold as much of the load returns in a period as this speed feigns in it. */
static double feigned_Nm(const struct invariant_ekf_gains *settled, double period_s,
                         double speed_rad_s)
{
    return speed_rad_s * period_s / settled->angle_return_rad_Nm;
}

__attribute__((noinline)) void invariant_ekf_bear_offset(double period_s,
                                                         double feigned_speed_rad_s,
                                                         struct invariant_ekf_hold_gains *gains)
{
    gains->load_step_Nm =
        larger(gains->load_step_Nm,
               feigned_Nm(&gains->quiet, period_s, BOTH_PHASES * feigned_speed_rad_s));
}

/* By the q current that compensates a load of 1 N m, and the speed as whose back-EMF its drop
   shows. */
static double feigned_share(const struct motor_params *motor, double period_s,
                            const struct invariant_ekf_gains *settled)
{
    const double speed_rad_s =
        HELD_RESISTANCE_ERROR * motor->resistance_ohm / square(motor->torque_constant_Nm_A);

    return feigned_Nm(settled, period_s, speed_rad_s);
}

/* Of that in motion, since a step is over within a swing; with more a load that grows draws the
   rotor further. */
#define ANGLE_FOUND_IN_STEP 1.5

void invariant_ekf_find_angle_in_step(const struct invariant_ekf_gains *moving,
                                      struct invariant_ekf_hold_gains *hold)
{
    hold->following.k_angle_d_rad_A = ANGLE_FOUND_IN_STEP * moving->k_angle_d_rad_A;
}

bool invariant_ekf_settled_hold_design(const struct motor_params *motor, double period_s,
                                       double hold_current_A,
                                       struct invariant_ekf_hold_gains *gains,
                                       char error[DESIGN_ERROR_TEXT])
{
    return motor_check(motor, period_s, error) &&
           design_require_positive(error, "hold current", hold_current_A, "A") &&
           (hold_gains(motor, period_s, hold_current_A, hold_tuning.load_walk, &gains->quiet) ||
            design_refuse(error, no_gain));
}

bool invariant_ekf_load_step_hold_design(const struct motor_params *motor, double period_s,
                                         double hold_current_A,
                                         struct invariant_ekf_hold_gains *gains,
                                         char error[DESIGN_ERROR_TEXT])
{
    if (!hold_gains(motor, period_s, hold_current_A, LOAD_STEP_WALK, &gains->following)) {
        return design_refuse(error, no_gain);
    }
    gains->unloaded = gains->quiet;
    /* A displacement is then the only other thing that an offset can be taken for; it decays by
       itself, with the rotor's swing. */
    gains->unloaded.k_angle_q_rad_A = 0.0;
    gains->unloaded.k_load_q_Nm_A = 0.0;
    gains->unloaded.k_bias_q_V_A =
        -BIAS_RATE_UNLOADED * period_s *
        voltage_per_innovation(motor, period_s, gains->quiet.k_current_d);
    let_return(motor, period_s, hold_current_A, &gains->quiet);
    gains->following.load_settle = 1.0 - exponential(-period_s / LOAD_SETTLE_TIME_S);
    gains->following_periods =
        periods(FOLLOWING_SWING / hold_frequency(motor, hold_current_A), period_s);
    gains->rest_periods = periods(REST_S, period_s);
    gains->swing_periods = periods(SWING_S, period_s);
    gains->load_step_Nm = load_step_Nm(motor, period_s, hold_current_A);
    gains->feigned_share = feigned_share(motor, period_s, &gains->quiet);
    return true;
}

bool invariant_ekf_hold_design(const struct motor_params *motor, double period_s,
                               double hold_current_A, struct invariant_ekf_hold_gains *gains,
                               char error[DESIGN_ERROR_TEXT])
{
    return invariant_ekf_settled_hold_design(motor, period_s, hold_current_A, gains, error) &&
           invariant_ekf_load_step_hold_design(motor, period_s, hold_current_A, gains, error);
}
