/*
 * What the control interrupt takes of its period: from S(k) to its end, in counts of
 * hal.cycle_count.
 *
 * The interrupt adds up and keeps the most; the sum wraps, in 25 s at the soonest. The background
 * gathers it before.
 */
#ifndef STEADYSTEP_CONTROL_CYCLES_H
#define STEADYSTEP_CONTROL_CYCLES_H

#include <stdint.h>

/* Written by the control interrupt; the background may read all and set `most` to 0. */
struct control_cycles {
    uint32_t periods, sum, most;
};

/* The background's: since start-up or the last restart. */
struct control_cycle_statistics {
    uint32_t periods, most;
    uint64_t sum;
    struct control_cycles seen;
};

/* The control interrupt, or what follows it: what one has taken. */
static inline void control_cycles_count(struct control_cycles *counted, uint32_t cycles)
{
    struct control_cycles now = *counted;

    now.periods++;
    now.sum += cycles;
    now.most = cycles > now.most ? cycles : now.most;
    *counted = now;
}

/* Background, at least once in 25 s. */
void control_cycles_gather(struct control_cycle_statistics *statistics,
                           const volatile struct control_cycles *counted);
void control_cycles_restart(struct control_cycle_statistics *statistics,
                            volatile struct control_cycles *counted);

#endif
