/*
 * One interface for every position law: from the position error and the estimates at S(k+1), when
 * the answer begins to act, to the torque-producing current. A law is a header and a source of its
 * own and one line of the registry (position_laws.h).
 */
#ifndef STEADYSTEP_POSITION_LAW_H
#define STEADYSTEP_POSITION_LAW_H

#include <stddef.h>

#include "firmware/design/refusal.h"
#include "firmware/motor/motor_params.h"
#include "firmware/motor/per_unit.h"
#include "firmware/numeric/num.h"

/* What a law is designed from. */
struct position_law_task {
    const struct motor_params *motor;
    const struct per_unit *base;
    double period_s;
    double bandwidth_rad_s;         /* of the position loop */
    double current_bandwidth_rad_s; /* of the loop inside it */
    double speed_limit_rad_s;
    double current_limit_A;
};

/* Gains, per-unit. Every law uses those it names; what it does not name stays zero. */
struct position_law_params {
    coef_t position;
    coef_t speed;
    coef_t integral;
    coef_t reference_acceleration; /* J/Km */
    coef_t reference_friction;     /* Kv/Km */
    num_t position_error_limit;    /* electrical turns; keeps each term inside the number range */
    num_t speed_error_limit;
    num_t current_limit;
};

struct position_law_state {
    num_t integral;
};

/* One period's inputs. References of speed and acceleration are zero without feed-forward. */
struct position_law_input {
    num_t position_error; /* electrical turns, reference minus estimate */
    num_t reference_speed;
    num_t reference_acceleration;
    num_t speed;
    num_t load_torque;
};

/* Gains that all laws share, SI. */
struct position_law_gains {
    double position_A_rad;
    double speed_As_rad;
    double reference_friction_As_rad;
    double reference_acceleration_As2_rad;
};

/*
 * Scales gains to per-unit and limits the errors so that every term stays inside the number range
 * (one third of it each). Clears the rest.
 */
void position_law_scale(struct position_law_params *params, const struct position_law_task *task,
                        const struct position_law_gains *gains);

/* Limited position and speed errors times their gains, plus the reference's own torque. */
static inline num_t position_law_proportional(const struct position_law_params *params,
                                              const struct position_law_input *input)
{
    num_t position_error = num_headroom(input->position_error, params->position_error_limit);
    num_t speed_error = num_clamp(input->reference_speed - input->speed, -params->speed_error_limit,
                                  params->speed_error_limit);

    return num_mul_coef(position_error, params->position) +
           num_mul_coef(speed_error, params->speed) +
           num_mul_coef(input->reference_acceleration, params->reference_acceleration) +
           num_mul_coef(input->reference_speed, params->reference_friction);
}

#endif
