/*
 * What ends the program: a fault of the core, a peripheral that does not answer, a refused start.
 * The bridge is opened first; a record stays in memory that the reset leaves alone and is told at
 * the next start.
 */
#ifndef STEADYSTEP_STM32G474_CRASH_H
#define STEADYSTEP_STM32G474_CRASH_H

#include <stdbool.h>
#include <stdint.h>

/* Hardware that does not do what it must. */
#define BOARD_FAULTS(FAULT)                                                                        \
    FAULT(CLOCK_REGULATOR, "core regulator not ready")                                             \
    FAULT(CLOCK_FLASH_LATENCY, "flash wait states not taken")                                      \
    FAULT(CLOCK_PLL, "PLL does not lock")                                                          \
    FAULT(CLOCK_SWITCH, "system clock does not switch to the PLL")                                 \
    FAULT(CLOCK_WATCHDOG, "low-speed oscillator does not start")                                   \
    FAULT(WATCHDOG, "watchdog does not take its period")                                           \
    FAULT(FLASH_OPTIONS, "flash option bytes: dual bank, booted from bank 1, expected")            \
    FAULT(ADC_CALIBRATION, "ADC calibration does not end")                                         \
    FAULT(ADC_READY, "ADC does not get ready")                                                     \
    FAULT(DAC_READY, "DAC does not get ready")                                                     \
    FAULT(PWM_UPDATE, "PWM timer gives no update")                                                 \
    FAULT(PWM_PHASE, "PWM timer loads its compares in the valley")                                 \
    FAULT(CURRENT_SAMPLES, "a current converter has not converted")                                \
    FAULT(LEG_SAMPLES, "leg-voltage conversions out of step or lost")                              \
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
/* Whether so many starts in a row have crashed, for whatever reason, before they were done, that
   this one shall not close a bridge; a power cycle or the reset pin begins anew. */
bool crash_stays_off(void);
/* The start has succeeded: failures in a row count anew. */
void crash_start_done(void);

/* Handler of HardFault, MemManage, BusFault and UsageFault, and of any other exception that nothing
   handles. */
void crash_exception(void);
/* Of NMI: a crash, too, but for a double error in the parameter store. */
void nmi_exception(void);
/* Before memory is in place: nothing could be recorded, and no peripheral is on; stays there. */
void start_exception(void);

#endif
