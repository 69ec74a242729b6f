#include "firmware/drive/torque_mode.h"

#include <stdatomic.h>

#include "firmware/drive/block_reset.h"
#include "firmware/drive/drive.h"

void torque_mode_take(struct drive *drive, const struct torque_mode *asked)
{
    if (drive->torque.speed == NUM(0.0)) {
        standstill_hold_leave(&drive->hold, 0u, true);
        if (position_law_gives_voltage(drive->params.position_law)) {
            drive_preset_current_control(drive);
        }
        position_law_reset(&drive->law); /* nothing of the past when it comes back */
        reference_follow(&drive->reference);
    }
    drive->torque = *asked;
}

/* Of what is demanded and what keeps the speed that which is nearer to rest. */
static num_t current_within_speed(const struct drive *drive, num_t speed, num_t load_torque)
{
    const struct standstill_hold_params *hold = &drive->params.hold;
    const bool back = speed < NUM(0.0);
    const num_t excess = speed - (back ? -drive->torque.speed : drive->torque.speed);
    const num_t keeping = load_torque - num_mul_large(excess, hold->damping);
    const num_t current = drive->torque.current;

    return num_limit((keeping < current) != back ? keeping : current, hold->current_limit);
}

num_t torque_mode_lead(struct drive *drive)
{
    const struct estimate *estimate = &drive->estimator.estimate;
    const struct outlook *rotor = &estimate->next;
    const num_t half_turns = half_period_turns(&drive->params.model, rotor->speed);
    const num_t current = current_within_speed(drive, rotor->speed,
                                               estimate->rotor.load_torque + drive->detent.torque);

    if (reference_follows(&drive->reference)) {
        reference_place_in_motion(&drive->reference, rotor->position, rotor->speed,
                                  (int32_t)angle_from_turns(half_turns));
    } else {
        torque_mode_leave(&drive->torque);
    }
    return current;
}

void torque_mode_end(struct drive *drive)
{
    torque_mode_leave(&drive->torque);
    atomic_signal_fence(memory_order_seq_cst); /* before the reference is looked at */
}
