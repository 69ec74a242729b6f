#include "firmware/drive/standing_rotor.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"

#define FAR_LIMIT ((int64_t)1 << 30)
#define PLACE     (1 << 27)
#define DELAYS    4u /* of the hold */

#define AT_ONCE_S 3.2e-3 /* of a background that was busy */

static void begin_anew(struct standing_rotor *standing, uint32_t period)
{
    standing->period = period;
}

int32_t standing_rotor_look(struct standing_rotor *standing, int64_t place, uint32_t period,
                            uint32_t longer)
{
    const int64_t away = place - standing->place;

    if (away > PLACE || away < -PLACE || place >= FAR_LIMIT || place <= -FAR_LIMIT) {
        standing->place = (int32_t)place;
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
    const uint32_t at_once = drive_periods_in(drive, (num_real)AT_ONCE_S);
    const uint32_t periods = passed < at_once ? passed : at_once;

    standstill_hold_lead_back(&drive->hold, 2 * (int32_t)periods * angle_from_turns(creep));
}

/* No other drive leads a held rotor. */
static bool hold_waits(const struct drive *drive)
{
    return drive->params.reference.creep_speed > NUM(0.0) &&
           interrupt_view_state(drive) == DRIVE_OPERATION_ENABLED &&
           standstill_hold_waits(&drive->params.hold, interrupt_view_slow_periods(drive));
}

void standing_rotor_background(struct drive *drive)
{
    const uint32_t period = interrupt_view_period(drive);
    const bool holds = interrupt_view_holds(drive);

    if (holds && drive->hold.offset != 0 && drive->hold.place == 0) { /* not as it begins */
        lead_back(drive, period);
    }
    atomic_signal_fence(memory_order_seq_cst);
    const int64_t place =
        position_distance(drive->reference.next.position, drive->estimator.estimate.next.position);

    atomic_signal_fence(memory_order_seq_cst);
    if (holds || !hold_waits(drive)) {
        begin_anew(&drive->standing, period);
        standstill_hold_put_place(&drive->hold, 0);
    } else if (period == interrupt_view_period(drive)) {
        standstill_hold_put_place(&drive->hold,
                                  standing_rotor_look(&drive->standing, place, period,
                                                      DELAYS * drive->params.hold.delay_periods));
    }
}
