#include "firmware/control/standstill_hold.h"

/* 18 degrees electrical: far inside the quarter turn from which the d axis draws the rotor in. */
static const double error_limit_turns = 0.05;

/* Within the ramp of the current the rotor may travel a sixteenth of an electrical turn. */
static const double ramp_travel_turns = 0.0625;

struct standstill_hold_params standstill_hold_design(const struct per_unit *base,
                                                     const struct standstill_hold_task *task)
{
    const double ramp_periods = task->ramp_s / task->period_s;
    const double current = task->current_A / base->current_A;
    struct standstill_hold_params params;

    params.current = num_from_double(current);
    params.ramp_in = num_from_double(current / ramp_periods);
    params.ramp_out = num_from_double(current * task->period_s / task->ramp_out_s);
    params.motion_current = num_from_double(task->motion_current_A / base->current_A);
    params.current_limit = num_from_double(task->current_limit_A / base->current_A);
    params.damping =
        coef_large_from_double(task->damping_As_rad * base->speed_rad_s / base->current_A);
    params.enters_at_rest = task->enters_at_rest;
    params.delay_periods =
        task->enters_at_rest ? (uint32_t)(task->delay_s / task->period_s + 0.5) : UINT32_MAX;
    if (params.delay_periods == 0u) { /* what is not slow never waits for a hold */
        params.delay_periods = 1u;
    }
    params.error_limit = num_from_double(error_limit_turns);
    params.speed_limit = num_from_double(ramp_travel_turns / ramp_periods / base->turns_per_period);
    standstill_hold_params_fit_coefficients(&params);
    return params;
}

void standstill_hold_reset(struct standstill_hold *hold,
                           const struct standstill_hold_params *params)
{
    hold->active = false;
    hold->current = params->current;
    hold->motion_current = params->motion_current;
    hold->i_d = NUM(0.0);
    hold->place = 0;
}

void standstill_hold_follow(struct standstill_hold *hold, angle_t reference, num_t speed,
                            bool goes_on)
{
    hold->frame = sincos_of(reference);
    hold->speed = speed;
    hold->leads = goes_on;
}

void standstill_hold_enter(struct standstill_hold *hold, angle_t reference)
{
    hold->active = true;
    hold->offset = 0;
    standstill_hold_follow(hold, reference, NUM(0.0), false);
}

void standstill_hold_align(struct standstill_hold *hold, angle_t angle, num_t speed, num_t current)
{
    standstill_hold_enter(hold, angle);
    hold->speed = speed;
    hold->current = current;
}

void standstill_hold_end_aligning(struct standstill_hold *hold,
                                  const struct standstill_hold_params *params)
{
    hold->current = params->current;
    hold->active = params->enters_at_rest;
}

void standstill_hold_preset(struct standstill_hold *hold, num_t i_d)
{
    hold->i_d = i_d;
}

void standstill_hold_lead_back(struct standstill_hold *hold, int32_t angle)
{
    hold->offset -= hold->offset > angle ? angle : hold->offset < -angle ? -angle : hold->offset;
}

void standstill_hold_leave(struct standstill_hold *hold, uint32_t slow_periods, bool moving)
{
    if (slow_periods == 0u) {
        hold->active = false;
    } else if (moving) {
        hold->leads = true;
    }
}

void standstill_hold_consider(struct standstill_hold *hold,
                              const struct standstill_hold_params *params, angle_t reference,
                              num_t position_error, num_t speed)
{
    const int32_t place = hold->place;

    if (num_abs(position_error + turns_from_angle(place)) < params->error_limit &&
        num_abs(speed) < params->speed_limit) {
        hold->active = true;
        hold->offset = place;
        standstill_hold_follow(hold, reference + (angle_t)place, NUM(0.0), place != 0);
    }
}

num_t standstill_hold_torque_current(const struct standstill_hold_params *params, num_t speed,
                                     num_t load_torque)
{
    const struct standstill_hold_params *gain = KNOWN(standstill_hold_params, params);
    num_t current = load_torque - num_mul_large(speed, gain->damping);

    return num_limit(current, params->current_limit);
}
