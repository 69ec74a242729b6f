/* Symbols of a port's memory.ld. */
#ifndef STEADYSTEP_CORTEX_M_LINKER_H
#define STEADYSTEP_CORTEX_M_LINKER_H

#include <stdint.h>

extern uint32_t stack_bottom, stack_top;
/* In memory without wait states: vector table and handlers, copied at reset; behind them code and
   constants of the control interrupt, unpacked later. */
extern uint32_t handlers_load, handlers_start, handlers_end;
extern uint32_t interrupt_code_start, interrupt_code_end;
extern uint32_t tables_start, tables_end, texts_start, texts_end; /* of the STM32G474 */
extern uint32_t designs_start, designs_end;                       /* of the STM32G474 */
extern const uint8_t packed[];
extern uint32_t data_load, data_start, data_end;
extern uint32_t bss_start, bss_end;
extern uint32_t dma_buffers_start, dma_buffers_end; /* of the STM32G474 */

#endif
