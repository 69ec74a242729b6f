/* Cyclic synchronous torque of a drive with an encoder, of which the test turns the rotor. */
#include "firmware/drive/board_limits.h"
#include "firmware/link/axis_torque.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_motion.h"
#include "tests/unit/link_bench.h"

enum { COUNTS = 16384, TURN = 65536, REACHED = 0x0400, LIMITED = 0x0800, OF_MODE = 0x1000 };

enum { LITTLE = 100 };

static double speed_rad_s; /* of the rotor */
static double angle_rad;

static void start(enum drive_feedback feedback)
{
    struct drive_settings settings = link_bench_settings(feedback);
    const struct hal board = bench_board(link_bench_encoder_facts(COUNTS));

    bench.inputs = 0; /* none is active */
    settings.inputs_used = HAL_INPUT_LIMIT_MINUS | HAL_INPUT_LIMIT_PLUS;
    link_bench_start_with(&board, &settings);
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
    speed_rad_s = 0.0;
    angle_rad = 0.0;
}

void setUp(void)
{
    start(DRIVE_FEEDBACK_ENCODER);
}

void tearDown(void)
{
}

/* The currents are those that the drive expects. */
static void run(int periods)
{
    for (int k = 0; k < periods; k++) {
        link_bench_expected_currents();
        angle_rad += speed_rad_s * PERIOD_S;
        bench.samples.encoder_count = (int32_t)floor(angle_rad / TWO_PI * COUNTS);
        bench_period();
    }
    TEST_ASSERT_EQUAL_STRING("none", drive_fault_name(bench.application.drive.supervision.fault));
}

static void put(unsigned index, unsigned sub, unsigned bytes, int32_t value)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(index, sub, bytes, (uint32_t)value));
}

static int demand(void)
{
    run(2);
    return (int16_t)link_bench_get(0x6074, 0);
}

static uint32_t status(uint32_t bits)
{
    return link_bench_get(0x6041, 0) & bits;
}

static void enable(void)
{
    put(0x6060, 0, 1, 10);
    put(0x6040, 0, 2, 0x06);
    run(20);
    put(0x6040, 0, 2, 0x0f);
    run(20);
    TEST_ASSERT_EQUAL_HEX32(0x27, status(0x6f));
    TEST_ASSERT_EQUAL(10, link_bench_get(0x6061, 0));
}

static bool leads(void)
{
    return interrupt_view_torque(&bench.application.drive);
}

static void test_the_mode_is_there_with_an_encoder_and_only_so(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x2a5, link_bench_get(0x6502, 0));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x6060, 0, 1, 10));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(0x6060, 0, 1, 4));
    start(DRIVE_FEEDBACK_SENSORLESS);
    TEST_ASSERT_EQUAL_HEX32(0xa5, link_bench_get(0x6502, 0));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(0x6060, 0, 1, 10));
    TEST_ASSERT_EQUAL_HEX32(1, link_bench_get(0x6060, 0));
}

static void test_the_target_is_the_demand_in_thousandths_of_the_rated_torque(void)
{
    put(0x6071, 0, 2, LITTLE);
    enable();
    TEST_ASSERT_EQUAL(LITTLE, demand());
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE | LIMITED | REACHED));
    put(0x6071, 0, 2, -LITTLE);
    TEST_ASSERT_EQUAL(-LITTLE, demand());
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, -1e-3 * LITTLE * 0.157 * 3.0,
                              num_to_double(bench.application.drive.torque.current) *
                                  bench.application.drive.base.torque_Nm);
}

static void test_a_target_beyond_the_largest_torque_is_cut_and_said(void)
{
    put(0x6072, 0, 2, LITTLE / 2);
    put(0x6071, 0, 2, LITTLE);
    enable();
    TEST_ASSERT_EQUAL(LITTLE / 2, demand());
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
    put(0x6072, 0, 2, 1000);
    TEST_ASSERT_EQUAL(LITTLE, demand());
    TEST_ASSERT_EQUAL_HEX32(0, status(LIMITED));
}

