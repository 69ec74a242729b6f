#include "firmware/link/capture.h"

#include <stdatomic.h>
#include <string.h>

#include "firmware/application/application.h"
#include "firmware/interface/dictionary.h"
#include "firmware/link/link.h"

#define SOURCE(path, base)                     {offsetof(struct drive, path), sizeof(((struct drive *)0)->path), base},
#define SOURCE_COUNT(index, member, path, ...) SOURCE(path, CAPTURE_COUNT)
#define SOURCE_ANGLE(index, member, path, ...) SOURCE(path, CAPTURE_ANGLE)
#define SOURCE_REAL(index, member, path, brief, traced, in, ...)                                   \
    SOURCE(path, offsetof(struct per_unit, in) / sizeof(double))

static const struct capture_source sources[SIGNALS] = {
    DRIVE_SIGNALS_TABLE(SOURCE_COUNT, SOURCE_COUNT, SOURCE_ANGLE, SOURCE_COUNT, SOURCE_REAL)};

static uint32_t words_of(const struct capture_source *source)
{
    return (source->bytes + 3u) / 4u;
}

/* ---- the interrupt ---- */

static union capture_raw raw_of(const struct capture_source *source, const void *from)
{
    union capture_raw raw = {.position = {0}};

    if (source->bytes == sizeof(uint8_t)) {
        raw.count = *(const uint8_t *)from;
    } else if (source->bytes == sizeof(uint32_t)) {
        memcpy(&raw.count, from, sizeof raw.count);
    } else {
        memcpy(&raw.position, from, sizeof raw.position);
    }
    return raw;
}

static bool is_above(const struct capture *capture, const struct drive *drive)
{
    const struct capture_source *trigger = capture->trigger;
    const union capture_raw now = raw_of(trigger, (const uint8_t *)drive + trigger->offset);

    if (trigger->base == CAPTURE_COUNT) {
        return now.count > capture->level.count;
    }
    if (trigger->base == CAPTURE_ANGLE) {
        return position_distance(capture->level.position, now.position) > 0;
    }
    return now.real > capture->level.real;
}

static void put_sample(struct capture *capture, const struct drive *drive)
{
    uint32_t *to = &capture->memory[(size_t)capture->head * capture->record_words];

    for (uint32_t i = 0; i < capture->signals; i++) {
        const struct capture_source *source = capture->source[i];
        const union capture_raw raw = raw_of(source, (const uint8_t *)drive + source->offset);

        memcpy(to, &raw, sizeof(uint32_t));
        if (source->bytes > sizeof(uint32_t)) {
            memcpy(to, &raw, sizeof raw);
        }
        to += words_of(source);
    }
    capture->head = capture->head + 1u == capture->samples ? 0u : capture->head + 1u;
}

static bool triggers(struct capture *capture, const struct drive *drive)
{
    const bool at_once = capture->trigger == NULL;
    const bool above = !at_once && is_above(capture, drive);
    const bool crosses = capture->known && above != capture->above && above == capture->rises;

    capture->above = above;
    capture->known = true;
    return at_once || crosses;
}

static void take_sample(struct capture *capture, const struct drive *drive)
{
    put_sample(capture, drive);
    if (capture->state == CAPTURE_RECORDS) {
        capture->left--;
        capture->state = capture->left == 0u ? CAPTURE_DONE : CAPTURE_RECORDS;
        return;
    }
    const bool now = triggers(capture, drive);

    if (capture->state == CAPTURE_FILLS) {
        capture->left--;
        capture->state = capture->left == 0u ? CAPTURE_WAITS : CAPTURE_FILLS;
    } else if (now) {
        capture->began_in = drive->supervision.period;
        capture->left = capture->samples - capture->before - 1u;
        capture->state = capture->left == 0u ? CAPTURE_DONE : CAPTURE_RECORDS;
    }
}

void capture_follow(struct capture *capture, const struct drive *drive)
{
    if (capture->state == CAPTURE_IDLE || capture->state == CAPTURE_DONE) {
        return;
    }
    if (capture->wait > 0u) {
        capture->wait--;
        return;
    }
    capture->wait = (uint16_t)(capture->divider - 1u);
    take_sample(capture, drive);
}

/* ---- the background ---- */

enum capture_state capture_state_of(const struct capture *capture)
{
    atomic_signal_fence(memory_order_seq_cst); /* read now */
    return (enum capture_state)capture->state;
}

static void follow(struct application *application, bool follows)
{
    struct capture *capture = &application->link->capture;

    if (capture->followed != follows) {
        capture->followed = follows;
        application->board.follow_control(application->board.context, follows);
    }
}

static const struct capture_source *source_of(uint16_t index)
{
    for (int i = 0; i < SIGNALS; i++) {
        if (signal_at((enum drive_signal)i)->index == index) {
            return &sources[i];
        }
    }
    return NULL;
}

static double base_of(const struct drive *drive, const struct capture_source *source)
{
    double base;

    memcpy(&base, (const uint8_t *)&drive->base + source->base * sizeof base, sizeof base);
    return base;
}

/* The nearest to a level that a count may be. */
static uint32_t count_of(double level)
{
    if (level >= UINT32_MAX) {
        return UINT32_MAX;
    }
    return level > 0.0 ? (uint32_t)level : 0u;
}

