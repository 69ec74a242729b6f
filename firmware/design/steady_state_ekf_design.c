#include "firmware/design/steady_state_ekf_design.h"

#include "firmware/design/motor_check.h"
#include "firmware/design/riccati.h"

/* States of the Riccati equation; theta, which drives none of them, follows from them. */
enum { I_D, I_Q, SPEED, LOAD, STATES };

/* 2^16 periods: the load estimate of a motor of large inertia is slow with the paper's Q. */
#define DOUBLINGS 16

/* The paper's Q and R; SI, variance per period. They belong to the paper: no scaling. */
#define NOISE_CURRENT     1e-4
#define NOISE_SPEED       1e-3
#define NOISE_LOAD        1e-6
#define NOISE_MEASUREMENT 1.0

static struct riccati_problem standstill_model(const struct motor_params *motor, double period_s)
{
    struct riccati_problem problem = {
        .states = STATES,
        .doublings = DOUBLINGS,
        .process_noise = {[I_D] = NOISE_CURRENT,
                          [I_Q] = NOISE_CURRENT,
                          [SPEED] = NOISE_SPEED,
                          [LOAD] = NOISE_LOAD},
        .measurement_noise = NOISE_MEASUREMENT,
    };
    struct matrix *f = &problem.transition;
    double per_inductance = period_s / motor->inductance_H;
    double per_inertia = period_s / motor->inertia_kgm2;

    f->at[I_D][I_D] = 1.0 - per_inductance * motor->resistance_ohm;
    f->at[I_Q][I_Q] = f->at[I_D][I_D];
    f->at[I_Q][SPEED] = -per_inductance * motor->torque_constant_Nm_A;
    f->at[SPEED][I_Q] = per_inertia * motor->torque_constant_Nm_A;
    f->at[SPEED][SPEED] = 1.0 - per_inertia * motor->viscous_friction_Nms_rad;
    f->at[SPEED][LOAD] = -per_inertia;
    f->at[LOAD][LOAD] = 1.0;
    return problem;
}

/*
 * theta(k+1) = theta + T w: its covariance p with the other states obeys, whatever its own
 * variance does,
 *   p = Phi (p + T P e_w),  Phi = F (I - K H),
 * whose series is summed by doubling. Returns K42 = p_iq / (P_iq,iq + R).
 */
static double angle_gain(const struct riccati_problem *problem,
                         const struct riccati_solution *solution, double period_s)
{
    struct matrix phi = problem->transition;
    double p[STATES];

    for (int i = 0; i < STATES; i++) {
        for (int j = 0; j < RICCATI_OUTPUTS; j++) {
            for (int k = 0; k < STATES; k++) {
                phi.at[i][j] -= problem->transition.at[i][k] * solution->gain[k][j];
            }
        }
    }
    for (int i = 0; i < STATES; i++) {
        p[i] = 0.0;
        for (int k = 0; k < STATES; k++) {
            p[i] += phi.at[i][k] * period_s * solution->covariance.at[k][SPEED];
        }
    }
    for (int doubling = 0; doubling < DOUBLINGS; doubling++) {
        struct matrix power = phi; /* Phi^(2^doubling) */
        double sum[STATES];        /* of as many terms */

        for (int i = 0; i < STATES; i++) {
            sum[i] = p[i];
        }
        for (int i = 0; i < STATES; i++) {
            for (int k = 0; k < STATES; k++) {
                p[i] += power.at[i][k] * sum[k];
            }
        }
        matrix_multiply(STATES, &power, &power, &phi);
    }
    return p[I_Q] / (solution->covariance.at[I_Q][I_Q] + problem->measurement_noise);
}

/* Below it the rotor, swinging against its own EMF, is damped in the Euler model (8) too. */
static double euler_period_max(const struct motor_params *motor)
{
    double r = motor->resistance_ohm;
    double l = motor->inductance_H;
    double km = motor->torque_constant_Nm_A;
    double kv = motor->viscous_friction_Nms_rad;

    return (r * motor->inertia_kgm2 + kv * l) / (r * kv + km * km);
}

bool steady_state_ekf_design(const struct motor_params *motor, double period_s,
                             struct steady_state_ekf_gains *gains, char error[DESIGN_ERROR_TEXT])
{
    struct riccati_problem problem;
    struct riccati_solution solution;

    if (!motor_check(motor, period_s, error)) {
        return false;
    }
    double period_max = euler_period_max(motor);
    if (!(period_s < period_max)) {
        return design_refuse_limit(error,
                                   (struct refusal){.quantity = "period",
                                                    .value = period_s,
                                                    .relation = "below",
                                                    .limit = period_max,
                                                    .unit = "s",
                                                    .reason = "or the Euler model is unstable"});
    }
    problem = standstill_model(motor, period_s);
    if (!riccati_solve(&problem, &solution)) {
        return design_refuse(error, "the steady-state EKF has no constant gain for this motor");
    }
    *gains = (struct steady_state_ekf_gains){
        .k_current_d = solution.gain[I_D][I_D],
        .k_current_q = solution.gain[I_Q][I_Q],
        .k_speed_q_rad_As = solution.gain[SPEED][I_Q],
        .k_angle_q_rad_A = angle_gain(&problem, &solution, period_s),
        .k_load_q_Nm_A = solution.gain[LOAD][I_Q],
    };
    return true;
}
