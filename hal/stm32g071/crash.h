/*
 * What ends the program: a fault of the core, a peripheral that does not answer, a refused start.
 * The bridge is opened first; a record stays in memory that the reset leaves alone and is told at
 * the next start.
 */
#ifndef STEADYSTEP_STM32G071_CRASH_H
#define STEADYSTEP_STM32G071_CRASH_H

#include <stdint.h>

/* Hardware that does not do what it must. */
#define BOARD_FAULTS(FAULT)                                                                        \
    FAULT(CLOCK, "clock does not reach 64 MHz")                                                    \
    FAULT(ADC_START, "ADC does not calibrate or get ready")                                        \
    FAULT(PWM_PHASE, "PWM timer does not load its compares at the peak")                           \
    FAULT(ADC_PHASE, "ADC out of step with the PWM timer")                                         \
    FAULT(WATCHDOG, "watchdog does not take its period")                                           \
    FAULT(SETTINGS_REFUSED, "drive refuses its default settings")

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

/* Handler of NMI, HardFault, and of any other exception that nothing handles. */
void crash_exception(void);

#endif
