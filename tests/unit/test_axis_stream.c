/* Cyclic positions: how they are followed, made up for and cut. */
#include "firmware/link/axis_motion.h"
#include "tests/unit/link_bench.h"

enum { TURN = 65536, CYCLE = 40 /* periods: 4 ms */, LIMITED = 0x0800, OF_MODE = 0x1000 };

static const double unit_rad = TWO_PI / TURN;

static int32_t target; /* the last one that was sent */

static void put(unsigned index, unsigned sub, unsigned bytes, uint32_t value)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(index, sub, bytes, value));
}

void setUp(void)
{
    link_bench_start();
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
    put(0x1601, 0, 1, 0);
    put(0x1601, 1, 4, 0x607a0020);
    put(0x1601, 0, 1, 1);
    put(0x1401, 1, 4, 0x301);
    put(0x6060, 0, 1, 8);
    put(0x6040, 0, 2, 0x06);
    bench_periods(20);
    put(0x6040, 0, 2, 0x0f);
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(0x27, link_bench_get(0x6041, 0) & 0x6fu);
    target = 0;
}

void tearDown(void)
{
}

static uint32_t status(uint32_t bits)
{
    return link_bench_get(0x6041, 0) & bits;
}

static double reference_units(void)
{
    struct drive_signals now;

    drive_signals_read(&bench.application.drive, &now);
    return now.theta_ref_rad / unit_rad;
}

/* Sent in the present period. */
static void send(int32_t position)
{
    char line[24];

    target = position;
    snprintf(line, sizeof line, "t3014%02X%02X%02X%02X\r", (unsigned)position & 255u,
             (unsigned)position >> 8 & 255u, (unsigned)position >> 16 & 255u,
             (unsigned)position >> 24);
    bench_type(line);
}

static void pass(int periods)
{
    for (int i = 0; i < periods; i++) {
        bench_period();
        (void)bench_heard();
    }
}

/* So many targets, each this far from the last, that come on time. */
static void stream(int count, int32_t step)
{
    for (int i = 0; i < count; i++) {
        send(target + step);
        pass(CYCLE);
    }
}

static bool rests(void)
{
    return axis_motion_rests(&bench.application);
}

static uint32_t underruns(void)
{
    return bench.application.drive.planner.underruns;
}

/* From the coming of a target to its being passed, in intervals, asked an interval after the last
   one has come. */
static double lag(int32_t step)
{
    return 1.0 + (target - reference_units()) / step;
}

static void test_targets_are_passed_some_intervals_later(void)
{
    stream(50, 400);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 3.325, lag(400));
    stream(50, 400);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 3.325, lag(400));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 400 * unit_rad / 4e-3, link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE | LIMITED));
}

/* Three intervals, and what a command takes. */
static void test_the_lag_is_three_intervals_and_1_3_ms(void)
{
    put(0x60c2, 1, 1, 20);
    for (int i = 0; i < 50; i++) {
        send(target + 800);
        pass(200);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 3.0 + 1.3 / 20.0, lag(800));
}

static void test_an_interval_is_its_value_by_its_power_of_ten(void)
{
    put(0x60c2, 1, 1, 40);
    put(0x60c2, 2, 1, 0xfc); /* 1e-4 s */
    stream(50, 400);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 3.325, lag(400));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 400 * unit_rad / 4e-3, link_bench_speed_rad_s());
}

static void test_targets_that_stay_move_nothing_and_the_same_twice_ends_a_motion(void)
{
    stream(20, 0);
    TEST_ASSERT_FALSE(bench.application.drive.planner.set_points_open);
    stream(50, 400);
    stream(10, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, target, reference_units());
    pass(500);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
    stream(50, -400); /* and begins anew */
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 3.325, lag(-400));
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
}

/* Their places are taken by the motion's going on; they may come when the next one is due. */
static void test_three_targets_may_be_missing_and_a_fourth_not(void)
{
    stream(50, 400);
    for (int missing = 1; missing <= 3; missing++) {
        pass(CYCLE * missing);
        TEST_ASSERT_EQUAL_UINT8(missing, bench_link.axis.stream.owed);
        TEST_ASSERT_EQUAL_HEX32(0, status(OF_MODE)); /* follows nobody */
        target += 400 * missing;
        stream(1, 400);
        TEST_ASSERT_EQUAL_UINT8(0, bench_link.axis.stream.owed);
        TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE));
        stream(20, 400);
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 3.325, lag(400));
        TEST_ASSERT_EQUAL_UINT32(0, underruns());
    }
    pass(CYCLE * 4);
    TEST_ASSERT_EQUAL_UINT8(3, bench_link.axis.stream.owed);
    pass(CYCLE * 10);
    TEST_ASSERT_EQUAL_UINT32(1, underruns());
    pass(1000); /* goes back to the last one */
    TEST_ASSERT_DOUBLE_WITHIN(1.0, target, reference_units());
}

