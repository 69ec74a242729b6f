#include "firmware/design/hold_check.h"

#include "firmware/design/elementary.h"
#include "firmware/design/loop_bandwidth.h"
#include "firmware/design/modes.h"
#include "firmware/design/state_feedback_design.h"

/* w0 of the damping: at least this, rad/s, and at least this share of w_h. */
static const double bandwidth_min = 200.0;
static const double bandwidth_share = 0.25;

/* Slower than this, rad/s, a mode of the estimation error is drift: load and displacement are one
   to a rotor at rest. */
static const double drift_rad_s = 1.0;

/* Electrical speed at which the hold leads the rotor, of w_h; and the back-EMF there, of the
 * supply. */
static const double resonance_share = 0.125;
static const double creep_back_emf = 0.026;
static const double creep_lag_rad = 0.02; /* electrical */

/* 1/w_h in which a load step shows most. */
static const double shown_swings = 8.0;

enum { CURRENT, SPEED, ANGLE, INTEGRAL, CONTROL_STATES, VOLTAGE = 3 };
enum { LOAD = 3, OFFSET, ESTIMATION_STATES };

double hold_bandwidth(const struct motor_params *motor, double hold_current_A,
                      double current_bandwidth_rad_s)
{
    const double wanted = bandwidth_share * hold_frequency(motor, hold_current_A);

    return smaller(larger(wanted, bandwidth_min),
                   current_bandwidth_rad_s / CURRENT_OVER_POSITION_BANDWIDTH_MIN);
}

double hold_creep_speed(const struct motor_params *motor, double hold_current_A)
{
    const double below_resonance =
        resonance_share * hold_frequency(motor, hold_current_A) / motor->rotor_teeth;

    return smaller(below_resonance, creep_back_emf * motor->supply_V / motor->torque_constant_Nm_A);
}

double hold_creep_acceleration(const struct motor_params *motor, double hold_current_A)
{
    const double w_h = hold_frequency(motor, hold_current_A);

    return creep_lag_rad * w_h * w_h / motor->rotor_teeth;
}

bool hold_damping_design(const struct hold_task *task, double *damping_As_rad,
                         char error[DESIGN_ERROR_TEXT])
{
    const bool given = task->bandwidth_rad_s == task->bandwidth_rad_s;
    const double bandwidth =
        given ? task->bandwidth_rad_s
              : hold_bandwidth(task->motor, task->hold_current_A, task->current_bandwidth_rad_s);
    struct state_feedback_gains gains;

    if (!state_feedback_design(task->motor, task->period_s, bandwidth,
                               task->current_bandwidth_rad_s, &gains, error)) {
        return false;
    }
    *damping_As_rad = 2.0 * gains.k_speed_As_rad;
    return true;
}

/* i_q, w, theta of the held rotor about its rest, times the period. */
static void held_rotor(const struct hold_task *task, struct matrix *a)
{
    const struct motor_params *motor = task->motor;
    const double per_inductance = task->period_s / motor->inductance_H;
    const double per_inertia = task->period_s / motor->inertia_kgm2;
    const double km = motor->torque_constant_Nm_A;

    *a = (struct matrix){{{0.0}}};
    a->at[CURRENT][CURRENT] = -per_inductance * motor->resistance_ohm;
    a->at[CURRENT][SPEED] = -per_inductance * km;
    a->at[SPEED][CURRENT] = per_inertia * km;
    a->at[SPEED][SPEED] = -per_inertia * motor->viscous_friction_Nms_rad;
    a->at[SPEED][ANGLE] = -per_inertia * km * motor->rotor_teeth * task->hold_current_A;
    a->at[ANGLE][SPEED] = task->period_s;
}

double hold_control_damping(const struct hold_task *task, double damping_As_rad)
{
    const struct motor_params *motor = task->motor;
    const double proportional = motor->inductance_H * task->current_bandwidth_rad_s;
    const double integral = motor->resistance_ohm * task->current_bandwidth_rad_s * task->period_s;
    struct matrix model;
    struct matrix transition;
    struct matrix loop = {{{0.0}}};

    held_rotor(task, &model);
    model.at[CURRENT][VOLTAGE] = task->period_s / motor->inductance_H;
    matrix_exponential(CONTROL_STATES, &model, &transition);

    const double voltage[CONTROL_STATES] = {
        [CURRENT] = -proportional,
        [SPEED] = motor->torque_constant_Nm_A - proportional * damping_As_rad,
        [INTEGRAL] = 1.0,
    };

    for (int i = 0; i < INTEGRAL; i++) {
        for (int j = 0; j < CONTROL_STATES; j++) {
            loop.at[i][j] = (j == INTEGRAL ? 0.0 : transition.at[i][j]) +
                            transition.at[i][VOLTAGE] * voltage[j];
        }
    }
    loop.at[INTEGRAL][INTEGRAL] = 1.0;
    loop.at[INTEGRAL][CURRENT] = -integral;
    loop.at[INTEGRAL][SPEED] = -integral * damping_As_rad;
    return modes_damping(CONTROL_STATES, &loop, task->period_s, 0.0);
}

/* The estimation error from one period to the next, its correction first; the number of its states.
 */
