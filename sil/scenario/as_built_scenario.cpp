#include "sil/scenario/as_built_scenario.h"

#include "sil/scenario/displaced_rotor.h"
#include "sil/scenario/random_scenario.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double period_parts = 1e4; /* times in whole control periods */

/* Shares of their bounds, -1...1 or, where only one sign is to be expected, 0...1. */
struct Tolerances {
    double hysteresis, eddy;
    double divider_a, divider_b, gain_a, gain_b, resistance_a, resistance_b;
    double inductance_a, inductance_b;
    double current_a, current_b, voltage_a, voltage_b; /* residuals */
    double resistance, inductance, warmth, inertia;
};

/* What 1 stands for; where from: sil/plant/README.md. */
constexpr double most_hysteresis = 0.02, most_eddy_s = 6e-6;
constexpr double most_divider = 2.5e-3, most_gain = 0.015, most_phase_resistance = 0.015;
constexpr double most_phase_inductance = 0.01;
constexpr double most_current_A = 0.01, most_voltage_V = 5e-3;
constexpr double most_resistance = 0.1, most_inductance = 0.15, most_inertia = 0.3;
constexpr double most_rise_K = 73; /* 8 % of the flux */

Tolerances drawn_tolerances(Draw draw)
{
    const auto either = [&draw] { return draw.between(-1, 1, 1e3); };
    const auto one_sided = [&draw] { return draw.between(0, 1, 1e3); };
    Tolerances of{};
    of.hysteresis = one_sided();
    of.eddy = one_sided();
    for (double Tolerances::*member :
         {&Tolerances::divider_a, &Tolerances::divider_b, &Tolerances::gain_a, &Tolerances::gain_b,
          &Tolerances::resistance_a, &Tolerances::resistance_b, &Tolerances::inductance_a,
          &Tolerances::inductance_b, &Tolerances::current_a, &Tolerances::current_b,
          &Tolerances::voltage_a, &Tolerances::voltage_b, &Tolerances::resistance,
          &Tolerances::inertia}) {
        of.*member = either();
    }
    of.inductance = -one_sided();
    of.warmth = one_sided();
    return of;
}

/* Of the first phase's gain and of the second's, of its resistance and of the second's, so that the
   phases differ by all of both; the rest of the signs in as many ways as there are mixes. */
constexpr Tolerances corners[] = {
    {1, 1, 1, -1, 1, -1, -1, 1, 1, -1, 1, -1, 1, -1, 1, -1, 1, 1},
    {1, 1, 1, 1, -1, 1, 1, -1, -1, 1, 1, 1, -1, 1, -1, -1, 1, -1},
    {1, 1, -1, 1, 1, -1, -1, 1, -1, 1, -1, 1, 1, 1, 1, -1, 1, -1},
    {1, 1, -1, -1, -1, 1, 1, -1, 1, -1, -1, -1, -1, -1, -1, -1, 1, 1},
};

double scale_of(double share, double most)
{
    return rounded(1 + share * most, 1e6);
}

void write_tolerances(ScenarioText &text, const Tolerances &of, const CampaignMotor &motor)
{
    const RatingScales &scales = motor.scales;
    const double by = motor.spread;
    const auto residual = [by](double share, double most, double scale) {
        return times(rounded(share * by * most, 1e7), scale);
    };
    text.table("plant");
    text.text("model", "as-built");
    text.number("current_range_A", times(plant::SensorConfig().current_range_A, scales.current));
    text.number("hysteresis", rounded(of.hysteresis * by * most_hysteresis, 1e6));
    text.number("eddy_time_s", rounded(of.eddy * by * most_eddy_s, 1e10));
    text.number("divider_mismatch_a", rounded(of.divider_a * by * most_divider, 1e7));
    text.number("divider_mismatch_b", rounded(of.divider_b * by * most_divider, 1e7));
    text.number("current_gain_a", scale_of(of.gain_a * by, most_gain));
    text.number("current_gain_b", scale_of(of.gain_b * by, most_gain));
    text.number("resistance_a_scale", scale_of(of.resistance_a * by, most_phase_resistance));
    text.number("resistance_b_scale", scale_of(of.resistance_b * by, most_phase_resistance));
    text.number("inductance_a_scale", scale_of(of.inductance_a * by, most_phase_inductance));
    text.number("inductance_b_scale", scale_of(of.inductance_b * by, most_phase_inductance));
    text.number("current_residual_a_A", residual(of.current_a, most_current_A, scales.current));
    text.number("current_residual_b_A", residual(of.current_b, most_current_A, scales.current));
    text.number("phase_voltage_residual_a_V",
                residual(of.voltage_a, most_voltage_V, scales.supply));
    text.number("phase_voltage_residual_b_V",
                residual(of.voltage_b, most_voltage_V, scales.supply));
    text.number("resistance_scale", scale_of(of.resistance * by, most_resistance));
    text.number("inductance_scale", scale_of(of.inductance * by, most_inductance));
    text.number("inertia_scale", scale_of(of.inertia * by, most_inertia));
    text.number("magnet_rise_K", rounded(of.warmth * by * most_rise_K, 10));
}

