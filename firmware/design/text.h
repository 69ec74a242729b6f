/*
 * Text into a buffer of fixed size, without printf: refusals of the design, answers of the console.
 * What does not fit is cut off; the text is terminated at all times. Numbers are written in double
 * arithmetic, so with the same digits everywhere.
 */
#ifndef STEADYSTEP_TEXT_H
#define STEADYSTEP_TEXT_H

#include <stddef.h>
#include <stdint.h>

struct text {
    char *at;
    size_t room; /* of the buffer, terminator included; > 0 */
    size_t length;
};

/* An empty text in a buffer. */
struct text text_in(char *buffer, size_t room);

void text_put(struct text *text, const char *words);

void text_unsigned(struct text *text, uint32_t value);

/* As many as 1...8 lower-case hexadecimal digits, without "0x". */
void text_hexadecimal(struct text *text, uint32_t value, int digits);

enum { TEXT_DIGITS_MAX = 9 };

/*
 * `digits` (1...9) significant decimal digits, zeros at the end left out: 0.0312, 1500, 2.5e-07.
 * "(not finite)" for what is none.
 */
void text_number(struct text *text, double value, int digits);

#endif
