/* Every position law in the whole drive, in closed loop: how closely the rotor follows. */
#include "tests/unit/drive_bench.h"

static double load_share; /* of 0.1 N m that the estimate of the load may be off */

void setUp(void)
{
    drive_bench_reset();
    bridge.background = true;
    load_share = 0.06;
    encoder_facts.encoder_counts_per_turn = 40000;
    board.facts = &encoder_facts;
}

void tearDown(void)
{
}

/* Errors between reference and rotor, mrad; those of laws are measured. */
struct errors {
    double moving;  /* largest in a move of 1.5 rad in 0.12 s and 80 ms of rest */
    double loaded;  /* largest while 0.1 N m, a fifth of the rated torque, come in motion */
    double carried; /* at most this is left 30 ms later */
};

struct expected {
    enum position_law law;
    struct errors delayed;
    struct errors at_once; /* on a board where duties act in the period that computes them */
};

static double largest_error_mrad(int periods)
{
    double largest = 0.0;

    for (int k = 0; k < periods; k++) {
        run(1);
        largest = fmax(largest, 1e3 * fabs(following_error_rad()));
    }
    return largest;
}

/* In one direction or the other. */
static void follows(const struct errors *expected, double direction)
{
    enable();
    const double start_rad = signals().theta_ref_rad;

    move(start_rad + direction * 1.5, 0.12);
    TEST_ASSERT_TRUE(largest_error_mrad(2000) < 1.25 * expected->moving);
    TEST_ASSERT_DOUBLE_WITHIN(8e-3, 0.0, signals().load_torque_est_Nm);
    move(start_rad + direction * 3.0, 0.12);
    TEST_ASSERT_TRUE(largest_error_mrad(400) < 1.25 * expected->moving);
    motor.load_torque_Nm = direction * 0.1;
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * expected->loaded, expected->loaded, largest_error_mrad(300));
    TEST_ASSERT_DOUBLE_WITHIN(load_share * 0.1, direction * 0.1, signals().load_torque_est_Nm);
    TEST_ASSERT_DOUBLE_WITHIN(expected->carried, 0.0, 1e3 * following_error_rad());
}

static void with_encoder(enum position_law law, bool zero_delay)
{
    setUp();
    encoder_facts.zero_delay = zero_delay;
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    settings.encoder_zero_known = true;
    drive_settings_select_law(&settings, law);
}

/* The motor being the same, laws differ by what they know of it: microstepping leads its rotor by a
   load angle, stmms has no current control, csmc no equivalent control. */
static void test_every_law_follows_an_encoder_in_both_directions_and_carries_a_load(void)
{
    static const struct expected laws[] = {
        {POSITION_LAW_STATE_FEEDBACK, {0.60, 4.13, 0.06}, {0.54, 3.92, 0.06}},
        {POSITION_LAW_PID, {0.59, 5.92, 0.6}, {0.54, 5.77, 0.6}},
        {POSITION_LAW_FEEDBACK_LINEARISATION, {0.19, 1.60, 0.05}, {0.15, 1.42, 0.05}},
        {POSITION_LAW_MICROSTEPPING, {6.53, 8.09, 6.3}, {6.53, 8.12, 6.3}},
        {POSITION_LAW_STMMS, {10.6, 62.1, 65.0}, {9.81, 55.0, 59.0}},
        {POSITION_LAW_STMMS_PLUS, {1.53, 2.66, 0.25}, {1.37, 2.40, 0.05}},
        {POSITION_LAW_FOC, {0.21, 2.62, 0.05}, {0.16, 2.36, 0.08}},
        {POSITION_LAW_CSMC, {18.3, 21.1, 6.0}, {18.1, 20.7, 6.0}},
        {POSITION_LAW_CSMC_EQUIVALENT, {0.75, 5.65, 0.15}, {0.65, 5.42, 0.08}},
    };

    for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++) {
        with_encoder(laws[i].law, false);
        follows(&laws[i].delayed, 1.0);
        with_encoder(laws[i].law, false);
        follows(&laws[i].delayed, -1.0);
        with_encoder(laws[i].law, true);
        follows(&laws[i].at_once, 1.0);
    }
}

static const struct errors of_sensorless = {.moving = 0.68, .loaded = 4.30, .carried = 0.10};

static void test_without_delay_and_without_an_encoder_the_rotor_follows(void)
{
    encoder_facts.zero_delay = true;
    follows(&of_sensorless, 1.0);
}

/* A bridge that takes nothing away: the command is the voltage. */
static void test_the_voltage_that_was_commanded_serves_where_none_is_measured(void)
{
    encoder_facts.has_phase_voltages = false;
    encoder_facts.dead_time_s = 0.0;
    bridge.loss_V = 0.0;
    settings.speed_limit_rad_s = 100.0;
    follows(&of_sensorless, 1.0);
}

/* The paper's observer sees a load sooner. It is for encoders that nobody has: 4 million counts. */
static void test_the_high_gain_observer_serves_an_ideal_encoder(void)
{
    static const struct expected laws[] = {
        {POSITION_LAW_STATE_FEEDBACK, {0.46, 0.95, 0.12}, {0.31, 0.86, 0.06}},
        {POSITION_LAW_CSMC_EQUIVALENT, {0.60, 1.36, 0.10}, {0.58, 1.18, 0.15}},
    };

    for (int i = 0; i < 4; i++) {
        const struct expected *law = &laws[i / 2];
        const bool zero_delay = i % 2 == 1;

        with_encoder(law->law, zero_delay);
        encoder_facts.encoder_counts_per_turn = 4000000;
        settings.observer = DRIVE_OBSERVER_HIGH_GAIN;
        settings.initial_angle_rad = 0.2;
        motor.angle_rad = 0.2;
        load_share = 0.3; /* what it shows of the load swings with the current */
        follows(zero_delay ? &law->at_once : &law->delayed, 1.0);
    }
}

static void test_the_high_gain_observer_begins_where_an_alignment_ends(void)
{
    with_encoder(POSITION_LAW_STATE_FEEDBACK, false);
    encoder_facts.encoder_counts_per_turn = 400000;
    settings.observer = DRIVE_OBSERVER_HIGH_GAIN;
    settings.encoder_zero_known = false;
    power_up();
    motor.angle_rad = 0.01;
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    do {
        run(1);
    } while (drive.supervision.state != DRIVE_OPERATION_ENABLED);
    TEST_ASSERT_DOUBLE_WITHIN(3e-5, motor.angle_rad, signals().theta_est_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.0, signals().omega_est_rad_s);
    TEST_ASSERT_TRUE(largest_error_mrad(500) < 0.6);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_law_follows_an_encoder_in_both_directions_and_carries_a_load);
    RUN_TEST(test_without_delay_and_without_an_encoder_the_rotor_follows);
    RUN_TEST(test_the_voltage_that_was_commanded_serves_where_none_is_measured);
    RUN_TEST(test_the_high_gain_observer_serves_an_ideal_encoder);
    RUN_TEST(test_the_high_gain_observer_begins_where_an_alignment_ends);
    return UNITY_END();
}
