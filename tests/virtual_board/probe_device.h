/*
 * The device of the core's tests: a flash that is never programmed, and a probe that keeps what a
 * program says and raises interrupts when it is asked to (programs/program.h).
 */
#ifndef STEADYSTEP_TESTS_PROBE_DEVICE_H
#define STEADYSTEP_TESTS_PROBE_DEVICE_H

#include <list>
#include <vector>

#include "sil/virtual_board/machine.h"

class ProbeDevice : public virtual_board::Device,
                    private virtual_board::Peripheral,
                    private virtual_board::FlashMemory
{
  public:
    explicit ProbeDevice(virtual_board::Machine &machine,
                         const virtual_board::ChipDescription &chip = virtual_board::stm32g474())
        : machine_(machine), flash_(chip.flash.bytes, 0xff)
    {
        for (unsigned line = 0; line < lines; ++line) {
            events_.emplace_back([this, line] { machine_.interrupt(line, true); });
        }
    }

    struct Entry {
        std::uint32_t value;
        virtual_board::Ticks at;
    };
    std::vector<Entry> log;
    std::vector<std::string> resets;
    bool ended = false;
    std::uint32_t result = 0;

    std::vector<virtual_board::Mapping> mappings() override
    {
        return {{"probe", 0x40000000, 0x400, this}};
    }
    virtual_board::FlashMemory &flash() override
    {
        return *this;
    }
    void reset(const std::string &cause) override
    {
        resets.push_back(cause);
        reset();
    }

  private:
    static constexpr unsigned lines = 8;

    std::uint32_t read(std::uint32_t offset, unsigned, virtual_board::Master) override
    {
        if (offset == 12) {
            machine_.interrupt(0, true);
            return 0;
        }
        if (offset != 8) {
            machine_.fail("probe: no such register");
        }
        random_ = random_ * 1664525 + 1013904223;
        return random_ >> 24;
    }
    void write(std::uint32_t offset, unsigned, std::uint32_t value, virtual_board::Master) override
    {
        if (offset == 0) {
            ended = true;
            result = value;
            machine_.stop();
        } else if (offset == 4) {
            log.push_back({value, machine_.now()});
        } else if (offset >= 0x10 && offset < 0x30) {
            auto event = events_.begin();
            std::advance(event, (offset - 0x10) / 4);
            machine_.schedule(*event, machine_.now() + value * machine_.core_cycle());
        } else if (offset >= 0x30 && offset < 0x50) {
            machine_.interrupt((offset - 0x30) / 4, false);
        } else {
            machine_.fail("probe: no such register");
        }
    }
    void reset() override
    {
        for (unsigned line = 0; line < lines; ++line) {
            machine_.interrupt(line, false);
        }
    }
    std::vector<std::uint8_t> &memory() override
    {
        return flash_;
    }
    void store(std::uint32_t, unsigned, std::uint32_t) override
    {
        machine_.fail("probe: the flash is not to be programmed");
    }
    virtual_board::Ticks busy_until(std::uint32_t) const override
    {
        return 0;
    }

    virtual_board::Machine &machine_;
    std::vector<std::uint8_t> flash_;
    std::list<virtual_board::Event> events_;
    std::uint32_t random_ = 1;
};

#endif
