/*
 * FDCAN3, its part of the message RAM, and the bus behind its transceiver, on which another node
 * sends, hears and acknowledges. CAN 2.0, data frames of 11-bit identifiers, standard filters, RX
 * FIFO 0, TX FIFO. A frame takes 47 bits and those of its data: stuff bits are left out, so the bus
 * carries more than a real one. RM0440, chapter FDCAN.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_FDCAN_H
#define STEADYSTEP_VIRTUAL_BOARD_FDCAN_H

#include <array>
#include <deque>
#include <vector>

#include "hal/hal.h"
#include "sil/virtual_board/peripherals/clock_tree.h"

namespace virtual_board
{

/* 212 words, whole words alone; their content survives a reset, and is anything after power-on. */
class MessageRam : public Peripheral
{
  public:
    static constexpr std::uint32_t bytes_each = 0x350;

    MessageRam(Chip &chip, Clocked clocked);

    std::uint32_t read(std::uint32_t offset, unsigned bytes, Master master) override;
    void write(std::uint32_t offset, unsigned bytes, std::uint32_t value, Master master) override;
    void reset() override
    {
    }
    std::uint32_t &at(std::uint32_t offset)
    {
        return words_[offset / 4];
    }

  private:
    void check(std::uint32_t offset, unsigned bytes) const;

    Chip &chip_;
    Clocked clocked_;
    std::array<std::uint32_t, bytes_each / 4> words_;
};

class Fdcan : public RegisterBlock
{
  public:
    static constexpr unsigned interrupt_line = 88;

    Fdcan(Chip &chip, const Rcc &rcc, double bus_bit_Hz);

    void reset() override;
    MessageRam &memory()
    {
        return memory_;
    }

    /* The other node: sends this as soon as the bus is free and it wins. false: too many wait. */
    bool send(const can_frame &frame);
    std::size_t waiting() const
    {
        return incoming_.size();
    }
    /* What it has heard of this one since the last call. */
    std::vector<can_frame> take_output()
    {
        return std::exchange(output_, {});
    }
    /* Whether there is another node: one that acknowledges. */
    void acknowledge(bool acknowledges);
    /* So many frames of this node end in a bit error; what it is out of by then stays so. */
    void disturb(unsigned frames)
    {
        disturbed_ = frames;
    }
    std::function<bool()> tx_routed, rx_routed;

    struct Counters {
        std::uint64_t sent = 0, received = 0, filtered = 0, lost = 0, errors = 0, bus_offs = 0;
    };
    Counters counters;

    /* As the registers have it. */
    double bit_Hz() const;
    double sample_point() const;

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    static constexpr unsigned elements = 3;

    bool on_bus() const;
    Ticks bits(unsigned count) const;
    void control(std::uint32_t value);
    void forget();
    void check_timing() const;
    void begin();
    void end();
    void end_own();
    void receive(const can_frame &frame);
    bool passes(std::uint32_t id);
    can_frame own_frame();
    void error();
    void recover();
    void raise(std::uint32_t flags);
    void interrupt();

    const Rcc &rcc_;
    MessageRam memory_;
    double bus_bit_Hz_;
    std::deque<can_frame> incoming_;
    std::vector<can_frame> output_;
    enum class Sender { nobody, other, own, nobody_any_more };
    Sender sends_ = Sender::nobody; /* on the bus */
    bool acknowledged_ = true;
    unsigned disturbed_ = 0;
    unsigned rx_get_ = 0, rx_fill_ = 0, tx_get_ = 0, tx_put_ = 0, errors_ = 0 /* TEC */;
    bool rx_lost_ = false, off_ = false;
    Event frame_event_, recovery_event_;
};

} // namespace virtual_board

#endif
