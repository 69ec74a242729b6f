/* What opens the bridge: each fault, its bound and its rank. */
#include "firmware/drive/protection.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

static struct per_unit base;
static struct protection_params params;
static struct sample_set now;
static struct estimate estimate;

void setUp(void)
{
    struct drive_settings settings;

    drive_settings_default(&settings, &bench_params);
    base = per_unit_base(&bench_params, PERIOD_S);
    params = protection_design(&base, &settings);
    now = (struct sample_set){.bus = NUM(1.0)};
    estimate = (struct estimate){.rotor = {.position = {0, 0}}};
}

void tearDown(void)
{
}

static enum drive_fault of_samples(uint32_t flags)
{
    return protection_check_samples(&params, &now, flags);
}

static enum drive_fault of_estimate(void)
{
    return protection_check_estimate(&params, &estimate);
}

static num_t amperes(double current_A)
{
    return num_from_double(current_A / base.current_A);
}

static num_t volts(double voltage_V)
{
    return num_from_double(voltage_V / base.voltage_V);
}

static void test_a_healthy_drive_has_no_fault(void)
{
    now.current.a = amperes(3.0);
    now.current.b = amperes(-3.0);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_samples(0));
    estimate.rotor.speed = num_from_double(140.0 / base.speed_rad_s);
    estimate.rotor.load_torque = num_from_double(0.47 / base.torque_Nm);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_estimate());
}

/* 1.8 times the rated 3 A. */
static void test_a_phase_current_beyond_its_trip_is_a_fault(void)
{
    static const double beyond[] = {5.41, -5.41};

    for (unsigned i = 0; i < 2u; i++) {
        now.current = (struct phases){amperes(beyond[i]), amperes(0.0)};
        TEST_ASSERT_EQUAL(DRIVE_FAULT_OVERCURRENT, of_samples(0));
        now.current = (struct phases){amperes(0.0), amperes(beyond[i])};
        TEST_ASSERT_EQUAL(DRIVE_FAULT_OVERCURRENT, of_samples(0));
        now.current = (struct phases){amperes(0.997 * beyond[i]), amperes(0.0)};
        TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_samples(0));
    }
}

static void test_the_boards_own_trip_is_a_fault(void)
{
    TEST_ASSERT_EQUAL(DRIVE_FAULT_HARDWARE_OVERCURRENT, of_samples(HAL_FLAG_OVERCURRENT_TRIP));
}

static void test_a_control_interrupt_that_ended_too_late_is_a_fault(void)
{
    TEST_ASSERT_EQUAL(DRIVE_FAULT_DEADLINE_MISSED, of_samples(HAL_FLAG_DEADLINE_MISSED));
}

/* Half of nominal to 1.29 times, where the converter is about to end. */
static void test_a_bus_out_of_range_is_a_fault(void)
{
    now.bus = volts(12.1);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_samples(0));
    now.bus = volts(11.9);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_BUS_VOLTAGE, of_samples(0));
    now.bus = volts(30.9);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_samples(0));
    now.bus = volts(31.0);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_BUS_VOLTAGE, of_samples(0));
    now.bus = volts(31.2 * 4095.0 / 4096.0); /* the last code */
    TEST_ASSERT_EQUAL(DRIVE_FAULT_BUS_VOLTAGE, of_samples(0));
}

/* A short pulls the bus down and may delay the interrupt: the comparator tells why. */
static void test_of_several_faults_the_cause_is_named(void)
{
    now.bus = volts(5.0);
    now.current.a = amperes(5.9);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_OVERCURRENT, of_samples(0));
    TEST_ASSERT_EQUAL(DRIVE_FAULT_DEADLINE_MISSED, of_samples(HAL_FLAG_DEADLINE_MISSED));
    TEST_ASSERT_EQUAL(DRIVE_FAULT_HARDWARE_OVERCURRENT,
                      of_samples(HAL_FLAG_DEADLINE_MISSED | HAL_FLAG_OVERCURRENT_TRIP));
}

/* 1.3 times the no-load speed of 152.9 rad/s. */
static void test_a_speed_no_supply_could_give_is_a_fault(void)
{
    static const double sign[] = {1.0, -1.0};

    for (unsigned i = 0; i < 2u; i++) {
        estimate.rotor.speed = num_from_double(sign[i] * 1.29);
        TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_estimate());
        estimate.rotor.speed = num_from_double(sign[i] * 1.31);
        TEST_ASSERT_EQUAL(DRIVE_FAULT_ESTIMATE_RANGE, of_estimate());
    }
}

/* Four times the torque at rated current. */
static void test_a_load_no_motor_could_hold_is_a_fault(void)
{
    static const double sign[] = {1.0, -1.0};

    for (unsigned i = 0; i < 2u; i++) {
        estimate.rotor.load_torque = num_from_double(sign[i] * 0.157 * 11.9 / base.torque_Nm);
        TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_estimate());
        estimate.rotor.load_torque = num_from_double(sign[i] * 0.157 * 12.1 / base.torque_Nm);
        TEST_ASSERT_EQUAL(DRIVE_FAULT_ESTIMATE_RANGE, of_estimate());
    }
}

static void test_an_estimated_current_out_of_range_is_a_fault(void)
{
    estimate.current.a = NUM(4.1);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_ESTIMATE_RANGE, of_estimate());
    estimate.current = (struct phases){NUM(0.0), NUM(-4.1)};
    TEST_ASSERT_EQUAL(DRIVE_FAULT_ESTIMATE_RANGE, of_estimate());
}

#if STEADYSTEP_NUM != NUM_FIXED
static void not_finite_is_a_fault(num_t *quantity)
{
    const num_t finite = *quantity;

    *quantity = (num_t)__builtin_nan("");
    TEST_ASSERT_EQUAL(DRIVE_FAULT_ESTIMATE_RANGE, of_estimate());
    *quantity = (num_t)__builtin_inf();
    TEST_ASSERT_EQUAL(DRIVE_FAULT_ESTIMATE_RANGE, of_estimate());
    *quantity = -(num_t)__builtin_inf();
    TEST_ASSERT_EQUAL(DRIVE_FAULT_ESTIMATE_RANGE, of_estimate());
    *quantity = finite;
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_estimate());
}

static void test_an_estimate_that_is_not_finite_is_a_fault(void)
{
    not_finite_is_a_fault(&estimate.rotor.speed);
    not_finite_is_a_fault(&estimate.rotor.load_torque);
    not_finite_is_a_fault(&estimate.current.a);
    not_finite_is_a_fault(&estimate.current.b);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_healthy_drive_has_no_fault);
    RUN_TEST(test_a_phase_current_beyond_its_trip_is_a_fault);
    RUN_TEST(test_the_boards_own_trip_is_a_fault);
    RUN_TEST(test_a_control_interrupt_that_ended_too_late_is_a_fault);
    RUN_TEST(test_a_bus_out_of_range_is_a_fault);
    RUN_TEST(test_of_several_faults_the_cause_is_named);
    RUN_TEST(test_a_speed_no_supply_could_give_is_a_fault);
    RUN_TEST(test_a_load_no_motor_could_hold_is_a_fault);
    RUN_TEST(test_an_estimated_current_out_of_range_is_a_fault);
#if STEADYSTEP_NUM != NUM_FIXED
    RUN_TEST(test_an_estimate_that_is_not_finite_is_a_fault);
#endif
    return UNITY_END();
}
