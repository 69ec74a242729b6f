/* What the modes of the drive profile make of a target: limits, ramps, windows, halts. */
#include "firmware/link/axis_motion.h"
#include "firmware/drive/board_limits.h"
#include "tests/unit/link_bench.h"

enum { TURN = 65536, REACHED = 0x0400, LIMITED = 0x0800, OF_MODE = 0x1000, OFF = 0x2000 };

static const double unit_rad = TWO_PI / TURN;

void setUp(void)
{
    link_bench_start();
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
}

void tearDown(void)
{
}

static void put(unsigned index, unsigned sub, unsigned bytes, uint32_t value)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(index, sub, bytes, value));
}

static uint32_t get(unsigned index)
{
    return link_bench_get(index, 0);
}

static void control(unsigned word)
{
    put(0x6040, 0, 2, word);
}

static uint32_t status(uint32_t bits)
{
    return get(0x6041) & bits;
}

static void enable(int mode)
{
    put(0x6060, 0, 1, (uint32_t)mode);
    control(0x06);
    bench_periods(20);
    control(0x0f);
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(0x27, status(0x6f));
}

static bool rests(void)
{
    return axis_motion_rests(&bench.application);
}

/* Greatest change of the reference's speed in a period from now on, rad/s^2, until it is constant
   for 20 ms; how long that takes in `periods`. */
static double greatest_acceleration(int *periods)
{
    double before = link_bench_speed_rad_s();
    double most = 0.0;
    int constant = 0;

    *periods = 0;
    while (constant < 200) {
        bench_period();
        const double change = fabs(link_bench_speed_rad_s() - before) / PERIOD_S;

        most = fmax(most, change);
        constant = change == 0.0 ? constant + 1 : 0;
        *periods += change == 0.0 ? 0 : 1;
        before = link_bench_speed_rad_s();
    }
    return most;
}

static double speed_limit_rad_s(void)
{
    const struct drive *drive = &bench.application.drive;

    return 0.999 * board_limits_speed(&drive->settings, drive->board->facts).rad_s;
}

static double acceleration_limit_rad_s2(void)
{
    return 0.999 * bench.application.drive.settings.current_limit_A *
           bench_params.torque_constant_Nm_A / bench_params.inertia_kgm2;
}

/* What nine tenths of the current that the supply drives at a speed accelerate, or brake. */
static double supplied_rad_s2(double speed_rad_s, bool brakes)
{
    const struct motor_params *motor = &bench.application.drive.settings.motor;
    const double volts =
        (1.0 - 2.0 * bench_facts.low_state_s / bench_facts.control_period_s) * motor->supply_V;
    const double emf_V = motor->torque_constant_Nm_A * speed_rad_s;
    const double across = motor->rotor_teeth * motor->inductance_H * speed_rad_s;
    double least_A = 0.0, most_A = volts / motor->resistance_ohm * 10.0;

    for (int i = 0; i < 100; i++) { /* where the voltage is used up */
        const double current_A = 0.5 * (least_A + most_A);
        const double along = emf_V + (brakes ? -1.0 : 1.0) * motor->resistance_ohm * current_A;

        if (hypot(along, across * current_A) < volts) {
            least_A = current_A;
        } else {
            most_A = current_A;
        }
    }
    const double current_A = fmin(0.9 * least_A, bench.application.drive.settings.current_limit_A);

    return 0.999 * current_A * motor->torque_constant_Nm_A / motor->inertia_kgm2;
}

/* ---- units ---- */

static void test_profile_quantities_come_from_the_motor(void)
{
    const double acceleration = acceleration_limit_rad_s2() / unit_rad;

    TEST_ASSERT_DOUBLE_WITHIN(5.0, 0.25 * speed_limit_rad_s() / unit_rad, get(0x6081));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * acceleration, 0.25 * acceleration, get(0x6083));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * acceleration, 0.5 * acceleration, get(0x6085));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, speed_limit_rad_s(),
                              axis_motion_speed_limit(&bench.application));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, acceleration_limit_rad_s2(),
                              axis_motion_acceleration_limit(&bench.application, 0.0f));
}

static void test_gear_and_feed_say_what_a_unit_is(void)
{
    put(0x6091, 1, 4, 3);
    put(0x6091, 2, 4, 2);
    put(0x6092, 1, 4, 1000);
    put(0x6092, 2, 4, 7);
    enable(1);
    put(0x6081, 0, 4, 50);
    put(0x6083, 0, 4, 500);
    put(0x607a, 0, 4, 30);
    control(0x1f);
    bench_periods(12000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 30.0 * TWO_PI * 7.0 * 3.0 / (1000.0 * 2.0),
                              link_bench_reference_rad());
    TEST_ASSERT_EQUAL_INT(30, (int)get(0x6062));
}

