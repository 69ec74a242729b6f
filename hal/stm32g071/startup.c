/* Reset and vector table: Armv6-M Architecture Reference Manual, B1.5. */
#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/linker.h"
#include "hal/cortex_m/parameter_flash.h"
#include "hal/stm32g071/control_interrupt.h"
#include "hal/stm32g071/device.h"
#include "hal/stm32g071/handlers.h"

typedef void (*vector)(void);

enum { EXCEPTIONS = 16 + INTERRUPTS };

#define LINE(interrupt) [16 + interrupt##_IRQn]

#define VECTORS                                                                                    \
    {                                                                                              \
        (vector) & stack_top,                                                                      \
            reset_handler, [2] = nmi_exception,                                                    \
                           [3 ... EXCEPTIONS - 1] = crash_exception, [14] = pend_sv_handler,       \
                           LINE(DMA1_CHANNEL1) = control_interrupt,                                \
                           LINE(DMA1_CHANNEL2_3) = dma1_channel2_3_handler,                        \
                           LINE(TIM1_BRK_UP_TRG_COM) = tim1_brk_up_trg_com_handler,                \
                           LINE(TIM2) = tim2_handler,                                              \
                           LINE(USART3_4_LPUART1) = usart3_4_lpuart1_handler                       \
    }

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Woverride-init" /* a default, and the lines that differ */
/* For the reset, at the begin of the flash. */
__attribute__((section(".vectors"), used)) static const vector vectors_in_flash[EXCEPTIONS] =
    VECTORS;
/* For everything else, so that no exception waits for the flash. */
__attribute__((section(".ram_vectors"), used)) static const vector vectors_in_ram[EXCEPTIONS] =
    VECTORS;
#pragma GCC diagnostic pop

/* Volatile, so that no loop becomes a call of memcpy or memset, which these loops bring into RAM.
 */
static void copy(const volatile uint32_t *from, volatile uint32_t *to, const uint32_t *end)
{
    while (to < end) {
        *to++ = *from++;
    }
}

void reset_handler(void)
{
    copy(&handlers_load, &handlers_start, &handlers_end);
    copy(&data_load, &data_start, &data_end);
    for (volatile uint32_t *word = &bss_start; word < &bss_end; word++) {
        *word = 0;
    }
    SCB->VTOR = (uint32_t)(uintptr_t)vectors_in_ram;
    __DSB();
    __ISB();
    (void)main();
    crash_exception();
}
