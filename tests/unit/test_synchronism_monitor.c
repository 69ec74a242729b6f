/* Each signature of the synchronism monitor: what it is shown by, and what is not one. */
#include "firmware/estimator/synchronism_monitor.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

#define BLOCK_S      SYNCHRONISM_BLOCK_S
#define CURRENT_GAIN 0.45
#define LIMIT_A      3.0
#define FLOOR_V      0.25

static struct per_unit base;
static struct motor_model_params model;
static struct synchronism_monitor_task task;
static struct synchronism_monitor_params params;
static struct synchronism_monitor monitor;

static void design(void)
{
    params = synchronism_monitor_design(&task);
    synchronism_monitor_reset(&monitor, &params);
}

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    model = motor_model_design(&bench_params, &base, PERIOD_S, 0.0);
    task = (struct synchronism_monitor_task){.motor = &bench_params,
                                             .base = &base,
                                             .model = &model,
                                             .period_s = PERIOD_S,
                                             .current_gain_moving = CURRENT_GAIN,
                                             .current_gain_holding = CURRENT_GAIN,
                                             .current_limit_A = LIMIT_A,
                                             .resistance_adapted = true,
                                             .resistance_calibrated = true};
    design();
}

void tearDown(void)
{
}

/* A drive as the monitor sees it. */
struct course {
    double disturbance_V; /* unexplained in d */
    double speed_rad_s, load_Nm;
    double wanted_A, i_d_A;
    double error_turns, deficit_rad_s;
    bool holding, leads;
};

static const struct course at_rest = {.disturbance_V = 0.0};

/* Sum over a block of the stationary innovations that a voltage leaves. */
static num_t innovation_sum(double voltage_V)
{
    const double a = exp(-PERIOD_S * bench_params.resistance_ohm / bench_params.inductance_H);
    const double b = (1.0 - a) / bench_params.resistance_ohm;
    const double innovation_A = voltage_V * b / (1.0 - (1.0 - CURRENT_GAIN) * a);

    return num_from_double(params.block_periods * innovation_A / base.current_A);
}

static enum synchronism block(const struct course *c)
{
    const num_t speed = num_from_double(c->speed_rad_s / base.speed_rad_s);
    const num_t error = num_from_double(c->error_turns);
    const num_t deficit = num_from_double(c->deficit_rad_s / base.speed_rad_s);
    enum synchronism verdict[] = {
        (synchronism_monitor_take(&monitor, &params, innovation_sum(c->disturbance_V), c->holding),
         synchronism_monitor_judge_voltage(&monitor, &params, speed,
                                           num_from_double(c->i_d_A / base.current_A))),
        c->holding ? synchronism_monitor_judge_hold(&monitor, &params, speed, c->leads)
                   : synchronism_monitor_judge_motion(&monitor, &params, speed,
                                                      num_from_double(c->i_d_A / base.current_A)),
        synchronism_monitor_judge_torque(&monitor, &params,
                                         num_from_double(c->wanted_A / base.current_A), speed),
        synchronism_monitor_judge_load(&monitor, &params,
                                       num_from_double(c->load_Nm / base.torque_Nm)),
        synchronism_monitor_judge_following(&monitor, &params, error, deficit),
        c->holding ? synchronism_monitor_judge_pull_out(&monitor, error) : SYNCHRONISM_SURE,
    };

    for (size_t i = 0; i < sizeof verdict / sizeof *verdict; ++i) {
        if (verdict[i] != SYNCHRONISM_SURE) {
            return verdict[i];
        }
    }
    return synchronism_monitor_judge_load_angle(&monitor);
}

/* The verdict after a time of the same. */
static enum synchronism after(const struct course *c, double time_s)
{
    enum synchronism verdict = SYNCHRONISM_SURE;

    for (int n = (int)(time_s / BLOCK_S + 0.5); n > 0; n--) {
        verdict = block(c);
        if (verdict == SYNCHRONISM_LOST || verdict == SYNCHRONISM_STALLED) {
            return verdict;
        }
    }
    return verdict;
}

static void expect(enum synchronism verdict, struct course c, double time_s)
{
    synchronism_monitor_reset(&monitor, &params);
    TEST_ASSERT_EQUAL_INT(verdict, after(&c, time_s));
}

