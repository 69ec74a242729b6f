#include "firmware/interface/simulation_only.h"

#include <stddef.h>

const char *simulation_only_setting(const struct drive_settings *settings)
{
    if (settings->law == POSITION_LAW_SMC) {
        return "law = smc";
    }
    if (settings->feedback == DRIVE_FEEDBACK_ENCODER &&
        settings->observer == DRIVE_OBSERVER_HIGH_GAIN) {
        return "observer = high-gain";
    }
    if (settings->initial_position == DRIVE_INITIAL_POSITION_PUBLISHED_IMPULSES) {
        return "initial_position = published-impulses";
    }
    return settings->initial_angle_error_rad != 0.0 ? "initial_angle_error_rad other than 0" : NULL;
}
