/*
 * Campaign "motors": does the drive hold a motor that nobody has tried, with its defaults? Each
 * seed draws a motor within what data sheets show ("motors-any": each value by itself), on `bench`
 * or, every fourth, on `real`, and moves, rests and loads from its ratings. Odd seeds are
 * sensorless, even ones have an encoder. The drive knows the motor exactly.
 *
 * Held, or else the first of: refused (by the drive, with its words), wrong ready (an encoder's
 * zero is off by more than 3 degrees electrical and 3/4 of a count), a fault, lost silently (beyond
 * 90 degrees without a fault), commutation (beyond 45 degrees), position (at the end). A position
 * that only a hold's yielding explains is distinguished (hold_yield.h); a zero that the drive does
 * not find, and says so instead of becoming ready, is a refusal.
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
constexpr double sqrt_2 = 1.4142135623730951;
constexpr double period_parts = 1e4; /* times in whole control periods */
constexpr int encoder_counts = 4000;
constexpr double largest_load = 0.25; /* of torque constant x rated current */
constexpr double largest_share = 0.5; /* of the rated speed and acceleration */
constexpr double longest_ramp_s = 0.3;
constexpr double at_rest_s = 0.7; /* behind the last move or load */
constexpr double judged_s = 0.25; /* of position error, at the end */
constexpr double ready_window_s = 1e-3;

enum Stream : std::uint64_t { of_motor, of_plant, of_moves, of_loads };

struct RandomMotor {
    std::string id, text;
    Ratings ratings;
};

/* N L I / Km, the winding's own flux by the magnet's: 0.6...3.1 in 280 data sheets. Far beyond, one
   value does not belong to the others. */
bool goes_together(const motor_params &motor)
{
    const double fluxes =
        motor.rotor_teeth * motor.inductance_H * motor.rated_current_A / motor.torque_constant_Nm_A;
    return fluxes >= 0.4 && fluxes <= 4;
}

/* Ranges: what data sheets of hybrid steppers from NEMA 8 to NEMA 34 show, each by itself. */
motor_params draw_params(Draw &draw)
{
    motor_params of{};
    of.rated_current_A = draw.over_octaves(0.4, 6);
    const double rated_V = draw.over_octaves(2, of.rated_current_A < 0.6 ? 12 : 6);
    of.resistance_ohm = significant(rated_V / of.rated_current_A, 4);
    of.inductance_H = significant(of.resistance_ohm * draw.over_octaves(0.5e-3, 6e-3), 4);
    const double holding_Nm = draw.over_octaves(0.03, 4);
    of.torque_constant_Nm_A = significant(holding_Nm / (sqrt_2 * of.rated_current_A), 6);
    of.inertia_kgm2 = significant(holding_Nm * draw.over_octaves(0.8e-5, 3e-4), 4);
    of.viscous_friction_Nms_rad = significant(draw.between(0, 1, 100) * 1e-4 * holding_Nm / 0.3, 4);
    of.rotor_teeth = draw.chance(0.25) ? 100 : 50;
    of.supply_V = draw.over_octaves(std::max(12.0, significant(4 * rated_V, 3)), 60);
    return of;
}

RandomMotor draw_motor(std::uint64_t seed, bool any)
{
    Draw draw(seed, of_motor);
    motor_params of = draw_params(draw);
    while (!any && !goes_together(of)) {
        of = draw_params(draw);
    }
    const double holding_Nm = sqrt_2 * of.torque_constant_Nm_A * of.rated_current_A;
    const double detent_Nm = significant(draw.between(0.02, 0.08, 1e3) * holding_Nm, 4);

    RandomMotor motor;
    motor.id = "random-" + std::to_string(seed);
    ScenarioText text;
    text.text("id", motor.id);
    text.text("description", "drawn at random by the campaign motors");
    text.text("source", "seed " + std::to_string(seed));
    text.number("resistance_ohm", of.resistance_ohm);
    text.number("inductance_H", of.inductance_H);
    text.number("torque_constant_Nm_A", of.torque_constant_Nm_A);
    text.number("detent_torque_Nm", detent_Nm);
    text.number("viscous_friction_Nms_rad", of.viscous_friction_Nms_rad);
    text.number("inertia_kgm2", of.inertia_kgm2);
    text.number("rated_current_A", of.rated_current_A);
    text.number("supply_V", of.supply_V);
    text.integer("rotor_teeth", static_cast<std::uint64_t>(of.rotor_teeth));
    motor.text = text.finish();
    motor.ratings = ratings_of(of);
    return motor;
}

