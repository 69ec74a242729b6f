/* What a drive does in closed loop is the same, bit for bit, on every compiler, and within a
   version: the numbers below. A change that moves them moves the hashes of scenarios, too, and says
   so; a failure shows the new one. */
#include "firmware/drive/drive_hash.h"
#include "tests/unit/drive_bench.h"
#include "tests/unit/servo_frequency.h"

static uint64_t hash;

void setUp(void)
{
    drive_bench_reset();
    bridge.background = true;
    hash = UINT64_C(0xcbf29ce484222325);
    encoder_facts.encoder_counts_per_turn = 4000;
    board.facts = &encoder_facts;
}

void tearDown(void)
{
}

static void add(uint32_t word)
{
    hash = drive_hash_word(hash, word);
}

/* Control and background, so many periods, whatever comes of it. */
static void go(int periods)
{
    for (int k = 0; k < periods; k++) {
        const struct reference_sample *reference = &drive.reference.now;

        period();
        hash = drive_hash_add(hash, drive_hash_row(&drive, &bridge.in_force));
        add((uint32_t)reference->position.turns);
        add(reference->position.fraction);
        add(num_bits(reference->speed));
        add(num_bits(reference->acceleration));
        add(num_bits(drive.current_reference.d));
        add(num_bits(drive.current_reference.q));
        add((uint32_t)drive.supervision.fault);
        add((uint32_t)drive.synchronism.shown);
        add((uint32_t)drive.axis.reference);
        add(num_bits(drive.thermal.heat));
        add(drive.commands.dropped + drive.planner.underruns);
    }
}

/* Accepted or refused, with which words. */
static void ask(struct drive_command command)
{
    error[0] = '\0';
    add(drive_command(&drive, &command, error) ? 1u : 0u);
    for (const char *c = error; *c != '\0'; c++) {
        add((uint8_t)*c);
    }
}

static void ask_kind(enum drive_command_kind kind)
{
    ask((struct drive_command){.kind = kind});
}

static void towards(enum drive_command_kind kind, double position_rad, double speed_rad_s)
{
    ask((struct drive_command){.kind = kind,
                               .position_rad = position_rad,
                               .speed_rad_s = speed_rad_s,
                               .acceleration_rad_s2 = 400.0,
                               .jerk_rad_s3 = 4e4});
}

static void make(enum drive_command_kind kind, double position_rad, double duration_s)
{
    ask((struct drive_command){.kind = kind,
                               .position_rad = position_rad,
                               .duration_s = duration_s,
                               .ramp_s = 0.3 * duration_s,
                               .jerk_s = 0.05 * duration_s});
}

static void begin(void)
{
    power_up();
    ask_kind(DRIVE_COMMAND_ENABLE);
    go(OFFSET_PERIODS + 301);
}

static void move_about(void)
{
    make(DRIVE_COMMAND_MOVE_TRAPEZOID, 0.8, 0.1);
    go(500);
    motor.load_torque_Nm = 0.1;
    go(1000);
    make(DRIVE_COMMAND_MOVE_SMOOTH, -0.5, 0.12);
    go(300);
    bridge.bus_V = 21.0;
    go(1300);
    motor.load_torque_Nm = -0.05;
    bridge.bus_V = 24.0;
    ask((struct drive_command){.kind = DRIVE_COMMAND_SINE,
                               .amplitude_rad = 0.05,
                               .frequency_Hz = 15.0,
                               .cycles = 1.0,
                               .ramp_s = 0.02});
    go(900);
}

static void change_its_mind(void)
{
    towards(DRIVE_COMMAND_VELOCITY, 0.0, 9.0);
    go(500);
    towards(DRIVE_COMMAND_VELOCITY, 0.0, -4.0);
    go(200);
    towards(DRIVE_COMMAND_RETARGET, 0.3, 12.0);
    go(900);
    for (int n = 0; n < 20; n++) {
        ask((struct drive_command){.kind = DRIVE_COMMAND_SET_POINT,
                                   .position_rad = 0.3 + 4e-4 * (n < 10 ? n * n : 100),
                                   .interval_s = 3e-3,
                                   .acceleration_rad_s2 = 900.0,
                                   .jerk_rad_s3 = 1e5});
        go(30);
    }
    go(400);
    make(DRIVE_COMMAND_MOVE_TRAPEZOID, 2.0, 0.2);
    go(700);
    ask_kind(DRIVE_COMMAND_STOP);
    go(500);
    ask((struct drive_command){.kind = DRIVE_COMMAND_SET_POSITION, .position_rad = -1.0});
    ask((struct drive_command){.kind = DRIVE_COMMAND_STEP, .position_rad = -0.99});
    go(500);
    ask_kind(DRIVE_COMMAND_DISABLE);
    go(200);
    ask_kind(DRIVE_COMMAND_ENABLE);
    go(OFFSET_PERIODS + 400);
}