static void test_quantities_are_shown_in_units_rounded(void)
{
    const double bus_mV = 1e3 * 3151.0 * bench_facts.bus_V_per_code;

    enable(3);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, bus_mV, get(0x6079));
    put(0x60ff, 0, 4, (uint32_t)-3000);
    bench_periods(3000);
    TEST_ASSERT_INT_WITHIN(1, -3000, (int32_t)get(0x606b));
    put(0x60ff, 0, 4, 0);
    bench_periods(3000);
    TEST_ASSERT_INT_WITHIN(1, lround(link_bench_reference_rad() / unit_rad), (int32_t)get(0x6062));
    TEST_ASSERT_TRUE(link_bench_reference_rad() < -0.05);

    struct drive_signals now;

    drive_signals_read(&bench.application.drive, &now);
    TEST_ASSERT_INT_WITHIN(1, lround(now.theta_est_rad / unit_rad), (int32_t)get(0x6064));
    TEST_ASSERT_INT_WITHIN(1, lround((now.theta_ref_rad - now.theta_est_rad) / unit_rad),
                           (int32_t)get(0x60f4));
    TEST_ASSERT_INT_WITHIN(1, lround(now.omega_est_rad_s / unit_rad), (int32_t)get(0x606c));
    TEST_ASSERT_NOT_EQUAL(get(0x6062), get(0x6064));
}

/* ---- ramps ---- */

/* A ramp with a quarter of it as jerk phases takes 5/4 of speed over acceleration. */
static void test_a_speed_is_reached_by_its_acceleration_and_jerk(void)
{
    int periods;

    enable(3);
    put(0x6083, 0, 4, 10 * TURN);
    put(0x6084, 0, 4, 10 * TURN);
    put(0x60ff, 0, 4, TURN);
    bench_periods(1); /* beside this line of the bus */
    TEST_ASSERT_DOUBLE_WITHIN(0.7, 10.0 * TWO_PI, greatest_acceleration(&periods));
    TEST_ASSERT_INT_WITHIN(6, 1250, periods);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, TWO_PI, link_bench_speed_rad_s());
    put(0x60ff, 0, 4, (uint32_t)-TURN);
    TEST_ASSERT_DOUBLE_WITHIN(0.7, 10.0 * TWO_PI, greatest_acceleration(&periods));
    TEST_ASSERT_INT_WITHIN(6, 2250, periods);
}

/* No jerk phase is shorter than 2 ms. */
static void test_a_quick_stop_brakes_by_its_own_deceleration(void)
{
    int periods;

    enable(3);
    put(0x6085, 0, 4, 20 * TURN);
    put(0x60ff, 0, 4, 2 * TURN);
    bench_periods(8000);
    control(0x0b);
    TEST_ASSERT_DOUBLE_WITHIN(0.8, 20.0 * TWO_PI, greatest_acceleration(&periods));
    TEST_ASSERT_INT_WITHIN(6, 1020, periods);
    bench_periods(520); /* the rotor follows to its rest */
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, bench.application.drive.supervision.state);
}

/* As quickly as it has begun: the quick stop's jerk alone would let it go on for 90 ms. */
static void test_a_quick_stop_ends_a_much_steeper_acceleration_at_once(void)
{
    double most = 0.0;

    enable(3);
    put(0x6083, 0, 4, 300 * TURN);
    put(0x6085, 0, 4, 20 * TURN);
    put(0x60ff, 0, 4, 8 * TURN);
    while (link_bench_speed_rad_s() < 4.0 * TWO_PI) {
        bench_period();
    }
    control(0x0b);
    for (int i = 0; i < 3000; i++) {
        bench_period();
        most = fmax(most, link_bench_speed_rad_s());
    }
    TEST_ASSERT_TRUE(most < 6.0 * TWO_PI);
}

