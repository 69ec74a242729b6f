#include "sil/scenario/motor_plausibility.h"

#include <limits>

#include "sil/scenario/table_reader.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double any = std::numeric_limits<double>::infinity();

struct Range {
    double least, most;

    bool has(double value) const
    {
        return value >= least && value <= most;
    }
};

struct Check {
    const char *key; /* where to look first */
    const char *quantity, *unit;
    double value;
    Range possible, usual;
};

/*
 * What 280 motors from data sheets show, NEMA 8 to 34: L/R 0.34...8.5 ms, R I 0.8...12 V, rotor J/T
 * 5e-6...5e-5 s^2, L I / Km 12...62 ms, detent 2...16 % of T, 50
 * or 100 teeth. Usual: up to twice as wide. Possible:
 * several times wider, and room for a rotor with J/T of 3e-4 s^2; a load that is given together
 * with the rotor makes J/T some 100 times larger.
 */
std::vector<Check> checks_of(const Motor &motor)
{
    const motor_params &of = motor.params;
    const double holding_Nm = motor.holding_torque_Nm();
    const double rated_V = of.resistance_ohm * of.rated_current_A;
    const bool apart = motor.rotor_inertia_kgm2.has_value();
    const double inertia = motor.rotor_inertia_kgm2.value_or(of.inertia_kgm2);
    std::vector<Check> checks = {
        {"inductance_H",
         "inductance / resistance",
         "s",
         of.inductance_H / of.resistance_ohm,
         {0.2e-3, 20e-3},
         {0.3e-3, 12e-3}},
        {"resistance_ohm", "resistance x rated current", "V", rated_V, {0.3, 50}, {0.6, 15}},
        {"supply_V",
         "supply / (resistance x rated current)",
         "",
         of.supply_V / rated_V,
         {1, 200},
         {3, 60}},
        {apart ? "rotor_inertia_kgm2" : "inertia_kgm2",
         apart ? "rotor inertia / holding torque" : "inertia / holding torque",
         "s^2",
         inertia / holding_Nm,
         {2e-6, apart ? 1.2e-3 : 3e-2},
         {4e-6, apart ? 1.2e-4 : 3e-3}},
        {"viscous_friction_Nms_rad",
         "viscous friction at 100 rad/s / holding torque",
         "",
         100 * of.viscous_friction_Nms_rad / holding_Nm,
         {0, 1},
         {0, 0.4}},
        {"rotor_teeth", "number of teeth", "", double(of.rotor_teeth), {1, 1000}, {50, 100}},
        {"inductance_H",
         "inductance x rated current / torque constant",
         "s",
         of.inductance_H * of.rated_current_A / of.torque_constant_Nm_A,
         {0, any},
         {8e-3, 80e-3}},
    };
    if (motor.detent_torque_Nm.has_value()) {
        checks.push_back({"detent_torque_Nm",
                          "detent torque / holding torque",
                          "",
                          *motor.detent_torque_Nm / holding_Nm,
                          {3e-3, 0.5},
                          {0.01, 0.25}});
    }
    return checks;
}

std::string complaint(const Check &check, const Range &range)
{
    const std::string unit = check.unit[0] != '\0' ? std::string(" ") + check.unit : "";
    return std::string(check.quantity) + " is " + readable(check.value) + unit + ", expected " +
           readable(range.least) + "..." + readable(range.most) + unit;
}

const Location &place(const Motor &motor, const char *key)
{
    const Value *value = motor.document.find(key);
    return value != nullptr ? value->location : motor.document.location;
}

} // namespace

void require_plausible(const Motor &motor)
{
    for (const Check &check : checks_of(motor)) {
        if (!check.possible.has(check.value)) {
            TableReader(motor.document, "")
                .fail(check.key, complaint(check, check.possible) + ": a slip of a unit?");
        }
    }
}

std::vector<std::string> doubts_about(const Motor &motor)
{
    std::vector<std::string> doubts;
    for (const Check &check : checks_of(motor)) {
        if (!check.usual.has(check.value)) {
            doubts.push_back(place(motor, check.key).text() + ": " + check.key + ": " +
                             complaint(check, check.usual) + " as other motors have it");
        }
    }
    return doubts;
}

std::vector<std::string> unexplained_doubts_about(const Motor &motor)
{
    return motor.unusual.empty() ? doubts_about(motor) : std::vector<std::string>();
}

} // namespace scenario
