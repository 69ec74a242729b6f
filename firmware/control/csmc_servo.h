/*
 * Continuous sliding-mode control with conditional servocompensators, Seshagiri and Khalil
 * (9)-(11): as csmc.h, but in place of an integrator an internal model of a sinusoidal reference of
 * known frequency w0 and of what it makes of the voltages, constant, w0 and, on the d axis, 2 w0.
 * The error to such a reference vanishes whatever the motor's parameters and a constant load.
 *
 * Design and coordinates: design/servocompensator_design.h.
 */
#ifndef STEADYSTEP_CSMC_SERVO_H
#define STEADYSTEP_CSMC_SERVO_H

#include "firmware/control/sliding_mode.h"
#include "firmware/design/servocompensator_design.h"

struct servo_mode_params {
    coef_t sine;           /* of the rotation in a period */
    coef_t sine_remainder; /* 16 bits of it put the frequency off by 1e-5 */
    coef_t one_minus_cosine;
    coef_t input_re;
    coef_t input_im;
};

struct servo_mode {
    num_t re;
    num_t im;
};

struct csmc_servo_law_params {
    struct sliding_mode_params mode;
    coef_t voltage; /* M */
    coef_t constant_d;
    coef_t constant_q;
    struct servo_mode_params first_d; /* w0 */
    struct servo_mode_params second_d;
    struct servo_mode_params first_q;
};

static inline num_t *csmc_servo_law_current_limit(struct csmc_servo_law_params *params)
{
    return &params->mode.surface.current_limit;
}

/* Shares of a level, times SERVO_STATE_SCALE. */
struct csmc_servo_law_state {
    num_t constant_d;
    num_t constant_q;
    struct servo_mode first_d;
    struct servo_mode second_d;
    struct servo_mode first_q;
};

/* Two more bits in fixed point; K sigma stays within a few levels. */
#define SERVO_STATE_SCALE 4.0

extern const struct law_gain_list csmc_servo_law_gains;

/* servo_frequency_rad_s must be given. false: a frequency or bandwidth is beyond its limit, in
   error. */
__attribute__((cold)) bool csmc_servo_law_design(struct csmc_servo_law_params *params,
                                                 const struct position_law_task *task,
                                                 char error[DESIGN_ERROR_TEXT]);

struct voltage_demand csmc_servo_law_step(struct csmc_servo_law_state *state,
                                          const struct csmc_servo_law_params *params,
                                          const struct voltage_law_input *input);

#endif
