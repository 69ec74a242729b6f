/* A drive with a fieldbus link on a board without a motor: lines of slcan in, frames out. */
#ifndef STEADYSTEP_LINK_BENCH_H
#define STEADYSTEP_LINK_BENCH_H

#include <stdio.h>

#include <unity.h>

#include "tests/unit/console_bench.h"

static struct link bench_link;

static inline void link_bench_start_drive(const struct drive_settings *settings)
{
    bench_power_up();
    (void)bench_start(settings);
    application_put_link(&bench.application, &bench_link);
    bench_periods(3);
    (void)bench_heard();
}

static inline void link_bench_start(void)
{
    const struct drive_settings settings = bench_quick_settings();

    link_bench_start_drive(&settings);
}

/* Of a board like the bench's that has just been powered up, with an encoder; they stay. */
static inline struct hal_facts *link_bench_encoder_facts(uint32_t counts_per_turn)
{
    static struct hal_facts facts;

    bench_power_up();
    facts = bench_stored_facts();
    facts.encoder_counts_per_turn = counts_per_turn;
    return &facts;
}

/* The quick ones, of an encoder whose zero is known, or without it. */
static inline struct drive_settings link_bench_settings(enum drive_feedback feedback)
{
    struct drive_settings settings = bench_quick_settings();

    drive_settings_select_feedback(&settings, feedback);
    settings.encoder_zero_known = true;
    return settings;
}

static inline void link_bench_start_with(const struct hal *board,
                                         const struct drive_settings *settings)
{
    char error[DRIVE_ERROR_TEXT] = "";

    TEST_ASSERT_TRUE_MESSAGE(application_init_with(&bench.application, board, settings, error),
                             error);
    application_put_link(&bench.application, &bench_link);
    bench_periods(3);
    (void)bench_heard();
}

static inline uint16_t link_bench_code(num_t current)
{
    const double current_A = num_to_double(current) * bench.application.drive.base.current_A;

    return (uint16_t)(2048.5 + current_A / bench_facts.current_A_per_code);
}

/* The currents of the next period are those that the drive expects. */
static inline void link_bench_expected_currents(void)
{
    const struct phases current = bench.application.drive.estimator.estimate.next.current;

    bench.samples.current_a = link_bench_code(current.a);
    bench.samples.current_b = link_bench_code(current.b);
}

/* What comes within some periods of a line, its '\r' left out. */
static inline const char *link_bench_say(const char *line, int periods)
{
    (void)bench_heard();
    bench_type(line);
    bench_type("\r");
    bench_periods(periods);
    return bench_heard();
}

/* A command of network management to the node; what comes within some periods. */
static inline const char *link_bench_nmt(unsigned command, int periods)
{
    char line[16];

    snprintf(line, sizeof line, "t0002%02X01", command);
    return link_bench_say(line, periods);
}

static inline void link_bench_heard(const char *part, const char *heard)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(heard, part), heard);
}

static inline void link_bench_open(void)
{
    (void)link_bench_say("O", 1);
}

/* The answer to an SDO request of eight bytes as hexadecimal digits, without its "t5818". */
static inline const char *link_bench_sdo(const char *request)
{
    static char answer[32];
    char line[64];
    const char *found;

    snprintf(line, sizeof line, "t6018%s", request);
    found = strstr(link_bench_say(line, 1), "t5818");
    snprintf(answer, sizeof answer, "%.16s", found == NULL ? "" : found + 5);
    return answer;
}

/* Writes up to four bytes; the abort code, 0: done. */
static inline uint32_t link_bench_put(unsigned index, unsigned sub, unsigned bytes, uint32_t value)
{
    char request[40];
    const char *answer;
    unsigned byte[4] = {0};

    snprintf(request, sizeof request, "%02X%02X%02X%02X%02X%02X%02X%02X", 0x23u | (4u - bytes) << 2,
             index & 255u, index >> 8, sub, (unsigned)(value & 255u), (unsigned)(value >> 8 & 255u),
             (unsigned)(value >> 16 & 255u), (unsigned)(value >> 24));
    answer = link_bench_sdo(request);
    TEST_ASSERT_EQUAL_STRING_LEN(&request[2], &answer[2], 6);
    if (strncmp(answer, "80", 2) != 0) {
        TEST_ASSERT_EQUAL_STRING_LEN("60", answer, 2);
        return 0;
    }
    TEST_ASSERT_EQUAL(4,
                      sscanf(&answer[8], "%2x%2x%2x%2x", &byte[0], &byte[1], &byte[2], &byte[3]));
    return byte[0] | byte[1] << 8 | byte[2] << 16 | byte[3] << 24;
}

/* Reads up to four bytes. */
static inline uint32_t link_bench_get(unsigned index, unsigned sub)
{
    char request[40];
    unsigned byte[4] = {0};

    snprintf(request, sizeof request, "40%02X%02X%02X00000000", index & 255u, index >> 8, sub);
    const char *answer = link_bench_sdo(request);

    TEST_ASSERT_EQUAL_STRING_LEN("4", answer, 1);
    TEST_ASSERT_EQUAL_STRING_LEN(&request[2], &answer[2], 6);
    TEST_ASSERT_EQUAL(4,
                      sscanf(&answer[8], "%2x%2x%2x%2x", &byte[0], &byte[1], &byte[2], &byte[3]));
    return byte[0] | byte[1] << 8 | byte[2] << 16 | byte[3] << 24;
}

/* Behind the controlword in RPDO1: index << 16 | bits. */
static inline void link_bench_map_controlword_and(uint32_t object)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1400, 1, 4, 0x80000201));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1600, 0, 1, 0));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1600, 2, 4, object));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1600, 0, 1, 2));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1400, 1, 4, 0x201));
}

/* The reference's. */
static inline double link_bench_reference_rad(void)
{
    struct drive_signals now;

    drive_signals_read(&bench.application.drive, &now);
    return now.theta_ref_rad;
}

/* Likewise. */
static inline double link_bench_speed_rad_s(void)
{
    struct drive_signals now;

    drive_signals_read(&bench.application.drive, &now);
    return now.omega_ref_rad_s;
}

/* How often a frame that begins so stands in what has come. */
static inline int link_bench_count(const char *begin, const char *heard)
{
    int count = 0;

    while ((heard = strstr(heard, begin)) != NULL) {
        count++;
        heard++;
    }
    return count;
}

#endif
