/* What can go wrong at the start; crash.h. */
#ifndef STEADYSTEP_STM32G071_FAULTS_H
#define STEADYSTEP_STM32G071_FAULTS_H

#define BOARD_FAULTS(FAULT)                                                                        \
    FAULT(CLOCK, "clock does not reach 64 MHz")                                                    \
    FAULT(ADC_START, "ADC does not calibrate or get ready")                                        \
    FAULT(PWM_PHASE, "PWM timer does not load its compares at the peak")                           \
    FAULT(ADC_PHASE, "ADC out of step with the PWM timer")                                         \
    FAULT(WATCHDOG, "watchdog does not take its period")                                           \
    FAULT(SETTINGS_REFUSED, "drive refuses its default settings")

#endif
