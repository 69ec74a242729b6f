#include "hal/stm32g071/board.h"

#include "hal/stm32g071/bridge.h"
#include "hal/stm32g071/clock.h"
#include "hal/stm32g071/crash.h"
#include "hal/stm32g071/image.h"
#include "hal/stm32g071/serial.h"
#include "hal/stm32g071/store.h"

static const struct hal_facts facts = {
    .board_name = BOARD_NAME,
    .control_period_s = 1e-4,
    .pwm_half_period_counts = BRIDGE_HALF_PERIOD_COUNTS,
    .dead_time_s = BRIDGE_DEAD_TIME_s,
    .current_A_per_code = CURRENT_A_PER_CODE,
    .current_zero_code = CURRENT_ZERO_CODE,
    .bus_V_per_code = BUS_V_PER_CODE,
    .phase_voltage_V_per_code = PHASE_VOLTAGE_V_PER_CODE,
    .has_phase_voltages = true,
    .bridge_resistance_ohm = BRIDGE_RESISTANCE_OHM,
    .cycle_counter_Hz = CORE_CLOCK_Hz,
    .parameter_page_bytes = STORE_PAGE_BYTES,
    .parameter_word_bytes = STORE_WORD_BYTES,
};

static bool enable(void *context)
{
    (void)context;
    return bridge_enable();
}

static void disable(void *context)
{
    (void)context;
    bridge_disable();
}

static uint32_t cycle_count(void *context)
{
    (void)context;
    return clock_cycles();
}

/* The background asks far more often than the counter wraps, every 67 s. */
static uint64_t time_us(void *context)
{
    static uint64_t cycles;

    (void)context;
    cycles += (uint32_t)(clock_cycles() - (uint32_t)cycles);
    return cycles / CORE_CYCLES_PER_us;
}

static void watchdog_feed(void *context)
{
    (void)context;
    IWDG->kr = IWDG_FEED;
}

static const char *start_cause(void *context)
{
    (void)context;
    return crash_start_cause();
}

static size_t stream_read(void *context, uint8_t *bytes, size_t capacity, uint32_t *line_period)
{
    (void)context;
    return serial_read(bytes, capacity, line_period);
}

static size_t stream_write(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    return serial_write(bytes, count);
}

static bool parameters_erase(void *context, uint32_t page)
{
    (void)context;
    return store_erase(page);
}

static bool parameters_program(void *context, uint32_t offset, const void *data, size_t count)
{
    (void)context;
    return store_program(offset, data, count);
}

static bool parameters_read(void *context, uint32_t offset, void *data, size_t count)
{
    (void)context;
    return store_read(offset, data, count);
}

const struct hal board = {
    .facts = &facts,
    .version = image_version,
    .bridge_enable = enable,
    .bridge_disable = disable,
    .cycle_count = cycle_count,
    .time_us = time_us,
    .watchdog_feed = watchdog_feed,
    .start_cause = start_cause,
    .stream_read = stream_read,
    .stream_write = stream_write,
    .parameters_erase = parameters_erase,
    .parameters_program = parameters_program,
    .parameters_read = parameters_read,
};
