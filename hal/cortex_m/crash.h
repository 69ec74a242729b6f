/*
 * What ends the program: a fault of the core, a peripheral that does not answer, a refused start.
 * The bridge is opened first; a record stays in memory that the reset leaves alone and is reported
 * at the next start.
 */
#ifndef STEADYSTEP_CORTEX_M_CRASH_H
#define STEADYSTEP_CORTEX_M_CRASH_H

#include <stdbool.h>
#include <stdint.h>

#include STEADYSTEP_FAULTS

/* Hardware that does not do what it must; BOARD_FAULTS lists names and texts. */
enum board_fault {
    BOARD_FAULT_NONE,
#define FAULT_NAME(name, text) BOARD_FAULT_##name,
    BOARD_FAULTS(FAULT_NAME)
#undef FAULT_NAME
        BOARD_FAULT_COUNT
};

/* Opens the bridge, records, resets. */
_Noreturn void board_fault(enum board_fault fault);

/* At start-up: puts the reset's cause, or what the last crash recorded, into words; forgets both.
 */
void crash_read_cause(void);
const char *crash_start_cause(void);
/* Whether so many starts in a row have crashed, for whatever reason, before they were done, that
   this one shall not close a bridge; a power cycle or the reset pin begins anew. */
bool crash_stays_off(void);
/* Says why, once a second, to whoever listens, for ever; gates and pins are the caller's. */
_Noreturn void crash_report(void);
/* What a start takes, of control. */
enum { CRASH_START_us = 100000 };

/* From the background, all the time: behind so many control periods the start has succeeded, and
   failures in a row count anew. */
void crash_watch_start(uint32_t start_periods);

/* Handler of the core's faults and of any other exception that nothing handles. */
void crash_exception(void);
/* Before memory is in place: nothing could be recorded, and no peripheral is on; stays there. */
void start_exception(void);

#endif
