/*
 * Campaign "long-run": a minute of random moves, rests and loads on the plant `real`, every
 * parameter of motor, bridge, supply and sensing drawn anew, while the drive believes the motor
 * file. Ranges: what the drive has to live with, from a motor's tolerances and warming. Speeds,
 * loads, currents and bus are those of the reference motor.
 */
#include "sil/scenario/campaign.h"

#include <algorithm>
#include <cmath>

#include "sil/scenario/random_scenario.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double pi = 3.14159265358979323846;
constexpr double period_parts = 1e4;     /* times in whole control periods */
constexpr double largest_load_Nm = 0.15; /* 32 % of the rated torque */
constexpr double warming = 1.4;          /* copper, 100 K */

enum Stream : std::uint64_t { of_plant, of_moves, of_loads };

/* What the timeline begins with. */
struct Start {
    double theta_rad, resistance_scale;
};

Start draw_plant(ScenarioText &text, Draw draw, const RatingScales &scales)
{
    Start start{};
    start.theta_rad = draw.between(-3, 3, 1e3);
    start.resistance_scale = draw.between(0.7, 1.3, 1e3);
    text.table("plant");
    text.text("model", "real");
    text.number("resistance_scale", start.resistance_scale);
    text.number("inductance_scale", draw.between(0.9, 1.1, 1e3));
    text.number("km_scale", draw.between(0.9, 1.1, 1e3));
    text.number("inertia_scale", draw.between(0.7, 1.3, 1e3));
    text.number("viscous_friction_scale", draw.between(0.5, 2, 1e3));
    text.number("saturation_depth", draw.between(0.05, 0.15, 1e3));
    text.number("flux_harmonic_3", draw.between(-0.03, 0.03, 1e3));
    text.number("detent_4", draw.between(0.02, 0.06, 1e4));
    text.number("detent_2", draw.between(0, 0.02, 1e4));
    text.number("detent_1", draw.between(0, 0.01, 1e4));
    text.number("coulomb_friction", draw.between(0, 0.02, 1e4));
    text.number("bridge_resistance_ohm", draw.between(0.1, 0.3, 1e3));
    text.number("bus_V", times(draw.between(22, 26, 10), scales.supply));
    text.number("bus_source_ohm", draw.between(0.05, 0.2, 1e3));
    text.number("brake_V", times(29, scales.supply));
    text.number("dead_time_s", draw.between(0.7e-6, 1.3e-6, 1e9));
    text.number("current_range_A", times(plant::SensorConfig().current_range_A, scales.current));
    text.number("current_offset_a_A", times(draw.between(-0.05, 0.05, 1e4), scales.current));
    text.number("current_offset_b_A", times(draw.between(-0.05, 0.05, 1e4), scales.current));
    text.number("current_offset_on_a_A", times(draw.between(-0.01, 0.01, 1e5), scales.current));
    text.number("current_offset_on_b_A", times(draw.between(-0.01, 0.01, 1e5), scales.current));
    text.number("current_gain_a", draw.between(0.99, 1.01, 1e4));
    text.number("current_gain_b", draw.between(0.99, 1.01, 1e4));
    text.number("phase_voltage_offset_on_a_V", draw.between(-0.005, 0.005, 1e5));
    text.number("phase_voltage_offset_on_b_V", draw.between(-0.005, 0.005, 1e5));
    text.number("initial_theta_rad", start.theta_rad);
    return start;
}

/* What a move is made of; speeds and accelerations are reached where the distance lets them. */
struct Move {
    double speed_rad_s, acceleration_rad_s2, ramp_s, cruise_s, distance_rad;
};

Move draw_move(Draw &draw, const RatingScales &scales)
{
    Move move{};
    move.speed_rad_s = times(draw.mostly_low(2, 60, 100), scales.speed);
    move.acceleration_rad_s2 = times(draw.between(100, 700, 1), scales.acceleration);
    move.ramp_s =
        rounded(std::max(0.005, move.speed_rad_s / move.acceleration_rad_s2), period_parts);
    move.cruise_s = draw.between(0.01, 0.35, period_parts);
    move.distance_rad =
        draw.either_sign(rounded(move.speed_rad_s * (move.ramp_s + move.cruise_s), 1e4));
    return move;
}

/* Writes the move to `target_rad`; returns when it is over. */
double write_profile(ScenarioText &text, Draw &draw, const Move &move, double time_s,
                     double target_rad)
{
    const double duration_s = rounded(2 * move.ramp_s + move.cruise_s, period_parts);
    const std::string common = "position_rad = " + shortest(target_rad) +
                               ", duration_s = " + shortest(duration_s) +
                               ", ramp_s = " + shortest(move.ramp_s);
    if (draw.chance(0.5)) {
        text.event(time_s, "command = \"move-trapezoid\", " + common);
    } else {
        const double share = draw.between(0.1, 0.5, 100); /* of the ramp */
        const double jerk_s = std::floor(move.ramp_s * share * period_parts) / period_parts;
        text.event(time_s,
                   "command = \"move-smooth\", " + common + ", jerk_s = " + shortest(jerk_s));
    }
    return time_s + duration_s;
}

/* The same with a new target in mid-move, as often as not behind the rotor. `target_rad` becomes
   the new one. */