/* Of float, of fixed point; a host's double is nobody's. */
static void is(uint64_t of_float, uint64_t of_fixed)
{
#if STEADYSTEP_NUM == NUM_FLOAT
    TEST_ASSERT_EQUAL_HEX64(of_float, hash);
#elif STEADYSTEP_NUM == NUM_FIXED
    TEST_ASSERT_EQUAL_HEX64(of_fixed, hash);
#endif
    (void)of_float;
    (void)of_fixed;
}

static void encoder(enum position_law law, bool zero_known)
{
    drive_bench_reset();
    bridge.background = true;
    board.facts = &encoder_facts;
    encoder_facts.encoder_counts_per_turn = 4000;
    drive_settings_select_feedback(&settings, DRIVE_FEEDBACK_ENCODER);
    drive_settings_select_law(&settings, law);
    give_servo_frequency(&settings, 100.0);
    settings.encoder_zero_known = zero_known;
}

static void test_the_default_drive(void)
{
    begin();
    move_about();
    change_its_mind();
    is(UINT64_C(0x8E51A2C3127EEC23), UINT64_C(0xB9331D8EECDE4ECF));
}

/* Phases are balanced, less current at rest, what is lost and found; no loss is compensated. */
static void test_a_drive_with_its_options(void)
{
    settings.balance_phases = true;
    settings.idle_current_A = 1.5;
    settings.idle_delay_s = 0.05;
    settings.motion_current_A = 0.3;
    settings.motor_time_constant_s = 5.0;
    bridge.gain_a = 1.03;
    begin();
    go(2500);
    move_about();
    settings.bridge_loss_compensation = false;
    settings.feed_forward = false;
    settings.voltage_source = DRIVE_VOLTAGE_COMMANDED;
    settings.synchronism_policy = DRIVE_SYNCHRONISM_WARN;
    begin();
    move_about();
    is(UINT64_C(0x9311571EBEFB28E8), UINT64_C(0xA0F41D96C34FEFCE));
}

static void test_the_other_ways_to_begin(void)
{
    settings.estimator = DRIVE_ESTIMATOR_STEADY_STATE_EKF;
    begin();
    move_about();
    setUp();
    settings.initial_position = DRIVE_INITIAL_POSITION_IMPULSES;
    motor.angle_rad = 0.01;
    begin();
    go(4000);
    move_about();
    encoder(POSITION_LAW_STATE_FEEDBACK, false);
    motor.angle_rad = 0.013;
    begin();
    go(20000);
    move_about();
    is(UINT64_C(0x7C6FB3423ED3D5A3), UINT64_C(0xF39093A92EEE8A1A));
}

static void test_every_law_on_an_encoder(void)
{
    for (int law = 0; law < POSITION_LAW_COUNT; law++) {
        encoder((enum position_law)law, true);
        begin();
        move_about();
    }
    encoder(POSITION_LAW_FEEDBACK_LINEARISATION, true);
    begin();
    change_its_mind();
    is(UINT64_C(0x707172b1b84ad75c), UINT64_C(0x2f1a411e846a7298));
}

static void test_what_a_drive_does_when_it_is_overcome(void)
{
    for (int feedback = 0; feedback < 2; feedback++) {
        if (feedback == 1) {
            encoder(POSITION_LAW_FEEDBACK_LINEARISATION, true);
        }
        begin();
        make(DRIVE_COMMAND_MOVE_TRAPEZOID, 3.0, 0.2);
        go(800);
        motor.load_torque_Nm = 0.7;
        go(1500);
        motor.load_torque_Nm = 0.0;
        motor.speed_rad_s = 0.0;
        ask_kind(DRIVE_COMMAND_DISABLE);
        go(50);
        ask_kind(DRIVE_COMMAND_ENABLE);
        go(OFFSET_PERIODS + 400);
        bridge.bus_V = 8.0;
        go(20);
    }
    is(UINT64_C(0x8035AF9F7EF3BEDF), UINT64_C(0xCFFB0E353CBD213C));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_default_drive);
    RUN_TEST(test_a_drive_with_its_options);
    RUN_TEST(test_the_other_ways_to_begin);
    RUN_TEST(test_every_law_on_an_encoder);
    RUN_TEST(test_what_a_drive_does_when_it_is_overcome);
    return UNITY_END();
}