static void test_speed_and_acceleration_beyond_what_the_drive_can_are_cut_and_said(void)
{
    int periods;

    enable(3);
    put(0x6083, 0, 4, 0xffffffff);
    put(0x6084, 0, 4, 0xffffffff);
    put(0x60ff, 0, 4, 0x7fffffff);
    const double most = greatest_acceleration(&periods);

    TEST_ASSERT_DOUBLE_WITHIN(0.01 * most,
                              fmin(supplied_rad_s2(speed_limit_rad_s(), true),
                                   supplied_rad_s2(0.875 * speed_limit_rad_s(), false)),
                              most);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, speed_limit_rad_s(), link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_HEX32(LIMITED | REACHED, status(LIMITED | REACHED));
    put(0x60ff, 0, 4, 0x80000001);
    bench_periods(4000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -speed_limit_rad_s(), link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
    put(0x60ff, 0, 4, TURN);
    bench_periods(4000);
    TEST_ASSERT_EQUAL_HEX32(0, status(LIMITED));
}

/* A quick stop, too, at each of its speeds: what the supply does not drive the rotor does not
   follow. Slower it drives more. */
static void test_a_stop_is_no_steeper_than_the_supply_drives_it(void)
{
    for (int share = 1; share <= 4; share++) {
        double most = 0.0;

        setUp();
        enable(3);
        put(0x6085, 0, 4, 0xffffffff);
        put(0x60ff, 0, 4, (uint32_t)(0.25 * share * speed_limit_rad_s() / unit_rad));
        bench_periods(12000);
        control(0x0b);
        for (double speed = link_bench_speed_rad_s(); speed > 0.0;) {
            bench_period();
            const double change = (speed - link_bench_speed_rad_s()) / PERIOD_S;

            TEST_ASSERT_TRUE(change < 1.01 * supplied_rad_s2(speed, true));
            most = fmax(most, change);
            speed = link_bench_speed_rad_s();
        }
        TEST_ASSERT_TRUE(most > 0.8 * acceleration_limit_rad_s2());
    }
}

static void test_no_speed_is_above_6080h_once_it_is_given(void)
{
    enable(3);
    put(0x60ff, 0, 4, 3 * TURN);
    bench_periods(6000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 3.0 * TWO_PI, link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_HEX32(0, status(LIMITED));
    put(0x6080, 0, 4, 60);
    bench_periods(6000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, TWO_PI, link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
}

/* A unit that grows under way would be another speed at once, and a turned one its reverse. */
static void test_units_and_directions_change_at_rest_and_out_of_operation_alone(void)
{
    static const unsigned indexes[] = {0x607e, 0x6091, 0x6092};

    for (size_t i = 0; i < 3; i++) {
        const unsigned sub = i == 0 ? 0 : 1, bytes = i == 0 ? 1 : 4;

        setUp();
        enable(3);
        TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(indexes[i], sub, bytes, 0x40));
        put(0x60ff, 0, 4, 2 * TURN);
        bench_periods(6000);
        control(0x07); /* brakes in SWITCHED ON */
        TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(indexes[i], sub, bytes, 0x40));
        bench_periods(6000);
        put(indexes[i], sub, bytes, 0x40);
    }
}

static void test_an_operation_begins_at_rest(void)
{
    static const unsigned words[] = {0x07, 0x0b};

    for (size_t i = 0; i < 2; i++) {
        setUp();
        put(0x605a, 0, 2, 6);
        enable(1);
        put(0x607a, 0, 4, 20 * TURN);
        control(0x1f);
        bench_periods(2000);
        control(words[i]);
        bench_periods(20);
        control(0x0f);
        bench_periods(20);
        TEST_ASSERT_NOT_EQUAL(0x27, status(0x6f));
        bench_periods(6000);
        TEST_ASSERT_EQUAL_HEX32(0x27, status(0x6f));
        const double rest_rad = link_bench_reference_rad();

        put(0x607a, 0, 4, TURN / 8);
        control(0x5f);
        bench_periods(6000);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, rest_rad + TWO_PI / 8.0, link_bench_reference_rad());
    }
}

static void test_a_least_position_is_not_above_the_most(void)
{
    put(0x607d, 1, 4, (uint32_t)-100);
    put(0x607d, 2, 4, 100);
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x607d, 1, 4, 101));
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x607d, 2, 4, (uint32_t)-101));
}

static void test_the_speed_counts_as_reached_within_a_thousandth(void)
{
    enable(3);
    TEST_ASSERT_EQUAL_HEX32(REACHED | OF_MODE, status(REACHED | OF_MODE)); /* 0, and at rest */
    put(0x6083, 0, 4, TURN);
    put(0x6084, 0, 4, TURN);
    put(0x60ff, 0, 4, TURN);
    bench_periods(200);
    TEST_ASSERT_EQUAL_HEX32(0, status(REACHED | OF_MODE));
    while (link_bench_speed_rad_s() < 0.9985 * TWO_PI) {
        bench_period();
    }
    TEST_ASSERT_EQUAL_HEX32(0, status(REACHED));
    bench_periods(2000);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(REACHED | OF_MODE));
    put(0x60ff, 0, 4, (uint32_t)-TURN);
    bench_periods(10);
    TEST_ASSERT_EQUAL_HEX32(0, status(REACHED));
    while (link_bench_speed_rad_s() > -0.9985 * TWO_PI) {
        bench_period();
    }
    TEST_ASSERT_EQUAL_HEX32(0, status(REACHED));
    bench_periods(2000);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(REACHED));
}

static void test_a_halt_of_a_speed_brakes_and_lets_it_go_on(void)
{
    enable(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(4000);
    control(0x10f);
    bench_periods(4000);
    TEST_ASSERT_TRUE(rests());
    put(0x60ff, 0, 4, 2 * TURN); /* waits for the end of the halt */
    bench_periods(2000);
    TEST_ASSERT_TRUE(rests());
    control(0x0f);
    bench_periods(4000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 2.0 * TWO_PI, link_bench_speed_rad_s());
}

/* ---- a speed and the software limits ---- */

static void begin_speed(int32_t units, int periods)
{
    put(0x60ff, 0, 4, (uint32_t)units);
    bench_periods(periods);
}

static void test_a_speed_ends_at_either_software_limit_and_goes_back_from_it(void)
{
    enable(3);
    put(0x6084, 0, 4, 20 * TURN);
    put(0x607d, 1, 4, (uint32_t)(-TURN / 4));
    put(0x607d, 2, 4, 3 * TURN);
    begin_speed(4 * TURN, 4000);
    TEST_ASSERT_EQUAL_HEX32(0, status(LIMITED));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 4 * TWO_PI, link_bench_speed_rad_s());
    bench_periods(8000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_INT(3 * TURN, (int)get(0x6062));
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED | REACHED));
    begin_speed(TURN, 2000); /* still beyond */
    TEST_ASSERT_EQUAL_INT(3 * TURN, (int)get(0x6062));
    begin_speed(-TURN, 8000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -TWO_PI, link_bench_speed_rad_s());
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(LIMITED | REACHED));
    begin_speed(-8 * TURN, 20000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_INT(-TURN / 4, (int32_t)get(0x6062));
}

