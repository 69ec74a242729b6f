/* Homing on a switch, by a machine whose switches the rotor passes. */
#include "firmware/link/axis_homing_switch.h"
#include "firmware/application/machine_io.h"
#include "tests/unit/link_bench.h"

enum {
    TURN = 65536,
    REACHED = 0x0400,
    ATTAINED = 0x1000,
    FAILED = 0x2000,
    ALL = 0x3400,
    LIMITS = HAL_INPUT_LIMIT_MINUS | HAL_INPUT_LIMIT_PLUS
};

static const double unit_rad = TWO_PI / TURN;
static const double slow_ms_rad = 1e-3 * TWO_PI / 16.0; /* what it goes in 1 ms to the edge */

/* Of the motor: where its switches are active. */
static const double limit_minus_rad = -0.6, switch_from_rad = 0.3, switch_to_rad = 0.4,
                    limit_plus_rad = 0.8;

/* Where the motor's zero lies in the machine. */
static double origin_rad;

static double rotor_rad, began_rad, furthest_rad, least_rad;
static bool switch_is_mute, switch_sticks, limits_stick, emergency_came;

static void put(unsigned index, unsigned sub, unsigned bytes, uint32_t value)
{
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(index, sub, bytes, value));
}

static uint32_t status(void)
{
    return link_bench_get(0x6041, 0) & ALL;
}

/* Where the motor's zero is, of the axis. */
static double zero_rad(void)
{
    struct drive_signals now;

    drive_signals_read(&bench.application.drive, &now);
    return now.motor_zero_rad;
}

static void put_rotor(double angle_rad)
{
    rotor_rad = angle_rad;
    furthest_rad = fmax(furthest_rad, rotor_rad);
    least_rad = fmin(least_rad, rotor_rad);
    bench.inputs =
        (limits_stick ? LIMITS : 0u) | (rotor_rad < limit_minus_rad ? HAL_INPUT_LIMIT_MINUS : 0u) |
        (rotor_rad > limit_plus_rad ? HAL_INPUT_LIMIT_PLUS : 0u) |
        (switch_sticks ||
                 (!switch_is_mute && rotor_rad > switch_from_rad && rotor_rad < switch_to_rad)
             ? HAL_INPUT_HOME
             : 0u);
}

/* At an angle, disabled, with these inputs wired. */
static void start(double angle_rad, int used)
{
    struct drive_settings settings = bench_quick_settings();

    settings.inputs_used = used;
    settings.resistance_adaptation = false; /* no current flows */
    origin_rad = angle_rad;
    furthest_rad = least_rad = angle_rad;
    bench_power_up();
    TEST_ASSERT_TRUE(bench_start(&settings));
    application_put_link(&bench.application, &bench_link);
    put_rotor(angle_rad);
    bench_periods(40);
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
    put(0x6099, 1, 4, TURN / 4);
    put(0x6099, 2, 4, TURN / 16);
    put(0x6085, 0, 4, 4 * TURN);
    put(0x607c, 0, 4, 1000);
}

void setUp(void)
{
    switch_is_mute = false;
    switch_sticks = false;
    limits_stick = false;
    emergency_came = false;
}

void tearDown(void)
{
}

/* The rotor follows its reference. */
static void period(void)
{
    struct cia402 *axis = &bench_link.axis;

    (void)bench_interrupt();
    drive_signals_read(&bench.application.drive, &axis->signals);
    axis->signals_in = bench.application.drive.supervision.period;
    axis->signals.theta_est_rad = axis->signals.theta_ref_rad;
    put_rotor(origin_rad + axis->signals.theta_ref_rad - axis->signals.motor_zero_rad);
    application_background(&bench.application);
}

static void turn(int ms)
{
    for (int i = 0; i < 10 * ms; i++) {
        period();
    }
    TEST_ASSERT_EQUAL_STRING("none", drive_fault_name(bench.application.drive.supervision.fault));
}

