/* What a loss of power leaves in the parameter store raises NMI when it is read. */
#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/parameter_flash.h"

/* crash_exception looks for what the core pushed, so the stack is as the core left it there. */
__attribute__((naked)) void nmi_exception(void)
{
    __asm__ volatile(".syntax unified\n"
                     "push {r4, lr}\n"
                     "bl parameter_flash_take_error\n"
                     "cmp r0, #0\n"
                     "beq 1f\n"
                     "pop {r4, pc}\n"
                     "1: pop {r3}\n"
                     "pop {r3}\n"
                     "mov lr, r3\n"
                     "ldr r3, =crash_exception\n"
                     "bx r3\n"
                     ".ltorg\n");
}
