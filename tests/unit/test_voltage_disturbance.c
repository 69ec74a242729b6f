/* What disturbs the voltage, from one-step innovations of the current. */
#include "firmware/control/voltage_disturbance.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

static struct per_unit base;
static struct voltage_disturbance_params params;
static struct voltage_disturbance disturbance;

static void design(double bandwidth_rad_s)
{
    disturbance = (struct voltage_disturbance){0};
    params = voltage_disturbance_design(&bench_params, &base, PERIOD_S, bandwidth_rad_s);
}

void setUp(void)
{
    base = per_unit_base(&bench_params, PERIOD_S);
    design(1000.0);
}

void tearDown(void)
{
}

/* What a voltage that acts in addition makes of the current in a period. */
static num_t innovation(double disturbance_V)
{
    const double decay = bench_params.resistance_ohm * PERIOD_S / bench_params.inductance_H;
    const double change_A = disturbance_V * (1.0 - exp(-decay)) / bench_params.resistance_ohm;

    return num_from_double(change_A / base.current_A);
}

static double run(double d_V, double q_V, int periods)
{
    for (int i = 0; i < periods; i++) {
        (void)voltage_disturbance_step(&disturbance, &params,
                                       (struct dq){innovation(d_V), innovation(q_V)});
    }
    return num_to_double(disturbance.voltage.q) * base.voltage_V;
}

static void test_a_constant_disturbance_is_found_on_each_axis(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.8, run(-0.4, 0.8, 200));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -0.4, num_to_double(disturbance.voltage.d) * base.voltage_V);
}

static void test_it_is_found_with_the_bandwidth_asked_for(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.8 * (1.0 - exp(-1.0)), run(0.0, 0.8, 10));
}

static void test_a_failed_sensor_shifts_the_voltage_by_its_bound_at_most(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(2e-2, 0.15 * base.voltage_V, run(0.0, 20.0, 300));
}

static void test_without_bandwidth_there_is_none(void)
{
    design(0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, run(1.0, 1.0, 100));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_constant_disturbance_is_found_on_each_axis);
    RUN_TEST(test_it_is_found_with_the_bandwidth_asked_for);
    RUN_TEST(test_a_failed_sensor_shifts_the_voltage_by_its_bound_at_most);
    RUN_TEST(test_without_bandwidth_there_is_none);
    return UNITY_END();
}
