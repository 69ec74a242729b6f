/* The drive profile: states, set-points, speeds, cyclic positions, homing, and who is heard no
 * more. */
#include <unity.h>

#include "firmware/link/axis_motion.h"
#include "tests/unit/link_bench.h"

enum { TURN = 65536, CYCLE = 40 /* periods */ };

void setUp(void)
{
    link_bench_start();
    link_bench_open();
    (void)link_bench_say("t00020101", 1);
}

void tearDown(void)
{
}

/* Writes up to four bytes; any answer will do. */
static void put(unsigned index, unsigned sub, unsigned bytes, uint32_t value)
{
    char request[40];

    snprintf(request, sizeof request, "%02X%02X%02X%02X%02X%02X%02X%02X", 0x23u | (4u - bytes) << 2,
             index & 255u, index >> 8, sub, (unsigned)(value & 255u), (unsigned)(value >> 8 & 255u),
             (unsigned)(value >> 16 & 255u), (unsigned)(value >> 24));
    TEST_ASSERT_EQUAL_STRING_LEN("60", link_bench_sdo(request), 2);
}

static uint32_t get(unsigned index)
{
    char request[40];
    unsigned byte[8] = {0};

    snprintf(request, sizeof request, "40%02X%02X0000000000", index & 255u, index >> 8);
    TEST_ASSERT_EQUAL(8,
                      sscanf(link_bench_sdo(request), "%2x%2x%2x%2x%2x%2x%2x%2x", &byte[0],
                             &byte[1], &byte[2], &byte[3], &byte[4], &byte[5], &byte[6], &byte[7]));
    return byte[4] | byte[5] << 8 | byte[6] << 16 | byte[7] << 24;
}

/* The statusword behind a controlword. */
static uint32_t control(unsigned word)
{
    put(0x6040, 0, 2, word);
    bench_periods(20);
    return get(0x6041);
}

static void assert_state(unsigned state, uint32_t status)
{
    TEST_ASSERT_EQUAL_HEX16(state, status & 0x6fu);
}

static void enable(int mode)
{
    put(0x6060, 0, 1, (uint32_t)mode);
    assert_state(0x21, control(0x06));
    assert_state(0x23, control(0x07));
    assert_state(0x27, control(0x0f));
}

static double reference_rad(void)
{
    return position_to_rad(bench.application.drive.reference.now.position,
                           bench_params.rotor_teeth);
}

static bool rests(void)
{
    return axis_motion_rests(&bench.application);
}

static void test_states_follow_the_controlword(void)
{
    assert_state(0x40, control(0x0f)); /* no way past "shutdown" */
    assert_state(0x21, control(0x06));
    assert_state(0x40, control(0x00));
    assert_state(0x21, control(0x06));
    assert_state(0x27, control(0x0f)); /* both steps in one */
    assert_state(0x23, control(0x07));
    assert_state(0x21, control(0x06));
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, bench.application.drive.supervision.state);
    assert_state(0x27, control(0x0f));
    assert_state(0x40, control(0x00));
    assert_state(0x21, control(0x06));
    assert_state(0x40, control(0x02)); /* quick stop */
}

static void test_a_fault_stays_until_it_is_reset(void)
{
    enable(1);
    bench.samples.bus_voltage = 0;
    assert_state(0x08, control(0x0f));
    bench.samples.bus_voltage = 3151;
    assert_state(0x08, control(0x06));
    assert_state(0x40, control(0x80));
    assert_state(0x21, control(0x06));
}

