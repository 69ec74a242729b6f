#include "hal/sil/hal_sil.h"

#include <string.h>

static bool bridge_enable(void *context)
{
    struct hal_sil *sil = context;
    sil->bridge_allowed = !sil->trip_latched;
    return sil->bridge_allowed;
}

static void bridge_disable(void *context)
{
    struct hal_sil *sil = context;
    sil->bridge_allowed = false;
    sil->trip_latched = false;
}

/* The timer counts up and down once per period. */
static uint16_t bridge_temperature(void *context)
{
    return ((const struct hal_sil *)context)->bridge_temperature;
}

static uint32_t cycle_count(void *context)
{
    const struct hal_sil *sil = context;
    return (uint32_t)(sil->period * 2u * sil->facts.pwm_half_period_counts);
}

static uint64_t time_us(void *context)
{
    const struct hal_sil *sil = context;
    const uint64_t period_ns = (uint64_t)(sil->facts.control_period_s * 1e9 + 0.5);
    return sil->period * period_ns / 1000u;
}

static uint32_t inputs_read(void *context)
{
    return ((const struct hal_sil *)context)->inputs;
}

static void outputs_write(void *context, uint32_t levels)
{
    ((struct hal_sil *)context)->outputs = levels;
}

static bool encoder_index(void *context, enum hal_index ask, int32_t *count)
{
    struct hal_sil *sil = context;
    if (ask != HAL_INDEX_PASSED) {
        sil->index_awaited = ask;
        sil->index_passed = false;
    }
    const bool passed = sil->index_passed;
    *count = sil->index_count;
    sil->index_passed = false;
    return passed;
}

static void watchdog_feed(void *context)
{
    struct hal_sil *sil = context;
    sil->watchdog_running = true;
    sil->watchdog_fed_us = time_us(sil);
}

static const char *start_cause(void *context)
{
    const struct hal_sil *sil = context;
    return sil->restarted ? "power-on after a power cycle" : "power-on";
}

static void follow_control(void *context, bool follows)
{
    struct hal_sil *sil = context;
    sil->follows = follows;
}

static size_t put(struct hal_sil_stream *stream, const uint8_t *bytes, size_t count,
                  uint32_t period)
{
    size_t moved = 0;
    for (; moved < count && stream->count < HAL_SIL_STREAM_BYTES; moved++) {
        const size_t at = (stream->first + stream->count) % HAL_SIL_STREAM_BYTES;
        stream->bytes[at] = bytes[moved];
        stream->arrived_in[at] = period;
        stream->count++;
    }
    return moved;
}

/* `until`: stops behind this byte, and says when it arrived; -1: none. */
static size_t take(struct hal_sil_stream *stream, uint8_t *bytes, size_t capacity, int until,
                   uint32_t *period)
{
    size_t moved = 0;
    while (moved < capacity && stream->count > 0) {
        const size_t at = stream->first;
        bytes[moved++] = stream->bytes[at];
        stream->first = (at + 1) % HAL_SIL_STREAM_BYTES;
        stream->count--;
        if (stream->bytes[at] == until) {
            *period = stream->arrived_in[at];
            break;
        }
    }
    return moved;
}

static size_t stream_read(void *context, uint8_t *bytes, size_t capacity, uint32_t *line_period)
{
    struct hal_sil *sil = context;
    return take(&sil->to_drive, bytes, capacity, '\n', line_period);
}

static size_t stream_write(void *context, const uint8_t *bytes, size_t count)
{
    struct hal_sil *sil = context;
    return put(&sil->to_host, bytes, count, 0);
}

static bool parameters_erase(void *context, uint32_t page)
{
    struct hal_sil *sil = context;
    if (page >= HAL_SIL_PAGES) {
        return false;
    }
    memset(&sil->parameters[page * HAL_SIL_PAGE_BYTES], 0xff, HAL_SIL_PAGE_BYTES);
    return true;
}

static bool in_store(uint32_t offset, size_t count)
{
    const size_t size = HAL_SIL_PAGES * HAL_SIL_PAGE_BYTES;
    return offset <= size && count <= size - offset;
}

