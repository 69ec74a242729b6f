/*
 * From reset to main: memory but for what main unpacks, FPU, vector table. Vector table and reset:
 * ARMv7-M Architecture Reference Manual, B1.5. All of this runs from flash, at 16 MHz.
 */
#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/linker.h"
#include "hal/cortex_m/parameter_flash.h"
#include "hal/cortex_m/port.h"
#include "hal/stm32g474/control_interrupt.h"
#include "hal/stm32g474/deadline_guard.h"
#include "hal/stm32g474/device.h"
#include "hal/stm32g474/fdcan.h"
#include "hal/stm32g474/handlers.h"
#include "hal/stm32g474/pwm.h"

enum { CORE_VECTORS = 16, STACK_PAINT = (int)0xa7a7a7a7 };

typedef void (*vector)(void);

#define FAULT_OF_BRIDGE (BRIDGE == BRIDGE_INTEGRATED ? pwm_fault_interrupt : crash_exception)

/* Coprocessors 10 and 11, which are the FPU: full access (ARMv7-M, B3.2.20). */
#define CPACR_FPU (UINT32_C(0xf) << 20)

/* In CCM SRAM, with the code they lead to. The core begins with the table of its start, in flash.
 */
__attribute__((section(".ccm.vectors"), used, aligned(512))) struct {
    const uint32_t *stack;
    vector core[CORE_VECTORS - 1];
    vector interrupts[INTERRUPTS];
} vectors = {
    .stack = &stack_top,
    .core = {[0] = reset_handler, [1] = nmi_exception, [2 ... CORE_VECTORS - 2] = crash_exception},
    .interrupts =
        {
            [0 ... TIM1_BRK_TIM15_IRQn - 1] = crash_exception,
            [TIM1_BRK_TIM15_IRQn] = FAULT_OF_BRIDGE,
            [TIM1_UP_TIM16_IRQn] = control_interrupt,
            [TIM1_UP_TIM16_IRQn + 1 ... TIM2_IRQn - 1] = crash_exception,
            [TIM2_IRQn] = deadline_guard_interrupt,
            [TIM2_IRQn + 1 ... FDCAN3_IT0_IRQn - 1] = crash_exception,
            [FDCAN3_IT0_IRQn] = CARRIES_CAN ? fdcan_interrupt : crash_exception,
            [FDCAN3_IT0_IRQn + 1 ... LPUART1_IRQn - 1] = crash_exception,
            [LPUART1_IRQn] = serial_line_interrupt,
            [LPUART1_IRQn + 1 ... INTERRUPTS - 1] = crash_exception,
        },
};

/* One word: an interrupt takes the one or the other. */
void port_follow_control(bool follows)
{
    vectors.interrupts[TIM1_UP_TIM16_IRQn] =
        follows ? control_interrupt_followed : control_interrupt;
    __DSB();
}

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
    SCB->CPACR |= CPACR_FPU; /* before anything could hold a register of the FPU */
    __DSB();
    __ISB();

    /* What of the stack has been used can be read afterwards: below this frame it is painted. */
    fill(&stack_bottom, (const uint32_t *)__builtin_frame_address(0) - 16, (uint32_t)STACK_PAINT);
    copy(&handlers_start, &handlers_end, &handlers_load);
    copy(&data_start, &data_end, &data_load);
    fill(&bss_start, &bss_end, 0);
    fill(&dma_buffers_start, &dma_buffers_end, 0);

    SCB->VTOR = (uint32_t)&vectors;
    SCB->SHCSR |= SCB_SHCSR_MEMFAULTENA_Msk | SCB_SHCSR_BUSFAULTENA_Msk | SCB_SHCSR_USGFAULTENA_Msk;
    SCB->CCR |= SCB_CCR_DIV_0_TRP_Msk;
    __DSB();
    __ISB();

    (void)main();
    for (;;) { /* main does not return */
    }
}
