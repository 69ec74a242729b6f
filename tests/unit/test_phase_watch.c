/* A current that stands although its voltage pushes: a broken lead, or a stuck sensor. */
#include "firmware/drive/phase_watch.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

enum { ZERO = 2048, NEVER = 10000 };

static struct phase_watch watch;
static struct phase_watch_params params;
static struct phase_look look;

static struct phase_watch_params design(enum drive_feedback feedback)
{
    const struct per_unit base = per_unit_base(&bench_params, PERIOD_S);
    struct hal_facts facts = bench_facts;
    struct drive_settings settings;

    drive_settings_default(&settings, &bench_params);
    settings.feedback = feedback;
    settings.observer_bandwidth_rad_s = 1400.0;
    facts.encoder_counts_per_turn = 4000;
    return phase_watch_design(&base, &facts, &settings);
}

void setUp(void)
{
    params = design(DRIVE_FEEDBACK_SENSORLESS);
    watch = (struct phase_watch){.period = 0};
    look = (struct phase_look){.code = {ZERO, ZERO}};
}

void tearDown(void)
{
}

/* A period with this much noise; the fault that it ends in. */
static enum drive_fault period(uint16_t noise)
{
    const uint16_t code[2] = {look.code[0], look.code[1]};

    look.period++;
    look.code[0] = (uint16_t)(look.code[0] + (look.period % 2u == 0u ? noise : 0u));
    const enum drive_fault fault = phase_watch_step(&watch, &params, &look);

    look.code[0] = code[0];
    look.code[1] = code[1];
    return fault;
}

/* Periods until it is said; NEVER. */
static int periods_until(enum drive_fault fault, uint16_t noise)
{
    for (int n = 1; n < NEVER; n++) {
        const enum drive_fault now = period(noise);

        if (now != DRIVE_FAULT_NONE) {
            TEST_ASSERT_EQUAL_STRING(drive_fault_name(fault), drive_fault_name(now));
            return n;
        }
    }
    return NEVER;
}

/* 0.1 of twice the rated current a period: the eleventh is more than it, behind one that begins. */
static void test_a_phase_that_does_not_move_is_named_as_soon_as_it_would_have_had_to(void)
{
    static const struct {
        int phase;
        bool flows;
        enum drive_fault fault;
    } all[] = {
        {0, false, DRIVE_FAULT_OPEN_PHASE_A},
        {1, false, DRIVE_FAULT_OPEN_PHASE_B},
        {0, true, DRIVE_FAULT_CURRENT_SENSOR_A},
        {1, true, DRIVE_FAULT_CURRENT_SENSOR_B},
    };

    for (size_t i = 0; i < 4; i++) {
        setUp();
        look.push[all[i].phase] = NUM(0.0999);
        look.flows[all[i].phase] = all[i].flows;
        (void)period(0);
        TEST_ASSERT_EQUAL_INT(11, periods_until(all[i].fault, 0));
    }
}

static void test_the_lag_is_a_mean_over_13_ms_whatever_the_period(void)
{
    static const double period_s[] = {50e-6, 100e-6, 200e-6};

    for (int i = 0; i < 3; i++) {
        struct per_unit base = per_unit_base(&bench_params, period_s[i]);
        struct hal_facts facts = bench_facts;
        struct drive_settings settings;

        facts.control_period_s = period_s[i];
        drive_settings_default(&settings, &bench_params);
        params = phase_watch_design(&base, &facts, &settings);
        TEST_ASSERT_EQUAL_UINT(64u >> i, params.lag_looks);
    }
}

/* Looks at a rotor that turns by so much in a period, each with as large a voltage; `stuck`: b is.
   The periods until a fault is said, or so many. */
