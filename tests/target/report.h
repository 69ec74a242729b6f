/* Text output of a target test that needs no printf: semihosting on the target, stdout on the host.
 */
#ifndef STEADYSTEP_REPORT_H
#define STEADYSTEP_REPORT_H

#include <stdint.h>

#if defined(__arm__)
#include "tests/target/semihosting.h"
#define report_text(text) semihosting_write(text)
#else
#include <stdio.h>
#define report_text(text) ((void)fputs((text), stdout))
#endif

/* name, 16 hexadecimal digits, end of line */
static inline void report_number(const char *name, uint64_t number)
{
    char line[] = "0x0123456789abcdef\n";
    for (int digit = 0; digit < 16; ++digit)
        line[2 + digit] = "0123456789abcdef"[(number >> (60 - 4 * digit)) & 15];
    report_text(name);
    report_text(line);
}

#endif
