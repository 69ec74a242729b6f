/* A drive that is designed for other settings is the one that it would have been from the start:
   nothing of the design before is left in what it uses. */
#include <stddef.h>
#include <stdio.h>

#include "tests/unit/drive_bench.h"

enum { DESIGNS = 5 };

static struct drive_settings designs[DESIGNS];
static struct drive fresh; /* `drive` has been another before */

/* As unlike one another as drives can be. */
void setUp(void)
{
    struct drive_settings *d = designs;

    drive_bench_reset();
    encoder_facts.encoder_counts_per_turn = 4000;
    board.facts = &encoder_facts;
    for (int i = 0; i < DESIGNS; i++) {
        d[i] = settings;
    }
    drive_settings_select_feedback(&d[1], DRIVE_FEEDBACK_ENCODER);

    drive_settings_select_feedback(&d[2], DRIVE_FEEDBACK_ENCODER);
    drive_settings_select_law(&d[2], POSITION_LAW_FOC);
    d[2].observer = DRIVE_OBSERVER_HIGH_GAIN;
    d[2].detent_learning = false;
    d[2].encoder_zero_known = true;
    d[2].encoder_zero_rad = 1.0;

    d[3].estimator = DRIVE_ESTIMATOR_STEADY_STATE_EKF;
    d[3].law = POSITION_LAW_PID;
    d[3].motor = (struct motor_params){.resistance_ohm = 0.5,
                                       .inductance_H = 1e-3,
                                       .torque_constant_Nm_A = 0.14,
                                       .viscous_friction_Nms_rad = 6e-4,
                                       .inertia_kgm2 = 2e-4,
                                       .rated_current_A = 2.5,
                                       .supply_V = 20.0,
                                       .rotor_teeth = 40};
    d[3].current_limit_A = 2.0;
    d[3].calibrate_offsets = false;
    d[3].feed_forward = false;
    d[3].bridge_loss_compensation = false;
    d[3].hold_on_enable_s = 0.2;
    d[3].hold_ramp_s = 0.02;
    d[3].hold_at_rest = false;
    d[3].initial_load_torque_Nm = 0.01;

    d[4].initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    d[4].standstill_pulses = true;
    d[4].balance_phases = true;
    d[4].initial_angle_rad = 1.0;
    d[4].initial_torque_constant_change = 0.1;
}

void tearDown(void)
{
}

static const char *names; /* of the two designs */

static void is_the_same(const void *a, const void *b, size_t bytes, const char *what)
{
    if (memcmp(a, b, bytes) != 0) {
        char words[100];

        (void)snprintf(words, sizeof words, "%s: %s", names, what);
        TEST_FAIL_MESSAGE(words);
    }
}

#define SAME(member) is_the_same(&fresh.member, &drive.member, sizeof fresh.member, #member)