static int fast_looks(double turns, double angle_turns, double amplitude, bool stuck, int periods,
                      enum drive_fault *fault)
{
    setUp();
    look.fast = true;
    look.push[0] = look.push[1] = NUM(0.2);
    look.flows[0] = look.flows[1] = true;
    for (*fault = DRIVE_FAULT_NONE;
         look.period < (uint32_t)periods && *fault == DRIVE_FAULT_NONE;) {
        look.period += 4u + watch.apart;
        const double at = TWO_PI * (angle_turns + turns * (double)look.period);

        look.code[0] = (uint16_t)lrint(ZERO + amplitude * cos(at));
        look.code[1] = stuck ? ZERO + 50 : (uint16_t)lrint(ZERO + amplitude * sin(at));
        *fault = phase_watch_step(&watch, &params, &look);
    }
    return (int)look.period;
}

/* At 2/9 of a turn in a period what is seen four and five periods apart is one value for ever. */
static void test_no_current_of_a_fast_rotor_stands_whatever_its_speed(void)
{
    enum drive_fault fault;

    for (double turns = 0.0625; turns < 0.205; turns += 1.0 / 1440.0) {
        for (double angle = 0.0; angle < 1.0; angle += 1.0 / 64.0) {
            (void)fast_looks(turns, angle, 1.8 * params.noise_codes, false, 300, &fault);
            TEST_ASSERT_EQUAL_STRING("none", drive_fault_name(fault));
        }
    }
}

static void test_small_currents_of_a_fast_rotor_stand_and_say_nothing(void)
{
    enum drive_fault fault;

    (void)fast_looks(0.1, 0.0, 0.5 * params.noise_codes, false, 300, &fault);
    TEST_ASSERT_EQUAL_STRING("none", drive_fault_name(fault));
}

static void test_a_stuck_sensor_of_a_fast_rotor_is_found_in_seven_looks(void)
{
    enum drive_fault fault;

    for (double turns = 0.0625; turns < 0.205; turns += 1.0 / 144.0) {
        TEST_ASSERT_LESS_THAN(60, fast_looks(turns, 0.3, 100.0, true, 300, &fault));
        TEST_ASSERT_EQUAL_STRING("current-sensor-b", drive_fault_name(fault));
    }
}

static void test_noise_stands_and_more_does_not(void)
{
    look.push[0] = NUM(0.1);
    (void)period(0);
    TEST_ASSERT_TRUE(periods_until(DRIVE_FAULT_OPEN_PHASE_A, params.noise_codes) < 15);
    watch.period -= 100u; /* begins anew */
    TEST_ASSERT_EQUAL_INT(NEVER,
                          periods_until(DRIVE_FAULT_NONE, (uint16_t)(params.noise_codes + 1u)));
}

/* Two currents of a moving rotor can be the same, and three. */
static void test_four_looks_at_least_find_it_standing(void)
{
    look.push[0] = NUM(2.0);
    (void)period(0);
    TEST_ASSERT_EQUAL_INT(4, periods_until(DRIVE_FAULT_OPEN_PHASE_A, 0));
}

static void test_without_a_push_a_current_may_stand(void)
{
    TEST_ASSERT_EQUAL_INT(NEVER, periods_until(DRIVE_FAULT_NONE, 0));
}

/* A voltage that changes its sign from look to look moves no current on the whole. */
static void test_pushes_to_and_fro_cancel(void)
{
    for (int n = 0; n < 1000; n++) {
        look.push[0] = n % 2 == 0 ? NUM(0.3) : NUM(-0.3);
        TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_NONE, period(0));
    }
    look.push[0] = NUM(-0.3);
    TEST_ASSERT_TRUE(periods_until(DRIVE_FAULT_OPEN_PHASE_A, 0) < 6);
}

/* What has not been seen may have moved. */
static void test_a_background_that_was_busy_begins_anew(void)
{
    look.push[0] = NUM(0.0999);
    (void)period(0);
    for (int n = 0; n < 100; n++) {
        for (int i = 0; i < 10; i++) {
            TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_NONE, period(0));
        }
        look.period += 14;
    }
    (void)period(0);
    TEST_ASSERT_EQUAL_INT(11, periods_until(DRIVE_FAULT_OPEN_PHASE_A, 0));
}

