/*
 * The ratio of the two phases, found at the end of the hold with which a sensorless drive is
 * enabled.
 *
 * The estimator has one resistance and takes both currents as they are measured. Resistances, or
 * gains of the current channels, that differ by a share e are a voltage e R i / 2 to it whenever a
 * held rotor's current stands between the phases, and that looks like motion. At an odd multiple of
 * 45 degrees electrical a d current flows in both phases alike. So the hold leads its rotor to the
 * nearest of these, waits for a swing, takes the means of voltages and currents over whole swings,
 * and leads it back to its final angle. With r = u / i of each phase the currents are then scaled,
 *
 *   i_a *= sqrt(r_a / r_b),   i_b *= sqrt(r_b / r_a),   sqrt(r_a / r_b) = 1 + d + d^2 / 2 + O(d^3),
 *   d = (u_a i_b - u_b i_a) / (u_a i_b + u_b i_a)
 *
 * so that both show one resistance, the root of r_a r_b. Resistance and gain cannot be
 * distinguished and need not be.
 *
 * The rotor is led to its final angle by way of a place a little beyond: friction holds it back on
 * either way, and what it takes of the one the other gives back.
 *
 * Takes some ten swings, 2 pi / sqrt(N Km i_hold / J) each, and turns the rotor by up to an eighth
 * of an electrical turn, half a full step, and back.
 */
#ifndef STEADYSTEP_PHASE_BALANCE_H
#define STEADYSTEP_PHASE_BALANCE_H

#include "firmware/motor/held_angle.h"
#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"

/*
 * Largest d of a sound board and motor: phases that differ by 15 %. Shunts and amplifiers of 2 %
 * and windings of 3 % make 7 at most; a short circuit between turns, or a lead that is off, more.
 */
#define PHASE_IMBALANCE_MAX 0.075

struct phase_balance_params {
    struct held_angle_params lead;
    uint32_t look;         /* periods of the means */
    coef_t per_look;       /* 1 / look */
    coef_t speed_per_turn; /* per-unit, of an electrical turn in a period */
    num_t current_min;     /* in each phase */
};

enum phase_balance_stage {
    PHASES_LED,      /* to where both carry the same */
    PHASES_SETTLING, /* there */
    PHASES_LOOKED_AT,
    PHASES_DIVIDED,
    PHASES_LED_BACK, /* a little further than the final angle */
    PHASES_SETTLING_BEYOND,
    PHASES_LED_TO_FINAL,
    PHASES_SETTLING_FINALLY,
    PHASES_BALANCED
};

struct phase_balance {
    enum phase_balance_stage stage;
    struct held_angle held;
    uint32_t periods; /* of the stage */
    struct channels mean;
    num_t difference; /* numerator and denominator of d */
    num_t sum;
    num_t imbalance; /* d; 0 until it is found */
};

struct phase_balance_task {
    const struct per_unit *base;
    const struct motor_params *motor;
    double period_s;
    double hold_current_A;
};

struct phase_balance_params phase_balance_design(const struct phase_balance_task *task);

/* Periods that it takes at most. */
uint32_t phase_balance_periods(const struct phase_balance_params *params);

/* With the electrical angle at which the hold has the rotor. */
void phase_balance_start(struct phase_balance *balance, angle_t held);

enum phase_balance_event {
    PHASES_GO_ON,
    PHASES_COMPARED,     /* `imbalance` has been found: the currents are to be scaled */
    PHASES_AT_FINAL,     /* it has ended */
    PHASES_TOO_DIFFERENT /* by more than PHASE_IMBALANCE_MAX, or one carries no current */
};

/* Whether the coming step uses the samples. */
static inline bool phase_balance_looks(const struct phase_balance *balance)
{
    return balance->stage == PHASES_LOOKED_AT;
}

/* One period, with the samples of S(k). */
enum phase_balance_event phase_balance_step(struct phase_balance *balance,
                                            const struct phase_balance_params *params,
                                            const struct channels *winding);

/* The held angle turns, or has only just come to rest. */
static inline bool phase_balance_leads(const struct phase_balance *balance)
{
    return balance->stage != PHASES_LOOKED_AT && balance->stage != PHASES_DIVIDED &&
           balance->stage != PHASES_BALANCED;
}

/* The held angle's, mechanical. */
static inline num_t phase_balance_speed(const struct phase_balance *balance,
                                        const struct phase_balance_params *params)
{
    return num_mul_coef(held_angle_turned(&balance->held), params->speed_per_turn);
}

#endif