/* Writes a course of the reference motor as one of another: all its times are longer by as much as
   its speeds grow more slowly. */
class Course
{
  public:
    Course(ScenarioText &text, const RatingScales &scales)
        : text_(text), scales_(scales), slower_(scales.speed / scales.acceleration)
    {
    }

    void last(double duration_s)
    {
        text_.number("duration_s", time(duration_s));
    }
    void load(double time_s, double torque_Nm)
    {
        text_.event(time(time_s), "load_torque_Nm = " + shortest(times(torque_Nm, scales_.torque)));
    }
    void trapezoid(double time_s, double position_rad, double duration_s, double ramp_s)
    {
        text_.event(time(time_s),
                    "command = \"move-trapezoid\", " + profile(position_rad, duration_s, ramp_s));
    }
    void smooth(double time_s, double position_rad, double duration_s, double ramp_s, double jerk_s)
    {
        text_.event(time(time_s), "command = \"move-smooth\", " +
                                      profile(position_rad, duration_s, ramp_s) +
                                      ", jerk_s = " + shortest(time(jerk_s)));
    }
    void velocity(double time_s, double speed_rad_s, double acceleration_rad_s2, double jerk_rad_s3)
    {
        const double a = scales_.acceleration;
        text_.event(
            time(time_s),
            "command = \"velocity\", speed_rad_s = " + shortest(times(speed_rad_s, scales_.speed)) +
                ", acceleration_rad_s2 = " + shortest(times(acceleration_rad_s2, a)) +
                ", jerk_rad_s3 = " + shortest(times(jerk_rad_s3, a / slower_)));
    }
    void sine(double time_s, double amplitude_rad, double frequency_Hz, double ramp_s)
    {
        text_.event(time(time_s),
                    "command = \"sine\", amplitude_rad = " +
                        shortest(times(amplitude_rad, scales_.speed * slower_)) +
                        ", frequency_Hz = " + shortest(times(frequency_Hz, 1 / slower_)) +
                        ", cycles = 0, ramp_s = " + shortest(time(ramp_s)));
    }
    void warm(double time_s, double resistance_scale, double ramp_s)
    {
        text_.event(time(time_s), "plant.resistance_scale = " + shortest(resistance_scale) +
                                      ", ramp_s = " + shortest(time(ramp_s)));
    }

  private:
    double time(double reference_s) const
    {
        return rounded(reference_s * slower_, period_parts);
    }
    std::string profile(double position_rad, double duration_s, double ramp_s) const
    {
        return "position_rad = " + shortest(times(position_rad, scales_.speed * slower_)) +
               ", duration_s = " + shortest(time(duration_s)) +
               ", ramp_s = " + shortest(time(ramp_s));
    }

    ScenarioText &text_;
    const RatingScales &scales_;
    double slower_;
};

void write_hold_transition(Course &course)
{
    course.last(3.6);
    course.smooth(0.1, 3, 0.3, 0.1, 0.03);
    course.smooth(3.2, 0, 0.3, 0.1, 0.03);
}

void write_load_steps(Course &course)
{
    constexpr double speeds_rad_s[] = {5, 20, 45, 100}, every_s = 0.45;
    course.last(1.85);
    for (int n = 0; n < 4; n++) {
        course.velocity(n * every_s, speeds_rad_s[n], 400, 20000);
        course.load(n * every_s + 0.25, 0.3);
        course.load(n * every_s + 0.35, 0);
    }
}

void write_reversal(Course &course)
{
    course.last(1.2);
    course.load(0, 0.05);
    course.trapezoid(0, 8, 0.25, 0.1);
    course.trapezoid(0.2501, -8, 0.4, 0.1);
    course.trapezoid(0.6502, 0, 0.25, 0.1);
}

