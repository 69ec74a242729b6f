#include "sil/scenario/slip_scenario.h"

#include <algorithm>

#include "sil/scenario/random_scenario.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double pi = 3.14159265358979323846;
constexpr double period_parts = 1e4; /* times in whole control periods */
constexpr double step_parts = 1e5;
constexpr double full_turn_rad = 0.1257; /* electrical, of 50 teeth */

enum Stream : std::uint64_t { of_plant, of_motion, of_load, of_provocation };

/* Of the true motor to its file. */
struct Scales {
    double resistance, inductance, km, inertia;
};

/* What the seed's motor is like, unless it is part of the provocation. */
Scales draw_scales(Draw &draw)
{
    if (draw.chance(0.2)) {
        return {1, 1, 1, 1};
    }
    return {draw.between(0.7, 1.3, 1e3), draw.between(0.9, 1.1, 1e3), draw.between(0.9, 1.1, 1e3),
            draw.between(0.7, 1.3, 1e3)};
}

void write_plant(ScenarioText &text, Draw &draw, const Scales &scales, const RatingScales &ratings,
                 bool slow_enough_to_notice)
{
    const double volts = slow_enough_to_notice ? 0.005 : 0.02; /* offset of the sensing */
    text.table("plant");
    text.text("model", draw.chance(0.5) ? "real" : "bench");
    text.number("resistance_scale", scales.resistance);
    text.number("inductance_scale", scales.inductance);
    text.number("km_scale", scales.km);
    text.number("inertia_scale", scales.inertia);
    text.number("current_range_A", times(plant::SensorConfig().current_range_A, ratings.current));
    if (draw.chance(0.3)) {
        text.number("current_offset_on_a_A",
                    times(draw.between(-0.02, 0.02, 1e4), ratings.current));
        text.number("current_offset_on_b_A",
                    times(draw.between(-0.02, 0.02, 1e4), ratings.current));
    }
    if (draw.chance(0.3)) {
        text.number("phase_voltage_offset_on_a_V", draw.between(-volts, volts, 1e4));
        text.number("phase_voltage_offset_on_b_V", draw.between(-volts, volts, 1e4));
    }
}

enum class Motion { rest, moves, velocity, slow, sine, steps };
constexpr std::size_t motions = 6;

void write_moves(ScenarioText &text, Draw &draw, const RatingScales &ratings, double duration_s)
{
    double position_rad = 0;
    double time_s = draw.between(0, 0.05, period_parts);
    for (;;) {
        const double move_s = draw.between(0.08, 0.25, period_parts);
        if (time_s + move_s > duration_s) {
            return;
        }
        const double ramp_s = rounded(move_s * draw.between(0.1, 0.49, 100), period_parts);
        const double speed_rad_s = std::min(times(draw.mostly_low(1, 100, 100), ratings.speed),
                                            times(1500, ratings.acceleration) * ramp_s);
        position_rad =
            rounded(position_rad + draw.either_sign(speed_rad_s * (move_s - ramp_s)), 1e4);
        text.event(time_s,
                   "command = \"move-trapezoid\", position_rad = " + shortest(position_rad) +
                       ", duration_s = " + shortest(move_s) + ", ramp_s = " + shortest(ramp_s));
        time_s =
            rounded(time_s + move_s + (draw.chance(0.5) ? 0 : draw.between(0, 0.1, period_parts)),
                    period_parts);
    }
}

void write_velocity(ScenarioText &text, Draw &draw, const RatingScales &ratings, double slowest,
                    double fastest)
{
    double speed_rad_s =
        times(draw.either_sign(draw.mostly_low(slowest, fastest, 100)), ratings.speed);
    const std::string limits =
        ", acceleration_rad_s2 = " +
        shortest(times(draw.mostly_low(100, 1500, 1), ratings.acceleration)) +
        ", jerk_rad_s3 = " + shortest(times(1e5, ratings.acceleration));
    double time_s = draw.between(0, 0.05, period_parts);
    text.event(time_s, "command = \"velocity\", speed_rad_s = " + shortest(speed_rad_s) + limits);
    if (draw.chance(0.4)) {
        time_s = rounded(time_s + draw.between(0.15, 0.3, period_parts), period_parts);
        speed_rad_s = rounded(-speed_rad_s * draw.between(0.3, 1, 100), 100);
        text.event(time_s,
                   "command = \"velocity\", speed_rad_s = " + shortest(speed_rad_s) + limits);
    }
}

