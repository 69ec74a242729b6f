/*
 * Campaign "load": what a drive bears that nobody commands. A load that grows in its own time to
 * 80 % of the rated torque and falls again; vibration, at rest and in motion: neither may end in a
 * fault. An overload: the fault must come soon behind the rotor's passing half an electrical turn
 * from where it is to be, and none may call the rotor lost while it is in its place (`stalled` may:
 * the current is at its limit). Torques are of the plant's own torque constant x rated current.
 */
#include "sil/scenario/campaign.h"

#include <algorithm>
#include <cmath>

#include "sil/scenario/displaced_rotor.h"
#include "sil/scenario/random_scenario.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double period_parts = 1e4;           /* times in whole control periods */
constexpr double borne = 0.8, vibration = 0.1; /* of the rated torque */
/* Of the run: when the load begins, the longest it takes to grow, how long it then stays. */
constexpr double begin = 0.04, longest_ramp = 0.5, stay = 0.1;
constexpr double shortest_ramp_s = 0.01;
constexpr double latest_s = 0.04; /* of a fault, behind half an electrical turn */

enum Stream : std::uint64_t { of_kind, of_plant, of_load };
enum class Kind { growing, overload, vibration_at_rest, vibration_in_motion };
constexpr std::size_t kinds = 4;

Kind kind_of(std::uint64_t seed)
{
    return static_cast<Kind>(Draw(seed, of_kind).index(kinds));
}

/* The plant's torque constant, relative to its file's. */
double write_plant(ScenarioText &text, Draw &draw, const RatingScales &ratings)
{
    text.table("plant");
    text.text("model", draw.chance(0.5) ? "real" : "bench");
    text.number("current_range_A", times(plant::SensorConfig().current_range_A, ratings.current));
    const bool as_its_file = draw.chance(0.5);
    const double resistance = draw.between(0.8, 1.2, 1e3), inertia = draw.between(0.7, 1.3, 1e3);
    const double km = draw.between(0.9, 1.1, 1e3);
    if (as_its_file) {
        return 1;
    }
    text.number("resistance_scale", resistance);
    text.number("inertia_scale", inertia);
    text.number("km_scale", km);
    return km;
}

std::string torque_of(const char *key, double share, double km, const RatingScales &ratings)
{
    return std::string(key) + " = " +
           shortest(times(rounded(share * km * reference_torque_Nm, 1e5), ratings.torque));
}

void write_ramp(ScenarioText &text, double time_s, const std::string &torque, double ramp_s)
{
    text.event(time_s, torque + ", ramp_s = " + shortest(ramp_s));
}

/* When the load begins. */
double begin_s(double duration_s)
{
    return rounded(begin * duration_s, period_parts);
}

double draw_ramp(Draw &draw, double duration_s)
{
    return rounded(draw.over_octaves(shortest_ramp_s, longest_ramp * duration_s), period_parts);
}

void write_growing(ScenarioText &text, Draw &draw, double km, const RatingScales &ratings,
                   double duration_s)
{
    const double ramp_s = draw_ramp(draw, duration_s);
    const double fall_s = rounded(begin_s(duration_s) + ramp_s + stay * duration_s, period_parts);
    const double share = draw.either_sign(borne);
    const double longest_fall_s = (duration_s - fall_s) / 2;
    write_ramp(text, begin_s(duration_s), torque_of("load_torque_Nm", share, km, ratings), ramp_s);
    write_ramp(text, fall_s, "load_torque_Nm = 0",
               rounded(draw.over_octaves(shortest_ramp_s, longest_fall_s), period_parts));
}

void write_overload(ScenarioText &text, Draw &draw, double km, const RatingScales &ratings,
                    double duration_s)
{
    const double share = draw.either_sign(draw.between(1.05, 2, 100));
    write_ramp(text, begin_s(duration_s), torque_of("load_torque_Nm", share, km, ratings),
               draw_ramp(draw, duration_s));
}

void write_vibration(ScenarioText &text, Draw &draw, double km, const RatingScales &ratings,
                     double duration_s)
{
    const double share = draw.between(0.5, 1, 100) * vibration;
    const double frequency_Hz = draw.over_octaves(15, 90);
    text.event(begin_s(duration_s), torque_of("load_vibration_Nm", share, km, ratings) +
                                        ", load_vibration_Hz = " + shortest(frequency_Hz));
}

