#include "sil/virtual_board/peripherals/fdcan.h"

#include <cmath>
#include <cstring>

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    CCCR = 0x18,
    NBTP = 0x1c,
    ECR = 0x40,
    PSR = 0x44,
    IR = 0x50,
    IE = 0x54,
    ILE = 0x5c,
    RXGFC = 0x80,
    RXF0S = 0x90,
    RXF0A = 0x94,
    TXFQS = 0xc4,
    TXBRP = 0xc8,
    TXBAR = 0xcc
};
enum : std::uint32_t { INIT = 1u << 0, CCE = 1u << 1 };
enum : std::uint32_t {
    RF0N = 1u << 0,
    RF0F = 1u << 1,
    RF0L = 1u << 2,
    TC = 1u << 7,
    TFE = 1u << 9,
    EP = 1u << 17,
    EW = 1u << 18,
    BO = 1u << 19
};

/* In the message RAM. */
enum : std::uint32_t { rx_fifo_0 = 0xb0, tx_buffers = 0x278, element_bytes = 72 };

constexpr unsigned frame_bits = 47; /* without data and stuff bits, 3 of intermission in it */
constexpr unsigned error_bits = 20; /* error flags and their delimiter, suspended transmission */
constexpr unsigned recovery_bits = 1419; /* 129 times 11 */
constexpr unsigned warning = 96, passive = 128, beyond = 256;
constexpr double rate_tolerance = 0.005;
constexpr std::size_t most_waiting = 256;

} // namespace

MessageRam::MessageRam(Chip &chip, Clocked clocked) : chip_(chip), clocked_(std::move(clocked))
{
    words_.fill(0xa5a5a5a5);
}

void MessageRam::check(std::uint32_t offset, unsigned bytes) const
{
    if (bytes != 4) {
        chip_.fail("message RAM of FDCAN3: access of " + std::to_string(bytes) +
                   " bytes at offset " + hexadecimal(offset) + "; expected the whole word");
    }
    if (!clocked_()) {
        chip_.fail("message RAM of FDCAN3: access while its clock is off (RCC enable bit)");
    }
}

std::uint32_t MessageRam::read(std::uint32_t offset, unsigned bytes, Master)
{
    check(offset, bytes);
    return at(offset);
}

void MessageRam::write(std::uint32_t offset, unsigned bytes, std::uint32_t value, Master)
{
    check(offset, bytes);
    at(offset) = value;
}

Fdcan::Fdcan(Chip &chip, const Rcc &rcc, double bus_bit_Hz)
    : RegisterBlock(chip, "FDCAN3",
                    {{CCCR, "CCCR", INIT | CCE, INIT},
                     {NBTP, "NBTP", 0xffffff7f, 0x06000a03},
                     {ECR, "ECR", 0},
                     {PSR, "PSR", 0, 0x707},
                     {IR, "IR", 0, 0, 0xffffff},
                     {IE, "IE", 0xffffff},
                     {ILE, "ILE", 0x1},
                     {RXGFC, "RXGFC", 0x1f003f},
                     {RXF0S, "RXF0S", 0},
                     {RXF0A, "RXF0A", 0x7},
                     {TXFQS, "TXFQS", 0},
                     {TXBRP, "TXBRP", 0},
                     {TXBAR, "TXBAR", 0x7}}),
      rcc_(rcc), memory_(chip, [this] { return clocked(); }), bus_bit_Hz_(bus_bit_Hz),
      frame_event_([this] { end(); }), recovery_event_([this] { recover(); })
{
}

/* The bus goes on with the frame that another node is sending. */
void Fdcan::reset()
{
    RegisterBlock::reset();
    errors_ = 0;
    off_ = false;
    chip_.schedule(recovery_event_, Event::never);
    forget();
    interrupt();
}

void Fdcan::forget()
{
    at(TXBRP) = 0;
    rx_get_ = rx_fill_ = tx_get_ = tx_put_ = 0;
    rx_lost_ = false;
    sends_ = sends_ == Sender::own ? Sender::nobody_any_more : sends_;
}

bool Fdcan::on_bus() const
{
    return clocked() && (at(CCCR) & INIT) == 0 && !off_;
}

double Fdcan::bit_Hz() const
{
    const double kernel = rcc_.pclk_Hz(1); /* FDCANSEL is checked */
    const double quanta = 3.0 + field(at(NBTP), 8, 8) + field(at(NBTP), 0, 7);
    return kernel / ((field(at(NBTP), 16, 9) + 1.0) * quanta);
}

double Fdcan::sample_point() const
{
    const double before = 2.0 + field(at(NBTP), 8, 8);
    return before / (before + 1.0 + field(at(NBTP), 0, 7));
}

Ticks Fdcan::bits(unsigned count) const
{
    return static_cast<Ticks>(count / bus_bit_Hz_ * static_cast<double>(ticks_per_s) + 0.5);
}