static void begin(int method)
{
    put(0x6060, 0, 1, 6);
    put(0x6098, 0, 1, (uint32_t)method);
    put(0x6040, 0, 2, 0x06);
    bench_periods(20);
    put(0x6040, 0, 2, 0x0f);
    bench_periods(20);
    TEST_ASSERT_EQUAL_HEX32(REACHED, status());
    began_rad = rotor_rad;
    (void)bench_heard();
    put(0x6040, 0, 2, 0x1f);
    turn(3);
}

static void turn_until_homed(void)
{
    for (int i = 0; i < 3000 && status() == 0u; i++) {
        turn(10);
        emergency_came = emergency_came || strstr(bench_heard(), "t081") != NULL;
    }
    turn(300);
}

/* Which edge a method means, and whether the rotor crosses it on its way up; of the motor. */
struct meaning {
    double edge_rad;
    bool up;
};

static struct meaning meaning_of(int method, bool turned)
{
    static const uint8_t mirrored[] = {18, 17, 21, 22, 19, 20, 27, 28, 29, 30, 23, 24, 25, 26};
    const int of_motor = turned ? mirrored[method - AXIS_HOMING_SWITCH_FIRST] : method;

    switch (of_motor) {
    case 17:
        return (struct meaning){limit_minus_rad, true};
    case 18:
        return (struct meaning){limit_plus_rad, false};
    case 19:
    case 23:
    case 30:
        return (struct meaning){switch_from_rad, false};
    case 20:
    case 24:
    case 29:
        return (struct meaning){switch_from_rad, true};
    case 21:
    case 26:
    case 27:
        return (struct meaning){switch_to_rad, true};
    default: /* 22, 25, 28 */
        return (struct meaning){switch_to_rad, false};
    }
}

static void homes(int method, double from_rad, bool turned)
{
    const struct meaning meaning = meaning_of(method, turned);
    const double offset_rad = (turned ? -1000.0 : 1000.0) * unit_rad;
    char what[60];

    snprintf(what, sizeof what, "method %d from %d mrad%s", method, (int)(1e3 * from_rad),
             turned ? ", turned" : "");
    start(from_rad, LIMITS | HAL_INPUT_HOME);
    put(0x607e, 0, 1, turned ? 0x80 : 0);
    begin(method);
    turn_until_homed();
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(REACHED | ATTAINED, status(), what);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(slow_ms_rad, offset_rad - meaning.edge_rad + origin_rad,
                                      zero_rad(), what);
    TEST_ASSERT_EQUAL_MESSAGE(meaning.up, rotor_rad > meaning.edge_rad, what);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.05, meaning.edge_rad, rotor_rad, what);
    TEST_ASSERT_FALSE_MESSAGE(emergency_came, what);
}

/* ---- statements ---- */

static void test_each_method_finds_its_edge_from_wherever_it_begins(void)
{
    static const double begins_rad[] = {-0.7, 0.0, 0.35, 0.6, 0.9};

    for (int method = AXIS_HOMING_SWITCH_FIRST; method <= AXIS_HOMING_SWITCH_LAST; method++) {
        for (size_t i = 0; i < sizeof begins_rad / sizeof begins_rad[0]; i++) {
            homes(method, begins_rad[i], false);
            homes(method, begins_rad[i], true);
        }
    }
}

static void test_a_switch_that_is_not_wired_is_refused_and_nothing_moves(void)
{
    start(0.0, LIMITS);
    begin(24);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    start(0.0, HAL_INPUT_HOME | HAL_INPUT_LIMIT_PLUS);
    begin(17);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    TEST_ASSERT_EQUAL_DOUBLE(began_rad, rotor_rad);
}

static void test_no_switch_between_the_limits_is_an_error(void)
{
    switch_is_mute = true;
    start(0.0, LIMITS | HAL_INPUT_HOME);
    begin(23);
    turn_until_homed();
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    TEST_ASSERT_DOUBLE_WITHIN(0.1, limit_plus_rad, furthest_rad);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, limit_minus_rad, least_rad);
}

static void test_no_switch_within_the_travel_is_an_error(void)
{
    switch_is_mute = true;
    start(0.0, HAL_INPUT_HOME);
    put(0x2403, 2, 4, TURN);
    begin(27);
    turn_until_homed();
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    TEST_ASSERT_DOUBLE_WITHIN(0.2, -TWO_PI, rotor_rad);
}