/* Whatever the speed, the ramps and what is in motion: never further than the limit. */
static void test_no_speed_passes_a_software_limit(void)
{
    enable(3);
    for (int i = 1; i <= 12; i++) {
        const int32_t limit = i % 2 ? TURN + 999 * i : -TURN - 999 * i;

        put(0x607d, 1, 4, (uint32_t)(limit < 0 ? limit : INT32_MIN));
        put(0x607d, 2, 4, (uint32_t)(limit > 0 ? limit : INT32_MAX));
        put(0x6083, 0, 4, (uint32_t)(i % 3 * 300 + 20) * TURN);
        put(0x6084, 0, 4, (uint32_t)(i % 5 * 100 + 20) * TURN);
        put(0x60ff, 0, 4, (uint32_t)(limit < 0 ? -i * TURN : i * TURN));
        double furthest = 0.0;

        for (int n = 0; n < 30000; n++) {
            bench_period();
            const double past =
                (link_bench_reference_rad() / unit_rad - limit) * (limit < 0 ? -1 : 1);

            furthest = n == 0 ? past : fmax(furthest, past);
        }
        TEST_ASSERT_TRUE(rests());
        TEST_ASSERT_DOUBLE_WITHIN(0.5, 0.0, furthest);
    }
}

static void test_a_limit_that_moves_is_gone_to_and_one_that_is_passed_stops(void)
{
    enable(3);
    put(0x607d, 2, 4, TURN);
    begin_speed(TURN / 2, 30000);
    TEST_ASSERT_EQUAL_INT(TURN, (int)get(0x6062));
    put(0x607d, 2, 4, TURN + 300); /* further off, but near */
    bench_periods(15000);
    TEST_ASSERT_EQUAL_INT(TURN + 300, (int)get(0x6062));
    put(0x607d, 2, 4, INT32_MAX);
    bench_periods(8000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, TWO_PI / 2, link_bench_speed_rad_s());
    put(0x607d, 2, 4, 0);
    bench_periods(8000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
}

/* The motion to the limit is commanded behind it. */
static void test_a_limit_that_comes_near_while_a_command_waits_is_kept(void)
{
    enable(3);
    put(0x6084, 0, 4, 20 * TURN);
    begin_speed(TURN, 8000);
    put(0x60ff, 0, 4, 2 * TURN);
    TEST_ASSERT_TRUE(command_queue_holds_any(&bench.application.drive.commands));
    const int32_t limit = (int32_t)lround(link_bench_reference_rad() / unit_rad) + TURN / 8;

    put(0x607d, 2, 4, (uint32_t)limit);
    TEST_ASSERT_TRUE(command_queue_holds_any(&bench.application.drive.commands));
    bench_periods(8000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_INT(limit, (int32_t)get(0x6062));
}

static void test_a_halt_before_a_limit_goes_on_to_it(void)
{
    enable(3);
    put(0x6084, 0, 4, 2 * TURN);
    put(0x607d, 2, 4, TURN);
    begin_speed(TURN, 3000);
    while (!bench_link.axis.motion.at_limit) {
        bench_period();
    }
    control(0x10f);
    bench_periods(15000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_TRUE(get(0x6062) < TURN - 1000);
    control(0x0f);
    bench_periods(20000);
    TEST_ASSERT_EQUAL_INT(TURN, (int)get(0x6062));
}

/* ---- polarity ---- */

static void test_polarity_turns_positions_and_speeds_each_for_itself(void)
{
    put(0x607e, 0, 1, 0x80);
    enable(1);
    put(0x607a, 0, 4, 1000);
    control(0x1f);
    bench_periods(6000);
    control(0x0f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -1000 * unit_rad, link_bench_reference_rad());
    TEST_ASSERT_EQUAL_INT(1000, (int)get(0x6062));
    put(0x607a, 0, 4, 500);
    control(0x5f); /* relative */
    bench_periods(6000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -1500 * unit_rad, link_bench_reference_rad());
    put(0x6060, 0, 1, 3);
    put(0x607d, 1, 4, (uint32_t)-TURN);
    begin_speed(TURN / 2, 20);
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x607e, 0, 1, 0)); /* in operation */
    bench_periods(30000);
    TEST_ASSERT_EQUAL_INT(-TURN, (int32_t)get(0x6062)); /* the motor's way up */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, TWO_PI, link_bench_reference_rad());
    control(0x00);
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(0x06090030, link_bench_put(0x607e, 0, 1, 0x20));
    put(0x607e, 0, 1, 0x40);
    enable(3);
    put(0x607d, 1, 4, (uint32_t)INT32_MIN);
    begin_speed(TURN / 2, 6000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -TWO_PI / 2, link_bench_speed_rad_s());
    TEST_ASSERT_INT_WITHIN(1, TURN / 2, (int32_t)get(0x606b));
}