bool has_encoder(std::uint64_t seed)
{
    return seed % 2 == 0;
}

void write_plant(ScenarioText &text, std::uint64_t seed)
{
    Draw draw(seed, of_plant);
    text.table("plant");
    text.text("model", draw.chance(0.25) ? "real" : "bench");
    text.number("current_range_rated", 2.2);
    if (has_encoder(seed)) {
        text.integer("encoder_counts_per_turn", encoder_counts);
        text.table("drive");
        text.text("feedback", "encoder");
    }
}

struct Move {
    double distance_rad, duration_s, ramp_s;
};

/* A tenth of a full step to two. */
Move draw_small_move(Draw &draw, const Ratings &ratings)
{
    const double tenths = draw.between(1, 20, 1);
    const double distance_rad = tenths / 10 * ratings.full_step_rad;
    const double least_s = draw.between(0.02, 0.06, period_parts);
    const double speed_s = 2 * distance_rad / (largest_share * ratings.speed_rad_s);
    const double acceleration_s =
        2 * std::sqrt(distance_rad / (largest_share * ratings.acceleration_rad_s2));
    const double ramp_s =
        std::ceil(std::max({least_s, speed_s, acceleration_s}) / 2 * period_parts) / period_parts;
    return {draw.either_sign(distance_rad), 2 * ramp_s, ramp_s};
}

/* Up to half the rated speed and acceleration, more often slowly. */
Move draw_move(Draw &draw, const Ratings &ratings)
{
    if (draw.chance(0.25)) {
        return draw_small_move(draw, ratings);
    }
    const double share = draw.mostly_low(0.02, largest_share, 1e3);
    const double acceleration =
        draw.between(0.05, largest_share, 100) * ratings.acceleration_rad_s2;
    const double speed = std::min(share * ratings.speed_rad_s, acceleration * longest_ramp_s);
    const double ramp_s =
        std::ceil(std::max(0.02, speed / acceleration) * period_parts) / period_parts;
    const double cruise_s = draw.between(0.01, 0.3, period_parts);
    return {draw.either_sign(speed * (ramp_s + cruise_s)),
            rounded(2 * ramp_s + cruise_s, period_parts), ramp_s};
}

/* Moves with rests between them, and a load that changes in each; the last part is left alone. */
void write_course(ScenarioText &text, std::uint64_t seed, const Ratings &ratings, double duration_s)
{
    Draw moves(seed, of_moves), loads(seed, of_loads);
    double position_rad = 0;
    double time_s = moves.between(0.05, 0.5, period_parts);
    for (;;) {
        const Move move = draw_move(moves, ratings);
        const double rest_s = moves.between(0.02, 0.4, period_parts);
        if (time_s + move.duration_s + rest_s > duration_s - at_rest_s) {
            return;
        }
        position_rad = rounded(position_rad + move.distance_rad, 1e6);
        text.event(time_s,
                   "command = \"move-trapezoid\", position_rad = " + shortest(position_rad) +
                       ", duration_s = " + shortest(move.duration_s) +
                       ", ramp_s = " + shortest(move.ramp_s));
        const double next_s = rounded(time_s + move.duration_s + rest_s, period_parts);
        if (loads.chance(0.6)) {
            const double torque_Nm =
                loads.between(-largest_load, largest_load, 1e3) * ratings.torque_Nm;
            text.event(loads.between(time_s, next_s, period_parts),
                       "load_torque_Nm = " + shortest(significant(torque_Nm, 4)));
        }
        time_s = next_s;
    }
}

Drawn draw_run(std::uint64_t seed, double duration_s, bool any)
{
    const RandomMotor motor = draw_motor(seed, any);
    ScenarioText text;
    text.text("description", "random moves, rests and loads of a random motor");
    text.text("motor", "./" + motor.id + ".toml");
    text.number("duration_s", duration_s);
    text.integer("seed", seed);
    write_plant(text, seed);
    write_course(text, seed, motor.ratings, duration_s);
    return {text.finish(), motor.id, motor.text};
}

Drawn draw_motors(std::uint64_t seed, double duration_s, const CampaignMotor &)
{
    return draw_run(seed, duration_s, false);
}

Drawn draw_any_motors(std::uint64_t seed, double duration_s, const CampaignMotor &)
{
    return draw_run(seed, duration_s, true);
}

