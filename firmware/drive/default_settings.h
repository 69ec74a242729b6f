/* The settings that are not given and follow from motor, feedback, law and control period. */
#ifndef STEADYSTEP_DEFAULT_SETTINGS_H
#define STEADYSTEP_DEFAULT_SETTINGS_H

#include "firmware/design/hold_check.h"
#include "firmware/interface/drive_interface.h"

/* Of the overcurrent trip: what a held rotor's current may reach. */
#define HOLD_TRIP_SHARE 0.7

/* The hold that these settings ask for. */
static inline struct hold_task hold_task_of(const struct drive_settings *settings, double period_s)
{
    return (struct hold_task){
        .motor = &settings->motor,
        .period_s = period_s,
        .hold_current_A = settings->hold_current_A,
        .bandwidth_rad_s = settings->hold_bandwidth_rad_s,
        .current_bandwidth_rad_s = settings->current_bandwidth_rad_s,
    };
}

/*
 * Puts in force what is not given (NaN) of law_bandwidth_rad_s, current_bandwidth_rad_s,
 * observer_bandwidth_rad_s, following_error_rad, hold_current_A, idle_current_A, motion_current_A,
 * hold_bandwidth_rad_s and hold_delay_s, each within what the period and the motor bear.
 */
void default_settings_apply(struct drive_settings *settings, double period_s,
                            uint32_t encoder_counts_per_turn);

/* The search for a hold current; all zero at first. */
struct default_settings_search {
    double hold_current_A;
    int refused;
};

/* The same in steps, which a watchdog outlasts: 80 ms on a Cortex-M0+. true: done. */
bool default_settings_step(struct default_settings_search *search, struct drive_settings *settings,
                           double period_s, uint32_t encoder_counts_per_turn);

static inline bool settings_ask_for_hold(const struct drive_settings *settings)
{
    return settings->hold_at_rest || settings->hold_on_enable;
}

#endif