/* A bridge that opens in motion ends the estimates and the steps of the reference. */
static void test_a_bridge_that_is_off_shows_no_speed(void)
{
    enable(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(3000);
    TEST_ASSERT_INT_WITHIN(10, TURN, (int)get(0x606b));
    bench.samples.bus_voltage = 0;
    bench_periods(20);
    bench.application.drive.estimator.estimate.rotor.speed = NUM(0.1); /* as it was left */
    assert_state(0x08, get(0x6041));
    TEST_ASSERT_EQUAL(0, get(0x606b));
    TEST_ASSERT_EQUAL(0, get(0x606c));
    bench.samples.bus_voltage = 3151;
    assert_state(0x40, control(0x80));
    TEST_ASSERT_EQUAL(0, get(0x606c));
}

static void test_a_set_point_is_acknowledged_and_reached(void)
{
    uint32_t status;

    enable(1);
    TEST_ASSERT_TRUE(get(0x6081) > 0u && get(0x6083) > 0u);
    put(0x6067, 0, 4, 0x7fffffffu); /* the rotor of this bench stands */
    put(0x607a, 0, 4, TURN / 8);
    status = control(0x1f);
    TEST_ASSERT_EQUAL_HEX16(0x1000, status & 0x1400u);
    status = control(0x0f);
    TEST_ASSERT_EQUAL_HEX16(0x0000, status & 0x1400u);
    bench_periods(4000);
    TEST_ASSERT_EQUAL_HEX16(0x0400, get(0x6041) & 0x1400u);
    TEST_ASSERT_TRUE(get(0x6062) == TURN / 8);
    (void)control(0x5f); /* relative, the same again */
    bench_periods(4000);
    TEST_ASSERT_TRUE(get(0x6062) == TURN / 4);
}

/* As RPDO3 is mapped from the start: 6040h, 607Ah. */
static void test_a_controlword_begins_the_move_to_the_target_in_its_own_frame(void)
{
    put(0x1402, 1, 4, 0x401);
    enable(1);
    put(0x607a, 0, 4, TURN);
    (void)link_bench_say("t40161F0000200000", 20);
    (void)link_bench_say("t40160F0000200000", 4000);
    TEST_ASSERT_EQUAL(TURN / 8, get(0x6062));
}

/* Of 65,536 units in a turn, then of 360. */
static void test_defaults_follow_the_unit_and_what_is_given_stays(void)
{
    const uint32_t speed = get(0x6081), acceleration = get(0x6083), rpm = get(0x6080);
    const uint32_t homing = (uint32_t)link_bench_get(0x6099, 2);

    TEST_ASSERT_EQUAL(2048, get(0x6065));
    TEST_ASSERT_EQUAL(100, get(0x6067));
    TEST_ASSERT_EQUAL(10 * TURN, link_bench_get(0x2403, 2));
    put(0x6084, 0, 4, 5 * TURN);
    put(0x6072, 0, 2, 500); /* the default of an acceleration depends on it */
    put(0x6092, 1, 4, 360);
    TEST_ASSERT_INT_WITHIN(1, speed * 360.0 / TURN, get(0x6081));
    TEST_ASSERT_INT_WITHIN(1, homing * 360.0 / TURN, link_bench_get(0x6099, 2));
    TEST_ASSERT_LESS_OR_EQUAL(acceleration * 360.0 / TURN, get(0x6083));
    TEST_ASSERT_EQUAL(5 * TURN, get(0x6084));
    TEST_ASSERT_EQUAL(11, get(0x6065));
    TEST_ASSERT_EQUAL(1, get(0x6067));
    TEST_ASSERT_EQUAL(3600, link_bench_get(0x2403, 2));
    TEST_ASSERT_EQUAL(rpm, get(0x6080));
    put(0x6091, 2, 4, 2); /* two turns of the shaft are one of the motor */
    TEST_ASSERT_INT_WITHIN(1, speed * 720.0 / TURN, get(0x6081));
}

static void test_software_limits_cut_a_target(void)
{
    enable(1);
    put(0x607d, 2, 4, TURN / 16);
    put(0x607a, 0, 4, TURN);
    TEST_ASSERT_EQUAL_HEX16(0x0800, control(0x1f) & 0x0800u);
    bench_periods(4000);
    TEST_ASSERT_TRUE(get(0x6062) == TURN / 16);
}

static void test_a_new_target_waits_or_preempts(void)
{
    enable(1);
    put(0x607a, 0, 4, 2 * TURN);
    (void)control(0x1f);
    put(0x607a, 0, 4, TURN);
    (void)control(0x0f);
    TEST_ASSERT_EQUAL_HEX16(0x1000, control(0x1f) & 0x1000u);
    TEST_ASSERT_EQUAL_HEX16(0x1000, control(0x0f) & 0x1000u); /* waits for the first */
    bench_periods(8000);
    TEST_ASSERT_TRUE(get(0x6062) == TURN);
    put(0x607a, 0, 4, 20 * TURN);
    (void)control(0x1f);
    (void)control(0x0f);
    put(0x607a, 0, 4, 0);
    (void)control(0x3f);
    bench_periods(8000);
    TEST_ASSERT_TRUE(get(0x6062) == 0u);
}

static void test_halt_stops_and_lets_go_on(void)
{
    enable(1);
    put(0x607a, 0, 4, 4 * TURN);
    (void)control(0x1f);
    bench_periods(1000);
    (void)control(0x10f);
    bench_periods(3000);
    TEST_ASSERT_TRUE(rests() && reference_rad() < 20.0);
    (void)control(0x0f);
    bench_periods(12000);
    TEST_ASSERT_TRUE(get(0x6062) == 4 * TURN);
}

static void test_a_speed_is_reached_changed_and_quick_stopped(void)
{
    enable(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(3000);
    TEST_ASSERT_EQUAL_HEX16(0x0400, get(0x6041) & 0x1400u);
    TEST_ASSERT_INT_WITHIN(10, TURN, (int)get(0x606b));
    put(0x60ff, 0, 4, (uint32_t)-TURN);
    bench_periods(3000);
    TEST_ASSERT_INT_WITHIN(10, -TURN, (int32_t)get(0x606b));
    assert_state(0x07, control(0x0b));
    bench_periods(3000);
    assert_state(0x40, get(0x6041));
}

/* Of a speed that begins and ends smoothly, target number n. */
static int32_t target_of(int n)
{
    return (int32_t)(n < 50 ? 4 * n * n : 4 * 50 * 50 + 400 * (n - 50));
}

static void cycle(int n)
{
    char line[40];
    const uint32_t target = (uint32_t)target_of(n);

    snprintf(line, sizeof line, "t20160F00%02X%02X%02X%02X\r", (unsigned)(target & 255u),
             (unsigned)(target >> 8 & 255u), (unsigned)(target >> 16 & 255u),
             (unsigned)(target >> 24));
    bench_type(line);
}

static void enable_cyclic(void)
{
    link_bench_map_controlword_and(0x607a0020);
    enable(8);
}

/* Greatest distance from target n - lag, in units, of the reference at each target. */
static int follow(int lag, bool (*comes)(int n))
{
    int off = 0;

    for (int n = 1; n < 200; n++) {
        if (comes(n)) {
            cycle(n);
        }
        for (int i = 0; i < CYCLE; i++) {
            bench_period();
            (void)bench_heard();
        }
        if (n > 20) {
            const int here = (int)(reference_rad() / 6.283185307179586 * TURN) - target_of(n - lag);

            off = here > off ? here : -here > off ? -here : off;
        }
    }
    return off;
}

static bool always(int n)
{
    (void)n;
    return true;
}

/* Two of ten are lost. */
static bool mostly(int n)
{
    return n % 10 > 1;
}

static int best(bool (*comes)(int n))
{
    int least = INT32_MAX;

    for (int lag = 3; lag <= 5; lag++) {
        setUp();
        enable_cyclic();
        const int off = follow(lag, comes);

        least = off < least ? off : least;
    }
    return least;
}

static void test_cyclic_positions_are_followed(void)
{
    TEST_ASSERT_LESS_THAN(500, best(always)); /* 400 are one interval */
    TEST_ASSERT_EQUAL(0, bench.application.drive.planner.underruns);
}

static void test_cyclic_positions_that_do_not_come_are_made_up_for(void)
{
    TEST_ASSERT_LESS_THAN(900, best(mostly));
    TEST_ASSERT_EQUAL(0, bench.application.drive.planner.underruns);
}

static void test_cyclic_positions_that_end_bring_it_to_rest(void)
{
    enable_cyclic();
    (void)follow(4, always);
    bench_periods(3000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL(1, bench.application.drive.planner.underruns);
}

/* One target alone, and a motion that ends: at 400 units in 4 ms it goes on by three of them. */
static void test_cyclic_positions_that_end_bring_it_to_the_last_one(void)
{
    enable_cyclic();
    put(0x607a, 0, 4, 50);
    bench_periods(4000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL(50, get(0x6062));
    setUp();
    enable_cyclic();
    (void)follow(4, always);
    bench_periods(9000);
    TEST_ASSERT_TRUE(rests());
    TEST_ASSERT_EQUAL(target_of(199), get(0x6062));
    TEST_ASSERT_EQUAL(1, bench.application.drive.planner.underruns);
}

/* Periods until the reference rests. */
static int rests_after(void)
{
    int periods = 0;

    while (!rests() && periods < 20000) {
        bench_period();
        (void)bench_heard();
        periods++;
    }
    return periods;
}

/* From a turn in a second, by a controlword and its option code. */
static int rests_after_word(unsigned controlword, unsigned option_index, unsigned option)
{
    setUp();
    put(0x6084, 0, 4, 4 * TURN);
    put(0x6085, 0, 4, 40 * TURN);
    put(option_index, 0, 2, option);
    enable(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(2000);
    put(0x6040, 0, 2, controlword);
    bench_period();
    return rests_after();
}

static int rests_after_quick_stop(unsigned option)
{
    return rests_after_word(0x0b, 0x605a, option);
}

static void test_a_quick_stop_brakes_and_ends_as_its_option_says(void)
{
    const int slowly = rests_after_quick_stop(1);

    bench_periods(400);
    assert_state(0x07, get(0x6041));
    bench_periods(200); /* the rotor comes to rest */
    assert_state(0x40, get(0x6041));
    TEST_ASSERT_TRUE(slowly > 2400 && slowly < 4000); /* a turn a second at 4 turns/s^2, 10 kHz */
    const int quickly = rests_after_quick_stop(2);

    bench_periods(600); /* the rotor comes to rest */
    assert_state(0x40, get(0x6041));
    TEST_ASSERT_LESS_THAN(500, quickly);
    TEST_ASSERT_INT_WITHIN(50, slowly, rests_after_quick_stop(5));
    bench_periods(600);
    TEST_ASSERT_EQUAL_HEX16(0x0407, get(0x6041) & 0x046fu);
    TEST_ASSERT_INT_WITHIN(50, quickly, rests_after_quick_stop(6));
    assert_state(0x07, get(0x6041));
    (void)rests_after_quick_stop(0);
    bench_periods(20);
    assert_state(0x40, get(0x6041));
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, bench.application.drive.supervision.state);
}

static void test_a_quick_stop_that_stays_has_reached_its_end_at_rest(void)
{
    put(0x605a, 0, 2, 6);
    put(0x6085, 0, 4, 4 * TURN);
    enable(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(3000);
    TEST_ASSERT_EQUAL_HEX16(0x0007, control(0x0b) & 0x046fu);
    (void)rests_after();
    TEST_ASSERT_EQUAL_HEX16(0x0407, get(0x6041) & 0x046fu);
}

static void test_a_speed_falls_with_the_deceleration(void)
{
    put(0x6083, 0, 4, 40 * TURN);
    put(0x6084, 0, 4, 4 * TURN);
    enable(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(600);
    TEST_ASSERT_INT_WITHIN(10, TURN, (int)get(0x606b));
    put(0x60ff, 0, 4, 0);
    bench_period();
    TEST_ASSERT_GREATER_THAN(2000, rests_after());
}

static void test_a_halt_brakes_as_its_option_says(void)
{
    TEST_ASSERT_GREATER_THAN(2400, rests_after_word(0x10f, 0x605d, 1));
    TEST_ASSERT_LESS_THAN(500, rests_after_word(0x10f, 0x605d, 2));
}

/* Rated current 3 A, 0.17 Nm/A, of the bench. */
static void test_torque_is_limited_in_thousandths_of_the_rated_one(void)
{
    const struct motor_params *motor = &bench.application.drive.settings.motor;

    TEST_ASSERT_EQUAL((int)(1e3 * motor->rated_current_A + 0.5), get(0x6075));
    TEST_ASSERT_EQUAL((int)(1e3 * motor->rated_current_A * motor->torque_constant_Nm_A + 0.5),
                      get(0x6076));
    enable(1);
    put(0x6072, 0, 2, 500);
    TEST_ASSERT_TRUE(bench.application.chosen.current_limit_A == 0.5 * motor->rated_current_A);
    bench_periods(20);
    TEST_ASSERT_EQUAL(500, get(0x6072));
    TEST_ASSERT_EQUAL_STRING("8072600030000906", link_bench_sdo("2B726000E8FF0000"));
}

static void test_homing_makes_here_the_offset(void)
{
    enable(6);
    put(0x607c, 0, 4, 1000);
    TEST_ASSERT_EQUAL_HEX16(0x1400, control(0x1f) & 0x3400u);
    TEST_ASSERT_EQUAL(1000, get(0x6062));
}

static void test_a_lost_heartbeat_stops_and_switches_off(void)
{
    put(0x1016, 1, 4, 0x00050014); /* node 5, 20 ms */
    put(0x6085, 0, 4, 10 * TURN);
    enable(3);
    put(0x60ff, 0, 4, TURN);
    for (int i = 0; i < 20; i++) {
        (void)link_bench_say("t705105", 100);
    }
    assert_state(0x27, get(0x6041));
    (void)link_bench_say("t705105", 300);
    assert_state(0x07, get(0x6041));
    bench_periods(3000);
    assert_state(0x40, get(0x6041));
}

/* No controlword is in force any more: the drive goes on with the first that comes. */
static void test_a_heartbeat_lost_before_operation_switches_off_and_drops_the_controlword(void)
{
    put(0x1016, 1, 4, 0x00050014); /* node 5, 20 ms */
    assert_state(0x21, control(0x06));
    assert_state(0x23, control(0x07));
    (void)link_bench_say("t705105", 300);
    assert_state(0x40, get(0x6041));
    TEST_ASSERT_EQUAL_HEX16(0, get(0x6040) & 0xffffu);
    assert_state(0x21, control(0x06));
}

/* What it had lost comes back: its emergency is over, which another one says. */
static void test_a_heartbeat_that_comes_back_ends_its_emergency(void)
{
    put(0x1016, 1, 4, 0x00050014);
    (void)link_bench_say("t705105", 1);
    TEST_ASSERT_NOT_NULL(strstr(link_bench_say("", 300), "t08183081110000000000\r"));
    TEST_ASSERT_EQUAL_HEX8(0x11, get(0x1001));
    TEST_ASSERT_NOT_NULL(strstr(link_bench_say("t705105", 1), "t08180000000000000000\r"));
    TEST_ASSERT_EQUAL_HEX8(0x00, get(0x1001));
    put(0x1016, 1, 4, 0x00060014); /* of another node, which has not been heard yet */
    bench_periods(400);
    TEST_ASSERT_EQUAL_HEX8(0x00, get(0x1001));
}

static void test_what_is_not_supervised_any_more_is_no_error(void)
{
    put(0x1016, 1, 4, 0x00050014);
    (void)link_bench_say("t705105", 300);
    TEST_ASSERT_EQUAL_HEX8(0x11, get(0x1001));
    (void)link_bench_say("t0800", 20); /* SYNC is no heartbeat */
    TEST_ASSERT_EQUAL_HEX8(0x11, get(0x1001));
    TEST_ASSERT_EQUAL_HEX32(0, link_bench_put(0x1016, 1, 4, 0));
    link_bench_heard("t08180000000000000000\r", link_bench_say("", 20));
    TEST_ASSERT_EQUAL_HEX8(0x00, get(0x1001));
    put(0x1006, 0, 4, 4000);
    (void)link_bench_say("t0800", 100);
    TEST_ASSERT_EQUAL_HEX8(0x11, get(0x1001));
    put(0x1006, 0, 4, 0);
    link_bench_heard("t08180000000000000000\r", link_bench_say("", 20));
    TEST_ASSERT_EQUAL_HEX8(0x00, get(0x1001));
}

static void test_a_quick_stop_that_stays_ends_when_the_heartbeat_is_lost(void)
{
    put(0x1016, 1, 4, 0x00050014);
    put(0x605a, 0, 2, 6);
    enable(1);
    (void)link_bench_say("t705105", 1);
    assert_state(0x07, control(0x0b));
    bench_periods(400);
    assert_state(0x40, get(0x6041));
}

static void turn(void)
{
    put(0x6085, 0, 4, 10 * TURN);
    enable(3);
    put(0x60ff, 0, 4, TURN);
    bench_periods(2000);
    TEST_ASSERT_FALSE(rests());
}

static void test_a_node_that_is_stopped_stops_and_switches_off(void)
{
    turn();
    (void)link_bench_say("t00020201", 1);
    bench_periods(3000);
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, bench.application.drive.supervision.state);
}

static void test_communication_that_is_reset_leaves_nothing_moving(void)
{
    turn();
    (void)link_bench_say("t00028201", 1);
    bench_periods(3000);
    TEST_ASSERT_TRUE(rests());
    assert_state(0x23, get(0x6041));
}

/* A question that comes right behind the line that opens it: before the next period. */
static void test_a_channel_that_opens_answers_at_once_with_the_drive_as_it_is(void)
{
    char answer[32];

    enable(1);
    put(0x607a, 0, 4, TURN / 8);
    (void)control(0x1f);
    bench_periods(8000);
    (void)link_bench_say("C", 1);
    (void)bench_heard();
    bench_type("O\rt60184062600000000000\r");
    for (int i = 0; i < 10; i++) {
        application_background(&bench.application);
    }
    snprintf(answer, sizeof answer, "t581843626000%02X%02X0000", TURN / 8 & 0xff, TURN / 8 >> 8);
    link_bench_heard(answer, bench_heard());
}

static void test_a_client_that_only_listens_stops_nothing(void)
{
    turn();
    (void)link_bench_say("C", 1);
    (void)link_bench_say("L", 1);
    bench_periods(3000);
    TEST_ASSERT_FALSE(rests());
}

static void test_homing_that_the_drive_refuses_is_an_error(void)
{
    put(0x6092, 1, 4, 1); /* a turn is one unit */
    enable(6);
    put(0x607c, 0, 4, INT32_MAX);
    TEST_ASSERT_EQUAL_HEX16(0x2400, control(0x1f) & 0x3400u);
    put(0x607c, 0, 4, 0);
    (void)control(0x0f);
    TEST_ASSERT_EQUAL_HEX16(0x1400, control(0x1f) & 0x3400u);
}

static void test_a_channel_that_closes_is_a_heartbeat_lost(void)
{
    put(0x1016, 1, 4, 0x00050014);
    enable(3);
    put(0x60ff, 0, 4, TURN);
    (void)link_bench_say("t705105", 100);
    (void)link_bench_say("C", 1);
    bench_periods(3000);
    TEST_ASSERT_EQUAL(DRIVE_SWITCH_ON_DISABLED, bench.application.drive.supervision.state);
}

static void test_a_lost_sync_stops_and_switches_off(void)
{
    put(0x1006, 0, 4, 4000);
    enable(1);
    (void)link_bench_say("t0800", 40);
    assert_state(0x27, get(0x6041));
    bench_periods(100);
    assert_state(0x40, get(0x6041));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_states_follow_the_controlword);
    RUN_TEST(test_a_fault_stays_until_it_is_reset);
    RUN_TEST(test_a_bridge_that_is_off_shows_no_speed);
    RUN_TEST(test_a_set_point_is_acknowledged_and_reached);
    RUN_TEST(test_a_controlword_begins_the_move_to_the_target_in_its_own_frame);
    RUN_TEST(test_defaults_follow_the_unit_and_what_is_given_stays);
    RUN_TEST(test_software_limits_cut_a_target);
    RUN_TEST(test_a_new_target_waits_or_preempts);
    RUN_TEST(test_halt_stops_and_lets_go_on);
    RUN_TEST(test_a_speed_is_reached_changed_and_quick_stopped);
    RUN_TEST(test_cyclic_positions_are_followed);
    RUN_TEST(test_cyclic_positions_that_do_not_come_are_made_up_for);
    RUN_TEST(test_cyclic_positions_that_end_bring_it_to_rest);
    RUN_TEST(test_cyclic_positions_that_end_bring_it_to_the_last_one);
    RUN_TEST(test_a_quick_stop_brakes_and_ends_as_its_option_says);
    RUN_TEST(test_a_quick_stop_that_stays_has_reached_its_end_at_rest);
    RUN_TEST(test_a_speed_falls_with_the_deceleration);
    RUN_TEST(test_a_halt_brakes_as_its_option_says);
    RUN_TEST(test_torque_is_limited_in_thousandths_of_the_rated_one);
    RUN_TEST(test_homing_makes_here_the_offset);
    RUN_TEST(test_a_lost_heartbeat_stops_and_switches_off);
    RUN_TEST(test_a_heartbeat_lost_before_operation_switches_off_and_drops_the_controlword);
    RUN_TEST(test_a_heartbeat_that_comes_back_ends_its_emergency);
    RUN_TEST(test_what_is_not_supervised_any_more_is_no_error);
    RUN_TEST(test_a_quick_stop_that_stays_ends_when_the_heartbeat_is_lost);
    RUN_TEST(test_a_node_that_is_stopped_stops_and_switches_off);
    RUN_TEST(test_communication_that_is_reset_leaves_nothing_moving);
    RUN_TEST(test_a_channel_that_opens_answers_at_once_with_the_drive_as_it_is);
    RUN_TEST(test_a_client_that_only_listens_stops_nothing);
    RUN_TEST(test_homing_that_the_drive_refuses_is_an_error);
    RUN_TEST(test_a_channel_that_closes_is_a_heartbeat_lost);
    RUN_TEST(test_a_lost_sync_stops_and_switches_off);
    return UNITY_END();
}
