/*
 * Replays a recorded closed-loop input through the firmware image and compares drive_hash with the
 * one the host reached. Runs on the target (and on the host, where it proves the recording).
 */
#include <stdalign.h>
#include <stddef.h>
#include <stdint.h>

#include "tests/target/replay_case.h"
#include REPLAY_DATA /* replay_facts, replay_case_name, replay_input, replay_drive_hash */
#include "tests/target/report.h"

/* The host has memory for a drive in double too. */
#ifdef __arm__
enum { DRIVE_BYTES_LIMIT = 8640 }; /* with its application: settings in force and as set */
#else
enum { DRIVE_BYTES_LIMIT = 16384 };
#endif

static bool always(void *context)
{
    (void)context;
    return true;
}

static void nothing(void *context)
{
    (void)context;
}

/* An empty parameter store. */
static bool unreadable(void *context, uint32_t offset, void *data, size_t count)
{
    (void)context;
    (void)offset;
    (void)data;
    (void)count;
    return false;
}

/* A line on which nothing comes and which takes everything. */
static size_t nothing_read(void *context, uint8_t *bytes, size_t capacity, uint32_t *line_period)
{
    (void)context;
    (void)bytes;
    (void)capacity;
    (void)line_period;
    return 0;
}

static size_t all_written(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    (void)bytes;
    return count;
}

static const char *replayed(void *context)
{
    (void)context;
    return "replay";
}

static const struct hal board = {.facts = &replay_facts,
                                 .version = "replay",
                                 .bridge_enable = always,
                                 .bridge_disable = nothing,
                                 .watchdog_feed = nothing,
                                 .start_cause = replayed,
                                 .stream_read = nothing_read,
                                 .stream_write = all_written,
                                 .parameters_read = unreadable};

static int fail(const char *reason)
{
    report_text(reason);
    report_text("\n");
    return 1;
}

int main(void)
{
    static alignas(max_align_t) unsigned char drive[DRIVE_BYTES_LIMIT];
    static struct drive_settings settings;
    static char error[DRIVE_ERROR_TEXT];
    const struct firmware_image *image = &REPLAY_IMAGE;
    const struct replay_case *which = replay_case_named(replay_case_name);

    if (image->drive_bytes > sizeof drive)
        return fail("the drive is larger than its memory");
    replay_settings(which, &settings);
    if (!image->init(drive, &board, &settings, error))
        return fail(error);

    int next_command = 0;
    int32_t encoder_count = 0;
    for (uint32_t k = 0; k < REPLAY_PERIODS; ++k) {
        while (next_command < which->command_count &&
               which->commands[next_command].at_period <= k + 1) {
            if (!image->command(drive, &which->commands[next_command++], error))
                return fail(error);
        }
        const struct replay_samples *input = &replay_input[k];

        encoder_count += input->encoder_step;
        struct hal_samples samples = {.current_a = input->current_a,
                                      .current_b = input->current_b,
                                      .bus_voltage = input->bus_voltage,
                                      .phase_voltage_a = input->phase_voltage_a,
                                      .phase_voltage_b = input->phase_voltage_b,
                                      .encoder_count = encoder_count};
        (void)image->control_cycle(drive, &samples);
        image->background(drive);
    }

    uint64_t hash = image->hash(drive);
    report_number("drive_bytes ", image->drive_bytes);
    report_number("drive_hash ", hash);
    report_number("host       ", replay_drive_hash);
    return hash == replay_drive_hash ? 0 : fail("drive_hash differs from the host's");
}
