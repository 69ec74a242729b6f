/* From a frame of a client to the motion that it commands: what the drive itself takes, by mode.
   The line adds its own: 0.24 ms of a frame of eight bytes at 921,600 baud; the background of a
   board up to a millisecond. */
#include "firmware/link/axis_motion.h"
#include "tests/unit/link_bench.h"

enum { COUNTS = 16384, CYCLE = 40 /* periods: 4 ms */, MOST = 400, TORQUE = 100 };

static void start(enum drive_feedback feedback)
{
    const struct drive_settings settings = link_bench_settings(feedback);
    const struct hal board = bench_board(link_bench_encoder_facts(COUNTS));

    link_bench_start_with(&board, &settings);
    link_bench_open();
    (void)link_bench_nmt(1, 1);
}

void setUp(void)
{
    start(DRIVE_FEEDBACK_SENSORLESS);
}

void tearDown(void)
{
}

static void put(unsigned index, unsigned sub, unsigned bytes, uint32_t value)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(index, sub, bytes, value));
}

/* RPDO1 has the controlword and an object. */
static void map(uint32_t object, unsigned type)
{
    link_bench_map_controlword_and(object);
    put(0x1400, 2, 1, type);
}

static void enable(unsigned mode)
{
    put(0x6060, 0, 1, mode);
    put(0x6040, 0, 2, 0x06);
    bench_periods(20);
    put(0x6040, 0, 2, 0x0f);
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(0x27, link_bench_get(0x6041, 0) & 0x6fu);
}

static void send(unsigned controlword, unsigned bytes, uint32_t value)
{
    char line[32];
    int length = snprintf(line, sizeof line, "t201%u%02X%02X", 2u + bytes, controlword & 255u,
                          controlword >> 8);

    for (unsigned i = 0; i < bytes; i++) {
        length += snprintf(&line[length], sizeof line - (size_t)length, "%02X",
                           (unsigned)(value >> 8 * i & 255u));
    }
    snprintf(&line[length], sizeof line - (size_t)length, "\r");
    bench_type(line);
}

static bool moves(void)
{
    struct drive_signals now;

    if (bench_link.axis.mode == CIA402_CYCLIC_TORQUE) { /* the reference follows the rotor */
        return cia402_thousandths(&bench.application, 0x6074) == TORQUE;
    }
    drive_signals_read(&bench.application.drive, &now);
    return now.omega_ref_rad_s != 0.0;
}

/* Periods until the reference moves, or the torque is in force. */
static int periods_to_motion(void)
{
    int periods = 0;

    while (!moves() && periods < MOST) {
        bench_period();
        (void)bench_heard();
        periods++;
    }
    return periods;
}

static void is(const char *mode, double least_ms, double most_ms, int periods)
{
    printf("%s: %.1f ms\n", mode, 1e3 * PERIOD_S * periods);
    TEST_ASSERT_TRUE(1e3 * PERIOD_S * periods >= least_ms - 1e-6);
    TEST_ASSERT_TRUE(1e3 * PERIOD_S * periods <= most_ms + 1e-6);
}

static void test_a_position_of_profile_position(void)
{
    enable(1);
    put(0x607a, 0, 4, 65536);
    bench_type("t20121F00\r");
    is("profile position", 1.0, 1.5, periods_to_motion());
}

static void test_a_speed_of_profile_velocity(void)
{
    map(0x60ff0020, 255);
    enable(3);
    send(0x0f, 4, 65536);
    is("profile velocity", 1.0, 1.5, periods_to_motion());
}

/* From the first target that moves: set-points before it are where the axis rests. */
static int of_cyclic_position(bool by_sync)
{
    int periods = 0;
    uint32_t target = 400;

    map(0x607a0020, by_sync ? 1 : 255);
    enable(8);
    for (; !moves() && periods < MOST; periods++) {
        if (periods % CYCLE == 0) {
            send(0x0f, 4, target);
            target += 400;
            bench_type(by_sync ? "t0800\r" : "");
        }
        bench_period();
        (void)bench_heard();
    }
    return periods;
}

