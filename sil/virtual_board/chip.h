/*
 * What a modelled peripheral sees of the chip around it: time, events, interrupt lines, memory for
 * DMA, and the way to say that the firmware has done what silicon would not forgive. The chip
 * (core, NVIC, bus) knows peripherals through the class below only.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_CHIP_H
#define STEADYSTEP_VIRTUAL_BOARD_CHIP_H

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace virtual_board
{

/* Time since power-on. The unit divides the periods of all clocks: 170, 64, 16 MHz and 32 kHz. */
using Ticks = std::uint64_t;
constexpr Ticks ticks_per_s = 5'440'000'000;

/* Who accesses the bus. */
enum class Master { core, dma };

/* Something that happens at a time; kept by the peripheral it belongs to, at a fixed address. */
class Event
{
  public:
    explicit Event(std::function<void()> happen) : happen(std::move(happen))
    {
    }
    Event(const Event &) = delete;
    Event &operator=(const Event &) = delete;

    const std::function<void()> happen;
    Ticks at = never;

    static constexpr Ticks never = ~Ticks{0};
};

class Chip
{
  public:
    virtual ~Chip() = default;

    /* Present time: exact within an instruction's access and within an event (its own `at`). */
    virtual Ticks now() const = 0;
    /* Length of a cycle of the core and bus clock (HCLK); set by the clock tree. */
    virtual Ticks core_cycle() const = 0;
    virtual void set_core_cycle(Ticks ticks) = 0;

    /* Lets an event happen at a time not before now(); one that is scheduled already moves.
       Event::never takes it back. Events of the same time happen in the order of scheduling. */
    virtual void schedule(Event &event, Ticks at) = 0;

    /* Level of an interrupt line into the NVIC. */
    virtual void interrupt(unsigned line, bool level) = 0;
    /* Requests the non-maskable interrupt. */
    virtual void non_maskable_interrupt()
    {
        fail("a non-maskable interrupt, which this chip does not pass on");
    }

    /* The bus as a DMA channel sees it: 1, 2 or 4 bytes, memory and peripherals. */
    virtual std::uint32_t load(std::uint32_t address, unsigned bytes) = 0;
    virtual void store(std::uint32_t address, unsigned bytes, std::uint32_t value) = 0;

    /* Plain memory from an address on, for a master with many items; nullptr: load and store them
       one by one. */
    virtual std::uint8_t *plain_memory(std::uint32_t address, std::uint32_t bytes)
    {
        static_cast<void>(address);
        static_cast<void>(bytes);
        return nullptr;
    }

    /* Resets the chip after the present instruction; `cause` is given to the clock tree, which
       keeps it for the firmware. Memory keeps its contents. */
    virtual void reset(const std::string &cause) = 0;

    /* The firmware misuses the hardware: ends the run with this text, the time and the program
       counter. Throws. */
    [[noreturn]] virtual void fail(const std::string &what) const = 0;
};

/* A block of registers on the bus. Offsets are relative to its base address. */
class Peripheral
{
  public:
    virtual ~Peripheral() = default;

    /* An access of 1, 2 or 4 bytes, aligned. What the model does not know is refused by
       Chip::fail, with the peripheral's name and the register's offset. */
    virtual std::uint32_t read(std::uint32_t offset, unsigned bytes, Master master) = 0;
    virtual void write(std::uint32_t offset, unsigned bytes, std::uint32_t value,
                       Master master) = 0;
    /* As after a system reset. */
    virtual void reset() = 0;
};

/* Where a peripheral's registers lie on the bus. */
struct Mapping {
    const char *name;
    std::uint32_t base, bytes;
    Peripheral *peripheral;
};

/* A flash memory behind its controller; addresses are absolute. */
class FlashMemory
{
  public:
    virtual ~FlashMemory() = default;

    /* The whole of it; keeps its place and size. Whoever flashes an image writes here. */
    virtual std::vector<std::uint8_t> &memory() = 0;
    /* A write of the core or a DMA channel into the memory. */
    virtual void store(std::uint32_t address, unsigned size, std::uint32_t value) = 0;
    /* End of the operation that a read of this address has to wait for; now or earlier: none. */
    virtual Ticks busy_until(std::uint32_t address) const = 0;
    /* The core reads here, as data: cells that fail the memory's own check finds. */
    virtual void core_reads(std::uint32_t address, unsigned size)
    {
        static_cast<void>(address);
        static_cast<void>(size);
    }
};

/* All peripherals of a chip around its core. */
class Device
{
  public:
    virtual ~Device() = default;

    virtual std::vector<Mapping> mappings() = 0;
    virtual FlashMemory &flash() = 0;
    /* After power-on ("power-on") and after any other reset, with its cause. Calls
       Chip::set_core_cycle for the clock the chip wakes with. */
    virtual void reset(const std::string &cause) = 0;
};

} // namespace virtual_board

#endif