/* Instead of becoming ready the drive says that it does not know where the rotor is. */
bool not_found(const std::string &failure)
{
    return failure.find(std::string("fault ") + drive_fault_name(DRIVE_FAULT_POSITION_NOT_FOUND)) !=
           std::string::npos;
}

/* What a run shows until the drive is in fault: what it estimates then says nothing. */
class MotorsWatch : public CampaignWatch
{
  public:
    explicit MotorsWatch(const Scenario &scenario)
        : ready_rows_(1 + rows(ready_window_s, scenario)),
          position_rad_(std::max<std::size_t>(1, rows(judged_s, scenario)))
    {
    }

    void read(const Record &record, const Row &row) override
    {
        if (record.rows() < record.time_zero_row()) {
            return;
        }
        ended_ = ended_ || row[DRIVE_STATE] == double(DRIVE_FAULT);
        if (ended_) {
            return;
        }
        const double commutation_rad = std::fabs(row[THETA] - row[THETA_EST]);
        widen(commutation_rad_, commutation_rad);
        if (rows_ < ready_rows_) {
            widen(ready_rad_, commutation_rad);
        }
        position_rad_[rows_ % position_rad_.size()] = std::fabs(row[THETA_REF] - row[THETA]);
        ++rows_;
    }

    CampaignOutcome judge(const Result &result) const override;

  private:
    static std::size_t rows(double time_s, const Scenario &scenario)
    {
        return static_cast<std::size_t>(std::floor(time_s / row_period_s(scenario) + 0.5));
    }
    static void widen(double &most, double error)
    {
        most = error <= most ? most : error; /* what is not finite counts */
    }

    std::size_t ready_rows_, rows_ = 0;
    bool ended_ = false;
    double ready_rad_ = 0, commutation_rad_ = 0; /* largest errors */
    std::vector<double> position_rad_;           /* of the latest rows */
};

CampaignOutcome MotorsWatch::judge(const Result &result) const
{
    const Scenario &scenario = *result.scenario;
    const double teeth = scenario.motor.params.rotor_teeth, degrees = teeth * 180 / pi;
    const double full_step_rad = pi / 2 / teeth;
    const int counts = scenario.plant.sensors.encoder_counts_per_turn;
    const double count_rad = counts > 0 ? 2 * pi / counts : 0;
    const bool detent = scenario.plant.imperfections.detent_4 != 0;
    double position_rad = 0; /* at the end */
    for (const double error_rad : position_rad_) {
        widen(position_rad, error_rad);
    }
    const double commutation_deg = commutation_rad_ * degrees;
    const double allowed_rad = (detent ? 1.0 / 5 : 1.0 / 16) * full_step_rad + count_rad;
    const double zero_rad = std::max(3 / degrees, 0.75 * count_rad);
    const std::string &fault = result.all.metrics.fault;
    CampaignOutcome outcome;
    outcome.verdict = counts > 0 && !(ready_rad_ <= zero_rad) ? "wrong ready"
                      : fault != "none"                       ? "fault " + fault
                      : not_found(result.failure)             ? "refused: position-not-found"
                      : !result.failure.empty()               ? "failed"
                      : !(commutation_deg <= 90)              ? "lost silently"
                      : !(commutation_deg <= 45)              ? "commutation beyond 45 degrees"
                      : position_rad <= allowed_rad           ? "held"
                      : position_rad <= result.hold_yield_rad.value_or(0)
                          ? "within its computed limit"
                          : "position at the end";
    outcome.figures = {commutation_deg, counts > 0 ? ready_rad_ * degrees : Metrics::none,
                       fault == "none" ? position_rad / full_step_rad : Metrics::none};
    return outcome;
}

std::unique_ptr<CampaignWatch> watch_motors(const Scenario &scenario)
{
    return std::make_unique<MotorsWatch>(scenario);
}

CampaignKind kind_of(const char *name, const char *description,
                     Drawn (*draw)(std::uint64_t, double, const CampaignMotor &))
{
    return {name,
            description,
            2.5,
            {{"commutation_max_deg_electrical", false},
             {"ready_error_deg_electrical", false},
             {"position_error_end_full_steps", false}},
            draw,
            watch_motors,
            true};
}

} // namespace

const CampaignKind motors_campaign =
    kind_of("motors",
            "random motors of 0.03...4 Nm and 0.4...6 A, sensorless and with an encoder, moves and "
            "loads from their ratings",
            draw_motors);

const CampaignKind any_motors_campaign =
    kind_of("motors-any", "the same, but a motor's values need not go together", draw_any_motors);

} // namespace scenario
