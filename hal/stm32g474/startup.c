/*
 * From reset to main: memory, FPU, vector table. Vector table and reset: ARMv7-M Architecture
 * Reference Manual, B1.5. All of this runs from flash, at 16 MHz.
 */
#include "hal/stm32g474/control_interrupt.h"
#include "hal/stm32g474/core.h"
#include "hal/stm32g474/crash.h"
#include "hal/stm32g474/deadline_guard.h"
#include "hal/stm32g474/linker.h"
#include "hal/stm32g474/serial_line.h"

int main(void);
void reset_handler(void);

enum { CORE_VECTORS = 16, STACK_PAINT = (int)0xa7a7a7a7 };

typedef void (*vector)(void);

/* In CCM SRAM, with the code they lead to. The core begins with the table of its start, in flash.
 */
__attribute__((section(".ccm.vectors"), used, aligned(512))) const struct {
    const uint32_t *stack;
    vector core[CORE_VECTORS - 1];
    vector interrupts[INTERRUPTS];
} vectors = {
    .stack = &stack_top,
    .core = {[0] = reset_handler, [1] = nmi_exception, [2 ... CORE_VECTORS - 2] = crash_exception},
    .interrupts =
        {
            [0 ... INTERRUPT_ADC1_2 - 1] = crash_exception,
            [INTERRUPT_ADC1_2] = control_interrupt,
            [INTERRUPT_ADC1_2 + 1 ... INTERRUPT_TIM2 - 1] = crash_exception,
            [INTERRUPT_TIM2] = deadline_guard_interrupt,
            [INTERRUPT_TIM2 + 1 ... INTERRUPT_LPUART1 - 1] = crash_exception,
            [INTERRUPT_LPUART1] = serial_line_interrupt,
            [INTERRUPT_LPUART1 + 1 ... INTERRUPTS - 1] = crash_exception,
        },
};

/* What the core reads at reset. A fault before the table above is in place ends here. */
__attribute__((section(".start_vectors"), used)) static const struct {
    const uint32_t *stack;
    vector core[CORE_VECTORS - 1];
} start_vectors = {
    .stack = &stack_top,
    .core = {[0] = reset_handler, [1 ... CORE_VECTORS - 2] = start_exception},
};

static void copy(uint32_t *to, const uint32_t *end, const uint32_t *from)
{
    while (to < end) {
        *to++ = *from++;
    }
}

static void fill(uint32_t *to, const uint32_t *end, uint32_t value)
{
    while (to < end) {
        *to++ = value;
    }
}

void reset_handler(void)
{
    SCB->cpacr |= SCB_CPACR_CP10(3) |
                  SCB_CPACR_CP11(3); /* before anything could hold a register of the FPU */
    data_barrier();
    instruction_barrier();

    /* What of the stack has been used can be read afterwards: below this frame it is painted. */
    fill(&stack_bottom, (const uint32_t *)__builtin_frame_address(0) - 16, (uint32_t)STACK_PAINT);
    copy(&ccm_start, &ccm_end, &ccm_load);
    copy(&data_start, &data_end, &data_load);
    fill(&bss_start, &bss_end, 0);

    SCB->vtor = (uint32_t)&vectors;
    SCB->shcsr |= SCB_SHCSR_MEMFAULTENA | SCB_SHCSR_BUSFAULTENA | SCB_SHCSR_USGFAULTENA;
    SCB->ccr |= SCB_CCR_DIV_0_TRP;
    data_barrier();
    instruction_barrier();

    (void)main();
    for (;;) { /* main does not return */
    }
}
