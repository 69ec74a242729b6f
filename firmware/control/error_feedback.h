/*
 * The part that state feedback and PID share: limited position and speed errors times their gains,
 * plus the reference's own torque.
 *
 *   i_q = K_theta (theta* - theta) + K_w (w* - w) + (J alpha* + Kv w*)/Km
 */
#ifndef STEADYSTEP_ERROR_FEEDBACK_H
#define STEADYSTEP_ERROR_FEEDBACK_H

#include "firmware/control/position_law.h"
#include "firmware/numeric/coefficients.h"

struct error_feedback_params {
    coef_t position;
    coef_t speed;
    coef_t reference_acceleration; /* J/Km */
    coef_t reference_friction;     /* Kv/Km */
    num_t position_error_limit;    /* electrical turns; keeps each term inside the number range */
    num_t speed_error_limit;
    num_t current_limit;
};

#define ERROR_FEEDBACK_PARAMS_COEFFICIENTS(X)                                                      \
    X(position, feedback_position)                                                                 \
    X(speed, feedback_speed)                                                                       \
    X(reference_acceleration, feedback_acceleration)                                               \
    X(reference_friction, feedback_friction)
COEFFICIENTS(error_feedback_params, ERROR_FEEDBACK_PARAMS_COEFFICIENTS)

/* SI. */
struct error_feedback_gains {
    double position_A_rad;
    double speed_As_rad;
    double reference_friction_As_rad;
    double reference_acceleration_As2_rad;
};

/*
 * Per-unit; the errors are limited so that every term stays inside the number range (one third of
 * it each).
 */
struct error_feedback_params error_feedback_scale(const struct position_law_task *task,
                                                  const struct error_feedback_gains *gains);

static inline num_t error_feedback(const struct error_feedback_params *params,
                                   const struct position_law_input *input)
{
    const struct error_feedback_params *gain = KNOWN(error_feedback_params, params);
    num_t position_error = num_headroom(input->position_error, params->position_error_limit);
    num_t speed_error =
        num_headroom(input->reference_speed - input->speed, params->speed_error_limit);

    return num_mul_coef(position_error, gain->position) + num_mul_large(speed_error, gain->speed) +
           num_mul_large(input->reference_acceleration, gain->reference_acceleration) +
           num_mul_coef(input->reference_speed, gain->reference_friction);
}

#endif