/* Without the padding behind its last member. */
#define SAME_UP_TO(member, type, last)                                                             \
    is_the_same(&fresh.member, &drive.member, offsetof(type, last) + sizeof fresh.member.last,     \
                #member)

static void the_law_is_the_same(void)
{
#define LAW_SAME(constant, function, text)                                                         \
    if (fresh.params.position_law == POSITION_LAW_##constant) {                                    \
        SAME(params.law.function);                                                                 \
    }
    POSITION_LAWS(LAW_SAME)
#undef LAW_SAME
}

static void the_estimator_is_the_same(void)
{
    const struct estimator_params *p = &fresh.params.estimator;

    SAME(params.estimator.kind);
    if (p->kind == ESTIMATOR_INVARIANT_EKF) {
        SAME(params.estimator.invariant_ekf);
        SAME(synchronism.params);
    } else if (p->kind == ESTIMATOR_STEADY_STATE_EKF) {
        SAME(params.estimator.steady_state_ekf);
    } else {
        SAME(params.estimator.encoder_observer.model);
        SAME(params.estimator.encoder_observer.encoder.angle_per_count);
        SAME(params.estimator.encoder_observer.gain_angle);
        SAME(params.estimator.encoder_observer.gain_speed);
        SAME(params.estimator.encoder_observer.gain_load);
        SAME(params.estimator.encoder_observer.gain_resistance);
    }
    if (p->kind == ESTIMATOR_HIGH_GAIN_OBSERVER) {
        SAME(params.estimator.high_gain_observer.speed_limit);
        SAME(params.estimator.high_gain_observer.transition);
        SAME(params.estimator.high_gain_observer.input);
        SAME(params.estimator.high_gain_observer.speed_per_turn);
        SAME(params.estimator.high_gain_observer.acceleration_per_turn);
    }
}

static void the_designs_are_the_same(void)
{
    SAME(settings);
    SAME(base);
    SAME(params.measurement);
    SAME(params.model);
    SAME(params.reference);
    SAME_UP_TO(params.hold, struct standstill_hold_params, enters_at_rest);
    SAME(params.current_control);
    SAME(params.modulator);
    SAME(params.protection);
    SAME(params.position_law);
    SAME(params.path);
    SAME(params.enabling.initial_position);
    SAME(params.enabling.encoder_zero);
    SAME(params.enabling.encoder_zero_assumed);
    SAME(params.enabling.initial_load_torque);
    SAME(params.enabling.hold_on_enable_periods);
    SAME(params.enabling.balance_periods);
    SAME(params.enabling.calibrates_offsets);
    SAME(params.enabling.detects_position);
    SAME(params.enabling.encoder_zero_known);
    SAME(params.detent);
    SAME(torque_constant.change);
    SAME(torque_constant.in_force);
    SAME(params.bridge_loss);
    SAME(params.following);
    SAME_UP_TO(phase_watch_params, struct phase_watch_params, noise_codes);
    SAME(enabling.calibration_params);
    SAME(standstill);
    SAME(synchronism.policy);
    SAME(synchronism.monitored);
    the_estimator_is_the_same();
    the_law_is_the_same();
    if (fresh.params.enabling.detects_position) {
        SAME(enabling.detection_params);
    }
    if (fresh.settings.feedback == DRIVE_FEEDBACK_ENCODER) {
        SAME_UP_TO(enabling.alignment_params, struct encoder_alignment_params, outlier_max);
    } else if (fresh.settings.balance_phases) {
        SAME(enabling.balance_params);
    }
}

/* What is not designed has something else than zero, then. */
static void forget_design(void)
{
    memset(&drive.params, 1, sizeof drive.params);
    memset(&drive.phase_watch_params, 1, sizeof drive.phase_watch_params);
    memset(&drive.standstill.params, 1, sizeof drive.standstill.params);
    memset(&drive.synchronism.params, 1, sizeof drive.synchronism.params);
    memset(&drive.enabling.calibration_params, 1, sizeof drive.enabling.calibration_params);
    memset(&drive.enabling.detection_params, 1, sizeof drive.enabling.detection_params);
    memset(&drive.enabling.balance_params, 1, sizeof drive.enabling.balance_params);
    memset(&drive.settings, 1, sizeof drive.settings);
    memset(&drive.base, 1, sizeof drive.base);
}

static void test_nothing_of_the_design_before_is_left(void)
{
    if (STEADYSTEP_NUM == NUM_DOUBLE) {
        return; /* the same source as float, and padding in between, which is not copied */
    }
    for (int before = 0; before < DESIGNS; before++) {
        for (int now = 0; now < DESIGNS; now++) {
            char pair[20];

            (void)snprintf(pair, sizeof pair, "%d, then %d", before, now);
            names = pair;
            memset(&fresh, 0, sizeof fresh);
            memset(&drive, 0, sizeof drive);
            TEST_ASSERT_TRUE_MESSAGE(drive_init(&fresh, &board, &designs[now], error), error);
            TEST_ASSERT_TRUE_MESSAGE(drive_init(&drive, &board, &designs[before], error), error);
            forget_design();
            TEST_ASSERT_TRUE_MESSAGE(drive_design(&drive, &designs[now], error), error);
            the_designs_are_the_same();
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_nothing_of_the_design_before_is_left);
    return UNITY_END();
}
