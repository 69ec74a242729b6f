/*
 * What the sliding-mode laws of Seshagiri and Khalil share: sliding surfaces, boundary layers and
 * conditional integrators.
 *
 *   s1* = e1,  e1 = i_d - I_dd
 *   s2* = k1 e2 + k2 de2 + dde2,  e2 = theta - theta*
 *   dde2 = k3 i_q - k4 w - d0 - alpha*      (per-unit: i_q - Kv w - T_L - alpha*)
 *
 *   d sigma/dt = -k0 sigma + mu sat(s/mu),  s = s* + k0 sigma                      (3), (4)
 *
 * Read as s2* = i_q - demand, the demand is a current, limited as that of every law. (The paper has
 * no limit; where i_q stays below it and the layer is narrow, there is no difference.)
 *
 * A surface is counted in levels, s/mu, of which the boundary layer is -1...1. The integrator keeps
 * k0 sigma/mu, which cannot leave -1...1: it needs no anti-windup.
 */
#ifndef STEADYSTEP_SLIDING_MODE_H
#define STEADYSTEP_SLIDING_MODE_H

#include "firmware/control/position_law.h"
#include "firmware/design/sliding_mode_design.h"

/* Gains that can be given by name; the paper's units: A, rad/s^2, V, and powers of 1/s. A law with
   boundary layers has the first four in front of its own, in this order. */
enum { SLIDING_MODE_K1, SLIDING_MODE_K2, SLIDING_MODE_MU_D, SLIDING_MODE_MU_Q, SLIDING_MODE_GAINS };

/* clang-format off */
#define SLIDING_MODE_GAIN_K1   {"k1", 0.0, 1e9}
#define SLIDING_MODE_GAIN_K2   {"k2", 0.0, 1e5}
#define SLIDING_MODE_GAIN_MU_D {"mu_d", 1e-4, 1e3}
#define SLIDING_MODE_GAIN_MU_Q {"mu_q", 1e-2, 1e7}
#define SLIDING_MODE_GAIN_LIST                                                                     \
    SLIDING_MODE_GAIN_K1, SLIDING_MODE_GAIN_K2, SLIDING_MODE_GAIN_MU_D, SLIDING_MODE_GAIN_MU_Q
#define SLIDING_MODE_GAIN_K0_D {"k0_d", 0.0, 1e5}
#define SLIDING_MODE_GAIN_K0_Q {"k0_q", 0.0, 1e5}
#define SLIDING_MODE_GAIN_M    {"M_V", 1e-2, 1e3}
/* clang-format on */

/* e2 and its derivatives, per-unit (position: electrical turns). */
struct tracking_error {
    num_t position;
    num_t speed;
    num_t acceleration;
    num_t torque; /* i_q at which the acceleration is the reference's */
};

struct sliding_surface_params {
    coef_t position;      /* k1 */
    coef_t speed;         /* k2 */
    coef_t friction;      /* Kv */
    num_t position_limit; /* keeps each term inside the number range */
    num_t speed_limit;
    num_t current_limit;
};

/* Levels beyond the layer that are distinguished, so that integrators can be added. */
#define SURFACE_LEVELS_MAX 8.0

struct boundary_layer_params {
    coef_t levels; /* 1/mu */
    num_t limit;   /* SURFACE_LEVELS_MAX mu */
};

/* Surfaces and layers of both axes. */
struct sliding_mode_params {
    struct sliding_surface_params surface;
    struct boundary_layer_params layer_d;
    struct boundary_layer_params layer_q;
};

struct conditional_integrator_params {
    coef_t rate; /* k0 T */
};

struct conditional_integrator {
    num_t share; /* k0 sigma/mu, times CONDITIONAL_INTEGRATOR_SCALE */
};

/* Four more bits in fixed point: k0 T is as small as 1e-4. */
#define CONDITIONAL_INTEGRATOR_SCALE 16.0

/* What the gains follow from where none are given. */
struct sliding_mode_task sliding_mode_task_of(const struct position_law_task *task);

/* SI, derivatives of e2 in rad, rad/s, rad/s^2. */
struct sliding_surface_params sliding_surface_design(const struct position_law_task *task,
                                                     double k1_1_s2, double k2_1_s);

/*
 * With boundary layers. `gains` receives what is in force: given, or else what follows from the
 * bandwidths. false: the sampled loop cannot bear a bandwidth that a gain follows from, the limit
 * in error.
 */
__attribute__((cold)) bool sliding_mode_design(struct sliding_mode_params *params,
                                               struct sliding_mode_gains *gains,
                                               const struct position_law_task *task,
                                               char error[DESIGN_ERROR_TEXT]);

struct conditional_integrator_params conditional_integrator_design(double k0_1_s, double period_s);

static inline struct tracking_error tracking_error_of(const struct sliding_surface_params *params,
                                                      const struct voltage_law_input *input)
{
    const struct position_law_input *motion = &input->motion;
    const num_t torque = num_mul_coef(motion->speed, params->friction) + motion->load_torque +
                         motion->reference_acceleration;

    return (struct tracking_error){
        .position = -motion->position_error,
        .speed = motion->speed - motion->reference_speed,
        .acceleration = input->current.q - torque,
        .torque = torque,
    };
}

/* s2* */
static inline num_t sliding_surface(const struct sliding_surface_params *params,
                                    const struct tracking_error *e)
{
    const num_t demand =
        e->torque -
        num_mul_coef(num_headroom(e->position, params->position_limit), params->position) -
        num_mul_coef(num_headroom(e->speed, params->speed_limit), params->speed);

    return e->acceleration + e->torque - num_limit(demand, params->current_limit);
}

/* s/mu, within +-SURFACE_LEVELS_MAX. */
static inline num_t boundary_layer_levels(const struct boundary_layer_params *params, num_t s)
{
    return num_mul_coef(num_limit(s, params->limit), params->levels);
}

/* Both surfaces in levels. */
static inline struct dq sliding_mode_levels(const struct sliding_mode_params *params,
                                            const struct voltage_law_input *input,
                                            const struct tracking_error *e)
{
    return (struct dq){
        boundary_layer_levels(&params->layer_d, input->current.d - input->current_d_reference),
        boundary_layer_levels(&params->layer_q, sliding_surface(&params->surface, e)),
    };
}

/* sat(s/mu) of the surface with its integral; the integral moves on by a period. */
static inline num_t conditional_integrator_step(struct conditional_integrator *integrator,
                                                const struct conditional_integrator_params *params,
                                                num_t levels)
{
    const num_t share = num_mul_unit(integrator->share, UNIT(1.0 / CONDITIONAL_INTEGRATOR_SCALE));
    const num_t level = num_limit(levels + share, NUM(1.0));

    integrator->share += num_mul_coef(level - share, params->rate);
    return level;
}

#endif