void Fdcan::check_timing() const
{
    require(rcc_.fdcan_source() == 2, CCCR, at(CCCR), "kernel clock: only PCLK1 is modelled");
    if (std::fabs(bit_Hz() / bus_bit_Hz_ - 1.0) > rate_tolerance) {
        refuse(NBTP, at(NBTP),
               "gives " + std::to_string(bit_Hz()) + " bit/s; the bus has " +
                   std::to_string(bus_bit_Hz_) + ": error frames");
    }
    require(sample_point() >= 0.75 && sample_point() <= 0.875, NBTP, at(NBTP),
            "the sample point is not at 75...87.5 %");
    require(field(at(NBTP), 25, 7) <= field(at(NBTP), 0, 7), NBTP, at(NBTP),
            "the jump is wider than segment 2");
    require(!tx_routed || tx_routed(), CCCR, at(CCCR), "TX is routed to no pin");
    require(!rx_routed || rx_routed(), CCCR, at(CCCR), "RX is routed to no pin");
}

/* ---- registers ---- */

std::uint32_t Fdcan::fetch(std::uint32_t offset, Master)
{
    switch (offset) {
    case ECR:
        return errors_ < beyond ? errors_ : 255;
    case PSR:
        return (off_ ? 1u << 7 : 0u) | (errors_ >= warning ? 1u << 6 : 0u) |
               (errors_ >= passive ? 1u << 5 : 0u) | 0x700u | 7u;
    case RXF0S:
        return rx_fill_ | rx_get_ << 8 | (rx_get_ + rx_fill_) % elements << 16 |
               (rx_fill_ == elements ? 1u << 24 : 0u) | (rx_lost_ ? 1u << 25 : 0u);
    case TXFQS: {
        unsigned free = 0;
        for (unsigned i = 0; i < elements; i++) {
            free += bit(at(TXBRP), i) ? 0 : 1;
        }
        return free | tx_get_ << 8 | tx_put_ << 16 | (free == 0 ? 1u << 21 : 0u);
    }
    default:
        return at(offset);
    }
}

void Fdcan::put(std::uint32_t offset, std::uint32_t value, Master)
{
    switch (offset) {
    case CCCR:
        control(value);
        break;
    case NBTP:
    case RXGFC:
        require((at(CCCR) & CCE) != 0, offset, value, "written while CCE is 0: protected");
        keep(offset, value);
        break;
    case IR:
        at(IR) &= ~value;
        rx_lost_ = rx_lost_ && (value & RF0L) == 0;
        break;
    case IE:
    case ILE:
        keep(offset, value);
        break;
    case RXF0A:
        require(rx_fill_ > 0 && value == rx_get_, offset, value,
                "acknowledges what is not the oldest frame of the FIFO");
        rx_get_ = (rx_get_ + 1) % elements;
        rx_fill_--;
        break;
    case TXBAR:
        require((at(CCCR) & INIT) == 0 || off_, offset, value, "a request while INIT is 1");
        require(value == 1u << tx_put_ && (at(TXBRP) & value) == 0, offset, value,
                "requests another buffer than the next one of the FIFO");
        at(TXBRP) |= value;
        tx_put_ = (tx_put_ + 1) % elements;
        begin();
        break;
    default:
        refuse(offset, value, "read only");
    }
    interrupt();
}

void Fdcan::control(std::uint32_t value)
{
    const bool was_out = (at(CCCR) & INIT) != 0;
    require((value & CCE) == 0 || was_out, CCCR, value, "CCE set while INIT is 0");
    if ((value & INIT) == 0) {
        value &= ~std::uint32_t{CCE};
    }
    if ((value & ~at(CCCR) & CCE) != 0) {
        forget();
    }
    keep(CCCR, value);
    if (was_out && (value & INIT) == 0) {
        check_timing();
        if (off_) {
            chip_.schedule(recovery_event_, chip_.now() + bits(recovery_bits));
        }
        begin();
    } else if (!was_out && (value & INIT) != 0) {
        chip_.schedule(recovery_event_, Event::never);
    }
}

/* ---- the bus ---- */

bool Fdcan::send(const can_frame &frame)
{
    if (incoming_.size() >= most_waiting) {
        return false;
    }
    incoming_.push_back(frame);
    begin();
    return true;
}

void Fdcan::acknowledge(bool acknowledges)
{
    acknowledged_ = acknowledges;
}

