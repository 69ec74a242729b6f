/*
 * The serial line: LPUART1, 115200 baud 8N1, both directions by DMA. The stream functions are those
 * of hal.h. A received line feed raises an interrupt that stamps it with the control period.
 *
 * 115200 baud and not more: in double precision without FPU the background plans for some 10 ms,
 * in which the buffer must hold what comes.
 */
#ifndef STEADYSTEP_STM32G071_SERIAL_H
#define STEADYSTEP_STM32G071_SERIAL_H

#include <stddef.h>
#include <stdint.h>

enum { SERIAL_BAUD = 115200, SERIAL_RECEIVED_BYTES = 512, SERIAL_SENT_BYTES = 512 };

void serial_start(void);
size_t serial_read(uint8_t *bytes, size_t capacity, uint32_t *line_period);
size_t serial_write(const uint8_t *bytes, size_t count);

#endif
