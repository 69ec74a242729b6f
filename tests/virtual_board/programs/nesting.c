/* Who runs when: a higher priority at once, an equal one behind, PRIMASK and BASEPRI in between. */
#include "program.h"

/* An exception that is pending comes here at the latest: between two blocks, if the program is
   watched by them. */
#define PAUSE() __asm volatile("dsb \n b 1f \n 1: nop \n b 2f \n 2: nop")

void interrupt_0(void) /* urgent */
{
    PROBE->lower[0] = 0;
    PROBE->log = 0x100;
}

void interrupt_1(void) /* raises all the others from within */
{
    PROBE->lower[1] = 0;
    PROBE->log = 0x110;
    NVIC_ISPR = 1u << 3 | 1u << 2 | 1u << 0;
    PAUSE();
    PROBE->log = 0x111;
}

void interrupt_2(void) /* the same priority as 1 */
{
    PROBE->log = 0x120;
}

void interrupt_3(void) /* lowest; the core goes on with it without return to the thread */
{
    PROBE->log = 0x130;
}

void pend_sv(void)
{
    PROBE->log = 0x1e0;
}

void supervisor_call(void)
{
    PROBE->log = 0x1b0;
}

static void raise_all(void)
{
    PROBE->log = 1;
    PROBE->raise[1] = 10;
    for (int i = 0; i < 100; i++) {
        PAUSE();
    }
    PROBE->log = 2;
    __asm volatile("cpsid i");
    NVIC_ISPR = 1u << 0;
    PAUSE();
    PROBE->log = 3; /* not yet */
    __asm volatile("cpsie i");
    PAUSE();
    PROBE->log = 4;
    __asm volatile("msr basepri, %0" ::"r"(0x80));
    NVIC_ISPR = 1u << 2 | 1u << 0;
    PAUSE();
    PROBE->log = 5; /* 0 has come, 2 has not */
    __asm volatile("msr basepri, %0" ::"r"(0));
    PAUSE();
    (void)PROBE->raise_0;
    PAUSE();
    PROBE->log = 6;
    ICSR = 1u << 28;
    PAUSE();
    __asm volatile("svc 0");
    PROBE->log = 7;
}

void program(void)
{
    NVIC_IPR0 = 0xc0808000; /* of lines 3, 2, 1, 0 */
    NVIC_ISER = 0xf;
    for (int i = 0; i < 4; i++) { /* the virtual board learns on the first visits */
        raise_all();
    }
    PROBE->end = 0;
    for (;;) {
    }
}
