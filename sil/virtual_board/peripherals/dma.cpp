#include "sil/virtual_board/peripherals/dma.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    ISR = 0x00,
    IFCR = 0x04,
    CCR = 0x08,
    CNDTR = 0x0c,
    CPAR = 0x10,
    CMAR = 0x14
};
enum : std::uint32_t { EN = 1u << 0, DIR = 1u << 4, CIRC = 1u << 5, PINC = 1u << 6 };
enum : std::uint32_t { MINC = 1u << 7 };
constexpr std::uint32_t interrupt_enables = 0xe;
constexpr std::uint32_t channel_stride = 0x14;

std::vector<Register> registers()
{
    static const char *const names[Dma::channels][4] = {
        {"CCR1", "CNDTR1", "CPAR1", "CMAR1"}, {"CCR2", "CNDTR2", "CPAR2", "CMAR2"},
        {"CCR3", "CNDTR3", "CPAR3", "CMAR3"}, {"CCR4", "CNDTR4", "CPAR4", "CMAR4"},
        {"CCR5", "CNDTR5", "CPAR5", "CMAR5"}, {"CCR6", "CNDTR6", "CPAR6", "CMAR6"},
        {"CCR7", "CNDTR7", "CPAR7", "CMAR7"}, {"CCR8", "CNDTR8", "CPAR8", "CMAR8"}};
    std::vector<Register> table = {{ISR, "ISR", 0}, {IFCR, "IFCR", 0xffffffff}};
    for (std::uint32_t i = 0; i < Dma::channels; i++) {
        const std::uint32_t at = i * channel_stride;
        table.push_back({at + CCR, names[i][0], 0x3fff});
        table.push_back({at + CNDTR, names[i][1], 0xffff});
        table.push_back({at + CPAR, names[i][2], 0xffffffff});
        table.push_back({at + CMAR, names[i][3], 0xffffffff});
    }
    return table;
}

constexpr std::uint32_t mask(unsigned bytes)
{
    return bytes == 4 ? ~0u : (1u << (8 * bytes)) - 1u;
}

unsigned interrupt_line(unsigned number, unsigned channel)
{
    if (number == 1) {
        return channel < 7 ? 11 + channel : 96;
    }
    return channel < 5 ? 56 + channel : 97 + (channel - 5);
}

} // namespace

Dma::Dma(Chip &chip, unsigned number)
    : RegisterBlock(chip, "DMA" + std::to_string(number), registers()), number_(number)
{
}

void Dma::reset()
{
    RegisterBlock::reset();
    ++changes_;
    interrupts();
}

bool Dma::enabled(unsigned channel) const
{
    return clocked() && bit(at(CCR + channel * channel_stride), 0);
}

void Dma::put(std::uint32_t offset, std::uint32_t value, Master)
{
    if (offset == IFCR) {
        std::uint32_t cleared = value;
        for (unsigned channel = 0; channel < channels; channel++) {
            cleared |= bit(value, 4 * channel) ? 0xfu << (4 * channel) : 0u;
        }
        at(ISR) &= ~cleared;
        for (unsigned channel = 0; channel < channels; channel++) {
            if (field(at(ISR), 4 * channel, 4) == 1) {
                at(ISR) &= ~(1u << (4 * channel)); /* no flag left: the global one falls */
            }
        }
        interrupts();
        return;
    }
    ++changes_;
    const unsigned channel = (offset - CCR) / channel_stride;
    const std::uint32_t base = channel * channel_stride;
    const bool on = bit(at(base + CCR), 0);
    if (offset != base + CCR) {
        require(!on, offset, value, "written while the channel is enabled");
        keep(offset, value);
        return;
    }
    const std::uint32_t free_while_on = 0xf;
    require(!on || (value & EN) == 0 || ((at(offset) ^ value) & ~free_while_on) == 0, offset, value,
            "configuration changed while the channel is enabled");
    require(field(value, 8, 2) < 3 && field(value, 10, 2) < 3, offset, value,
            "PSIZE and MSIZE: expected 0...2");
    /* Of an enabled channel the write that disables it changes nothing else of its configuration.
     */
    keep(offset, on ? (at(offset) & ~free_while_on) | (value & free_while_on) : value);
    if (!on && (value & EN) != 0) {
        require(at(base + CNDTR) != 0, offset, value, "enabled with CNDTR = 0");
        loaded_[channel] = at(base + CNDTR);
        if (on_enable) {
            on_enable(channel);
        }
    }
    interrupt(channel);
}