double write_retarget(ScenarioText &text, Draw &draw, const Move &move, double time_s,
                      double &target_rad)
{
    constexpr double lead_s = 2e-3; /* planning, and a period or two */
    const double ramp_jerk_s = draw.between(0.005, 0.02, 1e3);
    const double jerk_rad_s3 = rounded(move.acceleration_rad_s2 / ramp_jerk_s, 1);
    const auto write = [&](double at_s) {
        text.event(at_s, "command = \"retarget\", position_rad = " + shortest(target_rad) +
                             ", speed_rad_s = " + shortest(move.speed_rad_s) +
                             ", acceleration_rad_s2 = " + shortest(move.acceleration_rad_s2) +
                             ", jerk_rad_s3 = " + shortest(jerk_rad_s3));
    };
    write(time_s);
    const double middle_s =
        rounded(time_s + lead_s + (move.ramp_s + move.cruise_s) * draw.between(0.1, 0.9, 100),
                period_parts);
    const double change_rad = rounded(std::fabs(move.distance_rad) * draw.between(-1, 1, 100), 1e4);
    target_rad = rounded(target_rad + change_rad, 1e4);
    write(middle_s);
    /* At most: to rest, then from the farther end of the first move and what it went beyond. */
    const double ramp_s = move.speed_rad_s / move.acceleration_rad_s2 + ramp_jerk_s;
    const double way_rad =
        std::max(std::fabs(change_rad), std::fabs(move.distance_rad + change_rad));
    return middle_s + lead_s + 2 * ramp_s + way_rad / move.speed_rad_s + ramp_s;
}

void draw_moves(ScenarioText &text, Draw moves, Draw loads, const RatingScales &scales,
                double position_rad, double duration_s)
{
    double time_s = 0;
    for (;;) {
        const Move move = draw_move(moves, scales);
        const double begin_s = time_s;
        ScenarioText written = text;
        double target_rad = rounded(position_rad + move.distance_rad, 1e4);
        const double end_s = moves.chance(0.2)
                                 ? write_retarget(written, moves, move, begin_s, target_rad)
                                 : write_profile(written, moves, move, begin_s, target_rad);
        time_s = rounded(end_s + moves.between(0.05, 0.3, period_parts), period_parts);
        if (time_s > duration_s) {
            return;
        }
        const double load_Nm =
            loads.chance(0.2) ? 0 : loads.between(-largest_load_Nm, largest_load_Nm, 1e4);
        written.event(rounded(loads.between(begin_s, end_s, period_parts), period_parts),
                      "load_torque_Nm = " + shortest(times(load_Nm, scales.torque)));
        text = written;
        position_rad = target_rad;
    }
}

Drawn draw_long_run(std::uint64_t seed, double duration_s, const CampaignMotor &motor)
{
    ScenarioText text;
    text.text("description", "random moves, rests and loads on a motor off its file in everything");
    text.text("motor", motor.name);
    text.number("duration_s", duration_s);
    text.integer("seed", seed);
    const Start start = draw_plant(text, Draw(seed, of_plant), motor.scales);
    Draw loads(seed, of_loads);
    if (loads.chance(0.5)) {
        const double scale = start.resistance_scale * loads.between(1, warming, 100);
        text.event(0, "plant.resistance_scale = " + shortest(rounded(scale, 1e3)) +
                          ", ramp_s = " + shortest(duration_s));
    }
    draw_moves(text, Draw(seed, of_moves), loads, motor.scales, start.theta_rad, duration_s);
    text.expect("metric = \"fault\", equals = \"none\"");
    text.expect("metric = \"slip_full_steps\", max = 0");
    return {text.finish(), "", ""};
}

/* Goes by the metrics alone. */
class LongRun : public CampaignWatch
{
  public:
    CampaignOutcome judge(const Result &result) const override
    {
        const Metrics &all = result.all.metrics;
        const double teeth = result.scenario->motor.params.rotor_teeth;
        const double degrees = teeth * 180 / pi; /* electrical, per rad */
        CampaignOutcome outcome;
        /* What a drive in fault refuses is a failure, too: the fault is the reason. */
        outcome.verdict = all.fault != "none"                  ? "fault " + all.fault
                          : all.slip_full_steps > 0            ? "slipped"
                          : !result.not_as_described().empty() ? "failed"
                                                               : "held";
        outcome.figures = {std::floor(all.estimate_error_final_rad * degrees / 90 + 0.5),
                           all.estimate_error_max_rad, all.estimate_error_max_rad * degrees,
                           all.estimate_error_rms_rad * degrees, all.position_error_max_rad};
        return outcome;
    }
};

std::unique_ptr<CampaignWatch> watch_long_run(const Scenario &)
{
    return std::make_unique<LongRun>();
}

} // namespace

const CampaignKind long_run_campaign = {
    "long-run",
    "random moves of 2...60 rad/s, loads of up to 0.15 Nm, rests of 50...300 ms, motor unknown; "
    "another motor than the reference: in proportion to its ratings",
    60,
    {{"lost_full_steps", true},
     {"estimate_error_max_rad", false},
     {"estimate_error_max_deg_electrical", false},
     {"estimate_error_rms_deg_electrical", false},
     {"position_error_max_rad", false}},
    draw_long_run,
    watch_long_run,
};

} // namespace scenario