static void test_a_limit_before_the_edge_ends_it(void)
{
    start(0.35, LIMITS | HAL_INPUT_HOME);
    switch_sticks = true;
    begin(26);
    turn_until_homed();
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
    TEST_ASSERT_DOUBLE_WITHIN(0.1, limit_plus_rad, rotor_rad);
}

/* A narrow cam, and a search that comes to rest behind it. */
static void test_a_switch_that_is_passed_is_come_back_to(void)
{
    for (int method = 19; method <= AXIS_HOMING_SWITCH_LAST; method++) {
        const struct meaning meaning = meaning_of(method, false);

        start(0.0, LIMITS | HAL_INPUT_HOME);
        put(0x6099, 1, 4, TURN / 2);
        put(0x609a, 0, 4, 3 * TURN);
        begin(method);
        turn_until_homed();
        TEST_ASSERT_TRUE(furthest_rad > switch_to_rad + 0.05 || least_rad < limit_minus_rad);
        TEST_ASSERT_EQUAL_HEX32(REACHED | ATTAINED, status());
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 1000.0 * unit_rad - meaning.edge_rad + origin_rad,
                                  zero_rad());
    }
}

/* A wire that is broken, or the wrong level. */
static void test_both_limits_at_once_are_an_error(void)
{
    start(0.0, LIMITS | HAL_INPUT_HOME);
    limits_stick = true;
    put_rotor(0.0);
    bench_periods(40);
    begin(24);
    TEST_ASSERT_EQUAL_HEX32(REACHED | FAILED, status());
}

static void test_one_look_is_no_switch(void)
{
    start(0.0, LIMITS | HAL_INPUT_HOME);
    begin(24);
    turn(50);
    switch_sticks = true;
    turn(1);
    switch_sticks = false;
    turn(5);
    TEST_ASSERT_EQUAL(HOMING_SEEKS_SWITCH, bench_link.axis.motion.homing.phase);
    switch_sticks = true;
    turn(3);
    TEST_ASSERT_EQUAL(HOMING_LEAVES_SWITCH, bench_link.axis.motion.homing.phase);
}

static void test_bit_4_and_a_halt_interrupt_it(void)
{
    static const uint32_t words[] = {0x0f, 0x11f};

    for (size_t i = 0; i < 2; i++) {
        start(0.0, LIMITS | HAL_INPUT_HOME);
        begin(24);
        turn(20);
        TEST_ASSERT_EQUAL_HEX32(0, status());
        put(0x6040, 0, 2, words[i]);
        turn(200);
        TEST_ASSERT_EQUAL_HEX32(REACHED, status());
        TEST_ASSERT_TRUE(rotor_rad < switch_from_rad);
    }
}

/* The emergency and the stop are for who does not expect them. */
static void test_in_another_mode_a_limit_switch_stops_as_before(void)
{
    start(0.6, LIMITS | HAL_INPUT_HOME);
    begin(24);
    turn_until_homed();
    put(0x6040, 0, 2, 0x0f);
    put(0x6060, 0, 1, 3);
    put(0x60ff, 0, 4, TURN / 8);
    turn(2000);
    TEST_ASSERT_NOT_NULL(strstr(bench_heard(), "t08181286"));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, limit_plus_rad, rotor_rad);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_method_finds_its_edge_from_wherever_it_begins);
    RUN_TEST(test_a_switch_that_is_not_wired_is_refused_and_nothing_moves);
    RUN_TEST(test_no_switch_between_the_limits_is_an_error);
    RUN_TEST(test_no_switch_within_the_travel_is_an_error);
    RUN_TEST(test_a_limit_before_the_edge_ends_it);
    RUN_TEST(test_a_switch_that_is_passed_is_come_back_to);
    RUN_TEST(test_both_limits_at_once_are_an_error);
    RUN_TEST(test_one_look_is_no_switch);
    RUN_TEST(test_bit_4_and_a_halt_interrupt_it);
    RUN_TEST(test_in_another_mode_a_limit_switch_stops_as_before);
    return UNITY_END();
}
