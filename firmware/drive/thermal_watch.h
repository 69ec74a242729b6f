/*
 * The thermal load of the motor's winding and of the bridge (thermal_model.h): first the current
 * limit falls, then the bridge opens.
 *
 *            derating                                 fault
 *   winding  heat 1.02...1.1 of the rated current's   1.15
 *   bridge   bridge_derate_C...bridge_fault_C         bridge_fault_C
 *
 * Derated in full by the winding, the limit is what leaves no phase more than the rated current:
 * that itself in motion, in the hold the root of its square less that of the hold current. The
 * bridge takes it to 1/65. Both in 64 steps. The hold current stays, as a rotor that is let go is
 * lost: Km x hold_current_A is the torque that is left. A law whose current is no limit's
 * (microstepping), or that draws more than its limit, ends in the fault.
 *
 * In the background: the currents once in every eight periods, at a place among them that is as
 * good as random, so that no speed keeps a phase's peaks out of sight; all the rest every 256
 * periods. Heat goes on, and falls, while the bridge is off, and through settings that change; a
 * start begins cold. The impulses that detect a position are too short to count.
 */
#ifndef STEADYSTEP_THERMAL_WATCH_H
#define STEADYSTEP_THERMAL_WATCH_H

#include "firmware/drive/thermal_model.h"

/* What is to be said of it. */
enum {
    THERMAL_MOTOR_DERATES = 1 << 0,
    THERMAL_BRIDGE_DERATES = 1 << 1,
    THERMAL_NO_SENSOR = 1 << 2 /* of the bridge, although the board has one */
};

struct thermal_watch {
    double limit_A; /* current_limit_A as set: what derating begins with */
    struct winding_heat winding;
    num_t heat;              /* of the hotter phase */
    uint32_t slot;           /* eight periods, of the last look */
    uint16_t derate_code;    /* of the bridge's temperature */
    uint16_t fault_code;     /* 0: it is not watched */
    uint8_t motor_derated;   /* 64ths */
    uint8_t bridge_derated;  /* 64ths */
    uint8_t motor_in_force;  /* of what the limits were made with */
    uint8_t bridge_in_force; /* the same */
    uint8_t shown;           /* THERMAL_... */
};

struct drive;

/* With the drive's design. The heat is as it is. */
__attribute__((cold)) void thermal_watch_design(struct drive *drive);

/* Another current_limit_A has been set in motion. */
void thermal_watch_set_limit(struct thermal_watch *watch, double limit_A);

/* What is left of a limit of the q current beside this one along d, in per-unit. */
num_t thermal_watch_limit(const struct thermal_watch *watch, num_t limit, num_t along);

/* Background: looks at a drive in any state. */
void thermal_watch_background(struct drive *drive);

#endif
