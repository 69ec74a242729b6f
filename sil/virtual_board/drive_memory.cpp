#include "sil/virtual_board/drive_memory.h"

#include <cstring>
#include <stdexcept>

namespace virtual_board
{

namespace
{

constexpr double two_pi = 6.283185307179586;
constexpr double fraction_per_turn = 4294967296.0;
constexpr double fixed_point_one = 67108864.0; /* 2^26: Q5.26, numeric/num.h */

} // namespace

std::uint64_t DriveMemory::Place::bits() const
{
    std::uint64_t value = 0;
    for (unsigned i = 0; i < size; ++i) {
        value |= std::uint64_t{bytes[i]} << (8 * i);
    }
    return value;
}

double DriveMemory::Place::number() const
{
    const std::uint64_t value = bits();
    if (kind == real) {
        double number = 0;
        std::memcpy(&number, &value, sizeof number);
        return number;
    }
    const auto word = static_cast<std::uint32_t>(value);
    if (kind == single) {
        float number = 0;
        std::memcpy(&number, &word, sizeof number);
        return static_cast<double>(number);
    }
    const double whole = static_cast<double>(static_cast<std::int32_t>(word));
    return kind == fixed_point ? whole / fixed_point_one : whole;
}

DriveMemory::Place DriveMemory::place(Machine &machine, const ImageMap &map,
                                      const std::string &name, bool is_num) const
{
    const Variable &variable = map.signal(name);
    Place place;
    place.bytes = machine.memory(variable.address, variable.bytes);
    place.size = variable.bytes;
    if (place.bytes == nullptr || variable.bytes > 8) {
        throw std::invalid_argument("the image's map has " + name + " where there is no memory");
    }
    if (variable.type == "float") {
        place.kind = Place::single;
    } else if (variable.type == "double") {
        place.kind = Place::real;
    } else if (is_num) {
        place.kind = Place::fixed_point;
    }
    return place;
}

DriveMemory::DriveMemory(Machine &machine, const ImageMap &map)
{
    const auto whole = [&](const std::string &name) { return place(machine, map, name, false); };
    const auto num = [&](const std::string &name) { return place(machine, map, name, true); };
    gains_ = whole("gains_hash");
    for (int leg = 0; leg < 4; ++leg) {
        high_counts_[leg] = whole("outputs.high_counts[" + std::to_string(leg) + "]");
    }
    bridge_on_ = whole("outputs.bridge_on");
    state_ = whole("drive.supervision.state");
    fault_ = whole("drive.supervision.fault");
    synchronism_ = whole("drive.synchronism.shown");
    period_ = whole("drive.supervision.period");
    bus_ = num("drive.bus");
    holding_ = whole("drive.hold.active");
    estimator_ = whole("drive.params.estimator.kind");
    teeth_ = whole("drive.settings.motor.rotor_teeth");
    underruns_ = whole("drive.planner.underruns");
    dropped_ = whole("drive.commands.dropped");
    dropped_kind_ = whole("drive.commands.dropped_kind");
    reference_turns_ = whole("drive.reference.now.position.turns");
    reference_fraction_ = whole("drive.reference.now.position.fraction");
    reference_speed_ = num("drive.reference.now.speed");
    reference_moving_ = whole("drive.reference.now.moving");
    current_d_ = num("drive.current.d");
    current_q_ = num("drive.current.q");
    current_reference_d_ = num("drive.current_reference.d");
    current_reference_q_ = num("drive.current_reference.q");
    voltage_d_ = num("drive.voltage_command.d");
    voltage_q_ = num("drive.voltage_command.q");
    base_current_ = whole("drive.base.current_A");
    base_voltage_ = whole("drive.base.voltage_V");
    base_speed_ = whole("drive.base.speed_rad_s");
    base_torque_ = whole("drive.base.torque_Nm");
    base_resistance_ = whole("drive.base.resistance_ohm");
    const char *const kinds[] = {"invariant", "steady_state", "encoder", "high_gain"};
    for (int i = 0; i < 4; ++i) {
        const std::string estimate = std::string("drive.estimator.") + kinds[i] + ".estimate.";
        estimates_[i] = {whole(estimate + "rotor.position.turns"),
                         whole(estimate + "rotor.position.fraction"), num(estimate + "rotor.speed"),
                         num(estimate + "rotor.load_torque"), num(estimate + "winding.resistance")};
    }
}

const DriveMemory::Estimate &DriveMemory::estimate() const
{
    return estimates_[estimator_.bits() & 3];
}

/* As position_to_rad of numeric/angle.h. */
double DriveMemory::angle_rad(const Place &turns, const Place &fraction) const
{
    const double all =
        turns.number() +
        static_cast<double>(static_cast<std::uint32_t>(fraction.bits())) / fraction_per_turn;
    return all * two_pi / teeth_.number();
}

/* As drive_signals_read of drive/commands.c. */
drive_signals DriveMemory::signals() const
{
    const Estimate &x = estimate();
    const double current_A = base_current_.number(), voltage_V = base_voltage_.number();
    const double speed_rad_s = base_speed_.number();
    drive_signals signals = {};
    signals.state = static_cast<drive_state>(state_.bits());
    signals.fault = static_cast<drive_fault>(fault_.bits());
    signals.synchronism = static_cast<drive_synchronism>(synchronism_.bits());
    signals.period = static_cast<std::uint32_t>(period_.bits());
    signals.holding = holding_.bits() != 0;
    signals.reference_moving = reference_moving_.bits() != 0;
    signals.theta_ref_rad = angle_rad(reference_turns_, reference_fraction_);
    signals.omega_ref_rad_s = reference_speed_.number() * speed_rad_s;
    signals.theta_est_rad = angle_rad(x.turns, x.fraction);
    signals.omega_est_rad_s = x.speed.number() * speed_rad_s;
    signals.load_torque_est_Nm = x.load_torque.number() * base_torque_.number();
    signals.i_d_A = current_d_.number() * current_A;
    signals.i_q_A = current_q_.number() * current_A;
    signals.i_d_ref_A = current_reference_d_.number() * current_A;
    signals.i_q_ref_A = current_reference_q_.number() * current_A;
    signals.u_d_V = voltage_d_.number() * voltage_V;
    signals.u_q_V = voltage_q_.number() * voltage_V;
    signals.resistance_est_ohm = x.resistance.number() * base_resistance_.number();
    signals.bus_V = bus_.number() * voltage_V;
    signals.reference_underruns = static_cast<std::uint32_t>(underruns_.bits());
    signals.commands_dropped = static_cast<std::uint32_t>(dropped_.bits());
    signals.dropped_kind = static_cast<drive_command_kind>(dropped_kind_.bits());
    return signals;
}

std::uint64_t DriveMemory::gains_hash() const
{
    return gains_.bits();
}

/* As drive_hash_row of drive/drive_hash.c. */
struct drive_hash_row DriveMemory::hash_row() const
{
    const auto word = [](const Place &place) { return static_cast<std::uint32_t>(place.bits()); };
    const Estimate &x = estimate();
    return {{word(high_counts_[0]) << 16 | word(high_counts_[1]),
             word(high_counts_[2]) << 16 | word(high_counts_[3]),
             word(state_) << 1 | (bridge_on_.bits() != 0 ? 1u : 0u), word(x.turns),
             word(x.fraction), word(x.speed), word(x.load_torque), word(current_d_),
             word(current_q_)}};
}

} // namespace virtual_board
