/* What breaks in a drive, in closed loop: which fault says so, and how soon. */
#include <stdio.h>

#include "firmware/drive/state_machine.h"
#include "tests/unit/drive_bench.h"

enum breakage {
    LEAD_A,
    LEAD_B,
    SENSOR_A, /* shows what it showed last */
    SENSOR_B,
    LEG_VOLTAGE, /* likewise, of phase a */
    BUS_VOLTAGE, /* shows 0.7 of what there is */
    FROZEN_ENCODER,
    REVERSED_ENCODER,
    HALF_OF_THE_COUNTS,
    HELD_ROTOR,
    OVERLOAD, /* 0.6 N m, the rated torque is 0.47 */
};

static enum breakage breakage;
static bool broken;
static struct hal_samples last; /* before it broke */

static void disturb(struct hal_samples *samples)
{
    const int32_t counted = samples->encoder_count - last.encoder_count;

    if (!broken) {
        last = *samples;
    } else if (breakage == SENSOR_A) {
        samples->current_a = last.current_a;
    } else if (breakage == SENSOR_B) {
        samples->current_b = last.current_b;
    } else if (breakage == LEG_VOLTAGE) {
        samples->phase_voltage_a = last.phase_voltage_a;
    } else if (breakage == BUS_VOLTAGE) {
        samples->bus_voltage = (uint16_t)(samples->bus_voltage * 7u / 10u);
    } else if (breakage == FROZEN_ENCODER) {
        samples->encoder_count = last.encoder_count;
    } else if (breakage == REVERSED_ENCODER) {
        samples->encoder_count = last.encoder_count - counted;
    } else if (breakage == HALF_OF_THE_COUNTS) {
        samples->encoder_count = last.encoder_count + counted / 2;
    }
}

void setUp(void)
{
    drive_bench_reset();
    bridge.background = true;
    bridge.disturb = disturb;
    broken = false;
    encoder_facts.encoder_counts_per_turn = 4000;
}

void tearDown(void)
{
}

static void with_encoder(enum position_law law)
{
    board.facts = &encoder_facts;
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    settings.encoder_zero_known = true;
    drive_settings_select_law(&settings, law);
}

static void break_it(enum breakage what)
{
    breakage = what;
    broken = true;
    bridge.open_a = what == LEAD_A;
    bridge.open_b = what == LEAD_B;
    if (what == HELD_ROTOR) {
        motor.motor.inertia_kgm2 = IMPOSED_SPEED;
        motor.speed_rad_s = 0.0;
    } else if (what == OVERLOAD) {
        motor.load_torque_Nm = 0.6;
    }
}

/* Periods until the fault; 4000: there is none. */
static int periods_until_fault(void)
{
    int periods = 0;

    while (drive.supervision.fault == DRIVE_FAULT_NONE && periods < 4000) {
        period();
        periods++;
    }
    return periods;
}

struct row {
    enum breakage what;
    bool in_motion; /* at 20 rad/s, else at rest, and the motion begins */
    const char *fault;
    int earliest, latest; /* periods */
    int later;            /* in motion: periods in which the current of phase a turns on */
};

static void shows(const struct row *row)
{
    char words[80];

    (void)snprintf(words, sizeof words, "breakage %d%s: after", (int)row->what,
                   row->in_motion ? " in motion" : "");
    enable();
    run(500);
    motor.load_torque_Nm = 0.05;
    if (row->in_motion) {
        move(6.0, 0.3);
        run(1000 + row->later);
    }
    break_it(row->what);
    if (!row->in_motion) {
        move(6.0, 0.3);
    }
    const int periods = periods_until_fault();

    TEST_ASSERT_EQUAL_STRING_MESSAGE(row->fault, drive_fault_name(drive.supervision.fault), words);
    TEST_ASSERT_INT_WITHIN_MESSAGE((unsigned)(row->latest - row->earliest) / 2u,
                                   (row->latest + row->earliest) / 2, periods, words);
    TEST_ASSERT_EQUAL_INT(DRIVE_FAULT, drive.supervision.state);
    period();
    period();
    TEST_ASSERT_FALSE(bridge.in_force.bridge_on);
}