void write_sine(ScenarioText &text, Draw &draw, const RatingScales &ratings)
{
    const double frequency_Hz = draw.mostly_low(0.5, 8, 100);
    const double fastest = std::min(80.0, 1000 / (2 * pi * frequency_Hz));
    const double speed_rad_s = times(draw.mostly_low(1, rounded(fastest, 100), 100),
                                     std::min(ratings.speed, ratings.acceleration));
    text.event(draw.between(0, 0.05, period_parts),
               "command = \"sine\", amplitude_rad = " +
                   shortest(rounded(speed_rad_s / (2 * pi * frequency_Hz), 1e4)) +
                   ", frequency_Hz = " + shortest(frequency_Hz) +
                   ", cycles = 0, ramp_s = " + shortest(rounded(0.5 / frequency_Hz, period_parts)));
}

void write_steps(ScenarioText &text, Draw &draw, const RatingScales &ratings, double duration_s)
{
    double position_rad = 0;
    for (double time_s = draw.between(0, 0.05, period_parts); time_s < duration_s - 0.1;
         time_s = rounded(time_s + draw.between(0.06, 0.25, period_parts), period_parts)) {
        position_rad = rounded(
            position_rad + times(draw.either_sign(draw.between(0.01, 0.5, 1e3)), ratings.angle),
            step_parts);
        text.event(time_s, "command = \"step\", position_rad = " + shortest(position_rad));
    }
}

void write_motion(ScenarioText &text, Draw &draw, Motion motion, const RatingScales &ratings,
                  bool exact_enough, double duration_s)
{
    switch (motion) {
    case Motion::rest:
        break;
    case Motion::moves:
        write_moves(text, draw, ratings, duration_s);
        break;
    case Motion::velocity:
        write_velocity(text, draw, ratings, 3, 100);
        break;
    case Motion::slow: /* what table E asks for at 5 and at 20 mV of offset */
        write_velocity(text, draw, ratings, exact_enough ? 1 : 3, 6);
        break;
    case Motion::sine:
        write_sine(text, draw, ratings);
        break;
    case Motion::steps:
        write_steps(text, draw, ratings, duration_s);
        break;
    }
}

std::string load(double torque_Nm, const RatingScales &ratings)
{
    return "load_torque_Nm = " + shortest(times(torque_Nm, ratings.torque));
}

/* At rest the hold of half the rated current bears 0.24 N m when nothing is known of the load. */
void write_legal_load(ScenarioText &text, Draw &draw, Motion motion, const RatingScales &ratings,
                      double duration_s)
{
    const double largest = motion == Motion::rest ? 0.12 : motion == Motion::slow ? 0.15 : 0.3;
    if (draw.chance(0.3)) {
        return;
    }
    const double torque_Nm = draw.between(-largest, largest, 1e3);
    const double time_s = draw.between(0, 0.4 * duration_s, period_parts);
    text.event(time_s, load(torque_Nm, ratings));
    if (draw.chance(0.5)) {
        text.event(
            rounded(time_s + draw.between(0.05, 0.4 * duration_s, period_parts), period_parts),
            load(draw.chance(0.5) ? 0 : rounded(-torque_Nm * draw.between(0, 1, 100), 1e3),
                 ratings));
    }
}

void write_growing_load(ScenarioText &text, Draw &draw, const RatingScales &ratings, double time_s)
{
    constexpr int steps = 20;
    const double torque_Nm = draw.either_sign(draw.between(0.5, 1.5, 100));
    const double ramp_s = draw.between(0.01, 0.2, 1e3);
    for (int i = 1; i <= steps; ++i) {
        text.event(rounded(time_s + ramp_s * i / steps, period_parts),
                   load(rounded(torque_Nm * i / steps, 1e3), ratings));
    }
}

void write_load_pulse(ScenarioText &text, Draw &draw, const RatingScales &ratings, double time_s)
{
    text.event(time_s, load(draw.either_sign(draw.between(0.6, 3, 100)), ratings));
    text.event(rounded(time_s + draw.between(0.003, 0.06, period_parts), period_parts),
               load(0, ratings));
}

void write_jam(ScenarioText &text, Draw &draw, double time_s)
{
    text.event(time_s, "jam = true");
    if (draw.chance(0.5)) {
        text.event(rounded(time_s + draw.between(0.005, 0.05, period_parts), period_parts),
                   "jam = false");
    }
}

/* A motor that is not the one of the file. With four fifths of the inductance and less the hold
   itself oscillates. */
void alter(Scales &scales, Draw &draw)
{
    const double off =
        draw.chance(0.5) ? draw.between(0.7, 0.85, 100) : draw.between(1.15, 1.4, 100);
    switch (draw.index(4)) {
    case 0:
        scales.resistance = draw.between(0.5, 1.5, 100);
        break;
    case 1:
        scales.inductance = draw.between(0.85, 1.4, 100);
        break;
    case 2:
        scales.km = off;
        break;
    default:
        scales.inertia = draw.mostly_low(0.3, 3, 100);
        break;
    }
}

