/* What opens the bridge: each fault, its bound and its rank. */
#include "firmware/drive/protection.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

static struct per_unit base;
static struct protection_params params;
static struct hal_samples samples;
static struct estimate estimate;

void setUp(void)
{
    struct drive_settings settings;

    drive_settings_default(&settings, &bench_params);
    settings.overcurrent_trip_A = 5.4;
    base = per_unit_base(&bench_params, PERIOD_S);
    params = protection_design(&base, &bench_facts, &settings);
    samples = (struct hal_samples){.current_a = 2048, .current_b = 2048, .bus_voltage = 3151};
    estimate = (struct estimate){.rotor = {.position = {0, 0}}};
}

void tearDown(void)
{
}

static enum drive_fault of_samples(void)
{
    const enum drive_fault fault = protection_check_samples(&params, &samples);

    TEST_ASSERT_EQUAL(fault == DRIVE_FAULT_NONE, protection_passes(&params, &samples));
    return fault;
}

static enum drive_fault of_estimate(void)
{
    return protection_trusts(&params, &estimate) ? DRIVE_FAULT_NONE : DRIVE_FAULT_ESTIMATE_RANGE;
}

static uint16_t current_code(double current_A)
{
    return (uint16_t)(2048.5 + current_A / bench_facts.current_A_per_code);
}

static uint16_t bus_code(double bus_V)
{
    return (uint16_t)(0.5 + bus_V / bench_facts.bus_V_per_code);
}

static void test_a_healthy_drive_has_no_fault(void)
{
    samples.current_a = current_code(3.0);
    samples.current_b = current_code(-3.0);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_samples());
    estimate.rotor.speed = num_from_double(140.0 / base.speed_rad_s);
    estimate.rotor.load_torque = num_from_double(0.47 / base.torque_Nm);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_estimate());
}

/* 1.8 times the rated 3 A. */
static void test_a_phase_current_beyond_its_trip_is_a_fault(void)
{
    static const double beyond[] = {5.41, -5.41};

    for (unsigned i = 0; i < 2u; i++) {
        samples.current_a = current_code(beyond[i]);
        samples.current_b = current_code(0.0);
        TEST_ASSERT_EQUAL(DRIVE_FAULT_OVERCURRENT, of_samples());
        samples.current_a = current_code(0.0);
        samples.current_b = current_code(beyond[i]);
        TEST_ASSERT_EQUAL(DRIVE_FAULT_OVERCURRENT, of_samples());
        samples.current_b = current_code(0.997 * beyond[i]);
        TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_samples());
    }
}

static void test_the_boards_own_trip_is_a_fault(void)
{
    samples.flags = HAL_FLAG_OVERCURRENT_TRIP;
    TEST_ASSERT_EQUAL(DRIVE_FAULT_HARDWARE_OVERCURRENT, of_samples());
}

static void test_a_control_interrupt_that_ended_too_late_is_a_fault(void)
{
    samples.flags = HAL_FLAG_DEADLINE_MISSED;
    TEST_ASSERT_EQUAL(DRIVE_FAULT_DEADLINE_MISSED, of_samples());
}

/* Half of nominal to 1.29 times, where the converter is about to end. */
static void test_a_bus_out_of_range_is_a_fault(void)
{
    static const double healthy[] = {12.1, 18.0, 24.0, 30.9};
    static const double faulty[] = {0.0, 11.9, 31.0, 31.2 * 4095.0 / 4096.0};

    for (unsigned i = 0; i < sizeof healthy / sizeof healthy[0]; i++) {
        samples.bus_voltage = bus_code(healthy[i]);
        TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_samples());
        samples.bus_voltage = bus_code(faulty[i]);
        TEST_ASSERT_EQUAL(DRIVE_FAULT_BUS_VOLTAGE, of_samples());
    }
}

/* Codes of the bounds: both allowed, the next ones not. */
static void test_bounds_are_allowed_to_the_code(void)
{
    const int bus_least = (int)(12.0 / bench_facts.bus_V_per_code);
    const int bus_most = (int)(1.29 * 24.0 / bench_facts.bus_V_per_code);
    const int trip = (int)(5.4 / bench_facts.current_A_per_code);

    for (int code = 0; code < 4096; code++) {
        samples = (struct hal_samples){
            .current_a = 2048, .current_b = 2048, .bus_voltage = (uint16_t)code};
        TEST_ASSERT_EQUAL(code >= bus_least && code <= bus_most ? DRIVE_FAULT_NONE
                                                                : DRIVE_FAULT_BUS_VOLTAGE,
                          of_samples());
        samples = (struct hal_samples){.current_a = (uint16_t)code,
                                       .current_b = (uint16_t)code,
                                       .bus_voltage = bus_code(24.0)};
        TEST_ASSERT_EQUAL(code >= 2048 - trip && code <= 2048 + trip ? DRIVE_FAULT_NONE
                                                                     : DRIVE_FAULT_OVERCURRENT,
                          of_samples());
    }
}

/* A short pulls the bus down and may delay the interrupt: the comparator says why. */
static void test_of_several_faults_the_cause_is_named(void)
{
    samples.bus_voltage = bus_code(5.0);
    samples.current_a = current_code(5.9);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_OVERCURRENT, of_samples());
    samples.flags = HAL_FLAG_DEADLINE_MISSED;
    TEST_ASSERT_EQUAL(DRIVE_FAULT_DEADLINE_MISSED, of_samples());
    samples.flags = HAL_FLAG_DEADLINE_MISSED | HAL_FLAG_OVERCURRENT_TRIP;
    TEST_ASSERT_EQUAL(DRIVE_FAULT_HARDWARE_OVERCURRENT, of_samples());
}

/* A trip that is not given, or 200 A over converters of 6 A. */
static void test_a_bound_beyond_the_converters_is_none(void)
{
    struct drive_settings settings;
    struct motor_params large = bench_params;

    large.rated_current_A = 50.0;
    drive_settings_default(&settings, &large);
    params = protection_design(&base, &bench_facts, &settings);
    samples.current_a = 0;
    samples.current_b = 4095;
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_samples());
    settings.overcurrent_trip_A = 200.0;
    params = protection_design(&base, &bench_facts, &settings);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_NONE, of_samples());
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
    RUN_TEST(test_bounds_are_allowed_to_the_code);
    RUN_TEST(test_of_several_faults_the_cause_is_named);
    RUN_TEST(test_a_bound_beyond_the_converters_is_none);
    RUN_TEST(test_a_speed_no_supply_could_give_is_a_fault);
    RUN_TEST(test_a_load_no_motor_could_hold_is_a_fault);
#if STEADYSTEP_NUM != NUM_FIXED
    RUN_TEST(test_an_estimate_that_is_not_finite_is_a_fault);
#endif
    return UNITY_END();
}