/* Half an interval behind its overdue time the target is the one that was missed. */
static void test_a_target_that_comes_late_is_not_followed_twice(void)
{
    stream(50, 400);
    pass(25);
    TEST_ASSERT_EQUAL_UINT8(1, bench_link.axis.stream.owed);
    send(target + 400);
    pass(15);
    TEST_ASSERT_EQUAL_UINT8(0, bench_link.axis.stream.owed);
    stream(20, 400);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 3.325, lag(400));
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
}

static void test_a_target_is_overdue_half_an_interval_behind_its_time(void)
{
    stream(50, 400);
    pass(18);
    TEST_ASSERT_EQUAL_UINT8(0, bench_link.axis.stream.owed);
    pass(5);
    TEST_ASSERT_EQUAL_UINT8(1, bench_link.axis.stream.owed);
}

static void test_targets_in_a_heap_are_one(void)
{
    stream(50, 400);
    for (int i = 0; i < 12; i++) {
        send(target + 30);
        pass(2);
    }
    TEST_ASSERT_TRUE(set_points_waiting(&bench.application.drive.planner.set_points) <= 6u);
    pass(16 + 4 * CYCLE);
    stream(20, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, target, reference_units());
}

static double speed_limit_rad_s(void)
{
    return (double)axis_motion_speed_limit(&bench.application);
}

static void test_a_jump_is_followed_at_the_speed_that_the_drive_can(void)
{
    const double acceleration = (double)axis_motion_acceleration_limit(&bench.application, 0.0f);
    double most = 0.0;
    double steepest = 0.0; /* of three intervals */
    double before[3] = {0.0};

    send(100 * TURN);
    pass(1);
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
    pass(CYCLE - 2);
    for (int i = 0; i < 100; i++) {
        send(100 * TURN);
        for (int k = 0; k < CYCLE; k++) {
            pass(1);
            most = fmax(most, link_bench_speed_rad_s());
        }
        steepest =
            fmax(steepest, (link_bench_speed_rad_s() - before[0]) / (3.0 * CYCLE * PERIOD_S));
        before[0] = before[1];
        before[1] = before[2];
        before[2] = link_bench_speed_rad_s();
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * speed_limit_rad_s(), speed_limit_rad_s(), most);
    TEST_ASSERT_DOUBLE_WITHIN(0.07 * acceleration, 0.5 * acceleration, steepest);
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
}

/* Acceleration x interval^2: the curve through set-points swings by a thirtieth of it at an end. */
static double swing_units(void)
{
    const double interval_s = CYCLE * PERIOD_S;

    return (double)axis_motion_acceleration_limit(&bench.application, 0.0f) * interval_s *
           interval_s / unit_rad;
}

/* From rest to a target that stays: the reference comes up to it, and not beyond. */
static void test_a_jump_ends_at_its_target(void)
{
    static const int32_t steps[] = {1, 20, 1600, -6554, 20000, -65536, 10 * TURN};

    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        const double way = steps[i] < 0 ? -1.0 : 1.0;
        double furthest = 0.0;

        setUp();
        for (int k = 0; k < 1000 && (k < 20 || !rests()); k++) {
            send(steps[i]);
            pass(CYCLE);
            furthest = fmax(furthest, way * reference_units());
        }
        TEST_ASSERT_TRUE(rests());
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, steps[i], reference_units());
        TEST_ASSERT_TRUE(furthest < way * steps[i] + 0.035 * fmin(swing_units(), way * steps[i]));
        TEST_ASSERT_EQUAL_HEX32(0, status(LIMITED));
    }
}

