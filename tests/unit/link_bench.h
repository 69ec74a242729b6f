/* A drive with a fieldbus link on a board without a motor: lines of slcan in, frames out. */
#ifndef STEADYSTEP_LINK_BENCH_H
#define STEADYSTEP_LINK_BENCH_H

#include <stdio.h>

#include "tests/unit/console_bench.h"

static struct link bench_link;

static inline void link_bench_start(void)
{
    const struct drive_settings settings = bench_quick_settings();

    bench_power_up();
    (void)bench_start(&settings);
    application_put_link(&bench.application, &bench_link);
    bench_periods(3);
    (void)bench_heard();
}

/* What comes within some periods of a line, its '\r' left out. */
static inline const char *link_bench_say(const char *line, int periods)
{
    (void)bench_heard();
    bench_type(line);
    bench_type("\r");
    bench_periods(periods);
    return bench_heard();
}

static inline void link_bench_open(void)
{
    (void)link_bench_say("O", 1);
}

/* The answer to an SDO request of eight bytes as hexadecimal digits, without its "t5818". */
static inline const char *link_bench_sdo(const char *request)
{
    static char answer[32];
    char line[64];
    const char *found;

    snprintf(line, sizeof line, "t6018%s", request);
    found = strstr(link_bench_say(line, 1), "t5818");
    snprintf(answer, sizeof answer, "%.16s", found == NULL ? "" : found + 5);
    return answer;
}

#endif
