/*
 * Parameter store: the last four pages of flash bank 2. The program lies in bank 1, so erasing and
 * programming stall no instruction; interrupt code runs from CCM SRAM besides.
 */
#ifndef STEADYSTEP_STM32G474_PARAMETER_FLASH_H
#define STEADYSTEP_STM32G474_PARAMETER_FLASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PARAMETER_PAGES = 4, PARAMETER_WORD_BYTES = 8 };

/* Faults if the option bytes do not give two banks with this program in the first. */
void parameter_flash_check_options(void);

/* As in hal.h. Erasing takes up to 25 ms, programming 90 us a word. */
bool parameter_flash_erase(uint32_t page);
bool parameter_flash_program(uint32_t offset, const void *data, size_t count);
/* false, too, if a loss of power during programming or erasing has left cells that fail the check.
 */
bool parameter_flash_read(uint32_t offset, void *data, size_t count);
/* In the NMI: whether it came from such cells; then it is done with. */
bool parameter_flash_take_error(void);

#endif
