/* What the control interrupt takes of its period, by stage, in counts of hal.cycle_count. */
#ifndef STEADYSTEP_CONTROL_CYCLES_H
#define STEADYSTEP_CONTROL_CYCLES_H

#include <stdbool.h>
#include <stdint.h>

/* In the order in which they follow one another. */
enum control_stage {
    CONTROL_STAGE_LATENCY, /* from S(k) to the first instruction, conversion included */
    CONTROL_STAGE_READ,    /* raw results to struct hal_samples */
    CONTROL_STAGE_CONTROL, /* application_control_interrupt */
    CONTROL_STAGE_WRITE,   /* duties and bridge to the timer */
    CONTROL_STAGES
};

/* Of one control interrupt, as its board has measured them. */
struct control_cycles_of_period {
    uint32_t stage[CONTROL_STAGES];
};

struct control_stage_cycles {
    uint32_t last;
    uint32_t max;
    uint64_t sum;
};

/* Since start-up or the last reset. */
struct control_cycles {
    volatile bool restart; /* the background's wish; the interrupt obeys */
    volatile uint32_t periods;
    struct control_stage_cycles stage[CONTROL_STAGES];
    struct control_stage_cycles total; /* all stages, from S(k) to the end */
};

#endif
