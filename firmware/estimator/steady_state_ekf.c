#include "firmware/estimator/steady_state_ekf.h"

/* Per-unit; beyond all that a supply drives through a winding. */
static const num_t current_max = NUM(8.0);

struct steady_state_ekf_params steady_state_ekf_scale(const struct motor_model_params *model,
                                                      const struct per_unit *base,
                                                      const struct steady_state_ekf_gains *gains)
{
    const double i = base->current_A;
    const struct steady_state_ekf_params params = {
        .model = *model,
        .rotation = coef_from_double(base->turns_per_period * 6.283185307179586476925),
        .gain_current_d = coef_from_double(gains->k_current_d),
        .gain_current_q = coef_from_double(gains->k_current_q),
        .gain_speed = coef_from_double(gains->k_speed_q_rad_As * i / base->speed_rad_s),
        .gain_angle = coef_from_double(gains->k_angle_q_rad_A * i / base->rad_per_turn),
        .gain_load = coef_from_double(gains->k_load_q_Nm_A * i / base->torque_Nm),
    };
    return params;
}

void steady_state_ekf_reset(struct steady_state_ekf *ekf,
                            const struct steady_state_ekf_params *params, struct position position,
                            num_t resistance)
{
    const struct dq no_current = {NUM(0.0), NUM(0.0)};

    estimate_reset(&ekf->estimate, &params->model, position, resistance);
    ekf->current = no_current;
    ekf->mid_period = ekf->estimate.next.frame;
}

/* (8): x(k+1|k) = x(k|k) + T f(x(k|k), u). */
static void move_on(struct steady_state_ekf *ekf, const struct steady_state_ekf_params *params,
                    struct dq voltage)
{
    const struct motor_model_params *model = &params->model;
    struct rotor *rotor = &ekf->estimate.rotor;
    struct dq i = ekf->current;
    num_t resistance = ekf->estimate.winding.resistance;
    num_t rotation = num_mul_coef(rotor->speed, params->rotation);
    num_t u_d = voltage.d - num_mul(i.d, resistance);
    num_t u_q = voltage.q - num_mul(i.q, resistance) - rotor->speed;
    num_t torque = i.q - num_mul_coef(rotor->speed, model->friction) - rotor->load_torque;
    num_t turns = num_mul_coef(rotor->speed, model->turns_per_speed);

    ekf->current.d += num_mul_coef(u_d, model->rate) + num_mul(rotation, i.q);
    ekf->current.q += num_mul_coef(u_q, model->rate) - num_mul(rotation, i.d);
    rotor->speed += num_mul_coef(torque, model->speed_per_torque);
    rotor->position = position_add(rotor->position, angle_from_any_turns(turns));
}

/* (11): x(k|k) = x(k|k-1) + K (y - H x(k|k-1)). */
static void correct(struct steady_state_ekf *ekf, const struct steady_state_ekf_params *params,
                    struct dq measured)
{
    struct rotor *rotor = &ekf->estimate.rotor;
    struct dq innovation = {measured.d - ekf->current.d, measured.q - ekf->current.q};
    num_t turns = num_mul_coef(innovation.q, params->gain_angle);

    ekf->current.d = num_headroom(
        ekf->current.d + num_mul_coef(innovation.d, params->gain_current_d), current_max);
    ekf->current.q = num_headroom(
        ekf->current.q + num_mul_coef(innovation.q, params->gain_current_q), current_max);
    rotor->speed += num_mul_coef(innovation.q, params->gain_speed);
    rotor->position = position_add(rotor->position, angle_from_any_turns(turns));
    rotor->load_torque += num_mul_coef(innovation.q, params->gain_load);
}

struct passage steady_state_ekf_predict(struct steady_state_ekf *ekf,
                                        const struct steady_state_ekf_params *params,
                                        struct phases voltage)
{
    struct estimate *x = &ekf->estimate;
    const struct passage passage = estimate_predict_current(x, &params->model, voltage);

    ekf->mid_period = passage.mid_period;
    estimate_predict_rotor(x, &params->model, estimate_mean_current(x, passage.mid_period));
    return passage;
}

struct passage steady_state_ekf_step(struct steady_state_ekf *ekf,
                                     const struct steady_state_ekf_params *params,
                                     const struct channels *winding, struct phases in_force)
{
    struct estimate *x = &ekf->estimate;

    move_on(ekf, params, park(winding->voltage, ekf->mid_period));
    correct(ekf, params, park(winding->current, x->next.frame));
    x->current = winding->current;
    return steady_state_ekf_predict(ekf, params, in_force);
}