/* One that becomes another within a tenth of a second. */
void write_change(ScenarioText &text, Draw &draw, const Scales &scales, const RatingScales &ratings,
                  double time_s)
{
    Scales changed = scales;
    switch (draw.index(4)) {
    case 0:
        changed.resistance *= draw.between(0.75, 1.4, 100);
        break;
    case 1:
        changed.inductance *= draw.between(0.85, 1.4, 100);
        break;
    case 2:
        changed.km *= draw.between(0.7, 1.3, 100);
        break;
    default:
        changed.inertia *= draw.mostly_low(0.3, 3, 100);
        break;
    }
    text.event(time_s,
               "plant.resistance_scale = " + shortest(rounded(changed.resistance, 1e4)) +
                   ", plant.inductance_scale = " + shortest(rounded(changed.inductance, 1e4)) +
                   ", plant.km_scale = " + shortest(rounded(changed.km, 1e4)) +
                   ", plant.inertia_scale = " + shortest(rounded(changed.inertia, 1e4)) +
                   ", ramp_s = 0.1");
    text.event(rounded(time_s + draw.between(0, 0.1, period_parts), period_parts),
               load(draw.between(-0.4, 0.4, 1e3), ratings));
}

enum class Provocation { overload, growing_load, load_pulse, inertia, jam, motor, change, angle };
constexpr std::size_t provocations = 8;

/* What is wrong from the start. */
void write_drive(ScenarioText &text, Draw &draw, Scales &scales, const RatingScales &ratings,
                 Provocation provocation)
{
    if (provocation == Provocation::motor) {
        alter(scales, draw);
    } else if (provocation == Provocation::angle) {
        text.number(
            "initial_angle_error_rad",
            times(draw.either_sign(rounded(draw.between(0.1, 0.25, 100) * full_turn_rad, 1e4)),
                  ratings.angle));
    }
}

void write_provocation(ScenarioText &text, Draw &draw, const Scales &scales,
                       const RatingScales &ratings, Provocation provocation, double duration_s)
{
    const double time_s = draw.between(0.1, duration_s - 0.3, period_parts);
    switch (provocation) {
    case Provocation::overload:
        text.event(time_s, load(draw.either_sign(draw.between(0.3, 1.5, 100)), ratings));
        break;
    case Provocation::growing_load:
        write_growing_load(text, draw, ratings, time_s);
        break;
    case Provocation::load_pulse:
        write_load_pulse(text, draw, ratings, time_s);
        break;
    case Provocation::inertia:
        text.event(time_s, "plant.inertia_scale = " + shortest(draw.mostly_low(5, 1000, 1)));
        break;
    case Provocation::jam:
        write_jam(text, draw, time_s);
        break;
    case Provocation::motor:
        text.event(time_s, load(draw.between(-0.4, 0.4, 1e3), ratings));
        break;
    case Provocation::change:
        write_change(text, draw, scales, ratings, time_s);
        break;
    case Provocation::angle:
        break;
    }
}

} // namespace

bool slip_is_provoked(std::uint64_t seed)
{
    return seed % 2 == 0;
}

Drawn draw_slip(std::uint64_t seed, double duration_s, const CampaignMotor &motor)
{
    const RatingScales &ratings = motor.scales;
    Draw plant(seed, of_plant), motion(seed, of_motion), loads(seed, of_load);
    Draw provocation(seed, of_provocation);
    const auto kind = static_cast<Provocation>(provocation.index(provocations));
    const auto how = static_cast<Motion>(motion.index(motions));
    const bool exact_enough = motion.chance(0.6);
    Scales scales = draw_scales(plant);
    ScenarioText text;
    text.text("description", slip_is_provoked(seed) ? "the rotor is forced out of step, or nearly"
                                                    : "what a drive has to live with");
    text.text("motor", motor.name);
    text.number("duration_s", duration_s);
    text.integer("seed", seed);
    text.table("drive");
    text.text("synchronism_policy", "fault");
    if (slip_is_provoked(seed)) {
        write_drive(text, provocation, scales, ratings, kind);
    }
    write_plant(text, plant, scales, ratings, exact_enough);
    write_motion(text, motion, how, ratings, exact_enough, duration_s);
    write_legal_load(text, loads, how, ratings, duration_s);
    if (slip_is_provoked(seed)) {
        write_provocation(text, provocation, scales, ratings, kind, duration_s);
    }
    return {text.finish(), "", ""};
}

} // namespace scenario
