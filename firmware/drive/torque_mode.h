/*
 * Torque mode, of a drive with an encoder: the torque is commanded, and the load makes the position
 * of it.
 *
 *   Km i_q = T, but with w > 0 at most   T_L - k_w (w - w_max)
 *                    with w < 0 at least  T_L - k_w (w + w_max)
 *
 * by the current control that the current laws share, whatever the law is. The bounds are those of
 * a control of the speed at its limits, with the gain of the hold (control/standstill_hold.h): a
 * rotor that comes near a limit is held by them bit by bit and stays there, whatever its load is.
 *
 * The reference follows the rotor, as in a plan at constant speed that begins anew in each period:
 * nothing is off its reference, and a stop, a speed or a target begins from the rotor's own motion.
 * A stop ends the mode, and so does a reference that begins anew.
 */
#ifndef STEADYSTEP_TORQUE_MODE_H
#define STEADYSTEP_TORQUE_MODE_H

#include "firmware/numeric/num.h"

/* Per-unit. */
struct torque_mode {
    num_t current; /* that makes the torque */
    num_t speed;   /* largest, either way; 0: the position is controlled. All that the interrupt
                      asks */
};

struct drive;

/* Interrupt, in operation: this torque is commanded from now on, from whatever motion. Apart: rare.
 */
__attribute__((noinline)) void torque_mode_take(struct drive *drive,
                                                const struct torque_mode *asked);

/* Interrupt: the q current of a period; the reference follows the rotor. The period in which it has
   been stopped is the last. Apart: rare. */
__attribute__((noinline)) num_t torque_mode_lead(struct drive *drive);

/* Interrupt, as enabling begins, too, and background: the position is controlled. */
static inline void torque_mode_leave(struct torque_mode *torque)
{
    torque->speed = NUM(0.0);
}

/* Background: the position is controlled from the next period on, at the rotor's speed. */
void torque_mode_end(struct drive *drive);

#endif
