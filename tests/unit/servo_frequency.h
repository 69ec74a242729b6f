/* The one gain of a law that has no default. */
#ifndef STEADYSTEP_TESTS_SERVO_FREQUENCY_H
#define STEADYSTEP_TESTS_SERVO_FREQUENCY_H

#include <string.h>

#include "firmware/control/position_law_dispatch.h"
#include "firmware/interface/drive_interface.h"

static inline void give_servo_frequency(struct drive_settings *settings, double rad_s)
{
    const struct law_gain_list list = position_law_gains(settings->law);

    for (size_t i = 0; i < list.count; i++) {
        if (strcmp(list.gain[i].name, "servo_frequency_rad_s") == 0) {
            settings->law_gains[i] = rad_s;
        }
    }
}

#endif