static void put_level(struct capture *capture, const struct drive *drive, double level)
{
    if (capture->trigger->base == CAPTURE_COUNT) {
        capture->level.count = count_of(level);
    } else if (capture->trigger->base == CAPTURE_ANGLE) {
        capture->level.position = position_minus(
            position_from_rad(level, drive->settings.motor.rotor_teeth), drive->axis.offset);
    } else {
        capture->level.real = num_from_double(level / base_of(drive, capture->trigger));
    }
}

/* false: a signal that is not there, or none at all. */
static bool choose_signals(struct capture *capture, const struct link_objects *objects)
{
    const uint16_t *wanted = &objects->capture_1;

    capture->signals = 0;
    capture->record_words = 0;
    for (size_t i = 0; i < CAPTURE_SIGNALS && wanted[i] != 0u; i++) {
        const struct capture_source *source = source_of(wanted[i]);

        if (source == NULL) {
            return false;
        }
        capture->source[capture->signals++] = source;
        capture->record_words += words_of(source);
    }
    return capture->signals > 0u;
}

bool capture_arm(struct application *application, const struct link_objects *objects)
{
    struct capture *capture = &application->link->capture;

    capture_end(application);
    capture->trigger = source_of(objects->capture_trigger);
    if (capture->memory == NULL || !choose_signals(capture, objects) ||
        (capture->trigger == NULL && objects->capture_trigger != 0u)) {
        return false;
    }
    const uint32_t room = capture->words / capture->record_words;
    const uint32_t asked = objects->capture_samples;

    if (asked > room || objects->capture_before >= (asked == 0u ? room : asked)) {
        return false;
    }
    if (capture->trigger != NULL) {
        put_level(capture, &application->drive, objects->capture_level);
    }
    capture->samples = asked == 0u ? room : asked;
    capture->before = objects->capture_before;
    capture->left = capture->before;
    capture->divider = objects->capture_divider;
    capture->rises = objects->capture_edge >= 0;
    capture->known = false;
    capture->wait = 0;
    capture->head = 0;
    atomic_signal_fence(memory_order_seq_cst);
    capture->state = capture->before > 0u ? CAPTURE_FILLS : CAPTURE_WAITS;
    follow(application, true);
    return true;
}

void capture_end(struct application *application)
{
    follow(application, false);
    application->link->capture.state = CAPTURE_IDLE;
}

void capture_look(struct application *application)
{
    if (capture_state_of(&application->link->capture) == CAPTURE_DONE) {
        follow(application, false);
    }
}

double capture_value(const struct application *application, uint32_t sample, uint32_t signal)
{
    const struct capture *capture = &application->link->capture;
    const struct drive *drive = &application->drive;
    const struct capture_source *source = capture->source[signal];
    const uint32_t record = (capture->head + sample) % capture->samples;
    const uint32_t *from = &capture->memory[(size_t)record * capture->record_words];

    for (uint32_t i = 0; i < signal; i++) {
        from += words_of(capture->source[i]);
    }
    union capture_raw raw = {.position = {0}};

    memcpy(&raw, from, sizeof(uint32_t) * words_of(source));
    if (source->base == CAPTURE_COUNT) {
        return (double)raw.count;
    }
    if (source->base == CAPTURE_ANGLE) {
        return position_to_rad(position_plus(raw.position, drive->axis.offset),
                               drive->settings.motor.rotor_teeth);
    }
    return num_to_double(raw.real) * base_of(drive, source);
}

uint32_t capture_period(const struct capture *capture, uint32_t sample)
{
    return capture->began_in + (sample - capture->before) * capture->divider;
}

uint32_t capture_bytes(const struct capture *capture)
{
    return capture_state_of(capture) == CAPTURE_DONE
               ? capture->samples * capture->signals * CAPTURE_VALUE_BYTES
               : 0u;
}

void capture_copy(const struct application *application, uint32_t offset, uint8_t *to, size_t count)
{
    const uint32_t signals = application->link->capture.signals;
    uint8_t value[CAPTURE_VALUE_BYTES];

    for (size_t i = 0; i < count; i++, offset++) {
        const uint32_t number = offset / CAPTURE_VALUE_BYTES;

        if (i == 0u || offset % CAPTURE_VALUE_BYTES == 0u) {
            const double real = capture_value(application, number / signals, number % signals);

            memcpy(value, &real, sizeof value);
        }
        to[i] = value[offset % CAPTURE_VALUE_BYTES];
    }
}

void capture_put(struct text *text, const struct application *application, uint32_t sample)
{
    const struct capture *capture = &application->link->capture;
    const uint32_t samples = capture_bytes(capture) > 0u ? capture->samples : 0u;

    if (sample >= samples) {
        text_put(text, "samples=");
        text_unsigned(text, samples);
        return;
    }
    text_put(text, "period=");
    text_unsigned(text, capture_period(capture, sample));
    for (uint32_t i = 0; i < capture->signals; i++) {
        text_put(text, " ");
        text_put(text, signal_at((enum drive_signal)(capture->source[i] - sources))->name);
        text_put(text, "=");
        text_number(text, capture_value(application, sample, i), TEXT_DIGITS_MAX);
    }
}
