/* What dead time takes, against a switched phase in steps of a seventeenth of the dead time. */
#include <math.h>

#include "firmware/motor/bridge_loss.h"
#include "tests/unit/bench.h"
#include "tests/unit/num_assert.h"

static const double bus_V = 24.0, inductance_H = 0.9e-3, period_s = 1e-4, dead_time_s = 1e-6;
static const int steps = 1700, dead_steps = 17;

static struct per_unit base;
static struct bridge_loss_params params;

void setUp(void)
{
    base = per_unit_base(&bench_params, period_s);
    params = bridge_loss_design(&bench_params, &base, period_s, dead_time_s);
}

void tearDown(void)
{
}

/* A half-bridge: high in the middle `share` of the period, both gates off behind its edges. */
static bool high(int step, double share)
{
    return fabs(step + 0.5 - steps / 2) < 0.5 * share * steps;
}

static bool dead(int step, double share)
{
    return step >= dead_steps && high(step, share) != high(step - dead_steps, share);
}

/* Of a leg that `current` leaves; NAN: it floats. */
static double leg_V(int step, double share, double current)
{
    if (!dead(step, share)) {
        return high(step, share) ? bus_V : 0.0;
    }
    if (current == 0.0) {
        return (double)NAN;
    }
    return current > 0.0 ? -BRIDGE_DIODE_DROP_V : bus_V + BRIDGE_DIODE_DROP_V;
}

/* One period against a back-EMF that the modulation balances: the mean voltage. */
static double period_of_switching(double modulation, double *current)
{
    const double emf = modulation * bus_V, step_s = period_s / steps;
    double sum = 0.0;

    for (int step = 0; step < steps; step++) {
        const double plus = leg_V(step, 0.5 * (1.0 + modulation), *current);
        const double minus = leg_V(step, 0.5 * (1.0 - modulation), -*current);
        const bool floats = isnan(plus) || isnan(minus);
        const bool ends =
            dead(step, 0.5 * (1.0 + modulation)) || dead(step, 0.5 * (1.0 - modulation));
        const double voltage = floats ? emf : plus - minus;
        const double next = *current + (voltage - emf) * step_s / inductance_H;

        *current = floats || (ends && next * *current < 0.0) ? 0.0 : next;
        sum += voltage;
    }
    return sum / steps;
}

/* V that the model gives phase a for the same samples. */
static double model_V(double modulation, double before, double now)
{
    const struct phases voltage = bridge_loss_voltage(
        &params, (struct phases){num_from_double(modulation), NUM(0.0)},
        (struct phases){num_from_double(before / base.current_A), NUM(0.0)},
        (struct phases){num_from_double(now / base.current_A), NUM(0.0)}, NUM(1.0), NUM(1.0));

    return num_to_double(voltage.a) * base.voltage_V;
}

static void test_at_any_current_the_voltage_is_that_of_a_switched_bridge(void)
{
    double error = 0.0, loss = 0.0;
    int points = 0;

    for (double modulation = -0.3; modulation < 0.31; modulation += 0.075) {
        for (double before = -0.25; before < 0.26; before += 0.033) {
            double now = before;
            const double voltage = period_of_switching(modulation, &now);
            const double difference = model_V(modulation, before, now) - voltage;

            error += difference * difference;
            loss += (modulation * bus_V - voltage) * (modulation * bus_V - voltage);
            points++;
        }
    }
    printf("bridge loss: %.3f V rms, of which the model leaves %.3f\n", sqrt(loss / points),
           sqrt(error / points));
    TEST_ASSERT_TRUE(sqrt(loss / points) > 0.3);
    TEST_ASSERT_TRUE(sqrt(error / points) < 0.055);
}

static void test_far_from_zero_it_is_the_dead_time_alone(void)
{
    const double loss_V = 2.0 * dead_time_s / period_s * (bus_V + 2.0 * BRIDGE_DIODE_DROP_V);

    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 4.8 - loss_V, model_V(0.2, 1.0, 1.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 4.8 + loss_V, model_V(0.2, -1.0, -1.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -4.8 + loss_V, model_V(-0.2, -1.0, -1.0));
}

static void test_without_dead_time_nothing_is_lost(void)
{
    params = bridge_loss_design(&bench_params, &base, period_s, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 4.8, model_V(0.2, 1.0, 1.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -0.24, model_V(-0.01, 0.01, -0.01));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_at_any_current_the_voltage_is_that_of_a_switched_bridge);
    RUN_TEST(test_far_from_zero_it_is_the_dead_time_alone);
    RUN_TEST(test_without_dead_time_nothing_is_lost);
    return UNITY_END();
}