/* One that is lost or late, of a fast motion: its place is taken, and nothing is made up for. */
static void test_a_target_that_is_lost_does_not_show_in_the_speed(void)
{
    const int32_t step = (int32_t)(0.35 * speed_limit_rad_s() * CYCLE * PERIOD_S / unit_rad);
    const double speed = step * unit_rad / (CYCLE * PERIOD_S);

    for (int32_t least = 50; least < step; least += 25) { /* up to speed */
        stream(1, least);
    }
    stream(20, step);
    target += step;
    pass(CYCLE);
    for (int i = 0; i < 30; i++) {
        send(target + step);
        for (int k = 0; k < CYCLE; k++) {
            pass(1);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * speed, speed, link_bench_speed_rad_s());
        }
    }
    TEST_ASSERT_EQUAL_HEX32(0, status(LIMITED));
}

/* A master that is faster than 60c2h: what is too much is left out. */
static void test_targets_that_come_too_fast_end_at_the_last_one(void)
{
    static const int every[] = {20, 30, 38, 39};

    for (size_t i = 0; i < 4; i++) {
        setUp();
        for (int k = 0; k < 200; k++) {
            send(target + 300);
            pass(every[i]);
        }
        for (int k = 0; k < 300; k++) {
            send(target);
            pass(every[i]);
        }
        TEST_ASSERT_TRUE(rests());
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, target, reference_units());
    }
}

/* Neither by what takes the place of a target that does not come. */
static void test_a_stream_that_ends_before_a_software_limit_does_not_pass_it(void)
{
    put(0x607d, 2, 4, TURN);
    for (int32_t step = 50; target < TURN - 2 * step; step += step < 1500 ? 25 : 0) {
        stream(1, step);
    }
    for (int k = 0; k < 4000; k++) {
        pass(1);
        TEST_ASSERT_TRUE(reference_units() < TURN + 0.5 * swing_units());
    }
}

/* A stream that goes on beyond is no reason to pass it. */
static void test_a_stream_stops_at_a_software_limit(void)
{
    put(0x607d, 2, 4, 3 * TURN);
    put(0x607d, 1, 4, (uint32_t)(-2 * TURN));
    for (int k = 0; k < 400; k++) {
        send(target + 2000);
        pass(CYCLE);
        TEST_ASSERT_TRUE(reference_units() < 3 * TURN + 0.035 * swing_units());
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 3 * TURN, reference_units());
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
    target = 3 * TURN;
    for (int k = 0; k < 700; k++) {
        send(target - 2000);
        pass(CYCLE);
        TEST_ASSERT_TRUE(reference_units() > -2 * TURN - 0.035 * swing_units());
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -2 * TURN, reference_units());
}

/* Of less than three control periods no set-points are made, and nothing goes there otherwise. */
static void test_an_interval_that_is_none_is_said(void)
{
    put(0x60c2, 1, 1, 2);
    put(0x60c2, 2, 1, (uint8_t)-4);
    stream(20, 400);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_DOUBLE(0.0, reference_units());
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED | OF_MODE));
}

static void test_a_halt_takes_no_target_and_is_no_following(void)
{
    stream(50, 400);
    put(0x6040, 0, 2, 0x10f);
    pass(4000);
    TEST_ASSERT_TRUE(rests());
    stream(20, 400);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_HEX32(0, status(OF_MODE));
    put(0x6040, 0, 2, 0x0f);
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE));
}

static void test_a_target_beyond_a_software_limit_is_cut(void)
{
    put(0x607d, 2, 4, 3000);
    stream(20, 400);
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
    stream(10, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 3000, reference_units());
    TEST_ASSERT_TRUE(bench_link.axis.motion.target_rad < 3000.5 * unit_rad);
}

/* In another mode a target position is but a number. */
static void test_other_modes_follow_no_stream(void)
{
    put(0x6060, 0, 1, 3);
    pass(20);
    stream(20, 400);
    TEST_ASSERT_FALSE(bench.application.drive.planner.set_points_open);
    TEST_ASSERT_TRUE(rests());
}

/* ---- with SYNC ---- */

static void by_sync(void)
{
    put(0x1401, 2, 1, 1);
}

/* From a SYNC to the passing of its target; the target itself takes a pass before. */
static double lag_of_sync(int32_t step)
{
    return lag(step) - 1.0 / CYCLE;
}

/* The question takes a period. */
static void shows(uint32_t bits, uint32_t asked)
{
    TEST_ASSERT_EQUAL_HEX32(bits, status(asked));
}

/* A target, and the SYNC with which it acts. */
static void send_with_sync(int32_t position)
{
    send(position);
    bench_type("t0800\r");
}

/* So many, each SYNC `periods` behind the last one. */
static void sync_stream(int count, int32_t step, int periods)
{
    for (int i = 0; i < count; i++) {
        send_with_sync(target + step);
        pass(periods);
    }
}