static void test_a_drive_at_rest_and_in_steady_motion_is_sure(void)
{
    expect(SYNCHRONISM_SURE, at_rest, 1.0);
    expect(
        SYNCHRONISM_SURE,
        (struct course){.speed_rad_s = 45.0, .load_Nm = 0.3, .wanted_A = 2.2, .error_turns = 2.0},
        1.0);
    expect(SYNCHRONISM_SURE, (struct course){.i_d_A = 1.5, .holding = true, .load_Nm = 0.2}, 1.0);
}

/* A rotor 90 degrees beside its estimate at 20 rad/s shows all of its back-EMF, 3.1 V, in d. */
static void test_a_rotor_a_quarter_turn_off_is_lost_within_two_blocks(void)
{
    expect(SYNCHRONISM_LOST, (struct course){.speed_rad_s = 20.0, .disturbance_V = 3.14},
           2.0 * BLOCK_S);
    expect(SYNCHRONISM_LOST, (struct course){.speed_rad_s = -20.0, .disturbance_V = -3.14},
           2.0 * BLOCK_S);
}

/* V_0 + Km |w| / 4, on either side of it; just below it, for as long as what is more than the
   second term alone may last. */
static void test_the_voltage_allowed_grows_with_a_quarter_of_the_back_emf(void)
{
    static const double speeds_rad_s[] = {0.0, 8.0, -50.0, 120.0};

    for (unsigned i = 0; i < sizeof speeds_rad_s / sizeof speeds_rad_s[0]; i++) {
        const double speed = speeds_rad_s[i];
        const double allowed = FLOOR_V + 0.25 * bench_params.torque_constant_Nm_A * fabs(speed);

        expect(SYNCHRONISM_LOST,
               (struct course){.speed_rad_s = speed, .disturbance_V = 1.02 * allowed}, 10e-3);
        expect(SYNCHRONISM_DOUBTFUL,
               (struct course){.speed_rad_s = speed, .disturbance_V = -0.98 * allowed},
               3.0 * BLOCK_S);
        expect(SYNCHRONISM_DOUBTFUL,
               (struct course){.speed_rad_s = speed, .disturbance_V = 0.52 * allowed}, 10e-3);
        expect(SYNCHRONISM_SURE,
               (struct course){.speed_rad_s = speed, .disturbance_V = 0.48 * allowed}, 1.0);
    }
}

/* What an estimate half a turn off shows, 0.4 Km w, for 6.4 ms behind the block that it begins in.
 */
static void test_a_rotor_half_a_turn_beside_its_estimate_is_lost(void)
{
    static const double speeds_rad_s[] = {2.5, -4.0, 8.0};

    for (unsigned i = 0; i < sizeof speeds_rad_s / sizeof speeds_rad_s[0]; i++) {
        const double speed = speeds_rad_s[i];
        const double back_emf_V = bench_params.torque_constant_Nm_A * speed;
        struct course opposite = {.speed_rad_s = speed, .disturbance_V = 0.4 * back_emf_V};

        synchronism_monitor_reset(&monitor, &params);
        TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&opposite, 4.0 * BLOCK_S));
        TEST_ASSERT_EQUAL_INT(SYNCHRONISM_LOST, block(&opposite));
        opposite.disturbance_V = 0.24 * back_emf_V;
        synchronism_monitor_reset(&monitor, &params);
        TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&opposite, 1.0));
    }
}

/* Slower than standing, in a hold, or broken off, it is none. */
static void test_what_does_not_last_in_motion_is_no_loss(void)
{
    struct course c = {.speed_rad_s = 2.0, .disturbance_V = 0.2};

    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&c, 1.0));
    c = (struct course){.speed_rad_s = 4.0, .disturbance_V = 0.25};
    for (int n = 0; n < 50; n++) {
        TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&at_rest, 2.0 * BLOCK_S));
        TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&c, 4.0 * BLOCK_S));
    }
    (void)after(&at_rest, 2.0 * BLOCK_S);
    for (int n = 0; n < 50; n++) {
        c.holding = n % 4 == 3;
        TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, block(&c));
    }
}

/* A kick of a load step is over after a block; a voltage that changes its sign is an oscillation.
 */
