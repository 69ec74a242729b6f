#include "hal/cortex_m/board_hal.h"

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/image.h"
#include "hal/cortex_m/parameter_flash.h"
#include "hal/cortex_m/port.h"
#include "hal/cortex_m/serial_line.h"

static bool bridge_enable(void *context)
{
    (void)context;
    return port_bridge_enable();
}

static void bridge_disable(void *context)
{
    (void)context;
    port_bridge_disable();
}

static uint16_t bridge_temperature(void *context)
{
    (void)context;
    return port_bridge_temperature();
}

#ifndef STEADYSTEP_WITHOUT_MACHINE_IO
static uint32_t inputs_read(void *context)
{
    (void)context;
    return port_inputs_read();
}

static void outputs_write(void *context, uint32_t levels)
{
    (void)context;
    port_outputs_write(levels);
}
#endif

#ifndef STEADYSTEP_WITHOUT_LINK
static bool encoder_index(void *context, enum hal_index ask, int32_t *count)
{
    (void)context;
    return port_encoder_index(ask, count);
}
#endif

static uint32_t cycle_count(void *context)
{
    (void)context;
    return port_cycle_count();
}

static uint64_t time_us(void *context)
{
    (void)context;
    return port_time_us();
}

static void watchdog_feed(void *context)
{
    (void)context;
    port_watchdog_feed();
}

static const char *start_cause(void *context)
{
    (void)context;
    return crash_start_cause();
}

#ifndef STEADYSTEP_WITHOUT_LINK
static void follow_control(void *context, bool follows)
{
    (void)context;
    port_follow_control(follows);
}
#endif

static void defer_interrupts(void *context, bool defers)
{
    (void)context;
    port_defer_interrupts(defers);
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
    .facts = &port_facts,
    .version = image_version,
    .bridge_enable = bridge_enable,
    .bridge_disable = bridge_disable,
    .bridge_temperature = bridge_temperature,
#ifndef STEADYSTEP_WITHOUT_MACHINE_IO
    .inputs_read = inputs_read,
    .outputs_write = outputs_write,
#endif
#ifndef STEADYSTEP_WITHOUT_LINK
    .encoder_index = encoder_index,
#endif
    .cycle_count = cycle_count,
    .time_us = time_us,
    .watchdog_feed = watchdog_feed,
    .start_cause = start_cause,
#ifndef STEADYSTEP_WITHOUT_LINK
    .follow_control = follow_control,
#endif
    .defer_interrupts = defer_interrupts,
    .stream_read = stream_read,
    .stream_write = stream_write,
    .parameters_erase = parameters_erase,
    .parameters_program = parameters_program,
    .parameters_read = parameters_read,
};
