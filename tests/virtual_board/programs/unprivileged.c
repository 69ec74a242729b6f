/* Code that gives its privileges away, and an exception behind it. */
#include "program.h"

void supervisor_call(void)
{
}

void program(void)
{
    PROBE->log = 1;
    __asm volatile("msr control, %0 \n isb \n svc 0" ::"r"(1));
    PROBE->log = 2;
    PROBE->end = 0;
    for (;;) {
    }
}