static void test_homing_has_the_polarity_too(void)
{
    put(0x607e, 0, 1, 0x80);
    enable(6);
    put(0x607c, 0, 4, 1000);
    control(0x1f);
    bench_periods(20);
    TEST_ASSERT_EQUAL_INT(1000, (int)get(0x6062));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -1000 * unit_rad, link_bench_reference_rad());
}

/* ---- set-points ---- */

static void test_a_move_has_the_profile_s_speed_and_acceleration(void)
{
    double most = 0.0;
    double steepest = 0.0;
    double before = 0.0;

    enable(1);
    put(0x6081, 0, 4, TURN);
    put(0x6083, 0, 4, 10 * TURN);
    put(0x607a, 0, 4, TURN / 2);
    control(0x1f);
    for (int i = 0; i < 8000; i++) {
        bench_period();
        most = fmax(most, link_bench_speed_rad_s());
        steepest = fmax(steepest, fabs(link_bench_speed_rad_s() - before) / PERIOD_S);
        before = link_bench_speed_rad_s();
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, TWO_PI, most);
    TEST_ASSERT_DOUBLE_WITHIN(0.7, 10.0 * TWO_PI, steepest);
    TEST_ASSERT_INT_WITHIN(0, TURN / 2, (int)get(0x6062));
}

static void test_targets_are_cut_at_either_software_limit_and_free_of_it_in_between(void)
{
    enable(1);
    put(0x607d, 1, 4, (uint32_t)(-TURN / 4));
    put(0x607d, 2, 4, TURN / 8);
    put(0x607a, 0, 4, TURN / 8);
    control(0x1f);
    TEST_ASSERT_EQUAL_HEX32(0, status(LIMITED));
    bench_periods(4000);
    control(0x0f);
    put(0x607a, 0, 4, (uint32_t)-TURN);
    control(0x1f);
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
    bench_periods(6000);
    TEST_ASSERT_EQUAL_INT(-TURN / 4, (int32_t)get(0x6062));
    control(0x0f);
    put(0x607a, 0, 4, TURN / 16);
    control(0x5f); /* relative */
    TEST_ASSERT_EQUAL_HEX32(0, status(LIMITED));
    bench_periods(6000);
    TEST_ASSERT_EQUAL_INT(-TURN / 4 + TURN / 16, (int32_t)get(0x6062));
}

static void test_a_relative_target_counts_from_the_last_one(void)
{
    enable(1);
    put(0x6067, 0, 4, 0x7fffffff);
    put(0x607a, 0, 4, TURN);
    control(0x5f);
    bench_periods(20);
    control(0x4f);
    bench_periods(20);
    control(0x5f); /* waits */
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE | REACHED));
    control(0x4f);
    bench_periods(12000);
    TEST_ASSERT_EQUAL_INT(2 * TURN, (int)get(0x6062));
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(OF_MODE | REACHED));
}

static void test_a_third_target_is_not_accepted_while_the_second_waits(void)
{
    enable(1);
    put(0x607a, 0, 4, TURN);
    control(0x1f);
    bench_periods(20);
    control(0x0f);
    put(0x607a, 0, 4, TURN / 2);
    control(0x1f);
    bench_periods(20);
    control(0x0f);
    put(0x607a, 0, 4, TURN / 4);
    control(0x1f);
    control(0x0f);
    bench_periods(16000);
    TEST_ASSERT_EQUAL_INT(TURN / 2, (int)get(0x6062));
}

static void test_a_target_that_is_asked_for_at_once_preempts_and_without_a_rise_none_does(void)
{
    enable(1);
    put(0x607a, 0, 4, 40 * TURN);
    control(0x1f);
    bench_periods(500);
    put(0x607a, 0, 4, 0);
    control(0x3f); /* no rise of the bit */
    bench_periods(500);
    TEST_ASSERT_TRUE(link_bench_speed_rad_s() > 1.0);
    control(0x2f);
    control(0x3f);
    bench_periods(12000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_INT(0, (int)get(0x6062));
}

/* The rotor of this bench stands where it was estimated. */
static void test_a_target_is_reached_when_the_rotor_has_been_within_its_window_for_a_while(void)
{
    enable(1);
    put(0x6067, 0, 4, 0x7fffffff);
    put(0x6068, 0, 2, 100);
    put(0x607a, 0, 4, TURN / 100);
    control(0x1f);
    control(0x0f);
    while (!rests() || bench_link.axis.motion.waits) {
        bench_period();
    }
    bench_periods(950);
    TEST_ASSERT_EQUAL_HEX32(0, status(REACHED));
    bench_periods(80);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(REACHED));

    const int32_t away = (int32_t)get(0x60f4);

    put(0x6067, 0, 4, (uint32_t)(away < 0 ? -away : away) - 3u);
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(0, status(REACHED));
    put(0x6067, 0, 4, (uint32_t)(away < 0 ? -away : away) + 3u);
    bench_periods(900);
    TEST_ASSERT_EQUAL_HEX32(0, status(REACHED));
    bench_periods(150);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(REACHED));
}

