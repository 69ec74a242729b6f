#include "firmware/drive/standing_rotor.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"

#define FAR_LIMIT NUM(0.25)
#define PLACE     (1 << 27)
#define DELAYS    4u /* of the hold */

#define PERIODS_MAX 32u /* at once, of a background that was busy */

static void begin_anew(struct standing_rotor *standing, uint32_t period)
{
    standing->period = period;
}

int32_t standing_rotor_look(struct standing_rotor *standing, num_t error, uint32_t period,
                            uint32_t longer)
{
    const int32_t place = angle_from_any_turns(-error);
    const int32_t away = (int32_t)((uint32_t)place - (uint32_t)standing->place);

    if (away > PLACE || away < -PLACE || num_abs(error) >= FAR_LIMIT) {
        standing->place = place;
        begin_anew(standing, period);
    }
    return period - standing->period >= longer ? standing->place : 0;
}

/* At the speed at which it creeps. */
static void lead_back(struct drive *drive, uint32_t period)
{
    const num_t creep =
        half_period_turns(&drive->params.model, drive->params.reference.creep_speed);
    const uint32_t passed = period - drive->standing.period;
    const uint32_t periods = passed < PERIODS_MAX ? passed : PERIODS_MAX;

    standstill_hold_lead_back(&drive->hold, 2 * (int32_t)periods * angle_from_turns(creep));
}

void standing_rotor_background(struct drive *drive)
{
    const struct standstill_hold_params *params = &drive->params.hold;
    const uint32_t period = interrupt_view_period(drive);

    if (interrupt_view_holds(drive)) {
        if (drive->hold.offset != 0) {
            lead_back(drive, period);
        }
        begin_anew(&drive->standing, period);
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    const bool waits = params->enters_at_rest && drive->params.reference.creep_speed > NUM(0.0) &&
                       interrupt_view_state(drive) == DRIVE_OPERATION_ENABLED &&
                       standstill_hold_waits(params, interrupt_view_slow_periods(drive));
    const num_t error = position_difference(drive->reference.next.position,
                                            drive->estimator.estimate.next.position);

    atomic_signal_fence(memory_order_seq_cst);
    if (!waits) {
        begin_anew(&drive->standing, period);
        standstill_hold_put_place(&drive->hold, 0);
    } else if (period == interrupt_view_period(drive)) {
        standstill_hold_put_place(
            &drive->hold,
            standing_rotor_look(&drive->standing, error, period, DELAYS * params->delay_periods));
    }
}
