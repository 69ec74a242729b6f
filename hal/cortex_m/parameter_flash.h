/* The parameter store, in pages of the flash that the program does not use. */
#ifndef STEADYSTEP_CORTEX_M_PARAMETER_FLASH_H
#define STEADYSTEP_CORTEX_M_PARAMETER_FLASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PARAMETER_PAGES = 4, PARAMETER_WORD_BYTES = 8 };

/* As in hal.h; false, too, if the flash cannot do it now or the cells cannot be read. */
bool parameter_flash_erase(uint32_t page);
bool parameter_flash_program(uint32_t offset, const void *data, size_t count);
bool parameter_flash_read(uint32_t offset, void *data, size_t count);

/* In the NMI: whether it came from cells of the store that fail the check, which
   parameter_flash_read then refuses; so it is done with. */
__attribute__((used)) bool parameter_flash_take_error(void);

/* A crash, but for such cells. */
void nmi_exception(void);

#endif