static void test_a_rotor_off_its_reference_for_a_while_is_said(void)
{
    enable(1);
    put(0x6066, 0, 2, 200);
    put(0x607a, 0, 4, TURN / 10);
    control(0x1f);
    bench_periods(4000);

    const int32_t away = (int32_t)get(0x60f4);
    const uint32_t size = (uint32_t)(away < 0 ? -away : away);

    put(0x6065, 0, 4, size + 3u);
    bench_periods(3000);
    TEST_ASSERT_EQUAL_HEX32(0, status(OFF));
    put(0x6065, 0, 4, size - 3u);
    bench_periods(1900);
    TEST_ASSERT_EQUAL_HEX32(0, status(OFF));
    bench_periods(200);
    TEST_ASSERT_EQUAL_HEX32(OFF, status(OFF));
    put(0x6060, 0, 1, 3); /* no matter of a speed */
    bench_periods(100);
    TEST_ASSERT_EQUAL_HEX32(0, status(OFF));
}

/* Under way to four turns, halted at rest; where that is. */
static uint32_t halt_on_the_way(void)
{
    enable(1);
    put(0x607a, 0, 4, 4 * TURN);
    control(0x1f);
    bench_periods(1000);
    control(0x10f);
    TEST_ASSERT_EQUAL_HEX32(0, status(REACHED));
    bench_periods(4000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(REACHED));
    return get(0x6062);
}

/* The furthest that the reference comes from now on until it rests, in units. */
static int32_t furthest(void)
{
    double most = link_bench_reference_rad();

    do {
        bench_periods(50);
        most = fmax(most, link_bench_reference_rad());
    } while (!rests() || bench_link.axis.motion.waits);
    return (int32_t)lround(most / unit_rad);
}

static void test_a_target_given_in_a_halt_waits_for_its_end_behind_the_interrupted_one(void)
{
    const uint32_t here = halt_on_the_way();

    put(0x607a, 0, 4, TURN);
    control(0x11f);
    bench_periods(2000);
    TEST_ASSERT_EQUAL_UINT32(here, get(0x6062));
    control(0x10f);
    TEST_ASSERT_EQUAL_HEX32(REACHED | OF_MODE, status(REACHED | OF_MODE)); /* has no more room */
    control(0x0f);
    TEST_ASSERT_EQUAL_INT32(4 * TURN, furthest());
    TEST_ASSERT_EQUAL_INT(TURN, (int)get(0x6062));
    TEST_ASSERT_EQUAL_HEX32(0, status(OF_MODE));
}

static void test_a_target_that_waited_before_a_halt_goes_on_waiting(void)
{
    enable(1);
    put(0x607a, 0, 4, 4 * TURN);
    control(0x1f);
    control(0x0f);
    put(0x607a, 0, 4, TURN);
    control(0x1f);
    bench_periods(1000);
    control(0x10f);
    bench_periods(4000);
    TEST_ASSERT_TRUE(rests());
    control(0x0f);
    TEST_ASSERT_EQUAL_INT32(4 * TURN, furthest());
    TEST_ASSERT_EQUAL_INT(TURN, (int)get(0x6062));
}

static void test_a_target_at_once_given_in_a_halt_replaces_the_interrupted_one(void)
{
    const uint32_t here = halt_on_the_way();

    put(0x607a, 0, 4, TURN);
    control(0x13f);
    bench_periods(2000);
    TEST_ASSERT_EQUAL_UINT32(here, get(0x6062));
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE));
    control(0x10f);
    TEST_ASSERT_EQUAL_HEX32(0, status(OF_MODE)); /* has room for another */
    control(0x0f);
    TEST_ASSERT_TRUE(furthest() < 2 * TURN);
    TEST_ASSERT_EQUAL_INT(TURN, (int)get(0x6062));
}

/* Where nothing is interrupted the first that is given is the one that begins, a second waits. */
static void test_a_halt_at_rest_takes_two_targets(void)
{
    enable(1);
    control(0x10f);
    put(0x607a, 0, 4, 2 * TURN);
    control(0x11f);
    control(0x10f);
    TEST_ASSERT_EQUAL_HEX32(0, status(OF_MODE));
    put(0x607a, 0, 4, TURN);
    control(0x11f);
    control(0x10f);
    bench_periods(2000);
    TEST_ASSERT_EQUAL_HEX32(OF_MODE, status(OF_MODE));
    TEST_ASSERT_EQUAL_INT(0, (int)get(0x6062));
    control(0x0f);
    TEST_ASSERT_EQUAL_INT32(2 * TURN, furthest());
    TEST_ASSERT_EQUAL_INT(TURN, (int)get(0x6062));
}

static void test_a_halt_that_ends_before_the_rest_lets_it_go_on(void)
{
    enable(1);
    put(0x607a, 0, 4, 4 * TURN);
    control(0x1f);
    bench_periods(2000);
    control(0x10f);
    bench_periods(300);
    TEST_ASSERT_FALSE(rests());
    control(0x0f);
    TEST_ASSERT_EQUAL_INT32(4 * TURN, furthest());
    TEST_ASSERT_EQUAL_INT(4 * TURN, (int)get(0x6062));
}

/* One that was reached is not gone to again. */
static void test_a_halt_behind_a_move_moves_nothing(void)
{
    enable(1);
    put(0x6067, 0, 4, 0x7fffffff);
    put(0x607a, 0, 4, TURN / 4);
    control(0x1f);
    bench_periods(8000);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(REACHED));
    control(0x10f);
    control(0x0f);
    TEST_ASSERT_FALSE(bench_link.axis.motion.waits);
    bench_periods(100);
    TEST_ASSERT_TRUE(rests());
}