static void test_what_lasts_a_block_or_changes_its_sign_is_no_loss(void)
{
    struct course kick = {.disturbance_V = 1.9 * FLOOR_V};

    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, block(&kick));
    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, block(&at_rest));
    for (int n = 0; n < 50; n++) {
        kick.disturbance_V = -kick.disturbance_V;
        TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, block(&kick));
    }
}

static void test_an_unknown_resistance_is_allowed_its_voltage(void)
{
    const struct course off = {.i_d_A = 1.5, .holding = true, .disturbance_V = 0.7 * 0.37 * 1.5};

    expect(SYNCHRONISM_LOST, off, 10e-3);
    task.resistance_calibrated = task.resistance_adapted = false;
    design();
    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&off, 1.0));
}

static void test_a_hold_that_adapts_the_resistance_makes_it_known(void)
{
    const struct course off = {.i_d_A = 1.5, .speed_rad_s = 3.0, .disturbance_V = 0.7 * 0.37 * 1.5};
    const struct course held = {.i_d_A = 1.5, .holding = true};

    task.resistance_calibrated = false;
    design();
    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&off, 1.0));
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_SURE, after(&held, 0.15));
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_LOST, after(&off, 10e-3));
}

/* A tenth of a volt: a rotor that creeps at 0.7 rad/s. In motion that is nothing. */
static void test_a_settled_hold_sees_a_rotor_creep_away_in_20_ms(void)
{
    struct course creeps = {.i_d_A = 1.5, .holding = true, .disturbance_V = 0.1};
    struct course still = creeps;

    still.disturbance_V = 0.025;
    expect(SYNCHRONISM_SURE, still, 1.0);
    still.disturbance_V = 0.05;
    expect(SYNCHRONISM_DOUBTFUL, still, 1.0);
    expect(SYNCHRONISM_SURE, creeps, 0.1);
    creeps.disturbance_V = -0.1;
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_LOST, after(&creeps, 20e-3));
    creeps.holding = false;
    expect(SYNCHRONISM_SURE, creeps, 1.0);
}

/* An offset of the voltage that has turned with the rotor's d axis, also where it turns round; a
   load of a tenth of the rated torque that is not known: 0.2 rad electrical behind the frame. */
static void test_a_hold_that_leads_a_rotor_bears_that_offsets_turn_and_that_it_lags(void)
{
    struct course led = {.i_d_A = 1.5, .holding = true, .leads = true, .disturbance_V = 0.12};

    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&led, 1.0));
    led.speed_rad_s = 2.0;
    led.disturbance_V = 0.4 * bench_params.torque_constant_Nm_A * led.speed_rad_s;
    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&led, 1.0));
    led.disturbance_V = 0.5;
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_LOST, after(&led, 10e-3));
}

/* The resistance has a tenth of a second to be found anew. */
static void test_a_hold_settles_anew_behind_leading(void)
{
    const struct course held = {.i_d_A = 1.5, .holding = true};
    struct course led = {.i_d_A = 1.5, .holding = true, .leads = true, .disturbance_V = 0.12};

    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_SURE, after(&held, 0.15));
    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&led, 0.2));
    led.leads = false;
    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_LOST, after(&led, 0.1));
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_LOST, after(&led, 35e-3));
}

/* Motion in between makes it another hold, which has to settle again. */
static void test_a_hold_settles_anew_behind_motion(void)
{
    const struct course held = {.i_d_A = 1.5, .holding = true};
    struct course creeps = held;

    creeps.disturbance_V = -0.1;
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_SURE, after(&held, 0.15));
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_SURE, block(&at_rest));
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_SURE, after(&creeps, 0.1));
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_LOST, after(&creeps, 35e-3));
}

static void test_a_rotor_that_stands_under_full_current_is_stalled_in_15_ms(void)
{
    const struct course stands = {.wanted_A = -LIMIT_A, .speed_rad_s = 0.5, .error_turns = -0.1};

    expect(SYNCHRONISM_DOUBTFUL, stands, 12e-3);
    expect(SYNCHRONISM_STALLED, stands, 14.4e-3);
}

/* A hold whose q current bears a load that it takes for more than it is. 0.38 rad/s is what V_1 is
   the back-EMF of. */
