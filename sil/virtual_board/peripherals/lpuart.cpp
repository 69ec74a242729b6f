#include "sil/virtual_board/peripherals/lpuart.h"

#include <cmath>

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    CR1 = 0x00,
    CR2 = 0x04,
    CR3 = 0x08,
    BRR = 0x0c,
    RQR = 0x18,
    ISR = 0x1c,
    ICR = 0x20,
    RDR = 0x24,
    TDR = 0x28,
    PRESC = 0x2c
};
enum : std::uint32_t { UE = 1u << 0, RE = 1u << 2, TE = 1u << 3 };
enum : std::uint32_t {
    ORE = 1u << 3,
    IDLE = 1u << 4,
    RXNE = 1u << 5,
    TC = 1u << 6,
    TXE = 1u << 7,
    CMF = 1u << 17,
    TEACK = 1u << 21,
    REACK = 1u << 22
};
enum : std::uint32_t { EIE = 1u << 0, DMAR = 1u << 6, DMAT = 1u << 7, OVRDIS = 1u << 12 };

constexpr double baud_tolerance = 0.025; /* 8N1 with one start bit: about +-4.5 % in all, halved */

} // namespace

Lpuart::Lpuart(Chip &chip, const Rcc &rcc, Dmamux &dmamux, double host_baud)
    : RegisterBlock(chip, "LPUART1",
                    {{CR1, "CR1", 0x40fd},
                     {CR2, "CR2", 0xff000010},
                     {CR3, "CR3", 0x10c1},
                     {BRR, "BRR", 0xfffff},
                     {RQR, "RQR", 0x8},
                     {ISR, "ISR", 0, TC | TXE},
                     {ICR, "ICR", 0, 0, 0x121bdf},
                     {RDR, "RDR", 0, 0, 0, true},
                     {TDR, "TDR", 0x1ff, 0, 0, true},
                     {PRESC, "PRESC", 0xf}}),
      rcc_(rcc), dmamux_(dmamux), host_baud_(host_baud), transmit_event_([this] { shifted_out(); }),
      receive_event_([this] { shifted_in(); })
{
    dmamux_.on_ready(DmaRequest::lpuart1_tx, [this] { feed_transmitter(); });
}

void Lpuart::reset()
{
    RegisterBlock::reset();
    transmitting_ = data_waiting_ = false;
    chip_.schedule(transmit_event_, Event::never);
    interrupt();
}

double Lpuart::bit_s() const
{
    static const unsigned dividers[12] = {1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256};
    const double clocks[4] = {rcc_.pclk_Hz(1), rcc_.sysclk_Hz(), rcc_.hsi_Hz(), 32768.0};
    const double kernel = clocks[rcc_.lpuart_source()] / dividers[at(PRESC) & 15u];
    return at(BRR) / (256.0 * kernel);
}

Ticks Lpuart::byte_time() const
{
    return static_cast<Ticks>(10 * bit_s() * static_cast<double>(ticks_per_s) + 0.5);
}

void Lpuart::check_baud() const
{
    const double baud = 1.0 / bit_s();
    if (std::fabs(baud / host_baud_ - 1.0) > baud_tolerance) {
        refuse(BRR, at(BRR),
               "gives " + std::to_string(baud) + " baud; the host has " +
                   std::to_string(host_baud_) + ": framing errors");
    }
}

std::uint32_t Lpuart::fetch(std::uint32_t offset, Master)
{
    if (offset == ISR) {
        const std::uint32_t enables = at(CR1);
        const bool on = (enables & UE) != 0;
        return at(ISR) | (on && (enables & TE) != 0 ? TEACK : 0u) |
               (on && (enables & RE) != 0 ? REACK : 0u) | (receiving_ ? 1u << 16 : 0u);
    }
    if (offset == RDR) {
        at(ISR) &= ~RXNE;
        interrupt();
    }
    return at(offset);
}

void Lpuart::put(std::uint32_t offset, std::uint32_t value, Master)
{
    const bool on = (at(CR1) & UE) != 0;
    switch (offset) {
    case CR1:
        control_1(value);
        return;
    case CR2:
    case BRR:
    case PRESC:
        require(!on || offset == CR2, offset, value, "written while UE is set");
        require(!on || ((at(CR2) ^ value) & 0xff000010u) == 0 || (at(CR1) & RE) == 0, offset, value,
                "ADD changed while the receiver is on");
        require(offset != BRR || value >= 0x300, offset, value, "expected 0x300 or more");
        require(offset != PRESC || value <= 11, offset, value, "expected 0...11");
        keep(offset, value);
        return;
    case CR3:
        require(!on || ((at(CR3) ^ value) & OVRDIS) == 0, offset, value,
                "OVRDIS changed while UE is set");
        keep(offset, value);
        feed_transmitter();
        break;
    case RQR:
        at(ISR) &= ~RXNE;
        break;
    case ICR:
        at(ISR) &= ~(value & (0x12121fu | TC));
        break;
    case TDR:
        require(on && (at(CR1) & TE) != 0, offset, value, "written while the transmitter is off");
        require((at(ISR) & TXE) != 0, offset, value, "written while TXE is 0: a byte is lost");
        keep(offset, value);
        at(ISR) &= ~(TXE | TC);
        data_waiting_ = true;
        feed_transmitter();
        break;
    default:
        refuse(offset, value, "read only");
    }
    interrupt();
}

