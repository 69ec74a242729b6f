/*
 * Serial line to the host, 8N1: DMA in both directions; the interrupt of a received line feed
 * stamps the control period in which a line ended.
 */
#ifndef STEADYSTEP_CORTEX_M_SERIAL_LINE_H
#define STEADYSTEP_CORTEX_M_SERIAL_LINE_H

#include <stddef.h>
#include <stdint.h>

void serial_line_configure(void);

/* As hal.h: stream_read and stream_write. Writing sends what has been written before, too: the
   background does so all the time, be it with no byte. */
size_t serial_line_read(uint8_t *bytes, size_t capacity, uint32_t *line_period);
size_t serial_line_write(const uint8_t *bytes, size_t count);

/* Before serial_line_configure, instead of it: sends a text at the clock of reset, and waits. */
void serial_line_report(const char *text);

#endif
