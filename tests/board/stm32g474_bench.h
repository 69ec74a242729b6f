/* The image of the STM32G474 board, powered, on a board whose registers can be tampered with. */
#ifndef STEADYSTEP_TESTS_BOARD_STM32G474_BENCH_H
#define STEADYSTEP_TESTS_BOARD_STM32G474_BENCH_H

#include <filesystem>
#include <functional>
#include <list>
#include <string>
#include <vector>

#include "sil/virtual_board/image_map.h"
#include "sil/virtual_board/machine.h"
#include "sil/virtual_board/peripherals/stm32g474_device.h"
#include "tests/board/expectations.h"

namespace stm32g474_bench
{

using namespace virtual_board;

constexpr Ticks us = ticks_per_s / 1000000, ms = 1000 * us;
constexpr Ticks enable_time = 700 * ms;

/* sil/motors/bendjedia-2012.toml, the default motor of the image. */
inline Stm32g474Config board_config()
{
    Stm32g474Config config;
    config.power_stage.plant.motor = {0.37, 0.9e-3, 0.157, 0.000307, 15.62e-5, 50};
    config.power_stage.plant.bridge.bus_V = 24.0;
    return config;
}

/* Bits of a register that read as planted. */
struct PlantedBits {
    std::uint32_t address, mask, value;
};

/* The peripherals, with taps on the bus in front of them. */
class TappedDevice final : public Stm32g474Device
{
  public:
    using Stm32g474Device::Stm32g474Device;

    std::vector<Mapping> mappings() override
    {
        std::vector<Mapping> tapped = Stm32g474Device::mappings();
        for (Mapping &mapping : tapped) {
            taps_.emplace_back(*this, mapping);
            mapping.peripheral = &taps_.back();
        }
        return tapped;
    }

    std::vector<PlantedBits> planted;
    /* Before a write of the core: address and value. */
    std::function<void(std::uint32_t, std::uint32_t)> before_write;

  private:
    class Tap final : public Peripheral
    {
      public:
        Tap(TappedDevice &device, const Mapping &mapping)
            : device_(device), base_(mapping.base), behind_(*mapping.peripheral)
        {
        }
        std::uint32_t read(std::uint32_t offset, unsigned bytes, Master master) override
        {
            std::uint32_t value = behind_.read(offset, bytes, master);
            for (const PlantedBits &bits : device_.planted) {
                if (bits.address == base_ + offset) {
                    value = (value & ~bits.mask) | bits.value;
                }
            }
            return value;
        }
        void write(std::uint32_t offset, unsigned bytes, std::uint32_t value,
                   Master master) override
        {
            if (device_.before_write && master == Master::core) {
                device_.before_write(base_ + offset, value);
            }
            behind_.write(offset, bytes, value, master);
        }
        void reset() override
        {
            behind_.reset();
        }

      private:
        TappedDevice &device_;
        std::uint32_t base_;
        Peripheral &behind_;
    };

    std::list<Tap> taps_;
};

class Powered
{
  public:
    /* `prepare`: changes the flash before the supply comes. */
    explicit Powered(
        const std::string &image_file, const Stm32g474Config &config = board_config(),
        const std::function<void(std::vector<std::uint8_t> &)> &prepare = [](auto &) {})
        : elf(ElfImage::read(image_file)), machine(stm32g474()), device(machine, config),
          alarm_([this] { machine.stop(); })
    {
        if (std::filesystem::exists(map_file_of(image_file))) { /* else it takes longer */
            (void)ImageMap::read(map_file_of(image_file), elf, machine.costs());
        }
        machine.attach(device);
        machine.load(elf);
        prepare(device.flash().memory());
        device.power_stage().on_sample = [this](std::int64_t) {
            machine.mark_sampling();
            if (stops_at_peak_) {
                machine.stop();
            }
        };
        machine.power_on();
    }

    /* Resets, which end a run early, are counted in machine.resets(). */
    void run_for(Ticks time)
    {
        const Ticks end = machine.now() + time;
        while (machine.now() < end) {
            machine.schedule(alarm_, end);
            machine.run();
        }
    }
    /* So long behind the next peak of the PWM timer. */
    void run_behind_peak(Ticks time)
    {
        stops_at_peak_ = true;
        machine.run();
        stops_at_peak_ = false;
        run_for(time);
    }
    std::string output()
    {
        return device.serial_line().take_output();
    }
    std::string type(const std::string &line, Ticks time)
    {
        device.serial_line().send(machine.now(), line);
        run_for(time);
        return output();
    }
    bool bridge_on()
    {
        return device.power_stage().bridge_on();
    }
    /* Until the board has reported why it started, at most half a second; what it has written. */
    std::string start()
    {
        std::string text;
        for (int i = 0; i < 100 && count(text, "started by: ") == 0; ++i) {
            run_for(5 * ms);
            text += output();
        }
        run_for(5 * ms); /* the rest of the line */
        return text + output();
    }
    /* Enables; whether the drive is ready then. */
    bool enable(Ticks within = enable_time)
    {
        return count(type("enable\n", within), "ready:") == 1 && bridge_on();
    }

    ElfImage elf;
    Machine machine;
    TappedDevice device;

  private:
    bool stops_at_peak_ = false;
    Event alarm_;
};

/* A group of expectations, by a name that it can be asked for. */
struct Case {
    const char *name;
    void (*run)(Expectations &expectations, const std::string &image);
    bool only_if_asked = false; /* of another image */
};

/* stm32g474_starts.cpp */
void starts_fail(Expectations &expectations, const std::string &image);
void starts_fail_for_ever(Expectations &expectations, const std::string &image);
void starts_without_crystal(Expectations &expectations, const std::string &image);
void chip_supply_sags(Expectations &expectations, const std::string &image);

/* stm32g474_storage.cpp */
void supply_fails_in_store(Expectations &expectations, const std::string &image);
void supply_fails_in_erase(Expectations &expectations, const std::string &image);
void supply_fails_beside_weak_cell(Expectations &expectations, const std::string &image);
void simulation_is_asked_for(Expectations &expectations, const std::string &image);
void encoder_is_asked_for(Expectations &expectations, const std::string &image);
void encoder_counts(Expectations &expectations, const std::string &image);
void homing_on_index(Expectations &expectations, const std::string &image);

/* stm32g474_settings.cpp */
void settings_act(Expectations &expectations, const std::string &image);

/* stm32g474_lines.cpp */
void lines_overflow(Expectations &expectations, const std::string &image);
void line_ends(Expectations &expectations, const std::string &image);
void position_outlives_disable(Expectations &expectations, const std::string &image);

/* stm32g474_can.cpp */
void can_registers(Expectations &expectations, const std::string &image);
void can_bus_off(Expectations &expectations, const std::string &image);
void can_without_another_node(Expectations &expectations, const std::string &image);
void can_overrun(Expectations &expectations, const std::string &image);

/* stm32g474_floods.cpp */
void can_flood(Expectations &expectations, const std::string &image);
void can_flood_of_a_million(Expectations &expectations, const std::string &image);
void line_flood(Expectations &expectations, const std::string &image);
void line_flood_of_a_million(Expectations &expectations, const std::string &image);

} // namespace stm32g474_bench

#endif