void Lpuart::control_1(std::uint32_t value)
{
    const bool was = (at(CR1) & UE) != 0;
    keep(CR1, value);
    if (!was && (value & UE) != 0) {
        require(at(BRR) >= 0x300, CR1, value, "UE set while BRR is below 0x300");
        check_baud();
    }
    if ((value & UE) != 0) {
        require((value & TE) == 0 || !tx_routed || tx_routed(), CR1, value,
                "TE while TX is routed to no pin of the virtual port");
        require((value & RE) == 0 || !rx_routed || rx_routed(), CR1, value,
                "RE while RX is routed to no pin of the virtual port");
    }
    feed_transmitter();
    schedule_receive();
    interrupt();
}

/* Moves TDR into the shift register, and asks the DMA for the next byte. */
void Lpuart::feed_transmitter()
{
    if ((at(CR1) & (UE | TE)) != (UE | TE)) {
        return;
    }
    if (data_waiting_ && !transmitting_) {
        data_waiting_ = false;
        transmitting_ = true;
        shift_out_ = static_cast<std::uint8_t>(at(TDR));
        at(ISR) |= TXE;
        chip_.schedule(transmit_event_, chip_.now() + byte_time());
    }
    if ((at(CR3) & DMAT) != 0 && (at(ISR) & TXE) != 0) {
        dmamux_.request(DmaRequest::lpuart1_tx); /* its write to TDR comes back here */
    }
    interrupt();
}

void Lpuart::shifted_out()
{
    counters.sent++;
    output_ += static_cast<char>(shift_out_);
    transmitting_ = false;
    if (received_by_host) {
        received_by_host(shift_out_, chip_.now());
    }
    if (!data_waiting_) {
        at(ISR) |= TC;
    }
    feed_transmitter();
}

void Lpuart::send(Ticks at, const std::string &bytes)
{
    const Ticks length =
        static_cast<Ticks>(10.0 / host_baud_ * static_cast<double>(ticks_per_s) + 0.5);
    host_free_ = at > host_free_ ? at : host_free_;
    for (const char byte : bytes) {
        incoming_.push_back({host_free_, static_cast<std::uint8_t>(byte)});
        host_free_ += length;
    }
    schedule_receive();
}

/* The host's bytes come at its own speed, whether the receiver is on or not. */
void Lpuart::schedule_receive()
{
    if (receiving_ || incoming_.empty()) {
        return;
    }
    receiving_ = true;
    const Ticks end =
        incoming_.front().start +
        static_cast<Ticks>(10.0 / host_baud_ * static_cast<double>(ticks_per_s) + 0.5);
    chip_.schedule(receive_event_, end > chip_.now() ? end : chip_.now());
}

void Lpuart::shifted_in()
{
    const std::uint8_t byte = incoming_.front().byte;
    incoming_.pop_front();
    receiving_ = false;
    if (clocked() && (at(CR1) & (UE | RE)) == (UE | RE)) {
        if ((at(ISR) & RXNE) != 0) {
            counters.overruns++;
            at(ISR) |= (at(CR3) & OVRDIS) != 0 ? 0u : ORE;
        }
        if ((at(ISR) & RXNE) == 0 || (at(CR3) & OVRDIS) != 0) {
            at(RDR) = byte;
            at(ISR) |= RXNE;
            counters.received++;
            counters.last_receive = chip_.now();
            if ((at(CR3) & DMAR) != 0) {
                dmamux_.request(DmaRequest::lpuart1_rx);
            }
        }
        if (byte == field(at(CR2), 24, 8)) {
            at(ISR) |= CMF;
        }
        if (incoming_.empty() || incoming_.front().start > chip_.now()) {
            at(ISR) |= IDLE;
        }
        interrupt();
    }
    schedule_receive();
}

void Lpuart::interrupt()
{
    const std::uint32_t flags = at(ISR), enables = at(CR1);
    const std::uint32_t same_bits = IDLE | RXNE | TC | TXE; /* flag and enable at one position */
    bool level = (flags & enables & same_bits) != 0;
    level = level || ((flags & CMF) != 0 && bit(enables, 14));
    level = level || ((flags & ORE) != 0 && ((enables & RXNE) != 0 || (at(CR3) & EIE) != 0));
    chip_.interrupt(interrupt_line, clocked() && level);
}

} // namespace virtual_board