/* Enabled, in another mode, or with the start of a homing: a halt that stands is one. */
static void test_nothing_begins_in_a_halt_that_stands(void)
{
    put(0x6060, 0, 1, 3);
    put(0x60ff, 0, 4, TURN);
    control(0x06);
    bench_periods(20);
    control(0x10f);
    bench_periods(2000);
    TEST_ASSERT_EQUAL_HEX32(0x27, status(0x6f));
    TEST_ASSERT_EQUAL_INT(0, (int)get(0x606b));
    put(0x6060, 0, 1, 6);
    put(0x6098, 0, 1, (uint32_t)-1);
    bench_periods(50);
    bench_link.axis.motion.homed = true; /* before */
    control(0x11f);
    bench_periods(2000);
    TEST_ASSERT_EQUAL_INT(0, (int)get(0x606b));
    TEST_ASSERT_EQUAL_HEX32(0, status(OF_MODE));
    put(0x6060, 0, 1, 3);
    bench_periods(2000);
    TEST_ASSERT_EQUAL_INT(0, (int)get(0x606b));
    control(0x0f);
    bench_periods(8000);
    TEST_ASSERT_INT_WITHIN(1, TURN, (int)get(0x606b));
}

/* A set-point, its bit 4 with it and gone again. */
static void give(int32_t target, unsigned word)
{
    put(0x607a, 0, 4, (uint32_t)target);
    control(word);
    control(0x0f);
}

static void test_a_target_at_once_replaces_one_that_waits(void)
{
    enable(1);
    give(4 * TURN, 0x1f);
    give(8 * TURN, 0x1f);
    give(TURN / 2, 0x1f); /* finds the buffer full */
    give(TURN, 0x3f);
    TEST_ASSERT_TRUE(furthest() < 3 * TURN);
    TEST_ASSERT_EQUAL_INT(TURN, (int)get(0x6062));
}

/* What waited was not gone to. */
static void test_a_relative_target_at_once_goes_on_from_the_one_that_has_begun(void)
{
    enable(1);
    give(2 * TURN, 0x1f);
    give(8 * TURN, 0x1f);
    give(TURN, 0x7f);
    TEST_ASSERT_EQUAL_INT32(3 * TURN, furthest());
}

static void test_a_target_that_waits_keeps_the_profile_that_it_came_with(void)
{
    enable(1);
    give(TURN, 0x1f);
    put(0x6081, 0, 4, TURN);
    give(8 * TURN, 0x1f);
    put(0x6081, 0, 4, TURN / 8);
    bench_periods(20000);
    TEST_ASSERT_INT_WITHIN(5, TURN, (int)get(0x606b));
    control(0x10f);
    bench_periods(4000);
    control(0x0f);
    bench_periods(8000);
    TEST_ASSERT_INT_WITHIN(5, TURN, (int)get(0x606b));
}

/* ---- positions beyond 32 bits ---- */

/* Where 607ch puts it. */
static void at(int32_t position)
{
    enable(6);
    put(0x6098, 0, 1, 37);
    put(0x607c, 0, 4, (uint32_t)position);
    control(0x1f);
    bench_periods(50);
    control(0x0f);
    put(0x6060, 0, 1, 1);
    bench_periods(50);
    TEST_ASSERT_EQUAL_INT32(position, (int32_t)get(0x6062));
}

static void go(int32_t target, unsigned word)
{
    give(target, word);
    bench_periods(30000);
    TEST_ASSERT_TRUE(rests());
}

static void test_a_position_wraps_and_targets_are_of_the_range_it_is_in(void)
{
    at(INT32_MAX - 1000);
    go(3000, 0x5f);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN + 1999, (int32_t)get(0x6062));
    go(INT32_MIN + 500, 0x1f);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN + 500, (int32_t)get(0x6062));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1501.0 * unit_rad,
                              link_bench_reference_rad() - (INT32_MAX - 1000.0) * unit_rad);
    TEST_ASSERT_EQUAL_HEX32(0, status(LIMITED));
    go(-3000, 0x5f);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 2499, (int32_t)get(0x6062));
}

static void test_a_software_limit_ends_what_would_wrap(void)
{
    put(0x607d, 2, 4, INT32_MAX - 10);
    at(INT32_MAX - 1000);
    go(3000, 0x5f);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 10, (int32_t)get(0x6062));
    TEST_ASSERT_EQUAL_HEX32(LIMITED, status(LIMITED));
}

/* ---- from mode to mode ---- */