static void test_without_an_encoder(void)
{
    static const struct row rows[] = {
        {LEAD_A, true, "open-phase-a", 150, 260, 0},
        {LEAD_B, true, "open-phase-b", 150, 260, 0},
        {SENSOR_B, true, "current-sensor-b", 55, 75, 0},
        {SENSOR_A, true, "current-sensor-a", 55, 75, 11},
        {LEG_VOLTAGE, true, "lost-synchronism", 20, 50, 0}, /* before it is far off */
        {LEG_VOLTAGE, true, "voltage-sensor", 28, 60, 11},
        {HELD_ROTOR, false, "stalled", 205, 245, 0},
        {HELD_ROTOR, true, "stalled", 25, 55, 0},
        {OVERLOAD, false, "stalled", 1000, 1110, 0},
        {OVERLOAD, true, "stalled", 1000, 1110, 0},
    };

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        setUp();
        shows(&rows[i]);
    }
}

static void test_with_an_encoder_and_its_default_law(void)
{
    static const struct row rows[] = {
        {LEAD_A, false, "open-phase-a", 90, 150, 0},
        {LEAD_B, false, "open-phase-b", 10, 50, 0},
        {LEAD_A, true, "open-phase-a", 440, 840, 0},
        {LEAD_B, true, "open-phase-b", 440, 840, 0},
        {SENSOR_B, true, "current-sensor-b", 20, 90, 0},
        {SENSOR_A, true, "current-sensor-a", 20, 90, 11},
        {LEG_VOLTAGE, true, "voltage-sensor", 80, 180, 0},
        {LEG_VOLTAGE, false, "voltage-sensor", 600, 800, 0},
        {FROZEN_ENCODER, false, "following-error", 365, 395, 0},
        {FROZEN_ENCODER, true, "encoder", 50, 90, 0},
        {REVERSED_ENCODER, true, "estimate-range", 4, 16, 0},
        {HALF_OF_THE_COUNTS, false, "following-error", 385, 415, 0},
        {HALF_OF_THE_COUNTS, true, "following-error", 155, 185, 0},
        {HELD_ROTOR, false, "following-error", 365, 395, 0},
        {HELD_ROTOR, true, "following-error", 125, 155, 0},
        {OVERLOAD, false, "following-error", 200, 240, 0},
        {OVERLOAD, true, "following-error", 215, 265, 0},
    };

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        setUp();
        with_encoder(POSITION_LAW_FEEDBACK_LINEARISATION);
        shows(&rows[i]);
    }
}

/* From 0.12 of the supply, less what is shown of it: 40 %. Its back-EMF is 14 V at 86 rad/s. */
static void test_a_bus_voltage_that_is_wrong_shows_as_the_motor_takes_its_share(void)
{
    for (int encoder = 0; encoder < 2; encoder++) {
        for (int fast = 0; fast < 2; fast++) {
            setUp();
            if (encoder == 1) {
                with_encoder(POSITION_LAW_FEEDBACK_LINEARISATION);
            }
            enable();
            run(500);
            move(fast == 1 ? 36.0 : 9.0, 0.6);
            run(2500);
            break_it(BUS_VOLTAGE);
            const int periods = periods_until_fault();

            TEST_ASSERT_EQUAL_STRING(fast == 1 ? "voltage-sensor" : "none",
                                     drive_fault_name(drive.supervision.fault));
            TEST_ASSERT_TRUE(fast == 0 || periods < 100);
        }
    }
}

/* A current law asks less of a phase that does not answer. */
static void test_with_an_encoder_and_state_feedback(void)
{
    static const struct row rows[] = {
        {LEAD_A, false, "open-phase-a", 120, 180, 0},
        {LEAD_B, false, "open-phase-b", 30, 70, 0},
        {SENSOR_A, false, "open-phase-a", 150, 230, 0}, /* at rest it shows nothing to flow */
        {SENSOR_B, true, "current-sensor-b", 55, 75, 0},
        {SENSOR_A, true, "current-sensor-a", 55, 75, 11},
        {REVERSED_ENCODER, true, "estimate-range", 7, 18, 0},
    };

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        setUp();
        with_encoder(POSITION_LAW_STATE_FEEDBACK);
        shows(&rows[i]);
    }
}

