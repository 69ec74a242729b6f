/*
 * What dead time and diodes take from a commanded phase voltage, for boards that cannot measure it.
 *
 * In a leg's dead time, t_d behind each of its two edges, the current decides: one that leaves the
 * leg holds it a diode's drop below ground, one that enters it as much above the bus. So over a
 * period T, with s = sign(i) at each of the four edges of its two legs, a phase loses
 *
 *   t_d/T (V/2 + V_d) (s_1 + s_2 + s_3 + s_4)
 *
 * Three things decide at small currents, which is where a drive at low speed lives:
 * - the current at an edge is not that of a sample: the edges lie at (1 -+ m)/4 and (3 -+ m)/4 of
 *   the period, where it is the straight line between the samples less or more half the ripple,
 *   V T/L |m| (1 - |m|)/4;
 * - a current that ends within the dead time leaves the phase floating; from zero to i_z = V t_d/L
 *   the sign therefore turns gradually,
 * - on one side only, because with m > 0 it is a negative current that meets a voltage which ends
 *   it, and a positive one is met by nothing but a diode: s = sat((2 i + i_z) / i_z); mirrored for
 *   m < 0, and between them in proportion where the pulse is shorter than the dead time.
 */
#ifndef STEADYSTEP_BRIDGE_LOSS_H
#define STEADYSTEP_BRIDGE_LOSS_H

#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"

/* A transistor's body diode at a tenth of its rated current; 0.2 V more or less is 0.4 V t_d/T. */
#define BRIDGE_DIODE_DROP_V 0.9

struct bridge_loss_params {
    coef_t loss_per_bus;      /* t_d/T / 2: voltage per unit of bus and edge */
    num_t diode_loss;         /* t_d/T V_d: voltage per edge */
    coef_t ripple;            /* T/L / 4: current per unit of voltage */
    num_t half_zone;          /* i_z / 2 at the nominal supply */
    coef_t sign_per_current;  /* 2 / i_z */
    num_t short_pulse;        /* mean voltage of a pulse as long as the dead time */
    coef_t shift_per_voltage; /* i_z / 2 for such a pulse: current per unit of voltage */
};

/* `dead_time_s` 0: nothing is lost. */
__attribute__((cold)) struct bridge_loss_params bridge_loss_design(const struct motor_params *motor,
                                                                   const struct per_unit *base,
                                                                   double period_s,
                                                                   double dead_time_s);

/*
 * The voltage that acted on the phases over S(k-1)...S(k): what was commanded less the loss.
 * `before` and `now`: currents sampled at the two ends. `bus_reciprocal`: 1 / bus. Right to 50 mV
 * rms at 24 V and 1 us, against 0.4 V that are lost (tests/unit/test_bridge_loss.c).
 */
struct phases bridge_loss_voltage(const struct bridge_loss_params *params, struct phases commanded,
                                  struct phases before, struct phases now, num_t bus,
                                  num_t bus_reciprocal);

#endif
