/* An application on a board without a motor: what is typed goes in, what it writes comes out. */
#ifndef STEADYSTEP_CONSOLE_BENCH_H
#define STEADYSTEP_CONSOLE_BENCH_H

#include <string.h>

#include "firmware/application/application.h"
#include "tests/unit/bench.h"

enum { BENCH_PAGE = 800, BENCH_PAGES = 4, BENCH_STREAM = 1400, BENCH_TYPED = 410, BENCH_LINES = 8 };

struct console_bench {
    struct application application;
    uint32_t period; /* of the last control interrupt that has begun */
    char typed[BENCH_TYPED];
    uint32_t line_period[BENCH_LINES];
    size_t lines_typed, lines_read;
    size_t typed_count, typed_read;
    char written[BENCH_STREAM];
    size_t written_count;
    size_t room;  /* of the line to the host, per call */
    size_t piece; /* most that one reading brings; 0: all that has come */
    int watchdog_fed;
    int periods_between; /* control interrupts while the background feeds the watchdog, or reads */
    bool bridge_was_on;  /* in one of them */
    bool follows;        /* application_follow_control, behind the control interrupt */
    bool trip_latched;   /* refuses to enable the bridge until it has been disabled */
    bool bridge_enabled;
    uint8_t store[BENCH_PAGE * BENCH_PAGES];
    bool worn; /* the first page of each of the store's logs refuses to be programmed */
    size_t bytes_until_power_fails; /* of those that are programmed; then nothing is written */
    uint32_t inputs, outputs;       /* levels of the machine's */
    struct hal_samples samples;
};

static struct console_bench bench;

static inline bool bench_bridge_enable(void *context)
{
    struct console_bench *b = context;

    b->bridge_enabled = !b->trip_latched;
    return b->bridge_enabled;
}

static inline void bench_bridge_disable(void *context)
{
    struct console_bench *b = context;

    b->bridge_enabled = false;
    b->trip_latched = false;
}

/* A control interrupt. No motor: the currents are noise, or their phases would be taken for open.
 */
static inline const struct hal_outputs *bench_interrupt(void)
{
    const int noise = 60 * ((int)(bench.period % 3u) - 1);
    struct hal_samples samples = bench.samples;

    bench.period++;
    bench.application.drive.phase_watch.wrong = 0u; /* nor is a voltage there to be measured */
    samples.current_a = (uint16_t)(samples.current_a + noise);
    samples.current_b = (uint16_t)(samples.current_b + noise);

    const struct hal_outputs *outputs = application_control_interrupt(&bench.application, &samples);

    if (bench.follows) {
        application_follow_control(&bench.application);
    }
    return outputs;
}

static inline void bench_follow_control(void *context, bool follows)
{
    ((struct console_bench *)context)->follows = follows;
}

/* What a real background does not notice, if it takes its time. */
static inline void bench_interrupts_between(struct console_bench *b)
{
    for (int i = 0; i < b->periods_between; i++) {
        b->bridge_was_on |= bench_interrupt()->bridge_on;
    }
}

static inline uint32_t bench_inputs_read(void *context)
{
    return ((const struct console_bench *)context)->inputs;
}

static inline void bench_outputs_write(void *context, uint32_t levels)
{
    ((struct console_bench *)context)->outputs = levels;
}

static inline void bench_watchdog_feed(void *context)
{
    struct console_bench *b = context;

    b->watchdog_fed++;
    bench_interrupts_between(b);
}

static inline uint64_t bench_time_us(void *context)
{
    return 100u * (uint64_t)((struct console_bench *)context)->period;
}

static inline const char *bench_start_cause(void *context)
{
    (void)context;
    return "crash: hard fault at 0x08001234";
}

static inline size_t bench_stream_read(void *context, uint8_t *bytes, size_t capacity,
                                       uint32_t *line_period)
{
    struct console_bench *b = context;
    const size_t most = b->piece != 0u && b->piece < capacity ? b->piece : capacity;
    size_t count = 0;

    while (count < most && b->typed_read < b->typed_count) {
        bytes[count++] = (uint8_t)b->typed[b->typed_read++];
        if (bytes[count - 1] == '\n') {
            *line_period = b->line_period[b->lines_read++ % BENCH_LINES];
            bench_interrupts_between(b);
            break;
        }
    }
    return count;
}

static inline size_t bench_stream_write(void *context, const uint8_t *bytes, size_t count)
{
    struct console_bench *b = context;
    const size_t taken = count < b->room ? count : b->room;

    memcpy(&b->written[b->written_count], bytes, taken);
    b->written_count += taken;
    b->written[b->written_count] = '\0';
    return taken;
}

