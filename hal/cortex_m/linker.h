/* Symbols of a port's memory.ld. */
#ifndef STEADYSTEP_CORTEX_M_LINKER_H
#define STEADYSTEP_CORTEX_M_LINKER_H

#include <stdint.h>

extern uint32_t stack_bottom, stack_top;
/* Vector table, code and constants of the interrupts: copied at start to memory without wait
   states. */
extern uint32_t interrupt_code_load, interrupt_code_start, interrupt_code_end;
extern uint32_t data_load, data_start, data_end;
extern uint32_t bss_start, bss_end;
extern uint32_t dma_buffers_start, dma_buffers_end; /* of the STM32G474 */

#endif
