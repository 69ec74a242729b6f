/*
 * Serial line to the host: LPUART1, DMA in both directions. The character-match interrupt stamps
 * the control period in which a line ended.
 */
#ifndef STEADYSTEP_STM32G474_SERIAL_LINE_H
#define STEADYSTEP_STM32G474_SERIAL_LINE_H

#include <stddef.h>
#include <stdint.h>

void serial_line_configure(void);

/* As hal.h: stream_read and stream_write. */
size_t serial_line_read(uint8_t *bytes, size_t capacity, uint32_t *line_period);
size_t serial_line_write(const uint8_t *bytes, size_t count);

/* Background, all the time: what has been written goes on its way. */
void serial_line_continue(void);

/* Before serial_line_configure, instead of it: sends a text at the clock of reset, and waits. */
void serial_line_tell(const char *text);

void serial_line_interrupt(void);

#endif