static inline bool bench_erase(void *context, uint32_t page)
{
    struct console_bench *b = context;

    if (b->bytes_until_power_fails > 0u) {
        memset(&b->store[page * BENCH_PAGE], 0xff, BENCH_PAGE);
    }
    return page < BENCH_PAGES;
}

static inline bool bench_program(void *context, uint32_t offset, const void *data, size_t count)
{
    struct console_bench *b = context;
    const size_t left = b->bytes_until_power_fails;
    const size_t done = count < left ? count : left;

    if (b->worn && offset / BENCH_PAGE % 2u == 0u) {
        return false;
    }
    memcpy(&b->store[offset], data, done);
    b->bytes_until_power_fails -= done;
    return true;
}

static inline bool bench_read(void *context, uint32_t offset, void *data, size_t count)
{
    memcpy(data, &((struct console_bench *)context)->store[offset], count);
    return true;
}

static inline struct hal bench_board(const struct hal_facts *facts)
{
    return (struct hal){
        .context = &bench,
        .facts = facts,
        .version = "version",
        .bridge_enable = bench_bridge_enable,
        .bridge_disable = bench_bridge_disable,
        .inputs_read = bench_inputs_read,
        .outputs_write = bench_outputs_write,
        .time_us = bench_time_us,
        .watchdog_feed = bench_watchdog_feed,
        .start_cause = bench_start_cause,
        .follow_control = bench_follow_control,
        .stream_read = bench_stream_read,
        .stream_write = bench_stream_write,
        .parameters_erase = bench_erase,
        .parameters_program = bench_program,
        .parameters_read = bench_read,
    };
}

static inline struct hal_facts bench_stored_facts(void)
{
    struct hal_facts facts = bench_facts;

    facts.parameter_page_bytes = BENCH_PAGE;
    facts.parameter_word_bytes = 8;
    return facts;
}

/* No current, no voltage, 24 V on the bus. */
static inline void bench_power_up(void)
{
    memset(&bench, 0, sizeof bench); /* no copy on the stack of a small core */
    bench.period = UINT32_MAX;
    bench.room = BENCH_STREAM;
    bench.inputs = HAL_INPUTS;
    bench.bytes_until_power_fails = SIZE_MAX;
    bench.samples = (struct hal_samples){.current_a = 2048, .current_b = 2048, .bus_voltage = 3151};
    memset(bench.store, 0xff, sizeof bench.store);
}

/* A drive that is ready in the second period after an enable. */
static inline struct drive_settings bench_quick_settings(void)
{
    struct drive_settings settings;

    drive_settings_default(&settings, &bench_params);
    settings.calibrate_offsets = false;
    settings.hold_on_enable = false;
    settings.synchronism_policy = DRIVE_SYNCHRONISM_OFF; /* the rotor here follows nothing */
    return settings;
}

static inline bool bench_start(const struct drive_settings *settings)
{
    static struct hal_facts facts;
    char error[DRIVE_ERROR_TEXT] = "";

    facts = bench_stored_facts();
    const struct hal board = bench_board(&facts);

    return application_init_with(&bench.application, &board, settings, error);
}

/* The control interrupt and one turn of the main loop. */
static inline void bench_period(void)
{
    (void)bench_interrupt();
    application_background(&bench.application);
}

static inline void bench_periods(int count)
{
    for (int i = 0; i < count; i++) {
        bench_period();
    }
}

/* Control interrupts while the background is busy elsewhere. */
static inline void bench_interrupts(int count)
{
    for (int i = 0; i < count; i++) {
        (void)bench_interrupt();
    }
}

/* Arrive in the present period; nothing is read yet. */
static inline void bench_type_bytes(const char *bytes, size_t count)
{
    if (bench.typed_read == bench.typed_count) {
        bench.typed_read = bench.typed_count = 0;
    }
    for (size_t i = 0; i < count; i++) {
        if (bytes[i] == '\n') {
            bench.line_period[bench.lines_typed++ % BENCH_LINES] = bench.period;
        }
        bench.typed[bench.typed_count++] = bytes[i];
    }
}

static inline void bench_type(const char *text)
{
    bench_type_bytes(text, strlen(text));
}

/* What has been written since the last call; valid until more is written. */
static inline const char *bench_heard(void)
{
    const bool silent = bench.written_count == 0u;

    bench.written_count = 0;
    return silent ? "" : bench.written;
}

/* The answer to a line that is read in the next turn of the main loop. */
static inline const char *bench_ask(const char *line)
{
    (void)bench_heard();
    bench_type(line);
    bench_type("\n");
    for (int i = 0; i < CONSOLE_LINE_BYTES / CONSOLE_PIECE_BYTES + 2; i++) {
        application_background(&bench.application);
    }
    return bench_heard();
}

#endif