static void test_a_target_of_a_sync_is_passed_four_intervals_and_1_3_ms_behind_it(void)
{
    by_sync();
    sync_stream(50, 400, CYCLE);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 4.325, lag_of_sync(400));
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 400 * unit_rad / 4e-3, link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE | LIMITED));
    sync_stream(10, 0, CYCLE);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, target, reference_units());
    pass(500);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
}

static void test_a_target_waits_for_its_sync(void)
{
    by_sync();
    send(400);
    pass(10 * CYCLE);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_FALSE(bench.application.drive.planner.set_points_open);
}

/* Late by up to a quarter of an interval and early by as much: the course knows nothing of it. */
static void test_jitter_of_sync_is_none_of_the_reference(void)
{
    static const int late[8] = {0, 9, -10, 19, -3, -18, 12, -20};

    by_sync();
    sync_stream(50, 400, CYCLE);
    for (int i = 0; i < 400; i++) {
        sync_stream(1, 400, CYCLE + late[(i + 1) % 8] / 2 - late[i % 8] / 2);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 400 * unit_rad / 4e-3, link_bench_speed_rad_s());
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 4.325, lag_of_sync(400));
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
}

/* A master whose interval is 2.5 thousandths longer, or shorter: 100 periods in 1,000 cycles. */
static void follows_a_clock_that_is_off(int by)
{
    const double speed = 400 * unit_rad / 4e-3;

    by_sync();
    sync_stream(50, 400, CYCLE);
    for (int i = 0; i < 2000; i++) {
        sync_stream(1, 400, CYCLE + (i % 10 == 0 ? by : 0));
        TEST_ASSERT_DOUBLE_WITHIN(6e-3 * speed, speed, link_bench_speed_rad_s());
    }
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 4.325, lag_of_sync(400));
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE | LIMITED));
}

static void test_the_clock_is_the_sync_of_a_master_that_is_slow(void)
{
    follows_a_clock_that_is_off(1);
}

static void test_the_clock_is_the_sync_of_a_master_that_is_fast(void)
{
    follows_a_clock_that_is_off(-1);
}

/* Where the phase is off, set-points are between targets: on the parabola through these. */
static void test_a_course_is_passed_between_its_targets(void)
{
    int32_t begin;

    by_sync();
    for (int i = 0; i < 1500; i++) {
        sync_stream(1, 400, CYCLE + (i % 10 == 0 ? 1 : 0));
    }
    begin = target;
    for (int i = 1; i <= 20; i++) { /* decelerates: 400 i - 10 i^2 */
        sync_stream(1, 400 - 10 * (2 * i - 1), CYCLE);
        const double at = i + (double)bench_link.axis.stream.ahead - 1.0;

        TEST_ASSERT_DOUBLE_WITHIN(0.4, 0.5, at - floor(at)); /* truly between */
        if (i >= 3) {
            TEST_ASSERT_DOUBLE_WITHIN(0.01, begin + 400 * at - 10 * at * at,
                                      bench_link.axis.stream.last_rad / unit_rad);
        }
    }
}

/* It is the interval that the count goes by: the next one is where it would have been. */
static void test_a_sync_without_a_target_is_an_interval_too(void)
{
    by_sync();
    sync_stream(50, 400, CYCLE);
    for (int missing = 1; missing <= 3; missing++) {
        for (int i = 0; i < missing; i++) {
            pass(1); /* where a target would be */
            bench_type("t0800\r");
            pass(CYCLE - 1);
        }
        target += 400 * missing;
        sync_stream(1, 400, CYCLE);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 4.325, lag_of_sync(400));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 400 * unit_rad / 4e-3, link_bench_speed_rad_s());
        sync_stream(5, 400, CYCLE);
    }
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
    bench_type("t0800\r");
    pass(CYCLE);
    shows(0, OF_MODE);
    for (int i = 1; i < 12; i++) {
        bench_type("t0800\r");
        pass(CYCLE);
    }
    TEST_ASSERT_EQUAL_UINT32(1, underruns());
    pass(500);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_DOUBLE_WITHIN(1.0, target, reference_units());
}

/* As of a master that was away: what has come meanwhile is counted, and the delay is the old one.
 */