static void test_a_rotor_that_rests_in_its_hold_under_full_current_is_held(void)
{
    struct course rests = {.wanted_A = -LIMIT_A,
                           .i_d_A = LIMIT_A,
                           .speed_rad_s = -0.35,
                           .load_Nm = -0.65,
                           .holding = true};

    expect(SYNCHRONISM_SURE, rests, 1.0);
    rests.speed_rad_s = 0.42;
    expect(SYNCHRONISM_STALLED, rests, 14.4e-3);
    rests.speed_rad_s = 0.0;
    rests.leads = true;
    expect(SYNCHRONISM_STALLED, rests, 14.4e-3);
}

/* At 40 Hz, 160 degrees of phase between the two: 7 rad/s are 1.1 V of back-EMF, of which a third
   is in d. */
static void test_a_rotor_that_vibrates_in_its_hold_is_held(void)
{
    const struct course held = {.i_d_A = LIMIT_A, .holding = true};

    synchronism_monitor_reset(&monitor, &params);
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_SURE, after(&held, 0.2));
    for (int n = 0; n < 200; n++) {
        const double phase = 6.2831853 * 40.0 * BLOCK_S * n;
        const double grown = n < 16 ? n / 16.0 : 1.0;
        const struct course swings = {.i_d_A = LIMIT_A,
                                      .speed_rad_s = grown * 7.0 * sin(phase),
                                      .disturbance_V = grown * 0.35 * sin(phase + 2.8),
                                      .holding = true};

        TEST_ASSERT_LESS_THAN(SYNCHRONISM_STALLED, block(&swings));
    }
    const struct course creeps = {.i_d_A = LIMIT_A, .holding = true, .disturbance_V = 0.2};

    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_LOST, after(&creeps, 40e-3));
}

/* Heat has halved the limit: half of the current is all of it. */
static void test_what_turns_in_a_hold_on_all_the_current_that_heat_leaves_is_stalled(void)
{
    const struct course turns = {
        .wanted_A = LIMIT_A / 2.0, .i_d_A = LIMIT_A, .speed_rad_s = 0.5, .holding = true};

    expect(SYNCHRONISM_SURE, turns, 1.0);
    params.full_current = num_half(params.full_current);
    expect(SYNCHRONISM_STALLED, turns, 16e-3);
}

/* 3 A through 0.2 ohm that nobody knows of look like 4 rad/s. */
static void test_a_speed_that_an_unknown_resistance_feigns_is_standing(void)
{
    const struct course feigned = {.wanted_A = LIMIT_A, .speed_rad_s = 4.0};
    const struct course held = {.i_d_A = 1.5, .holding = true};

    expect(SYNCHRONISM_SURE, feigned, 1.0);
    task.resistance_calibrated = false;
    design();
    expect(SYNCHRONISM_STALLED, feigned, 14.4e-3);
    synchronism_monitor_reset(&monitor, &params);
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_SURE, after(&held, 0.15));
    TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_STALLED, after(&feigned, 1.0));
}

/* With a twentieth of the rated torque left. */
static void test_a_rotor_that_starts_under_a_heavy_load_is_not(void)
{
    struct course c = {.wanted_A = LIMIT_A, .error_turns = 3.0, .deficit_rad_s = -1.0};

    for (double t = 0.0; t < 50e-3; t += BLOCK_S) {
        c.speed_rad_s = 0.06 * 0.471 / bench_params.inertia_kgm2 * t;
        c.deficit_rad_s = -c.speed_rad_s;
        TEST_ASSERT_NOT_EQUAL(SYNCHRONISM_STALLED, block(&c));
    }
}

static void test_a_rotor_that_falls_behind_for_a_tenth_of_a_second_is_stalled(void)
{
    const struct course lags = {
        .wanted_A = LIMIT_A, .speed_rad_s = 20.0, .error_turns = 1.0, .deficit_rad_s = 5.0};
    struct course catches_up = lags;

    expect(SYNCHRONISM_DOUBTFUL, lags, 95e-3);
    expect(SYNCHRONISM_STALLED, lags, 105e-3);
    catches_up.deficit_rad_s = -5.0;
    expect(SYNCHRONISM_SURE, catches_up, 1.0);
}

static void test_a_lag_with_current_to_spare_is_the_laws_own(void)
{
    expect(SYNCHRONISM_SURE,
           (struct course){.wanted_A = 0.9 * LIMIT_A, .speed_rad_s = 45.0, .error_turns = 3.6},
           1.0);
}

