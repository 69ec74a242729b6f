#include "tests/one_step/state.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace one_step
{

namespace
{

template <typename Type> Type read(const unsigned char *at)
{
    Type value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

template <typename Type> void write(unsigned char *at, Type value)
{
    std::memcpy(at, &value, sizeof value);
}

std::int64_t integer(const unsigned char *at, std::size_t bytes)
{
    switch (bytes) {
    case 1:
        return read<std::int8_t>(at);
    case 2:
        return read<std::int16_t>(at);
    case 4:
        return read<std::int32_t>(at);
    default:
        return read<std::int64_t>(at);
    }
}

/* struct coef_t of fixed point */
double gain(const unsigned char *at)
{
    return std::ldexp(read<std::int16_t>(at), at[2] - at[3] - 16);
}

bool of_the_format(const Field &field)
{
    return field.kind == Kind::num || field.kind == Kind::unit || field.kind == Kind::coef ||
           field.kind == Kind::real;
}

} // namespace

State::State(const Layout &layout, bool fixed)
    : layout_(layout), fixed_(fixed), scale_(layout.fields.size(), 1.0)
{
    for (const auto &[tested, in_double] : layout.targets) {
        backwards_.emplace(in_double, tested);
    }
}

void State::begin(Memory tested, Memory in_double)
{
    std::fill(scale_.begin(), scale_.end(), 1.0);
    unknown_.clear();
    for (std::size_t i = 0; fixed_ && i < scale_.size(); ++i) {
        if (layout_.fields[i].kind == Kind::coef) {
            unknown_.push_back(i);
        }
    }
    compare_gains(tested, in_double);
}

void State::compare_gains(Memory tested, Memory in_double)
{
    const auto found = [&](std::size_t i) {
        const Field &field = layout_.fields[i];
        const double mine = in_use(field, tested.at) ? number(field, tested) : 0.0;
        const double its = mine == 0.0 ? 0.0 : number(field, in_double);
        if (its == 0.0) {
            return false;
        }
        const double ratio = its / mine;
        scale_[i] = ratio > 256.0 ? 65536.0 : ratio < 1.0 / 256.0 ? 1.0 / 65536.0 : 1.0;
        return true;
    };
    unknown_.erase(std::remove_if(unknown_.begin(), unknown_.end(), found), unknown_.end());
}

bool State::in_use(const Field &field, const unsigned char *tested) const
{
    if (field.condition < 0) {
        return true;
    }
    const Condition &condition = layout_.conditions[static_cast<std::size_t>(field.condition)];
    const std::int64_t value = integer(tested + condition.offset, condition.bytes);
    return std::find(condition.values.begin(), condition.values.end(), value) !=
           condition.values.end();
}

double State::number(const Field &field, Memory memory) const
{
    if (memory.is_double) {
        return read<double>(memory.at + field.in_double);
    }
    const unsigned char *const at = memory.at + field.tested;
    if (!fixed_) {
        return static_cast<double>(read<float>(at));
    }
    switch (field.kind) {
    case Kind::num:
        return read<std::int32_t>(at) / 67108864.0;
    case Kind::unit:
        return read<std::int32_t>(at) / 32768.0;
    case Kind::coef:
        return gain(at) * scale_[static_cast<std::size_t>(&field - layout_.fields.data())];
    default:
        return read<double>(at);
    }
}

std::int64_t State::whole(const Field &field, Memory memory) const
{
    const unsigned char *const at = memory.at + (memory.is_double ? field.in_double : field.tested);
    if (field.kind == Kind::position) {
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(read<std::uint32_t>(at)) << 32 |
                                         read<std::uint32_t>(at + sizeof(std::int32_t)));
    }
    return integer(at, field.bytes);
}

std::size_t State::target(const Field &field, Memory memory) const
{
    const auto *const pointed = read<const unsigned char *>(
        memory.at + (memory.is_double ? field.in_double : field.tested));
    const auto offset = static_cast<std::size_t>(pointed - memory.home);
    const auto &targets = memory.is_double ? backwards_ : layout_.targets;
    const auto found = pointed == nullptr ? targets.end() : targets.find(offset);
    if (found == targets.end()) {
        return pointed == nullptr ? 0 : std::string::npos;
    }
    return memory.is_double ? found->second : found->first;
}

void State::copy(const Field &field, Memory tested, unsigned char *in_double) const
{
    unsigned char *const to = in_double + field.in_double;
    if (of_the_format(field)) {
        const double rest = field.remainder == nullptr ? 0.0 : number(*field.remainder, tested);
        write(to, number(field, tested) + rest);
    } else if (field.kind != Kind::pointer) {
        std::memcpy(to, tested.at + field.tested, field.bytes);
    } else if (target(field, tested) == 0) {
        write<unsigned char *>(to, nullptr);
    } else if (target(field, tested) != std::string::npos) {
        write<const unsigned char *>(to, in_double + layout_.targets.at(target(field, tested)));
    }
}

void State::copy(const Block &block, Memory tested, unsigned char *in_double) const
{
    for (const std::size_t i : block.fields) {
        if (in_use(layout_.fields[i], tested.at)) {
            copy(layout_.fields[i], tested, in_double);
        }
    }
}

} // namespace one_step
