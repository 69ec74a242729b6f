/*
 * The motor over one control period, exact for constant voltage, speed and resistance.
 *
 * In phase coordinates, with phi the electrical angle of the middle of the period, h = N T w and
 * a = exp(-T R / L):
 *
 *   i+ = a i + (1 - a)/R (u - j Km w (1 - h^2/24) e^(j phi))
 *   w+ = w + c T/J (Km i_q - Kv w - T_L),   i_q of the mean of i and i+ in the frame phi
 *   theta+ = theta + T (w + w+)/2
 *
 * with c = (1 - exp(-y))/y, y = T Kv/J. The first line is written as i+ = i + b (u - R i - e) with
 * b = (1 - a)/R, so that a calibrated resistance enters in one place; b, of which a change of R by
 * half moves 1 %, is linear about the nominal resistance (off by 7e-5 then).
 */
#ifndef STEADYSTEP_MOTOR_MODEL_H
#define STEADYSTEP_MOTOR_MODEL_H

#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"
#include "firmware/numeric/coefficients.h"

struct motor_model_params {
    coef_t rate;             /* T/L: current per period and unit of voltage; T R/L per resistance */
    coef_t emf_droop;        /* (N T)^2/24: loss of mean EMF by rotation within the period */
    coef_t speed_per_torque; /* c T/J */
    coef_t friction;         /* Kv: torque per speed */
    coef_t turns_per_speed;  /* N T/(2 pi): electrical turns per period and unit of speed */
    coef_t half_turns_per_speed;      /* the same in half a period */
    coef_t admittance_per_resistance; /* -db/dR at the nominal resistance */
    num_t nominal_admittance;
    num_t nominal_resistance;
    num_t resistance_min; /* range of the calibrated resistance: a quarter of the nominal one to */
    num_t resistance_max; /* three times that, or what a bridge adds that nobody has stated */
};

#define MOTOR_MODEL_PARAMS_COEFFICIENTS(X)                                                         \
    X(rate, model_rate)                                                                            \
    X(emf_droop, model_emf_droop)                                                                  \
    X(speed_per_torque, model_speed_per_torque)                                                    \
    X(friction, model_friction)                                                                    \
    X(turns_per_speed, model_turns_per_speed)                                                      \
    X(half_turns_per_speed, model_half_turns_per_speed)                                            \
    X(admittance_per_resistance, model_admittance_per_resistance)
COEFFICIENTS(motor_model_params, MOTOR_MODEL_PARAMS_COEFFICIENTS)

/* The winding with its present resistance. */
struct winding {
    num_t resistance;
    num_t admittance; /* b = (1 - exp(-T R/L)) / R */
};

/* Rotor motion at one instant. */
struct rotor {
    struct position position; /* electrical */
    num_t speed;
    num_t load_torque;
};

__attribute__((cold)) struct motor_model_params motor_model_design(const struct motor_params *motor,
                                                                   const struct per_unit *base,
                                                                   double period_s,
                                                                   double bridge_resistance_ohm);

/* Sets the resistance, clamped to its range, and what follows from it. */
void winding_set_resistance(struct winding *winding, const struct motor_model_params *params,
                            num_t resistance);

/* Electrical turns of a rotor at this speed in half a period, below an eighth. */
static inline num_t half_period_turns(const struct motor_model_params *params, num_t speed)
{
    return num_mul_coef(speed, KNOWN(motor_model_params, params)->half_turns_per_speed);
}

/* Phase currents one period on under a mean voltage over it. */
static inline struct phases predict_current(const struct motor_model_params *params,
                                            const struct winding *winding, struct phases current,
                                            num_t speed, struct sincos mid_period,
                                            struct phases voltage)
{
    const num_t droop =
        num_mul_coef(num_mul(speed, speed), KNOWN(motor_model_params, params)->emf_droop);
    const num_t emf = speed - num_mul(droop, speed);
    const num_t across_a =
        voltage.a - num_mul(current.a, winding->resistance) + num_mul_unit(emf, mid_period.sin);
    const num_t across_b =
        voltage.b - num_mul(current.b, winding->resistance) - num_mul_unit(emf, mid_period.cos);
    const struct phases next = {current.a + num_mul(across_a, winding->admittance),
                                current.b + num_mul(across_b, winding->admittance)};
    return next;
}

/* The same under a voltage that differs by `more` over the period. To nearest: little else corrects
   what a floor would leave of each small difference. */
static inline struct phases forced_current(const struct winding *winding, struct phases predicted,
                                           struct phases more)
{
    const struct phases next = {predicted.a + num_mul_nearest(more.a, winding->admittance),
                                predicted.b + num_mul_nearest(more.b, winding->admittance)};
    return next;
}

/* Moves the rotor one period on under a mean torque-producing current; the load torque stays. */
static inline void predict_rotor(const struct motor_model_params *params, struct rotor *rotor,
                                 num_t i_q)
{
    const struct motor_model_params *model = KNOWN(motor_model_params, params);
    num_t torque = i_q - num_mul_coef(rotor->speed, model->friction) - rotor->load_torque;
    num_t speed = rotor->speed + num_mul_coef(torque, model->speed_per_torque);
    num_t turns = num_mul_coef(rotor->speed + speed, model->half_turns_per_speed);

    rotor->position = position_add(rotor->position, angle_from_turns(turns));
    rotor->speed = speed;
}

#endif