/* 60 mA of 3 A; 5 % of the supply, with 4,000 counts two of them at 1,400 rad/s: 2 x 2.2 rad/s. */
static void test_what_passes_for_noise(void)
{
    const struct per_unit base = per_unit_base(&bench_params, PERIOD_S);
    const double counts = 2.0 * 6.283185307 / 4000.0 * 1400.0 / base.speed_rad_s;

    TEST_ASSERT_EQUAL_UINT16(
        (uint16_t)(0.02 * bench_params.rated_current_A / bench_facts.current_A_per_code),
        params.noise_codes);
    TEST_ASSERT_NUM_WITHIN(1e-4, 0.05, params.voltage_error);
    TEST_ASSERT_NUM_WITHIN(1e-4, 0.05 + counts, design(DRIVE_FEEDBACK_ENCODER).voltage_error);
}

static const char *suspected(void)
{
    return drive_fault_name((enum drive_fault)watch.suspected);
}

/* A look every fourth period, with this much of the current that is asked for of phase b. */
static void look_behind(num_t wanted)
{
    look.period += 4u;
    look.wanted[1] = wanted;
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_NONE, phase_watch_step(&watch, &params, &look));
}

static void test_a_current_that_stands_while_another_is_asked_for_is_suspected(void)
{
    look.flows[1] = true;
    look_behind(NUM(0.3));
    for (int n = 0; n < 100; n++) { /* 5 % of the rated current, no more */
        look_behind(n % 2 == 0 ? NUM(0.3249) : NUM(0.2751));
    }
    TEST_ASSERT_EQUAL_STRING("none", suspected());
    look_behind(NUM(0.3251));
    look_behind(NUM(0.3251));
    TEST_ASSERT_EQUAL_STRING("none", suspected());
    look_behind(NUM(0.3251));
    TEST_ASSERT_EQUAL_STRING("current-sensor-b", suspected());
    look_behind(NUM(0.3251));
    look_behind(NUM(0.3)); /* it may have come back meanwhile */
    TEST_ASSERT_EQUAL_STRING("current-sensor-b", suspected());
    look_behind(NUM(0.3));
    TEST_ASSERT_EQUAL_STRING("none", suspected());
    look.code[1] = (uint16_t)(ZERO + params.noise_codes + 1u); /* it moves */
    look_behind(NUM(0.3251));
    look_behind(NUM(0.3251));
    TEST_ASSERT_EQUAL_STRING("none", suspected());
}

/* What a hold asks for is there, but for a lead that is not. */
static void test_a_hold_whose_current_is_gone_is_suspected_at_once(void)
{
    look.held = look.flows[1] = true;
    look.code[1] = ZERO + 900;
    look_behind(NUM(0.101));
    look.flows[1] = false;
    look.code[1] = ZERO;
    look_behind(NUM(0.099));
    TEST_ASSERT_EQUAL_STRING("none", suspected());
    look_behind(NUM(0.101));
    TEST_ASSERT_EQUAL_STRING("open-phase-b", suspected());
    look.flows[1] = true;
    look_behind(NUM(0.101));
    TEST_ASSERT_EQUAL_STRING("none", suspected());
    look.held = look.flows[1] = false;
    look_behind(NUM(0.101));
    TEST_ASSERT_EQUAL_STRING("none", suspected());
}

/* Of phase b: the current is zero, behind a look at this one, with this one asked for, which it was
   off by so much. */
static const char *suspected_behind(uint16_t code, num_t wanted, num_t off)
{
    setUp();
    look.held = look.flows[1] = true;
    look.code[1] = code;
    look.off[1] = off;
    look_behind(wanted);
    look.flows[1] = false;
    look.code[1] = ZERO;
    look.off[1] = NUM(0.2);
    look_behind(NUM(0.2));
    return suspected();
}

/* A rotor that is shaken takes its currents through zero: what is asked for swings along, or the
   current has not followed before. */
