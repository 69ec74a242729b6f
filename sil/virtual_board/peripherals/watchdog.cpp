#include "sil/virtual_board/peripherals/watchdog.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t { KR = 0x00, PR = 0x04, RLR = 0x08, SR = 0x0c, WINR = 0x10 };

constexpr Ticks lsi_period = ticks_per_s / 32000;
constexpr Ticks update_time = 6 * lsi_period; /* of PR and RLR into the LSI's domain */

} // namespace

Watchdog::Watchdog(Chip &chip)
    : RegisterBlock(chip, "IWDG",
                    {{KR, "KR", 0xffff},
                     {PR, "PR", 0x7},
                     {RLR, "RLR", 0xfff, 0xfff},
                     {SR, "SR", 0},
                     {WINR, "WINR", 0xfff, 0xfff}}),
      timeout_event_([this] {
          running_ = false;
          chip_.reset("watchdog");
      })
{
}

void Watchdog::reset()
{
    RegisterBlock::reset();
    running_ = unlocked_ = false;
    prescaler_busy_ = reload_busy_ = 0;
    chip_.schedule(timeout_event_, Event::never);
}

Ticks Watchdog::timeout() const
{
    const unsigned power = at(PR) < 6 ? at(PR) : 6; /* divider 4...256 */
    return (Ticks{at(RLR)} + 1) * (Ticks{4} << power) * lsi_period;
}

std::uint32_t Watchdog::fetch(std::uint32_t offset, Master)
{
    if (offset == SR) {
        return (chip_.now() < prescaler_busy_ ? 1u : 0u) | (chip_.now() < reload_busy_ ? 2u : 0u);
    }
    return offset == KR ? 0 : at(offset);
}

void Watchdog::put(std::uint32_t offset, std::uint32_t value, Master)
{
    if (offset == KR) {
        key(value);
        return;
    }
    require(offset != SR, offset, value, "read only");
    require(unlocked_, offset, value, "written without the access key 0x5555");
    require(offset != WINR || value == 0xfff, offset, value, "a window is not modelled");
    Ticks &busy = offset == PR ? prescaler_busy_ : reload_busy_;
    require(chip_.now() >= busy, offset, value, "written while its update is under way (SR)");
    keep(offset, value);
    busy = chip_.now() + update_time;
}

void Watchdog::key(std::uint32_t value)
{
    unlocked_ = value == 0x5555;
    if (value == 0xcccc) {
        if (!running_) {
            running_ = true;
            reloaded_ = chip_.now();
            chip_.schedule(timeout_event_, reloaded_ + timeout());
        }
    } else if (value == 0xaaaa) {
        reload();
    } else {
        require(value == 0x5555 || value == 0, KR, value,
                "expected 0xcccc, 0x5555, 0xaaaa or 0 (locks)");
    }
}

void Watchdog::reload()
{
    if (!running_) {
        return;
    }
    const Ticks now = chip_.now();
    counters.reloads++;
    counters.longest = now - reloaded_ > counters.longest ? now - reloaded_ : counters.longest;
    reloaded_ = now;
    chip_.schedule(timeout_event_, now + timeout());
}

} // namespace virtual_board