static int estimation_loop(const struct hold_task *task, const struct invariant_ekf_gains *gains,
                           struct matrix *transition, struct matrix *loop)
{
    const bool offset = gains->bias_return_V_Nm != 0.0 || gains->k_bias_q_V_A != 0.0;
    const int states = offset ? ESTIMATION_STATES : OFFSET;
    const double correction[ESTIMATION_STATES] = {
        [CURRENT] = 0.5 * (gains->k_current_d + gains->k_current_q),
        [SPEED] = gains->k_speed_q_rad_As,
        [ANGLE] = gains->k_angle_q_rad_A,
        [LOAD] = gains->k_load_q_Nm_A,
        [OFFSET] = gains->k_bias_q_V_A,
    };
    struct matrix model;
    struct matrix corrected = {{{0.0}}};

    held_rotor(task, &model);
    model.at[SPEED][LOAD] = -task->period_s / task->motor->inertia_kgm2;
    model.at[CURRENT][OFFSET] = -task->period_s / task->motor->inductance_H;
    matrix_exponential(states, &model, transition);
    for (int i = 0; i < states; i++) {
        corrected.at[i][i] = 1.0;
        corrected.at[i][CURRENT] -= correction[i];
    }
    corrected.at[LOAD][LOAD] -= gains->load_return;
    corrected.at[ANGLE][LOAD] = gains->angle_return_rad_Nm;
    corrected.at[OFFSET][LOAD] = -gains->bias_return_V_Nm;
    matrix_multiply(states, transition, &corrected, loop);
    return states;
}

double hold_estimator_damping(const struct hold_task *task, const struct invariant_ekf_gains *gains)
{
    struct matrix transition;
    struct matrix loop;
    const int states = estimation_loop(task, gains, &transition, &loop);

    return modes_damping(states, &loop, task->period_s, drift_rad_s);
}

double hold_step_shown(const struct hold_task *task, const struct invariant_ekf_gains *settled)
{
    const double swing_periods =
        1.0 / (hold_frequency(task->motor, task->hold_current_A) * task->period_s);
    struct matrix transition;
    struct matrix loop;
    const int states = estimation_loop(task, settled, &transition, &loop);
    double error[ESTIMATION_STATES] = {[LOAD] = -1.0};
    double shown = 0.0;

    for (int k = 0; k < (int)(shown_swings * swing_periods); k++) {
        double next[ESTIMATION_STATES] = {0.0};

        for (int i = 0; i < states; i++) { /* what returns, does so to the load before the step */
            next[i] = transition.at[i][ANGLE] * settled->angle_return_rad_Nm -
                      transition.at[i][LOAD] * settled->load_return;
            if (states == ESTIMATION_STATES) {
                next[i] -= transition.at[i][OFFSET] * settled->bias_return_V_Nm;
            }
            for (int j = 0; j < states; j++) {
                next[i] += loop.at[i][j] * error[j];
            }
        }
        for (int i = 0; i < states; i++) {
            error[i] = next[i];
        }
        shown = larger(1.0 + error[LOAD], shown);
    }
    return shown;
}

static bool require_damping(char error[DESIGN_ERROR_TEXT], const char *quantity, double damping)
{
    return damping >= HOLD_DAMPING_MIN ||
           design_refuse_limit(error, (struct refusal){.quantity = quantity,
                                                       .value = damping,
                                                       .relation = "at least",
                                                       .limit = HOLD_DAMPING_MIN,
                                                       .unit = "",
                                                       .reason = "or the held rotor rings: less "
                                                                 "hold_current_A"});
}

bool hold_control_check(const struct hold_task *task, char error[DESIGN_ERROR_TEXT])
{
    const double frequency = hold_frequency(task->motor, task->hold_current_A);
    double damping_As_rad;

    return design_require_within(error, "frequency of the held rotor", frequency, 0.0,
                                 HOLD_FREQUENCY_PERIOD_MAX / task->period_s, "rad/s",
                                 "0.3 per control period: less hold_current_A") &&
           hold_damping_design(task, &damping_As_rad, error) &&
           require_damping(error, "damping of the hold",
                           hold_control_damping(task, damping_As_rad));
}

double hold_drop_angle_deg(const struct hold_task *task)
{
    const struct motor_params *motor = task->motor;
    const double drop_V = motor->resistance_ohm * motor->rated_current_A;

    return DEGREES_PER_RAD * HOLD_DROP_ERROR * drop_V / motor->torque_constant_Nm_A *
           motor->rotor_teeth / hold_frequency(motor, task->hold_current_A);
}

bool hold_estimator_check(const struct hold_task *task,
                          const struct invariant_ekf_hold_gains *gains,
                          char error[DESIGN_ERROR_TEXT])
{
    return design_require_within(error, "winding_drop_angle_error", hold_drop_angle_deg(task), 0.0,
                                 ANGLE_ERROR_MAX_DEG, "degrees electrical",
                                 "of 2.5 % of R x rated current: too little back-EMF for its "
                                 "inertia") &&
           require_damping(error, "damping of the hold's estimate",
                           hold_estimator_damping(task, &gains->quiet)) &&
           require_damping(error, "damping of the hold's load estimate",
                           hold_estimator_damping(task, &gains->following));
}
