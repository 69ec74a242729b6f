/*
 * What a loss of power leaves in the parameter store, and what the start expects of the flash. The
 * program lies in bank 1, the store is the last four pages of bank 2: erasing (25 ms) and
 * programming (90 us a word) stall no instruction; interrupt code runs from CCM SRAM besides.
 */
#ifndef STEADYSTEP_STM32G474_FLASH_ERRORS_H
#define STEADYSTEP_STM32G474_FLASH_ERRORS_H

#include <stdbool.h>

/* Faults if the option bytes do not give two banks with this program in the first. */
void parameter_flash_check_options(void);

/* Of a cell whose error the flash has corrected: the next double error would raise no NMI. Asked
   for with each read of the store, and all the time in the background. */
void parameter_flash_forget_corrected(void);

#endif