static void test_syncs_that_come_late_and_in_a_heap_are_counted(void)
{
    by_sync();
    sync_stream(50, 400, CYCLE);
    pass(3 * CYCLE - 1);
    shows(0, OF_MODE);
    sync_stream(4, 400, 1);
    pass(CYCLE - 4);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 400 * unit_rad / 4e-3, link_bench_speed_rad_s());
    sync_stream(20, 400, CYCLE);
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 4.325, lag_of_sync(400));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * link_bench_speed_rad_s(), 400 * unit_rad / 4e-3,
                              link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE));
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
}

static void test_the_fourth_sync_in_a_row_that_is_missing_ends_the_motion(void)
{
    by_sync();
    sync_stream(50, 400, CYCLE);
    pass(CYCLE * 14);
    TEST_ASSERT_EQUAL_UINT32(1, underruns());
    pass(500);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_DOUBLE_WITHIN(1.0, target, reference_units());
    sync_stream(100, 400, CYCLE); /* and begins anew */
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 4.325, lag_of_sync(400));
    TEST_ASSERT_EQUAL_UINT32(1, underruns());
}

/* The delay, shorter by those that are lost, is made up for by and by. */
static void test_lost_syncs_are_made_up_for_slowly(void)
{
    by_sync();
    sync_stream(50, 400, CYCLE);
    pass(CYCLE);
    sync_stream(1, 400, CYCLE);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 3.325, lag_of_sync(400));
    for (int i = 0; i < 1000; i++) {
        sync_stream(1, 400, CYCLE);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * link_bench_speed_rad_s(), 400 * unit_rad / 4e-3,
                                  link_bench_speed_rad_s());
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 4.325, lag_of_sync(400));
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
}

/* What was overdue of a SYNC is nothing that a later target would have to make up for. */
static void test_targets_without_sync_are_followed_behind_syncs_that_are_lost(void)
{
    by_sync();
    sync_stream(50, 400, CYCLE);
    pass(3 * CYCLE - 1);
    shows(0, OF_MODE);
    put(0x1401, 2, 1, 255);
    target += 1200;
    stream(20, 400);
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE | LIMITED));
    TEST_ASSERT_EQUAL_UINT32(0, underruns());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_targets_are_passed_some_intervals_later);
    RUN_TEST(test_the_lag_is_three_intervals_and_1_3_ms);
    RUN_TEST(test_an_interval_is_its_value_by_its_power_of_ten);
    RUN_TEST(test_targets_that_stay_move_nothing_and_the_same_twice_ends_a_motion);
    RUN_TEST(test_three_targets_may_be_missing_and_a_fourth_not);
    RUN_TEST(test_a_target_that_comes_late_is_not_followed_twice);
    RUN_TEST(test_a_target_is_overdue_half_an_interval_behind_its_time);
    RUN_TEST(test_targets_in_a_heap_are_one);
    RUN_TEST(test_a_jump_is_followed_at_the_speed_that_the_drive_can);
    RUN_TEST(test_a_jump_ends_at_its_target);
    RUN_TEST(test_a_target_that_is_lost_does_not_show_in_the_speed);
    RUN_TEST(test_targets_that_come_too_fast_end_at_the_last_one);
    RUN_TEST(test_a_stream_that_ends_before_a_software_limit_does_not_pass_it);
    RUN_TEST(test_a_stream_stops_at_a_software_limit);
    RUN_TEST(test_an_interval_that_is_none_is_said);
    RUN_TEST(test_a_halt_takes_no_target_and_is_no_following);
    RUN_TEST(test_a_target_beyond_a_software_limit_is_cut);
    RUN_TEST(test_other_modes_follow_no_stream);
    RUN_TEST(test_a_target_of_a_sync_is_passed_four_intervals_and_1_3_ms_behind_it);
    RUN_TEST(test_a_target_waits_for_its_sync);
    RUN_TEST(test_jitter_of_sync_is_none_of_the_reference);
    RUN_TEST(test_the_clock_is_the_sync_of_a_master_that_is_slow);
    RUN_TEST(test_the_clock_is_the_sync_of_a_master_that_is_fast);
    RUN_TEST(test_a_course_is_passed_between_its_targets);
    RUN_TEST(test_a_sync_without_a_target_is_an_interval_too);
    RUN_TEST(test_syncs_that_come_late_and_in_a_heap_are_counted);
    RUN_TEST(test_the_fourth_sync_in_a_row_that_is_missing_ends_the_motion);
    RUN_TEST(test_lost_syncs_are_made_up_for_slowly);
    RUN_TEST(test_targets_without_sync_are_followed_behind_syncs_that_are_lost);
    return UNITY_END();
}