/* `resistance_scale`: of the plant as it starts. */
void write_course(Course &course, std::size_t number, double resistance_scale)
{
    switch (number) {
    case 0: /* bendjedia-fig12 */
        course.last(0.7);
        course.load(0, 0.1);
        course.trapezoid(0, 10, 0.4, 0.1);
        course.load(0.5, 0);
        break;
    case 1:
        write_hold_transition(course);
        break;
    case 2: /* loaded, and the winding warms */
        write_hold_transition(course);
        course.load(0, 0.2);
        course.warm(0.6, rounded(1.4 * resistance_scale, 1e6), 2.4);
        break;
    case 3: /* standstill-load */
        course.last(1.2);
        course.load(0.1, 0.1);
        course.load(0.6, 0);
        break;
    case 4: /* low-speed */
        course.last(2);
        course.load(0, 0.1);
        course.velocity(0, 0.3, 100, 10000);
        break;
    case 5: /* slow-crossing */
        course.last(4.2);
        course.load(0, 0.05);
        course.sine(0, 1, 0.25, 0.2);
        break;
    case 6:
        write_load_steps(course);
        break;
    case 7:
        write_reversal(course);
        break;
    default: /* start-under-load, with the aligning hold */
        course.last(0.5);
        course.load(0, 0.3);
        course.trapezoid(0, 5, 0.3, 0.1);
        break;
    }
}

Drawn written(std::uint64_t seed, const Tolerances &tolerances, const CampaignMotor &motor)
{
    const std::size_t number = as_built_course(seed);
    ScenarioText text;
    text.text("description",
              std::string(as_built_course_names[number]) + " on a motor and a board as built");
    text.text("motor", motor.name);
    text.integer("seed", seed);
    Course course(text, motor.scales);
    write_course(course, number, scale_of(tolerances.resistance * motor.spread, most_resistance));
    write_tolerances(text, tolerances, motor);
    if (number + 1 == as_built_courses) {
        constexpr double wrong_rad = 0.015708; /* 45 degrees electrical */
        text.table("drive");
        text.number("initial_angle_error_rad", times(wrong_rad, motor.scales.angle));
    }
    text.expect("metric = \"fault\", equals = \"none\"");
    text.expect("metric = \"estimate_error_max_rad\", max = " +
                shortest(times(0.015708, motor.scales.angle)));
    return {text.finish(), "", ""};
}

const double flux_per_K = plant::ImperfectionConfig().magnet_flux_per_K;
constexpr double borne = 0.9; /* of the plant's Km x the rated current */
constexpr double settled_s = 0.2, stays_s = 0.3;
constexpr double slowest_Nm_s = 0.05, fastest_Nm_s = 5;

} // namespace

const char *const as_built_course_names[as_built_courses] = {
    "bendjedia-fig12", "hold-transition", "hold-transition-loaded",
    "standstill-load", "low-speed",       "slow-crossing",
    "load-step",       "reversal",        "start-under-load"};

std::size_t as_built_course(std::uint64_t seed)
{
    return static_cast<std::size_t>((seed + as_built_courses - 1) % as_built_courses);
}

Drawn draw_as_built(std::uint64_t seed, double, const CampaignMotor &motor)
{
    return written(seed, drawn_tolerances(Draw(seed, 0)), motor);
}

Drawn draw_as_built_corner(std::uint64_t seed, double, const CampaignMotor &motor)
{
    const std::uint64_t cell = (seed + as_built_cells - 1) % as_built_cells;
    return written(seed, corners[cell / as_built_courses], motor);
}

bool as_built_load_is_borne(std::uint64_t seed)
{
    return seed % 2 == 0;
}

Drawn draw_as_built_load(std::uint64_t seed, double, const CampaignMotor &motor)
{
    Draw loads(seed, 1);
    const Tolerances tolerances = drawn_tolerances(Draw(seed, 0));
    const double rise_K = rounded(tolerances.warmth * motor.spread * most_rise_K, 10);
    const double share = as_built_load_is_borne(seed) ? borne : loads.between(1.05, 2, 100);
    const double torque_Nm =
        rounded(loads.either_sign(share) * (1 + flux_per_K * rise_K) * reference_torque_Nm, 1e5);
    const double rate_Nm_s = loads.over_octaves(slowest_Nm_s, fastest_Nm_s);
    const double ramp_s =
        rounded((torque_Nm < 0 ? -torque_Nm : torque_Nm) / rate_Nm_s, period_parts);
    ScenarioText text;
    text.text("description", "a load that grows, at rest, on a motor and a board as built");
    text.text("motor", motor.name);
    text.integer("seed", seed);
    text.number("duration_s", rounded(settled_s + ramp_s + stays_s, period_parts));
    text.event(settled_s, "load_torque_Nm = " + shortest(times(torque_Nm, motor.scales.torque)) +
                              ", ramp_s = " + shortest(ramp_s));
    write_tolerances(text, tolerances, motor);
    if (as_built_load_is_borne(seed)) {
        text.expect("metric = \"fault\", equals = \"none\"");
    }
    return {text.finish(), "", ""};
}

} // namespace scenario
