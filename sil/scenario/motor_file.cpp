#include "sil/scenario/motor_file.h"

#include "sil/scenario/motor_plausibility.h"
#include "sil/scenario/table_reader.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double sqrt_2 = 1.4142135623730951;

/* A torque constant that was measured and the holding torque of the data sheet may differ by so
   much of the latter: saturation, and a holding torque that is printed as a minimum. */
constexpr double torque_tolerance = 0.25;

/* The torque constant, given or from the holding torque; given both, the constant counts. */
void read_torque(TableReader &reader, motor_params &params)
{
    double holding_Nm = 0;
    const bool constant =
        reader.number("torque_constant_Nm_A", params.torque_constant_Nm_A, 1e-4, 100);
    const bool holding = reader.number("holding_torque_Nm", holding_Nm, 1e-4, 1000);
    if (!constant && !holding) {
        reader.fail("torque_constant_Nm_A", "is missing; holding_torque_Nm will do as well");
    }
    const double of_holding = holding_Nm / (sqrt_2 * params.rated_current_A);
    if (!constant) {
        params.torque_constant_Nm_A = of_holding;
        return;
    }
    const double least = (1 - torque_tolerance) * of_holding;
    const double most = (1 + torque_tolerance) * of_holding;
    if (holding && !(params.torque_constant_Nm_A >= least && params.torque_constant_Nm_A <= most)) {
        reader.fail("torque_constant_Nm_A",
                    "expected " + readable(least) + "..." + readable(most) +
                        ", holding_torque_Nm / (sqrt 2 x rated_current_A) within 25 %, got " +
                        readable(params.torque_constant_Nm_A));
    }
}

/* inertia_kgm2, or else the rotor's and, if there is one, the load's. */
void read_inertia(TableReader &reader, Motor &motor)
{
    constexpr double least = 1e-9, most = 10;
    double rotor = 0, load = 0;
    const bool together = reader.number("inertia_kgm2", motor.params.inertia_kgm2, least, most);
    const bool apart = reader.number("rotor_inertia_kgm2", rotor, least, most);
    const bool loaded = reader.number("load_inertia_kgm2", load, 0, most);
    if (together && (apart || loaded)) {
        reader.fail(apart ? "rotor_inertia_kgm2" : "load_inertia_kgm2",
                    "expected either inertia_kgm2, of rotor and load together, or each apart");
    }
    if (loaded && !apart) {
        reader.fail("rotor_inertia_kgm2", "is missing, load_inertia_kgm2 is the load's alone");
    }
    if (!together && !apart) {
        reader.fail("inertia_kgm2", "is missing; rotor_inertia_kgm2 will do as well");
    }
    if (apart) {
        motor.rotor_inertia_kgm2 = rotor;
        motor.params.inertia_kgm2 = rotor + load;
    }
}

void read_detent(TableReader &reader, Motor &motor)
{
    double detent_Nm = 0;
    if (reader.number("detent_torque_Nm", detent_Nm, 0, 100)) {
        motor.detent_torque_Nm = detent_Nm;
    }
}

/* `id`: the name of the file. */
Motor interpreted(const Value &document, const std::string &id)
{
    Motor motor;
    motor.document = document;
    TableReader reader(motor.document, "");
    motor_params &params = motor.params;
    std::int64_t rotor_teeth = 0;

    for (const char *key :
         {"id", "description", "source", "resistance_ohm", "inductance_H",
          "viscous_friction_Nms_rad", "rated_current_A", "supply_V", "rotor_teeth"}) {
        reader.require(key);
    }
    reader.text("id", motor.id);
    reader.text("description", motor.description);
    reader.text("source", motor.source);
    reader.text("stated", motor.stated);
    reader.text("assumed", motor.assumed);
    reader.text("unusual", motor.unusual);
    reader.number("resistance_ohm", params.resistance_ohm, 1e-3, 1e3);
    reader.number("inductance_H", params.inductance_H, 1e-6, 10);
    reader.number("viscous_friction_Nms_rad", params.viscous_friction_Nms_rad, 0, 10);
    reader.number("rated_current_A", params.rated_current_A, 1e-2, 100);
    reader.number("supply_V", params.supply_V, 1, 1000);
    reader.integer("rotor_teeth", rotor_teeth, 1, 1000);
    read_torque(reader, params);
    read_inertia(reader, motor);
    read_detent(reader, motor);
    reader.finish();
    if (motor.id != id) {
        reader.fail("id",
                    "expected \"" + id + "\", the name of the file, got \"" + motor.id + "\"");
    }
    params.rotor_teeth = static_cast<int32_t>(rotor_teeth);
    require_plausible(motor);
    return motor;
}

} // namespace

double Motor::holding_torque_Nm() const
{
    return sqrt_2 * params.torque_constant_Nm_A * params.rated_current_A;
}

Motor read_motor(const std::filesystem::path &file)
{
    return interpreted(read_toml(file), file.stem().string());
}

Motor read_motor_text(const std::string &text, const std::string &id)
{
    return interpreted(parse_toml(text, id), id);
}

} // namespace scenario