/* The supply drives less the faster it turns; what accelerates it limits by itself. */
static void test_a_torque_that_brakes_a_fast_rotor_is_what_the_supply_drives(void)
{
    const struct drive_settings *settings = &bench.application.drive.settings;
    const double rated_A = settings->motor.rated_current_A;

    put(0x6071, 0, 2, -1000);
    enable();
    for (int speed = 20; speed <= 100; speed += 20) {
        bench_link.axis.signals.omega_est_rad_s = speed;
        bench_link.axis.signals_in = bench.application.drive.supervision.period;
        axis_torque_background(&bench.application);
        const double braking_A = (double)board_limits_current(
                                     settings, bench.application.drive.board->facts, (float)speed)
                                     .braking_A;
        const double expected = fmin(1000.0, 750.0 * braking_A / rated_A);

        TEST_ASSERT_DOUBLE_WITHIN(16.0, -expected, bench_link.axis.motion.target);
        TEST_ASSERT_EQUAL(expected < 1000.0, bench_link.axis.motion.limited);
        bench_periods(20);
    }
}

static void test_the_speed_is_held_below_6080h(void)
{
    const double limit = (double)(axis_motion_speed_limit(&bench.application) / AXIS_RAD_S_PER_RPM);

    TEST_ASSERT_DOUBLE_WITHIN(1.0, limit, link_bench_get(0x6080, 0));
    TEST_ASSERT_EQUAL_HEX32(OBJECT_OUT_OF_RANGE, link_bench_put(0x6080, 0, 4, 0));
    put(0x6080, 0, 4, 60);
    put(0x6071, 0, 2, LITTLE);
    enable();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, TWO_PI,
                              num_to_double(bench.application.drive.torque.speed) *
                                  bench.application.drive.base.speed_rad_s);
    put(0x6080, 0, 4, 1000000);
    run(5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, axis_motion_speed_limit(&bench.application),
                              num_to_double(bench.application.drive.torque.speed) *
                                  bench.application.drive.base.speed_rad_s);
    put(0x6080, 0, 4, 1); /* less than the drive takes */
    run(5);
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_get(0x6041, 0) & 0x0080u);
    TEST_ASSERT_TRUE(leads());
}

static void test_a_halt_holds_and_lets_it_go_on(void)
{
    put(0x6071, 0, 2, LITTLE);
    enable();
    put(0x6040, 0, 2, 0x10f);
    run(100);
    TEST_ASSERT_FALSE(leads());
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(REACHED | OF_MODE));
    put(0x6040, 0, 2, 0x0f);
    TEST_ASSERT_EQUAL(LITTLE, demand());
}

static void test_a_quick_stop_controls_the_position(void)
{
    put(0x6071, 0, 2, LITTLE);
    enable();
    put(0x605a, 0, 2, 6);
    put(0x6040, 0, 2, 0x02);
    run(100);
    TEST_ASSERT_FALSE(leads());
    TEST_ASSERT_EQUAL_HEX32(0x07, status(0x6f));
    put(0x6040, 0, 2, 0x0f);
    TEST_ASSERT_EQUAL(LITTLE, demand());
}

static void test_another_mode_begins_at_rest(void)
{
    put(0x6071, 0, 2, LITTLE);
    enable();
    put(0x6060, 0, 1, 8);
    run(200);
    TEST_ASSERT_EQUAL(8, link_bench_get(0x6061, 0));
    TEST_ASSERT_FALSE(leads());
    put(0x6060, 0, 1, 10);
    TEST_ASSERT_EQUAL(LITTLE, demand());
}

