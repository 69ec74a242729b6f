/* The image: the board's start, the application's loop. */
#include <string.h>

#include "firmware/application/application.h"
#include "hal/cortex_m/board_hal.h"
#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/image.h"
#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/linker.h"
#include "hal/cortex_m/serial_line.h"
#include "hal/cortex_m/unpack.h"
#include "hal/stm32g071/bridge.h"
#include "hal/stm32g071/board.h"
#include "hal/stm32g071/clock.h"
#include "hal/stm32g071/control_interrupt.h"
#include "hal/stm32g071/converter.h"
#include "hal/stm32g071/pins.h"
#include "hal/stm32g071/watchdog.h"

struct application application;

/* No control interrupt may come before. */
static void unpack_memory(void)
{
    static const struct unpacked_region region = {&interrupt_code_start, &interrupt_code_end};

    unpack(packed, &region, 1);
    __DSB();
    __ISB();
}

static _Noreturn void stay_off(void)
{
    clock_of_blocks();
    bridge_start(); /* holds the gates low; no more is started, as any of it may have failed */
    pins_connect();
    crash_report();
}

int main(void)
{
    static char error[DRIVE_ERROR_TEXT];

    crash_read_cause();
    if (crash_stays_off()) {
        stay_off();
    }
    if (!clock_start()) {
        board_fault(BOARD_FAULT_CLOCK);
    }
    clock_of_blocks();
    unpack_memory();
    cycle_counter_start();
    bridge_start();
    pins_connect();
    serial_line_configure();
    if (!application_init(&application, &board_hal, &motor_default, error)) {
        (void)serial_line_write((const uint8_t *)error, strlen(error));
        clock_wait_us(100000); /* for the text to leave */
        board_fault(BOARD_FAULT_SETTINGS_REFUSED);
    }
    if (!converter_start()) {
        board_fault(BOARD_FAULT_ADC_START);
    }
    if (!bridge_run()) {
        board_fault(BOARD_FAULT_PWM_PHASE);
    }
    interrupt_enable(DMA1_CHANNEL1_IRQn, PRIORITY_CONTROL);
    NVIC_SetPriority(PendSV_IRQn, PRIORITY_STATISTICS);
    if (!converter_synchronise()) {
        board_fault(BOARD_FAULT_ADC_PHASE);
    }
    bridge_guard_start();
    watchdog_start();
    for (;;) {
        crash_watch_start(CRASH_START_us / CONTROL_PERIOD_us);
        application_background(&application);
        __WFI();
    }
}
