#include "firmware/drive/idle_current.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"

#define FALL_RAMPS       10.0     /* hold_ramp_s in which the current falls */
#define FALL_PERIODS_MAX 64u      /* at once, of a background that was busy */
#define LOAD_CHANGE      NUM(0.1) /* of twice the rated torque */

struct idle_current_params idle_current_design(const struct drive_settings *settings,
                                               const struct per_unit *base, double period_s)
{
    const double fall_A =
        settings->hold_current_A * period_s / (FALL_RAMPS * settings->hold_ramp_s);

    return (struct idle_current_params){
        .current = num_from_double(settings->idle_current_A / base->current_A),
        .fall = num_from_double(fall_A / base->current_A),
        .delay_periods = (uint32_t)(settings->idle_delay_s / period_s + 0.5),
    };
}

num_t idle_current_step(struct idle_current *idle, const struct idle_current_params *params,
                        const struct idle_look *look, num_t now, num_t full)
{
    const uint32_t passed = look->period - idle->period;

    idle->period = look->period;
    if (!look->holds || num_abs(look->load - idle->load) > LOAD_CHANGE) {
        idle->resting = 0u;
        idle->load = look->load;
        return full;
    }
    if (passed < params->delay_periods - idle->resting) {
        idle->resting += passed;
        return now;
    }
    idle->resting = params->delay_periods;
    for (uint32_t k = 0; k < passed && k < FALL_PERIODS_MAX && now > params->current; k++) {
        now -= params->fall;
    }
    return now > params->current ? now : params->current;
}

void idle_current_background(struct drive *drive)
{
    const struct idle_look look = {
        .period = interrupt_view_period(drive),
        .holds = interrupt_view_rests(drive),
        .load = interrupt_view_load(drive),
    };

    if (drive->idle_params.current < drive->params.hold.current &&
        interrupt_view_state(drive) == DRIVE_OPERATION_ENABLED) {
        standstill_hold_put_current(
            &drive->hold, idle_current_step(&drive->idle, &drive->idle_params, &look,
                                            drive->hold.current, drive->params.hold.current));
    }
}