static void test_a_current_that_passes_zero_is_no_broken_lead(void)
{
    TEST_ASSERT_EQUAL_STRING("open-phase-b", suspected_behind(ZERO + 400, NUM(0.2249), NUM(0.074)));
    TEST_ASSERT_EQUAL_STRING("none", suspected_behind(ZERO + 400, NUM(0.2251), NUM(0.074)));
    TEST_ASSERT_EQUAL_STRING("none", suspected_behind(ZERO + 400, NUM(0.2249), NUM(0.076)));
    look_behind(NUM(0.3)); /* it stays, as one that passes does not */
    TEST_ASSERT_EQUAL_STRING("open-phase-b", suspected());
}

/* The other answers what it does to the rotor. */
static void test_of_two_phases_the_one_that_is_further_off_is_suspected(void)
{
    for (int furthest = 0; furthest < 2; furthest++) {
        setUp();
        look.held = true;
        look_behind(NUM(0.2)); /* it stands */
        look.wanted[0] = NUM(0.2);
        look.off[furthest] = NUM(0.3);
        look.off[1 - furthest] = NUM(0.2);
        look_behind(NUM(0.2));
        TEST_ASSERT_EQUAL_STRING(furthest == 0 ? "open-phase-a" : "open-phase-b", suspected());
    }
}

static void test_a_wrong_voltage_is_suspected_before_a_phase(void)
{
    look.voltage_wrong = look.held = true;
    look_behind(NUM(0.0));
    TEST_ASSERT_EQUAL_STRING("voltage-sensor", suspected());
    look_behind(NUM(0.0));
    look_behind(NUM(0.2));
    TEST_ASSERT_EQUAL_STRING("voltage-sensor", suspected());
    look.voltage_wrong = false;
    look_behind(NUM(0.2));
    TEST_ASSERT_EQUAL_STRING("open-phase-b", suspected());
    look_behind(NUM(0.0));
    TEST_ASSERT_EQUAL_STRING("none", suspected());
}

/* Looks until it is said, of which so many in a row are wrong, and then one is not; NEVER. */
static int looks_until_voltage(int wrong)
{
    setUp();
    for (int n = 1; n < 200; n++) {
        look.period += 4u;
        look.voltage_wrong = n % (wrong + 1) != 0;
        const enum drive_fault fault = phase_watch_step(&watch, &params, &look);

        if (fault != DRIVE_FAULT_NONE) {
            TEST_ASSERT_EQUAL_STRING("voltage-sensor", drive_fault_name(fault));
            return n;
        }
    }
    return NEVER;
}

static void test_eight_looks_with_a_wrong_voltage_make_sure_less_two_for_each_without(void)
{
    TEST_ASSERT_EQUAL_INT(8, looks_until_voltage(8));
    TEST_ASSERT_EQUAL_INT(11, looks_until_voltage(7));
    TEST_ASSERT_EQUAL_INT(23, looks_until_voltage(3));
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_voltage(2));
}

static void test_what_was_measured_wrong_before_a_gap_is_forgotten(void)
{
    look.voltage_wrong = true;
    for (int n = 1; n < 8; n++) {
        look_behind(NUM(0.0));
    }
    look.period += 14u;
    for (int n = 1; n < 8; n++) {
        look_behind(NUM(0.0));
    }
}

static void test_what_was_measured_wrong_before_the_drive_was_off_is_forgotten(void)
{
    (void)looks_until_voltage(7);
    phase_watch_forget(&watch);
    look.voltage_wrong = true;
    for (int n = 1; n < 8; n++) {
        look_behind(NUM(0.0));
    }
}

/* A count that wraps would be a look that begins. */
static void test_what_stands_for_long_goes_on_standing(void)
{
    for (int n = 0; n < 300; n++) {
        look_behind(NUM(0.0));
    }
    TEST_ASSERT_EQUAL_UINT8(7, watch.count[0].looks);
}

/* A lead of a hold that breaks: its voltage would change the current by so much in each period. */
static int looks_until_gone(num_t push)
{
    setUp();
    look.held = look.flows[1] = true;
    look.code[1] = ZERO + 400;
    look_behind(NUM(0.2));
    look.flows[1] = false;
    look.code[1] = ZERO;
    look.push[1] = push;
    for (int n = 1; n < NEVER; n++) {
        look.period += 4u;
        if (phase_watch_step(&watch, &params, &look) != DRIVE_FAULT_NONE) {
            return n;
        }
    }
    return NEVER;
}

