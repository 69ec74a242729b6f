/* The whole drive on a motor whose phases saturate: where the rotor stands shows in the current. */
#include "tests/unit/drive_bench.h"

#define MAGNET_A   3.488                   /* Km / (N L): flux of the magnet, as a current */
#define SATURATION 0.00095                 /* 1/A^2, a depth of 10 % */
#define DEGREE     (TWO_PI / 360.0 / 50.0) /* electrical, of the rotor */

/* Of each phase: flux linkage over L, A; the magnet's is part of it. */
static struct bench_vector flux;

static double current_of(double flux_A, double magnet_A)
{
    return flux_A + SATURATION * flux_A * flux_A * flux_A - magnet_A;
}

static double flux_without_current(double magnet_A)
{
    double x = magnet_A;

    for (int i = 0; i < 30; i++) {
        x -= current_of(x, magnet_A) / (1.0 + 3.0 * SATURATION * x * x);
    }
    return x;
}

static void run_saturated(struct bench_motor *m, double u_a, double u_b)
{
    const int steps = 20;
    const double step_s = PERIOD_S / steps;
    const struct motor_params *p = &m->motor;

    if (m->i_a == 0.0 && m->i_b == 0.0) { /* switched on */
        flux.a = flux_without_current(MAGNET_A * cos(bench_electrical_rad(m)));
        flux.b = flux_without_current(MAGNET_A * sin(bench_electrical_rad(m)));
    }
    for (int i = 0; i < steps; i++) {
        const double c = cos(bench_electrical_rad(m));
        const double s = sin(bench_electrical_rad(m));

        m->i_a = current_of(flux.a, MAGNET_A * c);
        m->i_b = current_of(flux.b, MAGNET_A * s);
        m->speed_rad_s += step_s / p->inertia_kgm2 *
                          (p->torque_constant_Nm_A * (m->i_b * c - m->i_a * s) -
                           p->viscous_friction_Nms_rad * m->speed_rad_s - m->load_torque_Nm);
        m->angle_rad += step_s * m->speed_rad_s;
        flux.a += step_s / p->inductance_H * (u_a - p->resistance_ohm * m->i_a);
        flux.b += step_s / p->inductance_H * (u_b - p->resistance_ohm * m->i_b);
    }
}

void setUp(void)
{
    drive_bench_reset();
    bridge.run_motor = run_saturated;
    settings.initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    settings.standstill_pulses = true;
}

void tearDown(void)
{
}

static void enable_at(double angle_rad)
{
    motor.angle_rad = angle_rad;
    power_up();
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    for (int k = 0; drive.supervision.state != DRIVE_OPERATION_ENABLED; k++) {
        run(1);
        TEST_ASSERT_TRUE_MESSAGE(k < 20000, "it never ends");
    }
}

static double estimate_error_deg(void)
{
    return (signals().theta_est_rad - (motor.angle_rad - motor.speed_rad_s * PERIOD_S)) / DEGREE;
}

static double largest_error_deg(int periods, double load_change_Nm)
{
    double largest = 0.0;

    for (int k = 0; k < periods; k++) {
        motor.load_torque_Nm += load_change_Nm / periods;
        run(1);
        largest = fmax(largest, fabs(estimate_error_deg()));
    }
    return largest;
}

static const double angles_deg[] = {-150.0, -95.0, -40.0, 15.0, 70.0, 125.0};
enum { ANGLES = sizeof angles_deg / sizeof angles_deg[0] };

/* The way back to the angle where the impulses found it is not the reference's. */
static void test_impulses_find_the_rotor_where_it_stands(void)
{
    for (int i = 0; i < ANGLES; i++) {
        setUp();
        enable_at(angles_deg[i] * DEGREE);
        TEST_ASSERT_TRUE(drive.enabling.detection.by_impulses);
        TEST_ASSERT_DOUBLE_WITHIN(0.5, angles_deg[i], motor.angle_rad / DEGREE);
        TEST_ASSERT_DOUBLE_WITHIN(0.4, 0.0, estimate_error_deg());
        TEST_ASSERT_DOUBLE_WITHIN(0.5, angles_deg[i], signals().theta_ref_rad / DEGREE);
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, 0.0, signals().load_torque_est_Nm);
    }
}

/* 0.1 N m within half a second: its motion induces 9 mV. */
static void test_pulses_show_a_held_rotor_that_a_slow_load_draws_away(void)
{
    for (int i = 0; i < ANGLES; i++) {
        setUp();
        enable_at(angles_deg[i] * DEGREE);
        TEST_ASSERT_DOUBLE_WITHIN(5.5, 0.0, largest_error_deg(3000, 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(9.5, 0.0, largest_error_deg(5000, 0.1));
        TEST_ASSERT_DOUBLE_WITHIN(9.0, 0.0, largest_error_deg(2000, 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(0.015, 0.1, signals().load_torque_est_Nm);
        post((struct drive_command){.kind = DRIVE_COMMAND_MOVE_TRAPEZOID,
                                    .position_rad = signals().theta_ref_rad + 1.0,
                                    .duration_s = 0.1,
                                    .ramp_s = 0.03});
        TEST_ASSERT_DOUBLE_WITHIN(5.0, 0.0, largest_error_deg(1500, 0.0));
    }
}

/* Its filter has no offset of the voltage, and nothing of the hold. */
static void test_pulses_serve_the_steady_state_ekf_too(void)
{
    settings.estimator = DRIVE_ESTIMATOR_STEADY_STATE_EKF;
    enable_at(15.0 * DEGREE);
    TEST_ASSERT_DOUBLE_WITHIN(5.5, 0.0, largest_error_deg(3000, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(5.0, 0.0, largest_error_deg(5000, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(0.015, 0.1, signals().load_torque_est_Nm);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_impulses_find_the_rotor_where_it_stands);
    RUN_TEST(test_pulses_show_a_held_rotor_that_a_slow_load_draws_away);
    RUN_TEST(test_pulses_serve_the_steady_state_ekf_too);
    return UNITY_END();
}
