/* What can go wrong at the start and in the control interrupt; crash.h. */
#ifndef STEADYSTEP_STM32G474_FAULTS_H
#define STEADYSTEP_STM32G474_FAULTS_H

#define BOARD_FAULTS(FAULT)                                                                        \
    FAULT(SUPPLY, "the chip's supply is below 2.9 V")                                              \
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

#endif
