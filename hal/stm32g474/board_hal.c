#include "hal/stm32g474/board_hal.h"

#include "hal/stm32g474/board.h"
#include "hal/stm32g474/control_interrupt.h"
#include "hal/stm32g474/core.h"
#include "hal/stm32g474/crash.h"
#include "hal/stm32g474/cycle_counter.h"
#include "hal/stm32g474/image.h"
#include "hal/stm32g474/parameter_flash.h"
#include "hal/stm32g474/registers.h"
#include "hal/stm32g474/serial_line.h"
#include "hal/stm32g474/watchdog.h"

static const struct hal_facts facts = {
    .board_name = BOARD_NAME,
    .control_period_s = CONTROL_PERIOD_us / 1e6,
    .pwm_half_period_counts = PWM_HALF_PERIOD,
    .dead_time_s = DEAD_TIME_CYCLES / (double)CORE_Hz,
    .current_A_per_code = CURRENT_A_PER_CODE,
    .current_zero_code = CURRENT_ZERO_CODE,
    .bus_V_per_code = BUS_V_PER_CODE,
    .phase_voltage_V_per_code = PHASE_VOLTAGE_V_PER_CODE,
    .has_phase_voltages = true,
    .encoder_counts_per_turn = ENCODER_COUNTS_PER_TURN, /* by the build; 0: settings may tell */
    .cycle_counter_Hz = CORE_Hz,
    .parameter_page_bytes = FLASH_PAGE_BYTES,
    .parameter_word_bytes = PARAMETER_WORD_BYTES,
};

static bool bridge_enable(void *context)
{
    (void)context;
    return control_allow_bridge();
}

static void bridge_disable(void *context)
{
    (void)context;
    control_forbid_bridge();
}

static uint32_t cycle_count(void *context)
{
    (void)context;
    return cycle_counter_read();
}

/* Whole control periods; their index wraps after five days, which is noticed here. */
static uint64_t time_us(void *context)
{
    static uint32_t last, wraps;
    const uint32_t primask = interrupts_save_and_disable();
    const uint32_t periods = control_period() + 1u; /* 0 before the first */

    (void)context;
    wraps += periods < last;
    last = periods;

    const uint64_t all = ((uint64_t)wraps << 32) + periods;

    interrupts_restore(primask);
    return all * CONTROL_PERIOD_us;
}

static void feed(void *context)
{
    (void)context;
    watchdog_feed();
}

static const char *start_cause(void *context)
{
    (void)context;
    return crash_start_cause();
}

static size_t stream_read(void *context, uint8_t *bytes, size_t capacity, uint32_t *line_period)
{
    (void)context;
    return serial_line_read(bytes, capacity, line_period);
}

static size_t stream_write(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    return serial_line_write(bytes, count);
}

static bool parameters_erase(void *context, uint32_t page)
{
    (void)context;
    return parameter_flash_erase(page);
}

static bool parameters_program(void *context, uint32_t offset, const void *data, size_t count)
{
    (void)context;
    return parameter_flash_program(offset, data, count);
}

static bool parameters_read(void *context, uint32_t offset, void *data, size_t count)
{
    (void)context;
    return parameter_flash_read(offset, data, count);
}

const struct hal board_hal = {
    .facts = &facts,
    .version = image_version,
    .bridge_enable = bridge_enable,
    .bridge_disable = bridge_disable,
    .cycle_count = cycle_count,
    .time_us = time_us,
    .watchdog_feed = feed,
    .start_cause = start_cause,
    .stream_read = stream_read,
    .stream_write = stream_write,
    .parameters_erase = parameters_erase,
    .parameters_program = parameters_program,
    .parameters_read = parameters_read,
};
