#include "firmware/drive/torque_mode.h"

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

void torque_mode_end(struct drive *drive)
{
    *(volatile num_t *)&drive->torque.speed = NUM(0.0);
}
