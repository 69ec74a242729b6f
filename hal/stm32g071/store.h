/*
 * The parameter store: the last four pages of the flash. The chip has one bank: while a page is
 * erased (up to 40 ms) or a word programmed (0.1 ms) the core stalls at its next fetch from flash.
 * Both are refused while the bridge is on.
 */
#ifndef STEADYSTEP_STM32G071_STORE_H
#define STEADYSTEP_STM32G071_STORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { STORE_PAGES = 4, STORE_PAGE_BYTES = 2048, STORE_WORD_BYTES = 8 };

bool store_erase(uint32_t page);
bool store_program(uint32_t offset, const void *data, size_t count);
bool store_read(uint32_t offset, void *data, size_t count);

#endif
