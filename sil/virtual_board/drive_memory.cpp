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
    const auto angle = [&](const std::string &name) {
        return Signal{whole(name + ".turns"), whole(name + ".fraction")};
    };
    gains_ = whole("gains_hash");
    for (int leg = 0; leg < 4; ++leg) {
        high_counts_[leg] = whole("outputs.high_counts[" + std::to_string(leg) + "]");
    }
    bridge_on_ = whole("outputs.bridge_on");
    teeth_ = whole("drive.settings.motor.rotor_teeth");
    offset_ = angle("drive.axis.offset");
#define PLACE(index, member, path, ...)       signals_[SIGNAL_##member] = {whole("drive." #path), {}};
#define ANGLE_PLACE(index, member, path, ...) signals_[SIGNAL_##member] = angle("drive." #path);
#define REAL_PLACE(index, member, path, brief, traced, base, ...)                                  \
    signals_[SIGNAL_##member] = {num("drive." #path), whole("drive.base." #base)};
    DRIVE_SIGNALS_TABLE(PLACE, PLACE, ANGLE_PLACE, PLACE, REAL_PLACE)
}

/* Turns and fraction as one number, as angle_of_position of numeric/angle.h. */
std::uint64_t DriveMemory::position(const Signal &angle)
{
    return angle.place.bits() << 32 | angle.with.bits();
}

/* As position_plus and position_to_rad of numeric/angle.h. */
double DriveMemory::angle_rad(const Signal &angle) const
{
    const std::uint64_t sum = position(angle) + position(offset_);
    const double all = static_cast<double>(static_cast<std::int32_t>(sum >> 32)) +
                       static_cast<double>(static_cast<std::uint32_t>(sum)) / fraction_per_turn;
    return all * two_pi / teeth_.number();
}

/* As drive_signals_read of drive/commands.c. */
drive_signals DriveMemory::signals() const
{
    drive_signals signals = {};
#define READ(index, member, ...)                                                                   \
    signals.member = static_cast<decltype(signals.member)>(signals_[SIGNAL_##member].place.bits());
#define READ_ANGLE(index, member, ...) signals.member = angle_rad(signals_[SIGNAL_##member]);
#define READ_REAL(index, member, ...)                                                              \
    signals.member =                                                                               \
        signals_[SIGNAL_##member].place.number() * signals_[SIGNAL_##member].with.number();
    DRIVE_SIGNALS_TABLE(READ, READ, READ_ANGLE, READ, READ_REAL)
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
    const Signal &position = signals_[SIGNAL_theta_est_rad];
    const auto of = [&](drive_signal signal) { return word(signals_[signal].place); };
    return {{word(high_counts_[0]) << 16 | word(high_counts_[1]),
             word(high_counts_[2]) << 16 | word(high_counts_[3]),
             of(SIGNAL_state) << 1 | (bridge_on_.bits() != 0 ? 1u : 0u), word(position.place),
             word(position.with), of(SIGNAL_omega_est_rad_s), of(SIGNAL_load_torque_est_Nm),
             of(SIGNAL_i_d_A), of(SIGNAL_i_q_A)}};
}

} // namespace virtual_board
