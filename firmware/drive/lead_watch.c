#include "firmware/drive/lead_watch.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/state_machine.h"

#define UNSEEN_TURNS 2u
#define BLOCKS_MOST  8u /* for which the last one stands, of a background that was busy */

static void begin_turn(struct lead_watch *watch)
{
    watch->led = NUM(0.0);
    watch->seen = NUM(0.0);
}

void lead_watch_reset(struct lead_watch *watch)
{
    begin_turn(watch);
    watch->unseen = 0u;
}

bool lead_watch_is_left(struct lead_watch *watch, num_t led, num_t seen)
{
    const bool back = led < NUM(0.0);

    if (back != (watch->led < NUM(0.0))) {
        begin_turn(watch);
    }
    watch->led += led;
    watch->seen += seen;
    if (num_abs(watch->led) >= NUM(1.0)) {
        const num_t along = back ? -watch->seen : watch->seen;

        watch->unseen = along < NUM(0.25) ? (uint8_t)(watch->unseen + 1u) : (uint8_t)0u;
        begin_turn(watch);
    }
    return watch->unseen >= UNSEEN_TURNS;
}

struct look {
    uint32_t block;
    num_t led, shown; /* speed of the frame; estimate and offset along its q axis */
    num_t load, away; /* from the load that the hold returns to */
    bool follows;     /* a load step */
};

/* A block's mean of c sum(nu_q), from the load's equation. */
static num_real denied(const struct drive *drive, const struct look *look, num_real periods)
{
    const struct invariant_ekf_params *params = &drive->params.estimator.invariant_ekf;
    const struct invariant_ekf_gain_set *gain =
        look->follows ? &params->following : &params->holding;
    const num_real change = (num_real)num_to_double(look->load - drive->lead_watch.load);
    const num_real returned =
        (num_real)coef_to_double(gain->load_return) * (num_real)num_to_double(look->away);
    const num_real innovations =
        (change / periods + returned) / (num_real)coef_to_double(gain->load_q);

    return (num_real)coef_to_double(drive->synchronism.params.voltage_per_sum_holding) *
           (num_real)drive->synchronism.params.block_periods * innovations;
}

static bool is_left(struct drive *drive, const struct look *look)
{
    struct lead_watch *watch = &drive->lead_watch;
    const num_real periods = (num_real)(look->block - watch->block);
    const num_real turns = periods * (num_real)drive->base.turns_per_period;
    const num_real led = turns * (num_real)num_to_double(look->led);
    const num_real seen =
        turns * ((num_real)num_to_double(look->shown) - denied(drive, look, periods));

    return look->block - watch->block <= BLOCKS_MOST * drive->synchronism.params.block_periods &&
           lead_watch_is_left(watch, num_from_double((double)led),
                              num_headroom(num_from_double((double)seen), NUM(8.0)));
}

static bool is_led(const struct drive *drive)
{
    return drive->synchronism.monitored && drive->synchronism.policy == DRIVE_SYNCHRONISM_FAULT &&
           interrupt_view_state(drive) == DRIVE_OPERATION_ENABLED && interrupt_view_holds(drive);
}

void lead_watch_background(struct drive *drive)
{
    const struct invariant_ekf *ekf = &drive->estimator.invariant_ekf;
    struct lead_watch *watch = &drive->lead_watch;
    const uint32_t period = interrupt_view_period(drive);

    if (!is_led(drive)) {
        lead_watch_reset(watch);
        return;
    }
    atomic_signal_fence(memory_order_seq_cst);
    const struct look look = {
        .block = drive->synchronism.block_began,
        .led = drive->hold.leads ? drive->hold.speed : NUM(0.0),
        .shown = ekf->estimate.rotor.speed + park(ekf->bias, drive->hold.frame).q,
        .load = ekf->estimate.rotor.load_torque,
        .away = ekf->estimate.rotor.load_torque - ekf->settled_load,
        .follows = ekf->following_periods > drive->params.estimator.invariant_ekf.rest_periods,
    };

    atomic_signal_fence(memory_order_seq_cst);
    if (period != interrupt_view_period(drive) || look.block == watch->block) {
        return;
    }
    if (look.led != NUM(0.0) && is_left(drive, &look)) {
        state_machine_ask_for_fault(drive, DRIVE_FAULT_STALLED);
    }
    watch->block = look.block;
    watch->load = look.load;
}