/* Half an electrical turn lies between four periods at 1,250 Hz: from zero to zero of a current. */
static void test_a_fast_rotor_is_looked_at_four_to_nine_periods_apart(void)
{
    for (int fast = 0; fast < 2; fast++) {
        uint32_t longest = 0;

        setUp();
        with_encoder(POSITION_LAW_STATE_FEEDBACK);
        enable();
        bridge.background = false;
        for (int n = 0; n < 40; n++) {
            const uint32_t before = drive.phase_watch.period;

            period();
            drive.estimator.estimate.rotor.speed =
                num_from_double((fast == 1 ? 0.125 : 0.05) / drive.base.turns_per_period);
            phase_watch_background(&drive);
            if (drive.phase_watch.period - before > longest && n > 10) {
                longest = drive.phase_watch.period - before;
            }
        }
        TEST_ASSERT_EQUAL_UINT32(fast == 1 ? 9u : 4u, longest);
    }
}

/* Nothing asks for more torque: only the true rotor's back-EMF shows that the load turns it. */
static void test_an_encoder_that_stands_still_under_a_load_is_said(void)
{
    static const enum position_law laws[] = {POSITION_LAW_FEEDBACK_LINEARISATION,
                                             POSITION_LAW_STATE_FEEDBACK};

    for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++) {
        setUp();
        with_encoder(laws[i]);
        settings.motor.inertia_kgm2 /= 10.0; /* falls before the law winds up */
        motor.motor.inertia_kgm2 /= 10.0;
        enable();
        motor.load_torque_Nm = 0.2;
        run(1000);
        break_it(FROZEN_ENCODER);
        motor.load_torque_Nm = 0.25;
        TEST_ASSERT_INT_WITHIN(60, 120, periods_until_fault());
        TEST_ASSERT_EQUAL_STRING("encoder", drive_fault_name(drive.supervision.fault));
    }
}

/* It is a machine that presses, as long as the following error allows it. */
static void test_a_rotor_that_is_pressed_against_a_stop_is_no_fault_of_the_encoder(void)
{
    with_encoder(POSITION_LAW_FEEDBACK_LINEARISATION);
    enable();
    run(500);
    break_it(HELD_ROTOR);
    post((struct drive_command){.kind = DRIVE_COMMAND_STEP, .position_rad = 0.02});
    run(1000);
    TEST_ASSERT_TRUE(signals().i_q_ref_A > 0.99 * 3.0); /* with all that it has */
}

/* Loads that come at once and go, in motion and at rest; with an encoder to 90 % of the rated
   torque. */
static void test_a_sound_drive_says_nothing(void)
{
    for (int encoder = 0; encoder < 2; encoder++) {
        setUp();
        if (encoder == 1) {
            with_encoder(POSITION_LAW_FEEDBACK_LINEARISATION);
        }
        enable();
        run(500);
        for (int n = 0; n < 6; n++) {
            move(n % 2 == 0 ? 2.0 : -2.0, 0.25);
            run(1000);
            motor.load_torque_Nm = n % 3 == 0 ? (encoder == 1 ? 0.42 : 0.2) : -0.2;
            run(2500);
            motor.load_torque_Nm = n % 3 == 1 ? 0.25 : 0.0;
            run(1000);
        }
    }
}

static void held_under(enum drive_synchronism_policy policy)
{
    setUp();
    settings.synchronism_policy = policy;
    enable();
    run(500);
    break_it(HELD_ROTOR);
    move(6.0, 0.3);
    run(1000);
}

static void test_a_policy_warns_or_looks_away_instead(void)
{
    held_under(DRIVE_SYNCHRONISM_WARN);
    TEST_ASSERT_EQUAL_INT(DRIVE_POSITION_UNCERTAIN, drive.axis.reference);
    TEST_ASSERT_EQUAL_STRING("stalled", drive_synchronism_name(signals().synchronism));
    held_under(DRIVE_SYNCHRONISM_OFF);
    TEST_ASSERT_EQUAL_STRING("sure", drive_synchronism_name(signals().synchronism));
    TEST_ASSERT_EQUAL_INT(DRIVE_POSITION_ASSUMED, drive.axis.reference);
}