can_frame Fdcan::own_frame()
{
    const std::uint32_t element = tx_buffers + tx_get_ * element_bytes;
    const std::uint32_t id = memory_.at(element), control = memory_.at(element + 4);
    require((id & 0xe003ffff) == 0, TXBAR, id,
            "T0: only data frames of 11-bit identifiers are modelled");
    require((control & ~(15u << 16)) == 0 && field(control, 16, 4) <= 8, TXBAR, control,
            "T1: only 0...8 bytes of CAN 2.0 are modelled");
    can_frame frame = {static_cast<std::uint16_t>(field(id, 18, 11)),
                       static_cast<std::uint8_t>(field(control, 16, 4)),
                       {}};
    for (unsigned i = 0; i < frame.length; i++) {
        frame.data[i] =
            static_cast<std::uint8_t>(memory_.at(element + 8 + i / 4 * 4) >> 8 * (i % 4));
    }
    return frame;
}

/* Who has the lower identifier goes first. */
void Fdcan::begin()
{
    const bool ours = on_bus() && at(TXBRP) != 0, theirs = !incoming_.empty();
    if (sends_ != Sender::nobody || (!ours && !theirs)) {
        return;
    }
    const bool own = ours && (!theirs || own_frame().id <= incoming_.front().id);
    const unsigned length = own ? own_frame().length : incoming_.front().length;
    const bool fails = own && (disturbed_ > 0 || !acknowledged_);
    sends_ = own ? Sender::own : Sender::other;
    chip_.schedule(frame_event_,
                   chip_.now() + bits(frame_bits + 8 * length + (fails ? error_bits : 0)));
}

void Fdcan::end()
{
    const Sender sent = std::exchange(sends_, Sender::nobody);
    if (sent == Sender::own) {
        end_own();
    } else if (sent == Sender::other) {
        const can_frame frame = incoming_.front();
        incoming_.pop_front();
        if (on_bus()) {
            receive(frame);
        }
    }
    begin();
    interrupt();
}

void Fdcan::end_own()
{
    if (disturbed_ > 0) {
        disturbed_--;
        error();
        return;
    }
    if (!acknowledged_) {
        if (errors_ < passive) { /* who is passive already counts no missing acknowledgement */
            error();
        }
        return;
    }
    output_.push_back(own_frame());
    counters.sent++;
    errors_ -= errors_ > 0 ? 1 : 0;
    at(TXBRP) &= ~(1u << tx_get_);
    tx_get_ = (tx_get_ + 1) % elements;
    raise(TC | (at(TXBRP) == 0 ? TFE : 0u));
}

void Fdcan::error()
{
    const unsigned before = errors_;
    counters.errors++;
    errors_ += 8;
    raise((before < warning && errors_ >= warning ? EW : 0u) |
          (before < passive && errors_ >= passive ? EP : 0u));
    if (errors_ >= beyond) {
        counters.bus_offs++;
        off_ = true;
        at(CCCR) |= INIT;
        raise(BO);
    }
}

void Fdcan::recover()
{
    off_ = false;
    errors_ = 0;
    raise(BO);
    begin();
    interrupt();
}

/* ---- reception ---- */

bool Fdcan::passes(std::uint32_t id)
{
    for (std::uint32_t i = 0; i < field(at(RXGFC), 16, 5); i++) {
        const std::uint32_t filter = memory_.at(4 * i);
        const std::uint32_t first = field(filter, 16, 11), second = field(filter, 0, 11);
        const unsigned into = field(filter, 27, 3);
        bool matches = false;
        switch (filter >> 30) {
        case 0:
            matches = id >= first && id <= second;
            break;
        case 1:
            matches = id == first || id == second;
            break;
        case 2:
            matches = (id & second) == (first & second);
            break;
        default:
            break;
        }
        if (into != 0 && matches) {
            require(into == 1 || into == 3, RXGFC, filter,
                    "filter: only RX FIFO 0 and rejection are modelled");
            return into == 1;
        }
    }
    require(field(at(RXGFC), 4, 2) != 1, RXGFC, at(RXGFC), "RX FIFO 1 is not modelled");
    return field(at(RXGFC), 4, 2) == 0;
}

void Fdcan::receive(const can_frame &frame)
{
    if (!passes(frame.id)) {
        counters.filtered++;
        return;
    }
    if (rx_fill_ == elements) {
        counters.lost++;
        rx_lost_ = true;
        raise(RF0L);
        return;
    }
    const std::uint32_t element = rx_fifo_0 + (rx_get_ + rx_fill_) % elements * element_bytes;
    memory_.at(element) = std::uint32_t{frame.id} << 18;
    memory_.at(element + 4) = std::uint32_t{frame.length} << 16;
    std::memcpy(&memory_.at(element + 8), frame.data, sizeof frame.data);
    counters.received++;
    rx_fill_++;
    raise(RF0N | (rx_fill_ == elements ? RF0F : 0u));
}

void Fdcan::raise(std::uint32_t flags)
{
    at(IR) |= flags;
}

void Fdcan::interrupt()
{
    const bool level = bit(at(ILE), 0) && (at(IR) & at(IE)) != 0;
    chip_.interrupt(interrupt_line, clocked() && level);
}

} // namespace virtual_board