/* Whole words only, and only where nothing has been programmed since the erase. */
static bool parameters_program(void *context, uint32_t offset, const void *data, size_t count)
{
    struct hal_sil *sil = context;
    if (!in_store(offset, count) || offset % HAL_SIL_WORD_BYTES != 0 ||
        count % HAL_SIL_WORD_BYTES != 0) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        if (sil->parameters[offset + i] != 0xff) {
            return false;
        }
    }
    memcpy(&sil->parameters[offset], data, count);
    return true;
}

static bool parameters_read(void *context, uint32_t offset, void *data, size_t count)
{
    const struct hal_sil *sil = context;
    if (!in_store(offset, count)) {
        return false;
    }
    memcpy(data, &sil->parameters[offset], count);
    return true;
}

void hal_sil_init(struct hal_sil *sil, const struct hal_facts *facts)
{
    memset(sil, 0, sizeof *sil);
    memset(sil->parameters, 0xff, sizeof sil->parameters);
    sil->control_period = UINT32_MAX;
    sil->inputs = HAL_INPUTS; /* nothing is wired */
    sil->facts = *facts;
    sil->facts.parameter_page_bytes = HAL_SIL_PAGE_BYTES;
    sil->facts.parameter_word_bytes = HAL_SIL_WORD_BYTES;
    const double cycles_per_period = 2.0 * facts->pwm_half_period_counts;
    const double cycles_per_s = cycles_per_period / facts->control_period_s + 0.5;
    sil->facts.cycle_counter_Hz = cycles_per_s < 4e9 ? (uint32_t)cycles_per_s : 4000000000u;

    sil->board.context = sil;
    sil->board.facts = &sil->facts;
    sil->board.version = "steadystep " STEADYSTEP_VERSION " simulated";
    sil->board.bridge_enable = bridge_enable;
    sil->board.bridge_disable = bridge_disable;
    sil->board.bridge_temperature = bridge_temperature;
    sil->board.inputs_read = inputs_read;
    sil->board.outputs_write = outputs_write;
    if (facts->has_encoder_index) {
        sil->board.encoder_index = encoder_index;
    }
    sil->board.cycle_count = cycle_count;
    sil->board.time_us = time_us;
    sil->board.watchdog_feed = watchdog_feed;
    sil->board.start_cause = start_cause;
    sil->board.follow_control = follow_control;
    sil->board.stream_read = stream_read;
    sil->board.stream_write = stream_write;
    sil->board.parameters_erase = parameters_erase;
    sil->board.parameters_program = parameters_program;
    sil->board.parameters_read = parameters_read;
}

static void empty(struct hal_sil_stream *stream)
{
    stream->first = 0;
    stream->count = 0;
}

void hal_sil_restart(struct hal_sil *sil)
{
    sil->restarted = true;
    sil->outputs = 0;
    sil->follows = false;
    sil->control_period = UINT32_MAX;
    sil->bridge_allowed = false;
    sil->trip_latched = false;
    sil->watchdog_running = false;
    sil->index_awaited = HAL_INDEX_PASSED;
    sil->index_passed = false;
    empty(&sil->to_drive);
    empty(&sil->to_host);
}

void hal_sil_control_begins(struct hal_sil *sil)
{
    sil->control_period++;
}

void hal_sil_next_period(struct hal_sil *sil)
{
    sil->period++;
}

void hal_sil_index_edge(struct hal_sil *sil, bool rises, int32_t count)
{
    if (sil->index_awaited == (rises ? HAL_INDEX_RISES : HAL_INDEX_FALLS)) {
        sil->index_passed = true;
        sil->index_count = count;
    }
}

void hal_sil_trip(struct hal_sil *sil)
{
    sil->trip_latched = true;
    sil->bridge_allowed = false;
}

bool hal_sil_bridge_on(const struct hal_sil *sil)
{
    return sil->bridge_allowed;
}

size_t hal_sil_host_write(struct hal_sil *sil, const uint8_t *bytes, size_t count)
{
    return put(&sil->to_drive, bytes, count, sil->control_period);
}

size_t hal_sil_host_read(struct hal_sil *sil, uint8_t *bytes, size_t capacity)
{
    return take(&sil->to_host, bytes, capacity, -1, NULL);
}

bool hal_sil_watchdog_expired(const struct hal_sil *sil)
{
    return sil->watchdog_running &&
           time_us((void *)sil) - sil->watchdog_fed_us > HAL_SIL_WATCHDOG_US;
}