static void test_a_torque_ends_where_it_pushes_beyond_a_software_limit(void)
{
    put(0x607d, 2, 4, TURN);
    put(0x6071, 0, 2, LITTLE);
    enable();
    TEST_ASSERT_TRUE(leads());
    put(0x607d, 2, 4, -TURN); /* behind the rotor */
    run(100);
    TEST_ASSERT_FALSE(leads());
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED | OF_MODE));
    put(0x6071, 0, 2, 0);
    run(20);
    TEST_ASSERT_FALSE(leads());
    put(0x6071, 0, 2, -LITTLE);
    TEST_ASSERT_EQUAL(-LITTLE, demand());
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(LIMITED | OF_MODE));
}

static void test_a_torque_ends_before_a_software_limit_by_its_way_to_stop(void)
{
    put(0x607d, 1, 4, -TURN);
    put(0x6085, 0, 4, 1000000); /* 96 rad/s^2 */
    put(0x6071, 0, 2, 0);
    enable();
    speed_rad_s = -20.0;
    for (int k = 0; k < 3000 && leads(); k++) {
        run(1);
    }
    /* 20 rad/s: a ramp of 2.1 rad, its ends, and what a ramp that is under way may take */
    TEST_ASSERT_DOUBLE_WITHIN(0.05, -TWO_PI + 3.91, angle_rad);
}

static void test_what_moves_away_from_a_limit_may_be_braked(void)
{
    put(0x607d, 2, 4, 1000);
    put(0x6071, 0, 2, -LITTLE);
    enable();
    speed_rad_s = -20.0;
    run(20);
    put(0x6071, 0, 2, LITTLE);
    run(20);
    TEST_ASSERT_TRUE(leads());
}

static void test_a_limit_switch_stops_what_pushes_on_and_lets_the_way_back(void)
{
    put(0x6071, 0, 2, LITTLE);
    enable();
    bench.inputs = HAL_INPUT_LIMIT_PLUS;
    run(100);
    TEST_ASSERT_FALSE(leads());
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED | OF_MODE));
    put(0x6071, 0, 2, -LITTLE);
    TEST_ASSERT_EQUAL(-LITTLE, demand());
    speed_rad_s = 1.0; /* it goes on for a while, or seems to */
    run(25);
    TEST_ASSERT_TRUE(leads());
    put(0x6071, 0, 2, 0);
    run(25);
    TEST_ASSERT_FALSE(leads()); /* coasts further */
}

/* A cam: until the torque points away. */
static void test_a_limit_switch_that_is_passed_bars_the_way(void)
{
    put(0x6071, 0, 2, LITTLE);
    enable();
    bench.inputs = HAL_INPUT_LIMIT_PLUS;
    run(60);
    bench.inputs = 0;
    run(500);
    TEST_ASSERT_FALSE(leads());
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED | OF_MODE));
    put(0x6071, 0, 2, -LITTLE);
    TEST_ASSERT_EQUAL(-LITTLE, demand());
    put(0x6071, 0, 2, LITTLE);
    TEST_ASSERT_EQUAL(LITTLE, demand());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_mode_is_there_with_an_encoder_and_only_so);
    RUN_TEST(test_the_target_is_the_demand_in_thousandths_of_the_rated_torque);
    RUN_TEST(test_a_target_beyond_the_largest_torque_is_cut_and_said);
    RUN_TEST(test_a_torque_that_brakes_a_fast_rotor_is_what_the_supply_drives);
    RUN_TEST(test_the_speed_is_held_below_6080h);
    RUN_TEST(test_a_halt_holds_and_lets_it_go_on);
    RUN_TEST(test_a_quick_stop_controls_the_position);
    RUN_TEST(test_another_mode_begins_at_rest);
    RUN_TEST(test_a_torque_ends_where_it_pushes_beyond_a_software_limit);
    RUN_TEST(test_a_torque_ends_before_a_software_limit_by_its_way_to_stop);
    RUN_TEST(test_what_moves_away_from_a_limit_may_be_braked);
    RUN_TEST(test_a_limit_switch_stops_what_pushes_on_and_lets_the_way_back);
    RUN_TEST(test_a_limit_switch_that_is_passed_bars_the_way);
    return UNITY_END();
}
