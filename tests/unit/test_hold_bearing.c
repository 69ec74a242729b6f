/* What a drive without an encoder bears of a motor: what it says of it, and when it refuses. */
#include "firmware/drive/hold_bearing.c" /* no part of a drive: who asks on the host has it */
#include "tests/unit/drive_bench.h"

static struct drive_hold_bearing bearing;

void setUp(void)
{
    drive_bench_reset();
}

void tearDown(void)
{
}

static void ask(void)
{
    TEST_ASSERT_TRUE_MESSAGE(drive_hold_bearing_of(&settings, PERIOD_S, 0.0, &bearing, error),
                             error);
}

static void near(double share, double expected, double actual)
{
    TEST_ASSERT_DOUBLE_WITHIN(share * expected, expected, actual);
}

static double hold_frequency_rad_s(void)
{
    const struct motor_params *m = &settings.motor;

    return sqrt(m->rotor_teeth * m->torque_constant_Nm_A * bearing.current_A / m->inertia_kgm2);
}

/* By the formulas of firmware/README.md and of the members. */
static void by_formulas(void)
{
    const struct motor_params *m = &settings.motor;
    const double drop_V = 0.025 * m->resistance_ohm * m->rated_current_A;
    const double turned_rad =
        m->rotor_teeth * drop_V / m->torque_constant_Nm_A / hold_frequency_rad_s();

    near(1e-9, m->resistance_ohm * bearing.current_A * bearing.current_A, bearing.heat_W);
    near(1e-9, m->torque_constant_Nm_A * bearing.current_A, bearing.torque_Nm);
    near(1e-9, 0.7246 * bearing.torque_Nm, bearing.load_step_Nm);
    near(1e-6, 360.0 / TWO_PI * turned_rad, bearing.drop_deg);
    near(1e-6,
         fmin(hold_frequency_rad_s() / 8.0 / m->rotor_teeth,
              0.026 * m->supply_V / m->torque_constant_Nm_A),
         bearing.creep_speed_rad_s);
}

static void test_the_reference_motor_is_held_by_its_rated_current(void)
{
    ask();
    near(1e-9, 3.0, bearing.current_A);
    by_formulas();
    near(1e-3, 0.03379, bearing.noticed_step_Nm);
    near(1e-3, 2.854, bearing.thrown_deg);
    near(1e-3, 1.304, bearing.drop_deg);
}

static void test_half_the_current_bears_half_as_much_for_a_quarter_of_the_heat(void)
{
    settings.hold_current_A = 1.5;
    ask();
    by_formulas();
    near(1e-9, 0.8325, bearing.heat_W);
    near(1e-3, 0.03168, bearing.noticed_step_Nm);
    near(1e-3, 2.854, bearing.thrown_deg); /* in motion, of which the hold is no part */
}

static void test_a_light_rotor_is_thrown_less_and_led_as_fast_as_its_back_emf_bears(void)
{
    settings.motor.inertia_kgm2 /= 20.0;
    ask();
    by_formulas();
    near(1e-3, 0.02838, bearing.noticed_step_Nm);
    near(1e-3, 0.6975, bearing.thrown_deg);
}

/* N L I / Km of 0.86, and of 3.4. */
static void test_a_motor_of_little_magnet_flux_has_a_d_current_in_motion(void)
{
    ask();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bearing.motion_current_A);
    settings.motor.inductance_H *= 4.0;
    ask();
    near(1e-9, 0.375 * 3.0, bearing.motion_current_A);
    settings.motion_current_A = 0.5;
    ask();
    near(1e-9, 0.5, bearing.motion_current_A);
}

/* A step that the offset of a current feigns, 0.0385 N m: 50 x 0.157 x 1.5 N m/rad x 0.2 rad/s
 * x 10.9 ms x 1.5. */
static void test_a_coarse_board_notices_less(void)
{
    settings.hold_current_A = 1.5;
    TEST_ASSERT_TRUE(drive_hold_bearing_of(&settings, PERIOD_S, 0.2, &bearing, error));
    near(0.01, 0.03168 * 0.0385 / 0.025, bearing.noticed_step_Nm);
}

static void test_a_heavy_rotor_is_refused_with_what_the_winding_would_do(void)
{
    settings.motor.inertia_kgm2 *= 1000.0;
    TEST_ASSERT_FALSE(drive_hold_bearing_of(&settings, PERIOD_S, 0.0, &bearing, error));
    TEST_ASSERT_EQUAL_STRING("winding_drop_angle_error 41.24 degrees electrical: must be at most "
                             "20 degrees electrical, of 2.5 % of R x rated current: too little "
                             "back-EMF for its inertia",
                             error);
}

/* Of the sampled loop of damping, current control and held rotor: by the eigenvalues that another
   program finds of it. */
static void test_the_hold_is_damped_as_its_sampled_loop_is(void)
{
    static const double expected[] = {0.5497, 0.6205, 0.5035};

    default_settings_apply(&settings, PERIOD_S, 0u);
    for (int i = 0; i < 3; i++) {
        struct hold_task task = hold_task_of(&settings, PERIOD_S);
        double damping_As_rad;

        task.bandwidth_rad_s = 100.0 * (i + 1);
        TEST_ASSERT_TRUE_MESSAGE(hold_damping_design(&task, &damping_As_rad, error), error);
        near(3e-3, expected[i], hold_control_damping(&task, damping_As_rad));
    }
}

/* J w0^2, with 300 rad/s without an encoder and 900 with one. */
static void test_the_law_is_as_stiff_as_its_bandwidth(void)
{
    near(1e-9, 15.62e-5 * 300.0 * 300.0, drive_law_stiffness_Nm_rad(&settings, PERIOD_S, 0u));
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    near(1e-9, 15.62e-5 * 900.0 * 900.0, drive_law_stiffness_Nm_rad(&settings, PERIOD_S, 4000u));
    settings.law_bandwidth_rad_s = 500.0;
    near(1e-9, 15.62e-5 * 500.0 * 500.0, drive_law_stiffness_Nm_rad(&settings, PERIOD_S, 4000u));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_reference_motor_is_held_by_its_rated_current);
    RUN_TEST(test_half_the_current_bears_half_as_much_for_a_quarter_of_the_heat);
    RUN_TEST(test_a_light_rotor_is_thrown_less_and_led_as_fast_as_its_back_emf_bears);
    RUN_TEST(test_a_motor_of_little_magnet_flux_has_a_d_current_in_motion);
    RUN_TEST(test_a_coarse_board_notices_less);
    RUN_TEST(test_a_heavy_rotor_is_refused_with_what_the_winding_would_do);
    RUN_TEST(test_the_hold_is_damped_as_its_sampled_loop_is);
    RUN_TEST(test_the_law_is_as_stiff_as_its_bandwidth);
    return UNITY_END();
}