bool Dma::silent(unsigned channel) const
{
    const std::uint32_t forbidden = DIR | PINC | interrupt_enables;
    return (at(CCR + channel * channel_stride) & (CIRC | forbidden)) == CIRC;
}

/* Where the next item goes to or comes from. */
std::uint32_t Dma::memory_address(unsigned channel) const
{
    const std::uint32_t base = channel * channel_stride, control = at(base + CCR);
    const std::uint32_t item = loaded_[channel] - at(base + CNDTR);
    return at(base + CMAR) + ((control & MINC) != 0 ? item << field(control, 10, 2) : 0);
}

void Dma::count_item(unsigned channel)
{
    const std::uint32_t base = channel * channel_stride;
    const std::uint32_t left = --at(base + CNDTR);
    if (left == loaded_[channel] / 2) {
        flag(channel, half_flag);
    }
    if (left == 0) {
        flag(channel, whole_flag);
        if ((at(base + CCR) & CIRC) != 0) {
            at(base + CNDTR) = loaded_[channel];
        }
    }
}

bool Dma::transfer(unsigned channel, std::uint32_t *where)
{
    const std::uint32_t base = channel * channel_stride;
    const std::uint32_t control = at(base + CCR), left = at(base + CNDTR);
    if (!enabled(channel) || left == 0) {
        return false;
    }
    const unsigned peripheral_bytes = 1u << field(control, 8, 2);
    const unsigned memory_bytes = 1u << field(control, 10, 2);
    const std::uint32_t item = loaded_[channel] - left;
    const std::uint32_t peripheral =
        at(base + CPAR) + ((control & PINC) != 0 ? item * peripheral_bytes : 0);
    const std::uint32_t memory = memory_address(channel);
    if (peripheral % peripheral_bytes != 0 || memory % memory_bytes != 0) {
        refuse(base + CCR, control, "address is not aligned to the transfer size");
    }
    const bool to_peripheral = (control & DIR) != 0;
    const std::uint32_t data = to_peripheral
                                   ? chip_.load(memory, memory_bytes)
                                   : chip_.load(peripheral, peripheral_bytes) & mask(memory_bytes);
    count_item(channel); /* before the store: it may make the peripheral ask for the next item */
    if (to_peripheral) {
        chip_.store(peripheral, peripheral_bytes, data);
    } else {
        chip_.store(memory, memory_bytes, data);
    }
    if (where != nullptr) {
        *where = memory;
    }
    return true;
}

Dma::Ring::Ring(Dma &dma, unsigned channel)
    : dma_(dma), channel_(channel), address_(dma.at(channel * channel_stride + CMAR)),
      items_(dma.loaded_[channel]), left_(dma.at(channel * channel_stride + CNDTR))
{
    const std::uint32_t control = dma.at(channel * channel_stride + CCR);
    bytes_ = 1u << field(control, 10, 2);
    step_ = (control & MINC) != 0 ? bytes_ : 0;
    mask_ = mask(1u << field(control, 8, 2)) & mask(bytes_);
    if (bytes_ == 2 && mask_ == mask(2)) {
        host_ = dma.chip_.plain_memory(address_, items_ * step_ + bytes_ - step_);
    }
}