/* Their rotor leaves the estimate before the currents are enough by themselves. */
static void test_a_phase_that_breaks_at_rest_is_named_and_not_what_comes_of_it(void)
{
    static const struct {
        enum breakage what;
        double move_rad;
        const char *fault;
    } rows[] = {
        {LEAD_A, 0.0, "open-phase-a"},
        {SENSOR_A, 15.0, "current-sensor-a"},
    };

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        setUp();
        enable();
        run(2000);
        break_it(rows[i].what);
        if (rows[i].move_rad > 0.0) {
            run(1000);
            move(rows[i].move_rad, 0.75);
        }
        (void)periods_until_fault();
        TEST_ASSERT_EQUAL_STRING(rows[i].fault, drive_fault_name(drive.supervision.fault));
    }
}

/* An estimate made of a wrong voltage stalls without a rotor that does. */
static void test_what_a_sensor_cannot_cause_keeps_its_name(void)
{
    static const enum drive_fault sensors[] = {DRIVE_FAULT_CURRENT_SENSOR_B,
                                               DRIVE_FAULT_VOLTAGE_SENSOR};
    static const enum drive_fault causes[] = {
        DRIVE_FAULT_OVERCURRENT,      DRIVE_FAULT_HARDWARE_OVERCURRENT, DRIVE_FAULT_ESTIMATE_RANGE,
        DRIVE_FAULT_LOST_SYNCHRONISM, DRIVE_FAULT_FOLLOWING_ERROR,
    };

    for (int n = 0; n < 2 * DRIVE_FAULTS; n++) {
        const enum drive_fault sensor = sensors[n / DRIVE_FAULTS];
        const enum drive_fault fault = (enum drive_fault)(n % DRIVE_FAULTS);
        bool caused = fault == DRIVE_FAULT_STALLED && sensor == DRIVE_FAULT_VOLTAGE_SENSOR;

        if (fault == DRIVE_FAULT_NONE) {
            continue;
        }
        for (size_t i = 0; i < sizeof causes / sizeof causes[0]; i++) {
            caused = caused || causes[i] == fault;
        }
        caused = caused && !(fault == DRIVE_FAULT_HARDWARE_OVERCURRENT &&
                             sensor == DRIVE_FAULT_VOLTAGE_SENSOR);
        drive.phase_watch.suspected = (uint8_t)sensor;
        state_machine_fault(&drive, fault);
        TEST_ASSERT_EQUAL_INT(caused ? sensor : fault, drive.supervision.fault);
        phase_watch_background(&drive);
        TEST_ASSERT_EQUAL_INT(DRIVE_FAULT_NONE, drive.phase_watch.suspected);
    }
}

static void test_too_much_current_is_none_of_an_open_phase(void)
{
    for (int fault = DRIVE_FAULT_OVERCURRENT; fault <= DRIVE_FAULT_HARDWARE_OVERCURRENT; fault++) {
        drive.phase_watch.suspected = DRIVE_FAULT_OPEN_PHASE_A;
        state_machine_fault(&drive, (enum drive_fault)fault);
        TEST_ASSERT_EQUAL_INT(fault, drive.supervision.fault);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_an_encoder);
    RUN_TEST(test_with_an_encoder_and_its_default_law);
    RUN_TEST(test_a_bus_voltage_that_is_wrong_shows_as_the_motor_takes_its_share);
    RUN_TEST(test_with_an_encoder_and_state_feedback);
    RUN_TEST(test_a_fast_rotor_is_looked_at_four_to_nine_periods_apart);
    RUN_TEST(test_an_encoder_that_stands_still_under_a_load_is_said);
    RUN_TEST(test_a_rotor_that_is_pressed_against_a_stop_is_no_fault_of_the_encoder);
    RUN_TEST(test_a_sound_drive_says_nothing);
    RUN_TEST(test_a_policy_warns_or_looks_away_instead);
    RUN_TEST(test_a_phase_that_breaks_at_rest_is_named_and_not_what_comes_of_it);
    RUN_TEST(test_what_a_sensor_cannot_cause_keeps_its_name);
    RUN_TEST(test_too_much_current_is_none_of_an_open_phase);
    return UNITY_END();
}
