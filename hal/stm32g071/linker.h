/* Symbols of memory.ld. */
#ifndef STEADYSTEP_STM32G071_LINKER_H
#define STEADYSTEP_STM32G071_LINKER_H

#include <stdint.h>

extern uint32_t stack_bottom, stack_top;
extern uint32_t ram_code_load, ram_code_start, ram_code_end;
extern uint32_t data_load, data_start, data_end;
extern uint32_t bss_start, bss_end;

#endif
