#include "firmware/application/control_cycles.h"

/* Of one period: the interrupt may come in between. */
static struct control_cycles coherent(const volatile struct control_cycles *counted)
{
    struct control_cycles copy;

    do {
        copy.periods = counted->periods;
        copy.sum = counted->sum;
        copy.most = counted->most;
    } while (copy.periods != counted->periods);
    return copy;
}

void control_cycles_gather(struct control_cycle_statistics *statistics,
                           const volatile struct control_cycles *counted)
{
    const struct control_cycles now = coherent(counted);

    statistics->periods += now.periods - statistics->seen.periods;
    statistics->sum += now.sum - statistics->seen.sum;
    statistics->most = now.most;
    statistics->seen = now;
}

void control_cycles_restart(struct control_cycle_statistics *statistics,
                            volatile struct control_cycles *counted)
{
    counted->most = 0;
    *statistics = (struct control_cycle_statistics){.seen = coherent(counted)};
}
