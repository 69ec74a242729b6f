/* The bus: who answers at an address. */
#include "sil/virtual_board/machine.h"

#include <cstdio>

namespace virtual_board
{

const Mapping &Machine::mapping(std::uint32_t address, unsigned bytes, const char *what) const
{
    std::size_t &quick = mapping_at_[address >> 8 & 63]; /* the last that was found there */
    for (std::size_t i = 0; i <= mappings_.size(); ++i) {
        const std::size_t place = i == 0 ? quick : i - 1;
        if (address - mappings_[place].base < mappings_[place].bytes) {
            if (address % bytes != 0) {
                refuse_access(address, bytes, what, "is not aligned");
            }
            quick = place;
            return mappings_[place];
        }
    }
    refuse_access(address, bytes, what, "finds no peripheral that is modelled");
}

void Machine::refuse_access(std::uint32_t address, unsigned bytes, const char *what,
                            const char *why) const
{
    char text[96];
    std::snprintf(text, sizeof text, "%s of %u bytes at 0x%08x %s", what, bytes,
                  static_cast<unsigned>(address), why);
    fail(text);
}

std::uint32_t Machine::bus_read(std::uint32_t address, unsigned bytes, Master master)
{
    const Mapping &place = mapping(address, bytes, "read");
    return place.peripheral->read(address - place.base, bytes, master);
}

void Machine::bus_write(std::uint32_t address, unsigned bytes, std::uint32_t value, Master master)
{
    const Mapping &place = mapping(address, bytes, "write");
    place.peripheral->write(address - place.base, bytes, value, master);
}

namespace
{

std::uint32_t little_endian(const std::uint8_t *from, unsigned bytes)
{
    std::uint32_t value = 0;
    for (unsigned i = 0; i < bytes; ++i) {
        value |= std::uint32_t{from[i]} << (8 * i);
    }
    return value;
}

} // namespace

/* The core's accesses that are not to plain memory. */
std::uint32_t Machine::read(std::uint32_t address, unsigned bytes)
{
    calm_until_ = 0;
    if (description_.flash.contains(address)) {
        const Ticks free = flash_->busy_until(address);
        if (free > now_) { /* the bus waits for the end of the operation */
            add_time(in_every_column((free - now_ + core_cycle_ - 1) / core_cycle_));
        }
        flash_->core_reads(address, bytes);
        return little_endian(memory(address, bytes), bytes);
    }
    const unsigned stage = time_access(address);
    const bool own = address - SystemControl::base < SystemControl::bytes;
    if (own && address < 0xe0040000) {
        return system_.read(address - SystemControl::base, bytes, Master::core);
    }
    add_time(costs_.rules.peripheral, stage);
    return bus_read(address, bytes, Master::core);
}

void Machine::write(std::uint32_t address, unsigned bytes, std::uint32_t value)
{
    calm_until_ = 0;
    if (description_.flash.contains(address)) {
        flash_->store(address, bytes, value);
        return;
    }
    const unsigned stage = time_access(address);
    const bool own = address - SystemControl::base < SystemControl::bytes;
    if (own && address < 0xe0040000) {
        const bool allowed = system_.floating_point_allowed();
        system_.write(address - SystemControl::base, bytes, value, Master::core);
        if (system_.floating_point_allowed() != allowed) {
            allow_floating_point();
        }
        return;
    }
    add_time(costs_.rules.peripheral, stage);
    bus_write(address, bytes, value, Master::core);
}

/* What DMA channels see: memory or peripherals. */
std::uint32_t Machine::load(std::uint32_t address, unsigned bytes)
{
    if (peripherals.contains(address)) {
        return bus_read(address, bytes, Master::dma);
    }
    const std::uint8_t *const plain = memory(address, bytes);
    return plain != nullptr ? little_endian(plain, bytes) : bus_read(address, bytes, Master::dma);
}

void Machine::store(std::uint32_t address, unsigned bytes, std::uint32_t value)
{
    if (description_.flash.contains(address)) {
        flash_->store(address, bytes, value);
        return;
    }
    std::uint8_t *const plain = memory(address, bytes);
    if (plain == nullptr) {
        bus_write(address, bytes, value, Master::dma);
    } else if (bytes == 2) { /* the most by far */
        plain[0] = static_cast<std::uint8_t>(value);
        plain[1] = static_cast<std::uint8_t>(value >> 8);
    } else {
        for (unsigned i = 0; i < bytes; ++i) {
            plain[i] = static_cast<std::uint8_t>(value >> (8 * i));
        }
    }
}

} // namespace virtual_board