static void test_a_mode_that_is_asked_for_again_goes_on(void)
{
    enable(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(8000);
    put(0x6060, 0, 1, 1);
    bench_periods(20);
    put(0x6060, 0, 1, 3);
    bench_periods(8000);
    TEST_ASSERT_INT_WITHIN(1, TURN, (int)get(0x606b));
}

static void test_a_mode_begins_at_rest(void)
{
    enable(3);
    put(0x6067, 0, 4, 0x7fffffff);
    put(0x60ff, 0, 4, TURN);
    bench_periods(4000);
    put(0x6060, 0, 1, 1);
    bench_periods(20);
    TEST_ASSERT_EQUAL_UINT32(3, get(0x6061));
    TEST_ASSERT_FALSE(rests());
    bench_periods(4000);
    TEST_ASSERT_EQUAL_UINT32(1, get(0x6061));
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(REACHED));

    const uint32_t here = get(0x6062);

    put(0x607a, 0, 4, 1000);
    control(0x5f);
    bench_periods(4000);
    TEST_ASSERT_INT_WITHIN(1, (int)here + 1000, (int)get(0x6062));
}

static void test_homing_is_reached_at_rest_once_it_was_asked_for(void)
{
    enable(6);
    put(0x607c, 0, 4, 1000);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status(REACHED | OF_MODE | OFF));
    control(0x1f);
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(REACHED | OF_MODE, status(REACHED | OF_MODE | OFF));
    TEST_ASSERT_EQUAL_UINT32(1000, get(0x6062));
    put(0x607c, 0, 4, 3000);
    control(0x1f); /* no rise */
    bench_periods(20);
    TEST_ASSERT_EQUAL_UINT32(1000, get(0x6062));
    put(0x6060, 0, 1, 1);
    control(0x0f);
    control(0x1f);
    bench_periods(20);
    TEST_ASSERT_TRUE(get(0x6062) < 3000u); /* a target of 0 */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_profile_quantities_come_from_the_motor);
    RUN_TEST(test_gear_and_feed_say_what_a_unit_is);
    RUN_TEST(test_quantities_are_shown_in_units_rounded);
    RUN_TEST(test_a_speed_is_reached_by_its_acceleration_and_jerk);
    RUN_TEST(test_a_quick_stop_brakes_by_its_own_deceleration);
    RUN_TEST(test_a_quick_stop_ends_a_much_steeper_acceleration_at_once);
    RUN_TEST(test_speed_and_acceleration_beyond_what_the_drive_can_are_cut_and_said);
    RUN_TEST(test_a_stop_is_no_steeper_than_the_supply_drives_it);
    RUN_TEST(test_no_speed_is_above_6080h_once_it_is_given);
    RUN_TEST(test_units_and_directions_change_at_rest_and_out_of_operation_alone);
    RUN_TEST(test_an_operation_begins_at_rest);
    RUN_TEST(test_a_least_position_is_not_above_the_most);
    RUN_TEST(test_the_speed_counts_as_reached_within_a_thousandth);
    RUN_TEST(test_a_halt_of_a_speed_brakes_and_lets_it_go_on);
    RUN_TEST(test_a_speed_ends_at_either_software_limit_and_goes_back_from_it);
    RUN_TEST(test_no_speed_passes_a_software_limit);
    RUN_TEST(test_a_limit_that_moves_is_gone_to_and_one_that_is_passed_stops);
    RUN_TEST(test_a_limit_that_comes_near_while_a_command_waits_is_kept);
    RUN_TEST(test_a_halt_before_a_limit_goes_on_to_it);
    RUN_TEST(test_polarity_turns_positions_and_speeds_each_for_itself);
    RUN_TEST(test_homing_has_the_polarity_too);
    RUN_TEST(test_a_move_has_the_profile_s_speed_and_acceleration);
    RUN_TEST(test_targets_are_cut_at_either_software_limit_and_free_of_it_in_between);
    RUN_TEST(test_a_relative_target_counts_from_the_last_one);
    RUN_TEST(test_a_third_target_is_not_accepted_while_the_second_waits);
    RUN_TEST(test_a_target_that_is_asked_for_at_once_preempts_and_without_a_rise_none_does);
    RUN_TEST(test_a_target_is_reached_when_the_rotor_has_been_within_its_window_for_a_while);
    RUN_TEST(test_a_rotor_off_its_reference_for_a_while_is_said);
    RUN_TEST(test_a_target_given_in_a_halt_waits_for_its_end_behind_the_interrupted_one);
    RUN_TEST(test_a_target_that_waited_before_a_halt_goes_on_waiting);
    RUN_TEST(test_a_target_at_once_given_in_a_halt_replaces_the_interrupted_one);
    RUN_TEST(test_a_halt_at_rest_takes_two_targets);
    RUN_TEST(test_a_halt_that_ends_before_the_rest_lets_it_go_on);
    RUN_TEST(test_a_halt_behind_a_move_moves_nothing);
    RUN_TEST(test_nothing_begins_in_a_halt_that_stands);
    RUN_TEST(test_a_target_at_once_replaces_one_that_waits);
    RUN_TEST(test_a_relative_target_at_once_goes_on_from_the_one_that_has_begun);
    RUN_TEST(test_a_target_that_waits_keeps_the_profile_that_it_came_with);
    RUN_TEST(test_a_position_wraps_and_targets_are_of_the_range_it_is_in);
    RUN_TEST(test_a_software_limit_ends_what_would_wrap);
    RUN_TEST(test_a_mode_that_is_asked_for_again_goes_on);
    RUN_TEST(test_a_mode_begins_at_rest);
    RUN_TEST(test_homing_is_reached_at_rest_once_it_was_asked_for);
    return UNITY_END();
}
