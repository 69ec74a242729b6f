/*
 * The test bench: the motor bendjedia-2012, simulated in double by the equations of
 * motor_params.h, and the board's converters. Integrated by Runge-Kutta in steps of a quarter
 * period, whose error is below 1e-6 of the currents at full speed.
 */
#ifndef STEADYSTEP_BENCH_H
#define STEADYSTEP_BENCH_H

#include <math.h>

#include "firmware/motor/motor_params.h"
#include "firmware/motor/park.h"
#include "firmware/motor/per_unit.h"
#include "hal/hal.h"

#define TWO_PI   6.283185307179586476925
#define PERIOD_S 1e-4

static const struct motor_params bench_params = {
    .resistance_ohm = 0.37,
    .inductance_H = 0.9e-3,
    .torque_constant_Nm_A = 0.157,
    .viscous_friction_Nms_rad = 0.307e-3,
    .inertia_kgm2 = 15.62e-5,
    .rated_current_A = 3.0,
    .supply_V = 24.0,
    .rotor_teeth = 50,
};

static const struct hal_facts bench_facts = {
    .board_name = "bench",
    .control_period_s = PERIOD_S,
    .pwm_half_period_counts = 8500,
    .dead_time_s = 1e-6,
    .leg_delay_s = 20e-9,
    .low_state_s = 4e-6,
    .converter_codes = 4096,
    .current_A_per_code = 12.0 / 4096.0,
    .current_zero_code = 2048,
    .current_offset_codes = 4.0,
    .bus_V_per_code = 31.2 / 4096.0,
    .phase_voltage_V_per_code = 62.4 / 4096.0,
    .has_phase_voltages = true,
    .cycle_counter_Hz = 170000000,
};

struct bench_motor {
    struct motor_params motor;
    double load_torque_Nm;
    double i_a, i_b;    /* A */
    double speed_rad_s; /* mechanical */
    double angle_rad;   /* mechanical */
};

struct bench_vector {
    double a, b; /* phases, or d and q */
};

/* An inertia that no torque of this motor moves: the speed is imposed. */
#define IMPOSED_SPEED 1e30

static inline double bench_electrical_rad(const struct bench_motor *m)
{
    return m->angle_rad * (double)m->motor.rotor_teeth;
}

/* From the rotor frame at an electrical angle to phases, and back. */
static inline struct bench_vector bench_to_phases(double d, double q, double electrical_rad)
{
    const double c = cos(electrical_rad);
    const double s = sin(electrical_rad);

    return (struct bench_vector){d * c - q * s, d * s + q * c};
}

static inline struct bench_vector bench_to_rotor(double a, double b, double electrical_rad)
{
    return bench_to_phases(a, b, -electrical_rad);
}

static inline struct bench_motor bench_derivative(const struct bench_motor *m, double u_a,
                                                  double u_b)
{
    const struct motor_params *p = &m->motor;
    const double c = cos(bench_electrical_rad(m));
    const double s = sin(bench_electrical_rad(m));
    const double emf = p->torque_constant_Nm_A * m->speed_rad_s;
    const double torque = p->torque_constant_Nm_A * (m->i_b * c - m->i_a * s);

    return (struct bench_motor){
        .i_a = (u_a - p->resistance_ohm * m->i_a + emf * s) / p->inductance_H,
        .i_b = (u_b - p->resistance_ohm * m->i_b - emf * c) / p->inductance_H,
        .speed_rad_s = (torque - p->viscous_friction_Nms_rad * m->speed_rad_s - m->load_torque_Nm) /
                       p->inertia_kgm2,
        .angle_rad = m->speed_rad_s,
    };
}

static inline struct bench_motor bench_moved(const struct bench_motor *m,
                                             const struct bench_motor *rate, double time_s)
{
    struct bench_motor moved = *m;

    moved.i_a += time_s * rate->i_a;
    moved.i_b += time_s * rate->i_b;
    moved.speed_rad_s += time_s * rate->speed_rad_s;
    moved.angle_rad += time_s * rate->angle_rad;
    return moved;
}

static inline void bench_step(struct bench_motor *m, double u_a, double u_b, double step_s)
{
    const struct bench_motor k1 = bench_derivative(m, u_a, u_b);
    const struct bench_motor m2 = bench_moved(m, &k1, 0.5 * step_s);
    const struct bench_motor k2 = bench_derivative(&m2, u_a, u_b);
    const struct bench_motor m3 = bench_moved(m, &k2, 0.5 * step_s);
    const struct bench_motor k3 = bench_derivative(&m3, u_a, u_b);
    const struct bench_motor m4 = bench_moved(m, &k3, step_s);
    const struct bench_motor k4 = bench_derivative(&m4, u_a, u_b);

    *m = bench_moved(m, &k1, step_s / 6.0);
    *m = bench_moved(m, &k2, step_s / 3.0);
    *m = bench_moved(m, &k3, step_s / 3.0);
    *m = bench_moved(m, &k4, step_s / 6.0);
}

/* One control period under constant phase voltages. */
static inline void bench_run(struct bench_motor *m, double u_a, double u_b)
{
    for (int quarter = 0; quarter < 4; quarter++) {
        bench_step(m, u_a, u_b, PERIOD_S / 4.0);
    }
}

/*
 * Phase voltages for the coming period that bring the currents towards i_d, i_q by three tenths a
 * period: a control that knows the motor and its angle.
 */
static inline struct bench_vector bench_regulate(const struct bench_motor *m, double i_d,
                                                 double i_q)
{
    const struct motor_params *p = &m->motor;
    const struct bench_vector i = bench_to_rotor(m->i_a, m->i_b, bench_electrical_rad(m));
    const double rotation = m->speed_rad_s * (double)p->rotor_teeth;
    const double stiffness = 0.3 * p->inductance_H / PERIOD_S;
    const double u_d =
        p->resistance_ohm * i.a + stiffness * (i_d - i.a) - rotation * p->inductance_H * i.b;
    const double u_q = p->resistance_ohm * i.b + stiffness * (i_q - i.b) +
                       rotation * p->inductance_H * i.a + p->torque_constant_Nm_A * m->speed_rad_s;

    return bench_to_phases(u_d, u_q, bench_electrical_rad(m) + 0.5 * rotation * PERIOD_S);
}

/* The q current that brings the rotor to a speed, with 2000 rad/s^2 at most, whatever the load. */
static inline double bench_speed_current(const struct bench_motor *m, double speed_rad_s)
{
    const struct motor_params *p = &m->motor;
    const double wanted = 500.0 * (speed_rad_s - m->speed_rad_s);
    const double acceleration = fmin(fmax(wanted, -2000.0), 2000.0);

    return (p->inertia_kgm2 * acceleration + p->viscous_friction_Nms_rad * m->speed_rad_s +
            m->load_torque_Nm) /
           p->torque_constant_Nm_A;
}

/* Per-unit phases of SI values. */
static inline struct phases bench_phases(double a, double b, double base)
{
    return (struct phases){num_from_double(a / base), num_from_double(b / base)};
}

#endif
