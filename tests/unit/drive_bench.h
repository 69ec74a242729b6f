/* A drive in closed loop on the simulated motor: averaged bridge, converters without noise. For one
   drive at a time. */
#ifndef STEADYSTEP_DRIVE_BENCH_H
#define STEADYSTEP_DRIVE_BENCH_H

#include <stddef.h>
#include <string.h>

#include "firmware/drive/idle_current.h"
#include "firmware/drive/motion_current.h"
#include "firmware/drive/phase_watch.h"
#include "firmware/drive/rotor_watch.h"
#include "firmware/drive/standing_rotor.h"
#include "firmware/drive/thermal_watch.h"
#include "tests/unit/fake_board.h"
#include "tests/unit/num_assert.h"

#define DEAD_TIME_LOSS_V 0.3

static struct drive drive;
static struct drive_settings settings;
static struct bench_motor motor;
static char error[DRIVE_ERROR_TEXT];

static struct hal_facts encoder_facts;
static struct hal board;

/* The bridge over S(k)...S(k+1), and what is commanded for S(k+1)...S(k+2). */
static struct {
    struct hal_outputs in_force;
    struct bench_vector mean_V; /* over the past period */
    double bus_V;
    double gain_a;       /* of a current sensor */
    double loss_V;       /* against the current, of its dead time */
    bool open_a, open_b; /* broken leads */
    void (*run_motor)(struct bench_motor *motor, double u_a, double u_b); /* over a period */
    void (*disturb)(struct hal_samples *samples);
    bool background; /* runs, once in a period */
} bridge;

static inline void feed_no_watchdog(void *context)
{
    (void)context;
}

static inline void drive_bench_reset(void)
{
    drive_settings_default(&settings, &bench_params);
    settings.hold_on_enable_s = 0.03;
    settings.balance_phases = false;
    fake_board = (struct fake_board){.trip_latched = false};
    motor = (struct bench_motor){.motor = bench_params};
    memset(&bridge, 0, sizeof bridge);
    bridge.bus_V = 24.0;
    bridge.gain_a = 1.0;
    bridge.loss_V = DEAD_TIME_LOSS_V;
    bridge.run_motor = bench_run;
    board = fake_hal;
    board.watchdog_feed = feed_no_watchdog;
    encoder_facts = bench_facts;
}

static inline void power_up(void)
{
    TEST_ASSERT_TRUE_MESSAGE(drive_init(&drive, &board, &settings, error), error);
}

static inline int32_t code(double x)
{
    return (int32_t)(x + 8192.5) - 8192;
}

/* Of an encoder; on a board without one nobody asks. */
static inline int32_t encoder_count(void)
{
    return (int32_t)floor(motor.angle_rad / TWO_PI * (double)encoder_facts.encoder_counts_per_turn);
}

static inline struct hal_samples sample(void)
{
    return (struct hal_samples){
        .encoder_count = encoder_count(),
        .current_a =
            (uint16_t)code(2048.0 + bridge.gain_a * motor.i_a / bench_facts.current_A_per_code),
        .current_b = (uint16_t)code(2048.0 + motor.i_b / bench_facts.current_A_per_code),
        .bus_voltage = (uint16_t)code(bridge.bus_V / bench_facts.bus_V_per_code),
        .phase_voltage_a = (int16_t)code(bridge.mean_V.a / bench_facts.phase_voltage_V_per_code),
        .phase_voltage_b = (int16_t)code(bridge.mean_V.b / bench_facts.phase_voltage_V_per_code),
    };
}

/* Dead time costs a voltage against the current; a small current less. */
static inline double phase_voltage(const uint16_t high_counts[2], double current_A)
{
    const double modulation = ((double)high_counts[0] - (double)high_counts[1]) / 8500.0;
    const double loss = fmin(fmax(current_A / 0.05, -1.0), 1.0) * bridge.loss_V;

    return modulation * bridge.bus_V - loss;
}

static inline void period(void)
{
    struct hal_samples samples = sample();
    struct hal_outputs next;

    if (bridge.disturb != NULL) {
        bridge.disturb(&samples);
    }

    drive_control_cycle(&drive, &samples, &next);
    if (board.facts->zero_delay) {
        bridge.in_force = next;
    }
    if (bridge.in_force.bridge_on) {
        bridge.mean_V.a = phase_voltage(&bridge.in_force.high_counts[HAL_LEG_A_PLUS], motor.i_a);
        bridge.mean_V.b = phase_voltage(&bridge.in_force.high_counts[HAL_LEG_B_PLUS], motor.i_b);
        bridge.run_motor(&motor, bridge.mean_V.a, bridge.mean_V.b);
    } else {
        bridge.mean_V = (struct bench_vector){0.0, 0.0};
        motor.i_a = 0.0;
        motor.i_b = 0.0;
    }
    motor.i_a = bridge.open_a ? 0.0 : motor.i_a;
    motor.i_b = bridge.open_b ? 0.0 : motor.i_b;
    bridge.in_force = next;
    if (bridge.background) {
        drive_background(&drive);
        phase_watch_background(&drive);
        idle_current_background(&drive);
        motion_current_background(&drive);
        standing_rotor_background(&drive);
        thermal_watch_background(&drive);
        rotor_watch_background(&drive);
        lead_watch_background(&drive);
        torque_constant_background(&drive);
    }
}

static inline void run(int periods)
{
    for (int k = 0; k < periods; k++) {
        period();
    }
    TEST_ASSERT_EQUAL_STRING("none", drive_fault_name(drive.supervision.fault));
}

static inline void post(struct drive_command command)
{
    TEST_ASSERT_TRUE_MESSAGE(drive_command(&drive, &command, error), error);
}

static inline void enable(void)
{
    power_up();
    post((struct drive_command){.kind = DRIVE_COMMAND_ENABLE});
    run(OFFSET_PERIODS + 301);
    TEST_ASSERT_EQUAL_STRING("operation-enabled", drive_state_name(drive.supervision.state));
}

static inline struct drive_signals signals(void)
{
    struct drive_signals now;

    drive_signals_read(&drive, &now);
    return now;
}

static inline void move(double position_rad, double duration_s)
{
    post((struct drive_command){.kind = DRIVE_COMMAND_MOVE_TRAPEZOID,
                                .position_rad = position_rad,
                                .duration_s = duration_s,
                                .ramp_s = 0.3 * duration_s});
}

/* Before S(k) is left: reference, estimate and rotor at one instant. */
static inline double following_error_rad(void)
{
    return signals().theta_ref_rad - (motor.angle_rad - motor.speed_rad_s * PERIOD_S);
}

#endif
