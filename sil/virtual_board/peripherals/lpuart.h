/*
 * LPUART1 and the host at its other end: 8 data bits, no parity, 1 stop bit, no FIFO. A byte takes
 * ten bit times. RM0440, chapter LPUART.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_LPUART_H
#define STEADYSTEP_VIRTUAL_BOARD_LPUART_H

#include <deque>

#include "sil/virtual_board/peripherals/clock_tree.h"
#include "sil/virtual_board/peripherals/dma.h"

namespace virtual_board
{

class Lpuart : public RegisterBlock
{
  public:
    static constexpr unsigned interrupt_line = 91;

    Lpuart(Chip &chip, const Rcc &rcc, Dmamux &dmamux, double host_baud);

    void reset() override;

    /* Host side: bytes whose first start bit is not earlier than `at`; what the firmware sent. */
    void send(Ticks at, const std::string &bytes);
    std::function<void(std::uint8_t byte, Ticks end)> received_by_host;
    std::string take_output()
    {
        return std::exchange(output_, {});
    }
    Ticks byte_time() const; /* with the divider in force */
    std::function<bool()> tx_routed, rx_routed;

    struct Counters {
        std::uint64_t sent = 0, received = 0, overruns = 0;
        Ticks last_receive = 0;
    };
    Counters counters;

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    void control_1(std::uint32_t value);
    double bit_s() const;
    void check_baud() const;
    void feed_transmitter();
    void shifted_out();
    void schedule_receive();
    void shifted_in();
    void interrupt();

    struct Incoming {
        Ticks start;
        std::uint8_t byte;
    };

    const Rcc &rcc_;
    Dmamux &dmamux_;
    double host_baud_;
    std::deque<Incoming> incoming_;
    Ticks host_free_ = 0;
    bool receiving_ = false, transmitting_ = false, data_waiting_ = false;
    std::uint8_t shift_out_ = 0;
    std::string output_;
    Event transmit_event_, receive_event_;
};

} // namespace virtual_board

#endif