/* Eight periods of push are two looks; dead time keeps a current at zero, too, but not against
   that. */
static void test_a_hold_whose_current_stands_at_zero_against_its_voltage_is_open(void)
{
    TEST_ASSERT_EQUAL_INT(3, looks_until_gone(NUM(0.9)));
    TEST_ASSERT_EQUAL_INT(3, looks_until_gone(NUM(0.032)));
    TEST_ASSERT_EQUAL_INT(4, looks_until_gone(NUM(0.031)));
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_gone(NUM(0.0)));
}

/* ---- a converter that gives one code ---- */

/* Looks until phase b's is said to be dead, whose code changes every so many, as does that of phase
   a, and the resistance by a step; 0: not at all. */
static int looks_until_dead(int changes_a, int changes_b, int warms, enum drive_fault fault)
{
    static const uint16_t noise[2] = {0, 1};

    look.eighth = 40;
    for (int n = 1; n < 1000; n++) {
        look.period += 4u;
        look.code[0] = (uint16_t)(ZERO + 300 + (changes_a > 0 ? noise[n / changes_a % 2] : 0));
        look.code[1] = (uint16_t)(ZERO + 300 + (changes_b > 0 ? noise[n / changes_b % 2] : 0));
        look.resistance = (uint16_t)(251 + (warms != 0 ? n / warms : 0));
        const enum drive_fault now = phase_watch_step(&watch, &params, &look);

        if (now != DRIVE_FAULT_NONE) {
            TEST_ASSERT_EQUAL_STRING(drive_fault_name(fault), drive_fault_name(now));
            return n;
        }
    }
    return NEVER;
}

static int looks_until_dead_in_motion(int changes_a, int changes_b)
{
    setUp();
    look.turns = look.flows[1] = true;
    return looks_until_dead(changes_a, changes_b, 0, DRIVE_FAULT_CURRENT_SENSOR_B);
}

/* The first shows the code. */
static void test_a_converter_without_noise_is_dead_while_the_rotor_turns(void)
{
    TEST_ASSERT_EQUAL_INT(113, looks_until_dead_in_motion(1, 0));
    TEST_ASSERT_EQUAL_INT(113, looks_until_dead_in_motion(8, 0));
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_dead_in_motion(1, 112)); /* it is alive */
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_dead_in_motion(0, 0));   /* no noise at all */
    setUp();
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_dead(1, 0, 0, DRIVE_FAULT_NONE)); /* it rests */
}

/* At rest, whatever the other one does, and of a current of zero, too. */
static void test_a_sensor_that_scattered_is_dead_as_soon_as_it_does_not(void)
{
    static const int others[] = {1, 64, 0};

    for (int n = 0; n < 3; n++) {
        setUp();
        look.noisy[1] = true;
        TEST_ASSERT_EQUAL_INT(113, looks_until_dead(others[n], 0, 0, DRIVE_FAULT_CURRENT_SENSOR_B));
    }
    setUp();
    look.noisy[1] = true;
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_dead(0, 112, 0, DRIVE_FAULT_NONE));
    setUp();
    look.noisy[0] = true; /* the other's noise is none of this one's */
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_dead(1, 0, 0, DRIVE_FAULT_NONE));
}

/* 56 in 112 looks are more than 40 and 28 are less; a low byte wraps. */
static void test_in_a_hold_it_is_dead_as_the_resistance_moves_by_an_eighth(void)
{
    setUp();
    look.held = look.settled = look.flows[1] = true;
    TEST_ASSERT_EQUAL_INT(113, looks_until_dead(1, 0, 2, DRIVE_FAULT_CURRENT_SENSOR_B));
    setUp();
    look.held = look.settled = look.flows[1] = true;
    TEST_ASSERT_EQUAL_INT(113, looks_until_dead(1, 0, -2, DRIVE_FAULT_CURRENT_SENSOR_B));
    setUp();
    look.held = look.settled = look.flows[1] = true;
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_dead(1, 0, 4, DRIVE_FAULT_NONE));
    setUp();
    look.held = look.settled = look.flows[1] = true;
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_dead(1, 64, 2, DRIVE_FAULT_NONE));
    setUp();
    look.held = look.flows[1] = true; /* it is still being found */
    TEST_ASSERT_EQUAL_INT(NEVER, looks_until_dead(1, 0, 2, DRIVE_FAULT_NONE));
}