void write_motion(ScenarioText &text, Draw &draw, const RatingScales &ratings, double duration_s)
{
    const double speed = times(draw.either_sign(draw.mostly_low(1, 50, 10)), ratings.speed);
    const std::string limits =
        ", acceleration_rad_s2 = " + shortest(times(500, ratings.acceleration)) +
        ", jerk_rad_s3 = " + shortest(times(5e4, ratings.acceleration));
    text.event(0, "command = \"velocity\", speed_rad_s = " + shortest(speed) + limits);
    text.event(rounded(duration_s / 2, period_parts),
               "command = \"velocity\", speed_rad_s = " + shortest(-speed) + limits);
}

Drawn draw_load(std::uint64_t seed, double duration_s, const CampaignMotor &motor)
{
    const RatingScales &ratings = motor.scales;
    Draw plant(seed, of_plant), loads(seed, of_load);
    ScenarioText text;
    text.text("description", "a load that grows, overloads or vibrates");
    text.text("motor", motor.name);
    text.number("duration_s", duration_s);
    text.integer("seed", seed);
    const double km = write_plant(text, plant, ratings);
    switch (kind_of(seed)) {
    case Kind::growing:
        write_growing(text, loads, km, ratings, duration_s);
        break;
    case Kind::overload:
        write_overload(text, loads, km, ratings, duration_s);
        break;
    case Kind::vibration_in_motion:
        write_motion(text, loads, ratings, duration_s);
        write_vibration(text, loads, km, ratings, duration_s);
        break;
    case Kind::vibration_at_rest:
        write_vibration(text, loads, km, ratings, duration_s);
        break;
    }
    return {text.finish(), "", ""};
}

class LoadWatch : public CampaignWatch
{
  public:
    explicit LoadWatch(const Scenario &scenario) : rotor_(scenario)
    {
    }

    void read(const Record &record, const Row &row) override
    {
        if (!rotor_.read(record, row)) {
            return;
        }
        const double load_Nm = std::fabs(row[LOAD_TORQUE]);
        falls_ = load_Nm < largest_Nm_;
        largest_Nm_ = std::max(largest_Nm_, load_Nm);
        lost_ = static_cast<drive_synchronism>(row[SYNCHRONISM]) == DRIVE_SYNCHRONISM_LOST;
    }

    CampaignOutcome judge(const Result &result) const override
    {
        const Kind kind = kind_of(result.seed);
        CampaignOutcome outcome;
        outcome.figures.assign(figures + kinds, Metrics::none);
        if (rotor_.shows_nothing(result)) {
            outcome.verdict = "failed";
            return outcome;
        }
        if (kind == Kind::overload) {
            outcome.verdict = rotor_.delay_s() > latest_s          ? "late"
                              : lost_ && rotor_.largest_deg() < 45 ? "false alarm"
                                                                   : "held";
            outcome.figures[0] = rotor_.passed() ? 1 : 0;
            outcome.figures[1] = rotor_.reported_ms();
        } else {
            static const char *const names[kinds] = {"growing load", "", "vibration at rest",
                                                     "vibration in motion"};
            const std::string name =
                kind == Kind::growing && falls_ ? "release" : names[static_cast<std::size_t>(kind)];
            outcome.verdict = rotor_.faulted()  ? name + ": fault"
                              : rotor_.passed() ? name + ": slipped"
                                                : "held";
        }
        outcome.figures[figures + static_cast<std::size_t>(kind)] = rotor_.largest_deg();
        return outcome;
    }

  private:
    static constexpr std::size_t figures = 2; /* before those of each kind */

    DisplacedRotor rotor_;
    double largest_Nm_ = 0;
    bool falls_ = false; /* the load, by the fault */
    bool lost_ = false;  /* the fault says so of the estimate */
};

std::unique_ptr<CampaignWatch> watch_load(const Scenario &scenario)
{
    return std::make_unique<LoadWatch>(scenario);
}

} // namespace

const CampaignKind load_campaign = {
    "load",
    "loads that grow slowly, overload or vibrate: what is borne, and how soon the rest is reported",
    6,
    {{"overloads_beyond_half_a_turn", true},
     {"overload_delay_ms", false},
     {"growing_largest_deg", false},
     {"overload_largest_deg", false},
     {"vibration_at_rest_largest_deg", false},
     {"vibration_in_motion_largest_deg", false}},
    draw_load,
    watch_load,
};

} // namespace scenario
