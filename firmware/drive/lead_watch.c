#include "firmware/drive/lead_watch.h"

#include "firmware/drive/drive.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/drive/state_machine.h"
#include "firmware/drive/synchronism.h"

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

bool lead_watch_rotor_is_left(const struct lead_watch *watch)
{
    return watch->unseen >= UNSEEN_TURNS;
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
    return lead_watch_rotor_is_left(watch);
}

static num_t turns_in_block(const struct drive *drive, num_t speed)
{
    const num_t half_turns = half_period_turns(&drive->params.model, speed);

    return (half_turns + half_turns) * (num_t)drive->synchronism.params.block_periods;
}

/* c nu_q, from the load's equation; `change` and `away` of the load. Per-unit, a voltage is a
 * speed. */
static num_t denied(const struct drive *drive, num_t change, num_t away)
{
    const struct invariant_ekf_gain_set *gain = &drive->params.estimator.invariant_ekf.holding;
    const double per_load = coef_to_double(drive->synchronism.params.voltage_per_sum_holding) /
                            coef_to_double(gain->load_q);
    const num_t returned =
        num_mul_small(away, gain->load_return) * (num_t)drive->synchronism.params.block_periods;

    return num_mul_coef(num_headroom(change + returned, NUM(4.0)), coef_from_double(per_load));
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
    const uint32_t block = drive->synchronism.block_began;
    const num_t led = drive->hold.leads ? drive->hold.speed : NUM(0.0);
    const num_t shown = ekf->estimate.rotor.speed + park(ekf->bias, drive->hold.frame).q;
    const num_t load = ekf->estimate.rotor.load_torque;
    const num_t away = load - ekf->settled_load;

    atomic_signal_fence(memory_order_seq_cst);
    const uint32_t blocks = (block - watch->block) / drive->synchronism.params.block_periods;

    if (period != interrupt_view_period(drive) || blocks == 0u) {
        return;
    }
    if (led != NUM(0.0) && blocks <= BLOCKS_MOST) {
        const num_t change = (load - watch->load) / (num_t)blocks;
        const num_t seen = turns_in_block(drive, shown - denied(drive, change, away));

        if (lead_watch_is_left(watch, turns_in_block(drive, led) * (num_t)blocks,
                               seen * (num_t)blocks) &&
            synchronism_loss_is_fault(drive)) {
            state_machine_ask_for_fault(drive, DRIVE_FAULT_STALLED);
        }
    }
    watch->block = block;
    watch->load = load;
}
