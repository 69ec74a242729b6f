#include "sil/scenario/motor_file.h"

#include "sil/scenario/table_reader.h"

namespace scenario
{

Motor read_motor(const std::filesystem::path &file)
{
    Motor motor;
    motor.document = read_toml(file);
    TableReader reader(motor.document, "");
    motor_params &params = motor.params;
    std::int64_t rotor_teeth = 0;

    reader.text("id", motor.id);
    reader.text("description", motor.description);
    reader.text("source", motor.source);
    reader.number("resistance_ohm", params.resistance_ohm, 1e-3, 1e3);
    reader.number("inductance_H", params.inductance_H, 1e-6, 10);
    reader.number("torque_constant_Nm_A", params.torque_constant_Nm_A, 1e-4, 100);
    reader.number("viscous_friction_Nms_rad", params.viscous_friction_Nms_rad, 0, 10);
    reader.number("inertia_kgm2", params.inertia_kgm2, 1e-9, 10);
    reader.number("rated_current_A", params.rated_current_A, 1e-2, 100);
    reader.number("supply_V", params.supply_V, 1, 1000);
    reader.integer("rotor_teeth", rotor_teeth, 1, 1000);
    reader.finish();
    for (const char *key : {"id", "description", "source", "resistance_ohm", "inductance_H",
                            "torque_constant_Nm_A", "viscous_friction_Nms_rad", "inertia_kgm2",
                            "rated_current_A", "supply_V", "rotor_teeth"}) {
        reader.require(key);
    }
    if (motor.id != file.stem().string()) {
        reader.fail("id", "expected \"" + file.stem().string() +
                              "\", the name of the file, got \"" + motor.id + "\"");
    }
    params.rotor_teeth = static_cast<int32_t>(rotor_teeth);
    return motor;
}

} // namespace scenario
