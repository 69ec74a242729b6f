/* What of the application the control interrupt runs; all else is background or start-up. */
#include "firmware/application/application.h"
#include "firmware/linkage.h"

CALLED_FROM_OUTSIDE struct hal_outputs
application_control_interrupt(struct application *application, const struct hal_samples *samples)
{
    drive_control_cycle(&application->drive, samples, &application->outputs);
    return application->outputs;
}

static void count(struct control_stage_cycles *stage, uint32_t cycles)
{
    stage->last = cycles;
    stage->max = cycles > stage->max ? cycles : stage->max;
    stage->sum += cycles;
}

CALLED_FROM_OUTSIDE void application_count_cycles(struct application *application,
                                                  const struct control_cycles_of_period *cycles)
{
    struct control_cycles *counted = &application->cycles;
    uint32_t total = 0;

    if (counted->restart) {
        *counted = (struct control_cycles){.periods = 0};
    }
    for (int stage = 0; stage < CONTROL_STAGES; stage++) {
        count(&counted->stage[stage], cycles->stage[stage]);
        total += cycles->stage[stage];
    }
    count(&counted->total, total);
    counted->periods++;
}