static void test_a_load_far_beyond_the_rated_torque_is_a_stall(void)
{
    expect(SYNCHRONISM_STALLED, (struct course){.load_Nm = -0.77, .speed_rad_s = 30.0}, 3.2e-3);
    expect(SYNCHRONISM_SURE, (struct course){.load_Nm = 0.74, .speed_rad_s = 30.0}, 1.0);
}

static void test_a_load_angle_of_a_quarter_turn_is_pull_out(void)
{
    struct course c = {.i_d_A = 1.5, .holding = true, .error_turns = -0.26};

    expect(SYNCHRONISM_STALLED, c, BLOCK_S);
    c.error_turns = 0.24;
    expect(SYNCHRONISM_DOUBTFUL, c, 1.0);
    c.error_turns = 0.12;
    expect(SYNCHRONISM_SURE, c, 1.0);
    c = (struct course){.error_turns = -5.0, .speed_rad_s = 20.0, .deficit_rad_s = -20.0};
    expect(SYNCHRONISM_SURE, c, 1.0);
}

/* On either side: a rotor that catches up is not behind. */
static void test_a_rotor_that_catches_up_is_not_stalled(void)
{
    for (int side = -1; side <= 1; side += 2) {
        struct course c = {.wanted_A = 3.0, .speed_rad_s = 20.0, .error_turns = side * 0.6};

        c.deficit_rad_s = -side * 40.0;
        expect(SYNCHRONISM_SURE, c, 0.3);
        c.deficit_rad_s = side * 40.0;
        expect(SYNCHRONISM_STALLED, c, 0.3);
    }
}

static void test_doubtful_lasts_for_20_ms(void)
{
    const struct course doubtful = {.holding = true, .error_turns = 0.2};
    int blocks = 0;

    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_DOUBTFUL, block(&doubtful));
    while (block(&at_rest) == SYNCHRONISM_DOUBTFUL) {
        blocks++;
    }
    TEST_ASSERT_INT_WITHIN(1, (int)(20e-3 / BLOCK_S), blocks);
}

#if STEADYSTEP_NUM != NUM_FIXED
static void test_a_disturbance_that_is_no_number_is_a_loss(void)
{
    const num_t nothing = (num_t)__builtin_nan("");

    synchronism_monitor_take(&monitor, &params, nothing, false);
    TEST_ASSERT_EQUAL_INT(SYNCHRONISM_LOST,
                          synchronism_monitor_judge_voltage(&monitor, &params, NUM(0.0), NUM(0.0)));
}
#endif

/* Of 24 V, 3 A and 0.157 N m/A; blocks of 1.6 ms. */
static void test_the_design_in_figures(void)
{
    const double standing_rad_s = 0.05 * 0.157 * 3.0 / bench_params.inertia_kgm2 * 14.4e-3;

    TEST_ASSERT_NUM_WITHIN(1e-5, 0.25 / 24.0, params.voltage_floor);
    TEST_ASSERT_NUM_WITHIN(1e-5, 0.06 / 24.0, params.settled_floor);
    TEST_ASSERT_NUM_WITHIN(1e-5, standing_rad_s / base.speed_rad_s, params.standing_speed);
    TEST_ASSERT_NUM_WITHIN(1e-5, standing_rad_s / base.speed_rad_s, params.standing_speed_at_first);
    TEST_ASSERT_NUM_WITHIN(1e-4, 1.6 * 0.157 * 3.0 / base.torque_Nm, params.load_limit);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.05 * 0.37 / base.resistance_ohm,
                              coef_to_double(params.voltage_per_current));
    TEST_ASSERT_NUM_WITHIN(1e-5, 0.99 * LIMIT_A / base.current_A, params.full_current);
    TEST_ASSERT_EQUAL_UINT32(69, params.settled_blocks);
    task.resistance_calibrated = false;
    design();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.75 * 0.37 / base.resistance_ohm,
                              coef_to_double(params.voltage_per_current_at_first));
    TEST_ASSERT_NUM_WITHIN(1e-4,
                           (standing_rad_s + 0.75 * 0.37 * LIMIT_A / 0.157) / base.speed_rad_s,
                           params.standing_speed_at_first);
}