/* Of a current that is asked for, 16 are enough; none may be held by the bridge's dead time. */
static void test_a_code_that_its_reference_has_left_is_a_dead_sensors(void)
{
    for (int flows = 0; flows < 2; flows++) {
        setUp();
        look.held = true;
        look.flows[1] = flows == 1;
        look.code[1] = ZERO + 300;
        look_behind(NUM(0.3));
        for (int n = 1; n < 16; n++) {
            look_behind(NUM(0.3251));
        }
        look.period += 4u;
        TEST_ASSERT_EQUAL_STRING(
            drive_fault_name(flows == 1 ? DRIVE_FAULT_CURRENT_SENSOR_B : DRIVE_FAULT_NONE),
            drive_fault_name(phase_watch_step(&watch, &params, &look)));
    }
    setUp();
    look.held = look.flows[1] = true;
    look.code[1] = ZERO + 300;
    look_behind(NUM(0.3));
    for (int n = 1; n < 100; n++) {
        look_behind(NUM(0.3249));
    }
    look_behind(NUM(0.3251)); /* the current may follow in the next look */
    setUp();
    look.held = look.flows[1] = true;
    look_behind(NUM(0.3));
    for (int n = 1; n < 100; n++) { /* it stands, but not at one code */
        look.code[1] = (uint16_t)(ZERO + 300 + n / 15 % 2);
        look_behind(NUM(0.3251));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_phase_that_does_not_move_is_named_as_soon_as_it_would_have_had_to);
    RUN_TEST(test_the_lag_is_a_mean_over_13_ms_whatever_the_period);
    RUN_TEST(test_no_current_of_a_fast_rotor_stands_whatever_its_speed);
    RUN_TEST(test_small_currents_of_a_fast_rotor_stand_and_say_nothing);
    RUN_TEST(test_a_stuck_sensor_of_a_fast_rotor_is_found_in_seven_looks);
    RUN_TEST(test_noise_stands_and_more_does_not);
    RUN_TEST(test_four_looks_at_least_find_it_standing);
    RUN_TEST(test_without_a_push_a_current_may_stand);
    RUN_TEST(test_pushes_to_and_fro_cancel);
    RUN_TEST(test_a_background_that_was_busy_begins_anew);
    RUN_TEST(test_what_passes_for_noise);
    RUN_TEST(test_a_current_that_stands_while_another_is_asked_for_is_suspected);
    RUN_TEST(test_a_hold_whose_current_is_gone_is_suspected_at_once);
    RUN_TEST(test_a_current_that_passes_zero_is_no_broken_lead);
    RUN_TEST(test_of_two_phases_the_one_that_is_further_off_is_suspected);
    RUN_TEST(test_a_wrong_voltage_is_suspected_before_a_phase);
    RUN_TEST(test_eight_looks_with_a_wrong_voltage_make_sure_less_two_for_each_without);
    RUN_TEST(test_what_was_measured_wrong_before_a_gap_is_forgotten);
    RUN_TEST(test_what_was_measured_wrong_before_the_drive_was_off_is_forgotten);
    RUN_TEST(test_what_stands_for_long_goes_on_standing);
    RUN_TEST(test_a_hold_whose_current_stands_at_zero_against_its_voltage_is_open);
    RUN_TEST(test_a_converter_without_noise_is_dead_while_the_rotor_turns);
    RUN_TEST(test_a_sensor_that_scattered_is_dead_as_soon_as_it_does_not);
    RUN_TEST(test_in_a_hold_it_is_dead_as_the_resistance_moves_by_an_eighth);
    RUN_TEST(test_a_code_that_its_reference_has_left_is_a_dead_sensors);
    return UNITY_END();
}
