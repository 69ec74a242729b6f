/* The image: the board's start, the application's loop. */
#include "firmware/application/application.h"
#include "hal/cortex_m/board_hal.h"
#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/image.h"
#include "hal/cortex_m/linker.h"
#include "hal/cortex_m/serial_line.h"
#include "hal/cortex_m/unpack.h"
#include "hal/stm32g474/board.h"
#include "hal/stm32g474/clock.h"
#include "hal/stm32g474/control_interrupt.h"
#include "hal/stm32g474/current_sampling.h"
#include "hal/stm32g474/cycle_counter.h"
#include "hal/stm32g474/deadline_guard.h"
#include "hal/stm32g474/encoder.h"
#include "hal/stm32g474/fdcan.h"
#include "hal/stm32g474/flash_errors.h"
#include "hal/stm32g474/overcurrent_trip.h"
#include "hal/stm32g474/phase_voltage_sampling.h"
#include "hal/stm32g474/pins.h"
#include "hal/stm32g474/pwm.h"
#include "hal/stm32g474/watchdog.h"

struct application application;
static struct link fieldbus;
static uint32_t capture_memory[HAL_CAPTURE_WORDS] __attribute__((section(".bss.capture")));

/* Before, nothing of firmware/ may run that has constants, which design/text.c has not, and no
   control interrupt. */
static void unpack_memory(void)
{
    static const struct unpacked_region regions[] = {
        {&interrupt_code_start, &interrupt_code_end},
        {&tables_start, &tables_end},
        {&texts_start, &texts_end},
        {&designs_start, &designs_end},
    };

    unpack(packed, regions, sizeof regions / sizeof regions[0]);
    __DSB();
    __ISB();
}

/* The gates are held low, by pull-downs until the timer drives them, from reset on. */
static void start_board(void)
{
    cycle_counter_start();
    clock_start();
    parameter_flash_check_options();
    overcurrent_trip_configure();
    pwm_configure();
    pins_connect();
    encoder_configure();
    serial_line_configure();
    if (CARRIES_CAN) {
        fdcan_configure();
    }
    unpack_memory();
}

/*
 * In step with the PWM timer, so before it starts; control interrupts begin at the first peak after
 * two at which compares have been seen to load, when the means of a whole period are there.
 */
static void start_control(void)
{
    current_sampling_configure();
    phase_voltage_sampling_configure();
    deadline_guard_configure();
    pwm_start();
    pwm_watch_fault();
    deadline_guard_start();
    current_sampling_start();
    pwm_raise_control();
}

static _Noreturn void stay_off(void)
{
    pwm_configure(); /* holds the gates low; no more is started, as any of it may have failed */
    pins_connect();
    crash_report();
}

int main(void)
{
    char error[DRIVE_ERROR_TEXT] = "";

    crash_read_cause();
    if (crash_stays_off()) {
        stay_off();
    }
    start_board();
    if (!application_init(&application, &board_hal, &motor_default, error)) {
        board_fault(BOARD_FAULT_SETTINGS_REFUSED);
    }
    application_put_link(&application, &fieldbus);
    link_put_memory(&fieldbus, capture_memory, HAL_CAPTURE_WORDS);
    if (CARRIES_CAN) {
        link_put_can(&fieldbus, &fdcan);
    }
    start_control();
    watchdog_start();
    pins_led(1);
    for (;;) {
        crash_watch_start(CRASH_START_us / CONTROL_PERIOD_us);
        application_background(&application);
        (void)serial_line_write(0, 0);
        __WFI();
    }
}