Dma::Ring::~Ring()
{
    dma_.at(channel_ * channel_stride + CNDTR) = left_;
    if (flags_ != 0) { /* which raise no interrupt: the channel is silent */
        dma_.at(ISR) |= (flags_ | 1u) << (4 * channel_);
    }
}

void Dma::flag(unsigned channel, std::uint32_t flags)
{
    at(ISR) |= (flags | 1u) << (4 * channel);
    interrupt(channel);
}

void Dma::interrupt(unsigned channel)
{
    const std::uint32_t enables = at(CCR + channel * channel_stride) & interrupt_enables;
    chip_.interrupt(interrupt_line(number_, channel),
                    (field(at(ISR), 4 * channel, 4) & enables) != 0);
}

void Dma::interrupts()
{
    for (unsigned channel = 0; channel < channels; channel++) {
        interrupt(channel);
    }
}

Dmamux::Dmamux(Chip &chip, Dma &dma1, Dma &dma2)
    : RegisterBlock(chip, "DMAMUX",
                    {{0x00, "C0CR", 0x7f},
                     {0x04, "C1CR", 0x7f},
                     {0x08, "C2CR", 0x7f},
                     {0x0c, "C3CR", 0x7f},
                     {0x10, "C4CR", 0x7f},
                     {0x14, "C5CR", 0x7f},
                     {0x18, "C6CR", 0x7f},
                     {0x1c, "C7CR", 0x7f},
                     {0x20, "C8CR", 0x7f},
                     {0x24, "C9CR", 0x7f},
                     {0x28, "C10CR", 0x7f},
                     {0x2c, "C11CR", 0x7f},
                     {0x30, "C12CR", 0x7f},
                     {0x34, "C13CR", 0x7f},
                     {0x38, "C14CR", 0x7f},
                     {0x3c, "C15CR", 0x7f},
                     {0x80, "CSR", 0},
                     {0x84, "CFR", 0xffff}}),
      dma1_(dma1), dma2_(dma2), poll_event_([this] {
          const std::vector<DmaRequest> ready = std::move(ready_);
          ready_.clear();
          for (DmaRequest source : ready) {
              polls_[source]();
          }
      })
{
    dma1_.on_enable = [this](unsigned channel) { enabled(channel); };
    dma2_.on_enable = [this](unsigned channel) { enabled(Dma::channels + channel); };
}

void Dmamux::reset()
{
    RegisterBlock::reset();
    ++changes_;
}

void Dmamux::put(std::uint32_t offset, std::uint32_t value, Master)
{
    ++changes_;
    if (offset < 0x40) {
        const unsigned index = offset / 4;
        Dma &dma = index < Dma::channels ? dma1_ : dma2_;
        require(!dma.enabled(index % Dma::channels), offset, value,
                "routing changed while the DMA channel is enabled");
        for (std::uint32_t other = 0; value != 0 && other < 0x40; other += 4) {
            require(other == offset || at(other) != value, offset, value,
                    "the request is routed to two channels");
        }
    }
    keep(offset, value);
}

void Dmamux::enabled(unsigned index)
{
    const DmaRequest source = static_cast<DmaRequest>(at(4 * index));
    if (clocked() && polls_.count(source) != 0) {
        ready_.push_back(source);
        chip_.schedule(poll_event_, chip_.now());
    }
}

Dmamux::Route Dmamux::route(DmaRequest source) const
{
    for (unsigned index = 0; clocked() && index < 2 * Dma::channels; index++) {
        if (at(4 * index) == static_cast<std::uint32_t>(source)) {
            Dma &dma = index < Dma::channels ? dma1_ : dma2_;
            const unsigned channel = index % Dma::channels;
            return dma.enabled(channel) ? Route{&dma, channel} : Route{};
        }
    }
    return {};
}

bool Dmamux::request(DmaRequest source, std::uint32_t *where)
{
    const Route found = route(source);
    return found.dma != nullptr && found.dma->transfer(found.channel, where);
}

} // namespace virtual_board