/* The set-point before has the mean speed of both intervals, so that the motion begins an interval
   earlier than the target's own. */
static void test_a_target_of_cyclic_position_on_reception(void)
{
    is("cyclic position", CYCLE * 0.1 + 1.0, CYCLE * 0.1 + 1.5, of_cyclic_position(false));
}

static void test_a_target_of_cyclic_position_with_sync(void)
{
    is("cyclic position with SYNC", 2 * CYCLE * 0.1 + 1.0, 2 * CYCLE * 0.1 + 1.6,
       of_cyclic_position(true));
}

enum { SWING = 200 /* intervals */, SWINGS = 3, COURSE = SWING * SWINGS * CYCLE };

static const double amplitude = 8192.0; /* units, of 65,536 a turn */

static double course(double intervals)
{
    return amplitude * (1.0 - cos(TWO_PI * intervals / SWING));
}

/* Of what was captured from its second swing on, shifted by some periods: rms and most, units. */
static void deviation(const double *reference, int shift, double *rms, double *most)
{
    double sum = 0.0;
    int count = 0;

    *most = 0.0;
    for (int k = SWING * CYCLE; k < COURSE; k++, count++) {
        const double off = reference[k] - course((double)(k - shift) / CYCLE);

        sum += off * off;
        *most = fmax(*most, fabs(off));
    }
    *rms = sqrt(sum / count);
}

/* SYNC comes early or late by up to a quarter of an interval: the reference is the course, later.
 */
static void test_the_reference_is_the_course_whenever_sync_comes(void)
{
    static double reference[COURSE];
    static const int late[8] = {0, 9, -10, 4, -3, -9, 10, -5};
    const double unit_s = SWING * CYCLE * PERIOD_S / (TWO_PI * amplitude); /* at full speed */
    double best_rms = 1e9;
    double best_most = 0.0;
    double rms;
    double most;
    int delay = 0;

    map(0x607a0020, 1);
    enable(8);
    for (int k = 0, n = 0; k < COURSE; k++) {
        struct drive_signals now;

        if (k == n * CYCLE + (n > 1 ? late[n % 8] : 0)) {
            send(0x0f, 4, (uint32_t)(int32_t)lrint(course(n)));
            bench_type("t0800\r");
            n++;
        }
        bench_period();
        (void)bench_heard();
        drive_signals_read(&bench.application.drive, &now);
        reference[k] = now.theta_ref_rad * 65536 / TWO_PI;
    }
    for (int shift = 0; shift < 8 * CYCLE; shift++) {
        deviation(reference, shift, &rms, &most);
        if (rms < best_rms) {
            best_rms = rms;
            best_most = most;
            delay = shift;
        }
    }
    printf("reference with SYNC: %.1f ms behind the course, off by %.0f us rms, %.0f us at most\n",
           1e3 * PERIOD_S * delay, 1e6 * unit_s * best_rms, 1e6 * unit_s * best_most);
    TEST_ASSERT_INT_WITHIN(3, 4 * CYCLE + 13, delay);
    TEST_ASSERT_TRUE(unit_s * best_most < PERIOD_S);
    TEST_ASSERT_EQUAL_UINT32(0, bench.application.drive.planner.underruns);
}

static void test_a_torque_of_cyclic_torque(void)
{
    start(DRIVE_FEEDBACK_ENCODER);
    map(0x60710010, 255);
    enable(10);
    send(0x0f, 2, TORQUE);
    is("cyclic torque", 0.1, 0.3, periods_to_motion());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_position_of_profile_position);
    RUN_TEST(test_a_speed_of_profile_velocity);
    RUN_TEST(test_a_target_of_cyclic_position_on_reception);
    RUN_TEST(test_a_target_of_cyclic_position_with_sync);
    RUN_TEST(test_the_reference_is_the_course_whenever_sync_comes);
    RUN_TEST(test_a_torque_of_cyclic_torque);
    return UNITY_END();
}