/* 0.24 Km/N in 12.8 ms, where that is more than a four hundredth of the supply. */
static void test_a_settled_hold_allows_for_the_flux_of_a_rotor_that_a_load_displaces(void)
{
    struct motor_params strong = bench_params;

    task.motor = &strong;
    strong.torque_constant_Nm_A *= 3.0;
    design();
    TEST_ASSERT_NUM_WITHIN(1e-5, 0.24 * 3.0 * 0.157 / 50.0 / 12.8e-3 / base.voltage_V,
                           params.settled_floor);
    strong.torque_constant_Nm_A /= 3.0;
    strong.supply_V *= 2.0;
    design();
    TEST_ASSERT_NUM_WITHIN(1e-5, 0.12 / base.voltage_V, params.settled_floor);
}

/* A block is a time and no number of periods, and has a period for each of its steps. */
static void test_the_times_follow_the_control_period(void)
{
    TEST_ASSERT_EQUAL_UINT32(16, params.block_periods);
    task.period_s = 0.5 * PERIOD_S;
    TEST_ASSERT_EQUAL_UINT32(32, synchronism_monitor_design(&task).block_periods);
    task.period_s = 2.0 * PERIOD_S;
    TEST_ASSERT_EQUAL_UINT32(SYNCHRONISM_STEPS, synchronism_monitor_design(&task).block_periods);
    task.period_s = 4.0 * PERIOD_S;
    TEST_ASSERT_EQUAL_UINT32(SYNCHRONISM_STEPS, synchronism_monitor_design(&task).block_periods);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_drive_at_rest_and_in_steady_motion_is_sure);
    RUN_TEST(test_a_rotor_a_quarter_turn_off_is_lost_within_two_blocks);
    RUN_TEST(test_the_voltage_allowed_grows_with_a_quarter_of_the_back_emf);
    RUN_TEST(test_a_rotor_half_a_turn_beside_its_estimate_is_lost);
    RUN_TEST(test_what_does_not_last_in_motion_is_no_loss);
    RUN_TEST(test_what_lasts_a_block_or_changes_its_sign_is_no_loss);
    RUN_TEST(test_an_unknown_resistance_is_allowed_its_voltage);
    RUN_TEST(test_a_hold_that_adapts_the_resistance_makes_it_known);
    RUN_TEST(test_a_settled_hold_sees_a_rotor_creep_away_in_20_ms);
    RUN_TEST(test_a_hold_that_leads_a_rotor_bears_that_offsets_turn_and_that_it_lags);
    RUN_TEST(test_a_hold_settles_anew_behind_leading);
    RUN_TEST(test_a_hold_settles_anew_behind_motion);
    RUN_TEST(test_a_rotor_that_stands_under_full_current_is_stalled_in_15_ms);
    RUN_TEST(test_a_rotor_that_rests_in_its_hold_under_full_current_is_held);
    RUN_TEST(test_a_rotor_that_vibrates_in_its_hold_is_held);
    RUN_TEST(test_what_turns_in_a_hold_on_all_the_current_that_heat_leaves_is_stalled);
    RUN_TEST(test_a_speed_that_an_unknown_resistance_feigns_is_standing);
    RUN_TEST(test_a_rotor_that_starts_under_a_heavy_load_is_not);
    RUN_TEST(test_a_rotor_that_falls_behind_for_a_tenth_of_a_second_is_stalled);
    RUN_TEST(test_a_lag_with_current_to_spare_is_the_laws_own);
    RUN_TEST(test_a_load_far_beyond_the_rated_torque_is_a_stall);
    RUN_TEST(test_a_load_angle_of_a_quarter_turn_is_pull_out);
    RUN_TEST(test_a_rotor_that_catches_up_is_not_stalled);
    RUN_TEST(test_doubtful_lasts_for_20_ms);
#if STEADYSTEP_NUM != NUM_FIXED
    RUN_TEST(test_a_disturbance_that_is_no_number_is_a_loss);
#endif
    RUN_TEST(test_the_design_in_figures);
    RUN_TEST(test_a_settled_hold_allows_for_the_flux_of_a_rotor_that_a_load_displaces);
    RUN_TEST(test_the_times_follow_the_control_period);
    return UNITY_END();
}
