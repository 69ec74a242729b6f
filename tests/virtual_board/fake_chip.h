/* A chip without a core: time that the test moves, events, interrupt levels, a bus. */
#ifndef STEADYSTEP_TESTS_FAKE_CHIP_H
#define STEADYSTEP_TESTS_FAKE_CHIP_H

#include <map>
#include <stdexcept>
#include <vector>

#include "sil/virtual_board/chip.h"

namespace virtual_board
{

struct Refusal : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class FakeChip : public Chip
{
  public:
    Ticks now() const override
    {
        return now_;
    }
    Ticks core_cycle() const override
    {
        return core_cycle_;
    }
    void set_core_cycle(Ticks ticks) override
    {
        core_cycle_ = ticks;
    }
    void schedule(Event &event, Ticks at) override
    {
        for (std::size_t i = 0; i < events_.size(); i++) {
            if (events_[i] == &event) {
                events_.erase(events_.begin() + static_cast<std::ptrdiff_t>(i));
                break;
            }
        }
        event.at = at;
        if (at != Event::never) {
            scheduled++;
            events_.push_back(&event);
        }
    }
    void interrupt(unsigned line, bool level) override
    {
        if (level && !lines[line] && on_interrupt) {
            lines[line] = level;
            on_interrupt(line);
        }
        lines[line] = level;
    }
    void non_maskable_interrupt() override
    {
        non_maskable_interrupts++;
    }
    std::uint32_t load(std::uint32_t address, unsigned bytes) override
    {
        return access(address, bytes, nullptr, Master::dma);
    }
    void store(std::uint32_t address, unsigned bytes, std::uint32_t value) override
    {
        access(address, bytes, &value, Master::dma);
    }
    void reset(const std::string &cause) override
    {
        reset_cause = cause;
    }
    [[noreturn]] void fail(const std::string &what) const override
    {
        throw Refusal(what);
    }

    /* As the core: whole words. */
    std::uint32_t read(std::uint32_t address)
    {
        return access(address, 4, nullptr, Master::core);
    }
    void write(std::uint32_t address, std::uint32_t value)
    {
        access(address, 4, &value, Master::core);
    }
    void set(std::uint32_t address, std::uint32_t bits)
    {
        write(address, read(address) | bits);
    }

    void run_until(Ticks time)
    {
        for (;;) {
            std::size_t first = events_.size();
            for (std::size_t i = 0; i < events_.size(); i++) {
                if (events_[i]->at <= time &&
                    (first == events_.size() || events_[i]->at < events_[first]->at)) {
                    first = i;
                }
            }
            if (first == events_.size()) {
                break;
            }
            Event *event = events_[first];
            events_.erase(events_.begin() + static_cast<std::ptrdiff_t>(first));
            now_ = event->at > now_ ? event->at : now_;
            event->at = Event::never;
            event->happen();
        }
        now_ = time;
    }
    void run_for(Ticks time)
    {
        run_until(now_ + time);
    }

    std::vector<Mapping> mappings;
    std::map<unsigned, bool> lines;
    std::function<void(unsigned)> on_interrupt;
    std::string reset_cause;
    unsigned non_maskable_interrupts = 0;
    unsigned long scheduled = 0; /* events, since the beginning */
    static constexpr std::uint32_t ram = 0x20000000;
    std::vector<std::uint8_t> memory = std::vector<std::uint8_t>(4096);

  private:
    std::uint32_t access(std::uint32_t address, unsigned bytes, const std::uint32_t *value,
                         Master master)
    {
        if (address - ram < memory.size()) {
            std::uint32_t result = 0;
            for (unsigned i = 0; i < bytes; i++) {
                std::uint8_t &byte = memory[address - ram + i];
                if (value != nullptr) {
                    byte = static_cast<std::uint8_t>(*value >> (8 * i));
                }
                result |= std::uint32_t{byte} << (8 * i);
            }
            return result;
        }
        for (const Mapping &mapping : mappings) {
            if (address - mapping.base < mapping.bytes) {
                const std::uint32_t offset = address - mapping.base;
                if (value == nullptr) {
                    return mapping.peripheral->read(offset, bytes, master);
                }
                mapping.peripheral->write(offset, bytes, *value, master);
                return 0;
            }
        }
        throw Refusal("nothing on the bus at this address");
    }

    Ticks now_ = 0, core_cycle_ = 340;
    std::vector<Event *> events_;
};

} // namespace virtual_board

#endif
