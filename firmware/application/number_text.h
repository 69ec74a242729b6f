/*
 * Numbers as they are typed, to the same bits on every core and compiler, and to the nearest
 * double: what cannot be had exactly with one rounding is refused, not approximated.
 */
#ifndef STEADYSTEP_NUMBER_TEXT_H
#define STEADYSTEP_NUMBER_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum number_text {
    NUMBER_TEXT_READ,
    NUMBER_TEXT_MALFORMED,
    NUMBER_TEXT_TOO_LONG,    /* more than 53 bits, 15 decimal digits */
    NUMBER_TEXT_OUT_OF_RANGE /* decimal: beyond 1e37 or below 1e-22; hexadecimal: no normal double
                              */
};

/*
 * Decimal, 15 significant digits: -1.5, 2e-3. Hexadecimal as of C99, exact: 0x1.8p+0, -0x.8p1. No
 * infinity, no NaN. `value` is written if the answer is NUMBER_TEXT_READ.
 */
enum number_text number_from_text(const char *text, size_t length, double *value);

/* Decimal digits alone, 0...4294967295. */
bool unsigned_from_text(const char *text, size_t length, uint32_t *value);

#endif
