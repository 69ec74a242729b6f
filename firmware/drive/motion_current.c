#include "firmware/drive/motion_current.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/interface/parts_carried.h"

num_t motion_current_at(num_t all, num_t speed)
{
    const num_t left = num_clamp(NUM(0.25) - num_abs(speed), NUM(0.0), NUM(0.125));

    return num_mul(all, 8 * left);
}

void motion_current_background(struct drive *drive)
{
    const num_t all =
        LINK_CARRIED && drive->axis.seeks_stop ? NUM(0.0) : drive->params.hold.motion_current;

    standstill_hold_put_motion_current(&drive->hold,
                                       motion_current_at(all, interrupt_view_speed(drive)));
}
