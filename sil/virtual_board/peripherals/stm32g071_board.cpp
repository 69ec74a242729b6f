#include "sil/virtual_board/peripherals/stm32g071_board.h"

#include <algorithm>

namespace virtual_board
{

namespace
{

struct Wire {
    unsigned channel;
    Pin pin;
};
constexpr Wire legs_in[4] = {{4, {'A', 4}}, {7, {'A', 7}}, {8, {'B', 0}}, {9, {'B', 1}}};
/* Shunts between low sides and ground, amplifiers that do not invert. */
struct Shunt {
    Wire wire;
    int leg; /* 0...3: A+, A-, B+, B- */
};
constexpr Shunt shunts[2] = {{{0, {'A', 0}}, 1}, {{1, {'A', 1}}, 3}};
constexpr Wire bus_in = {10, {'B', 2}}, temperature_in = {11, {'B', 10}};
constexpr Pin gates[4] = {{'C', 8}, {'C', 9}, {'C', 10}, {'C', 11}}, fault = {'A', 6};
constexpr unsigned reset_pin = 13; /* of port B */
constexpr Pin brake = {'C', 6};

constexpr std::uint32_t zero_code = 2048;
constexpr int middle = 2048;
constexpr Ticks sequence = ticks_per_s / 1000000 * 5; /* a little more than it takes */

plant::Config without_delay(plant::Config config)
{
    config.bridge.delay_periods = 0;
    return config;
}

} // namespace

const ChipDescription &stm32g071_board()
{
    static const ChipDescription chip = [] {
        ChipDescription board = stm32g071();
        board.control_line = 9;
        board.fast_code = {0x20000000, 36 * 1024};
        return board;
    }();
    return chip;
}

G071Board::G071Board(Chip &chip, const plant::Config &config, double host_baud)
    : chip_(chip), numbers_(chip), rcc_(chip), flash_(chip, rcc_.tree()), pins_(chip),
      timer1_(numbers_, triggers_, [this] { return chip_.core_cycle(); }), timer1_pins_(timer1_),
      timer2_(chip, {"TIM2", Trigger::tim2, 15, true, true}, triggers_,
              [this] { return chip_.core_cycle(); }),
      timer3_(chip, {"TIM3", Trigger::tim3, 16, true, false}, triggers_,
              [this] { return chip_.core_cycle(); }),
      dma_(numbers_, 1), no_dma_(numbers_, 2), dmamux_(numbers_, dma_, no_dma_),
      dmamux_numbers_(dmamux_), adc_(chip, triggers_, dmamux_),
      lpuart_(numbers_, rcc_.tree(), dmamux_, host_baud), watchdog_(chip),
      dbg_(chip, "DBG",
           {{0x00, "IDCODE", 0, 0x20006460},
            {0x04, "CR", 0x6},
            {0x08, "APBFZ1", 0x00201c33},
            {0x0c, "APBFZ2", 0x00078800}}),
      plant_(without_delay(config))
{
    const auto clock_at = [this](std::uint32_t offset, unsigned position) {
        return [this, offset, position] { return rcc_.enabled(offset, position); };
    };
    timer1_.clocked_by(clock_at(0x40, 11));
    timer2_.clocked_by(clock_at(0x3c, 0));
    timer3_.clocked_by(clock_at(0x3c, 1));
    adc_.clocked_by(clock_at(0x40, 20));
    lpuart_.clocked_by(clock_at(0x3c, 20));
    dbg_.clocked_by(clock_at(0x3c, 27));
    dma_.clocked_by(clock_at(0x38, 0));
    dmamux_.clocked_by(clock_at(0x38, 0));
    no_dma_.clocked_by([] { return false; });
    for (const char port : {'A', 'B', 'C'}) {
        pins_.port(port).clocked_by(clock_at(0x34, static_cast<unsigned>(port - 'A')));
    }
    lpuart_.tx_routed = [this] { return pins_.routed({'A', 2}, 6); };
    lpuart_.rx_routed = [this] { return pins_.routed({'A', 3}, 6); };
    timer1_.on_peak = [this] { peak(); };
    timer1_.on_outputs_enabled = [this] { outputs_enabled(); };
    adc_.input = [this](unsigned channel) { return code(channel); };
    adc_.moved = [this](unsigned channel, std::uint32_t address) {
        for (int leg = 0; leg < legs; leg++) {
            /* The group of the peak itself is not rewritten. */
            if (legs_in[leg].channel == channel && chip_.now() - peak_at_ > sequence) {
                open_[leg].push_back(address);
            }
        }
    };
}

std::vector<Mapping> G071Board::mappings()
{
    return {
        {"RCC", 0x40021000, 0x400, &rcc_},
        {"FLASH", 0x40022000, 0x400, &flash_},
        {"GPIOA", 0x50000000, 0x400, &pins_.port('A')},
        {"GPIOB", 0x50000400, 0x400, &pins_.port('B')},
        {"GPIOC", 0x50000800, 0x400, &pins_.port('C')},
        {"TIM1", 0x40012c00, 0x400, &timer1_pins_},
        {"TIM2", 0x40000000, 0x400, &timer2_},
        {"TIM3", 0x40000400, 0x400, &timer3_},
        {"ADC1", 0x40012400, 0x400, &adc_},
        {"DMA1", 0x40020000, 0x400, &dma_},
        {"DMAMUX1", 0x40020800, 0x400, &dmamux_numbers_},
        {"LPUART1", 0x40008000, 0x400, &lpuart_},
        {"IWDG", 0x40003000, 0x400, &watchdog_},
        {"DBG", 0x40015800, 0x400, &dbg_},
    };
}

void G071Board::reset(const std::string &cause)
{
    for (const Mapping &mapping : mappings()) {
        mapping.peripheral->reset();
    }
    rcc_.record_cause(cause);
    timer1_pins_.break_pin(!tripped_);
    started_ = false;
    last_difference_[0] = last_difference_[1] = 0;
    for (auto &addresses : open_) {
        addresses.clear();
    }
}

/* The half-bridges follow their inputs while RESET is high. */
bool G071Board::bridge_on() const
{
    const Gpio &port = pins_.port('B');
    return timer1_.outputs_enabled() && port.mode(reset_pin) == 1 && port.output(reset_pin) &&
           !tripped_;
}

void G071Board::trip()
{
    tripped_ = true;
    timer1_pins_.break_pin(false);
}

void G071Board::outputs_enabled() const
{
    for (int leg = 0; leg < legs; leg++) {
        const std::string channel = "power stage: TIM1 channel " + std::to_string(leg + 1);
        if (!pins_.routed(gates[leg], 2) || timer1_.output_control(leg) != 1) {
            chip_.fail(channel + " does not drive " + text(gates[leg]) + " while MOE is set");
        }
        if (timer1_.output_mode(leg) != 6 || !timer1_.preloaded(leg)) {
            chip_.fail(channel + ": expected PWM mode 1 with preload while MOE is set");
        }
    }
    if (!pins_.routed(fault, 2)) {
        chip_.fail("power stage: MOE set while FAULT does not reach TIM1");
    }
}

void G071Board::peak()
{
    if (started_) {
        plant::Duties duties;
        for (int leg = 0; leg < legs; leg++) {
            duties.high_counts[leg] = static_cast<std::uint16_t>(
                std::min(timer1_.active_compare(leg), std::uint32_t{timer1_.half_period()}));
        }
        duties.bridge_on = bridge_on();
        duties.brake_on = pins_.port(brake.port).drives_high(brake.number);
        plant_.step(duties);
    }
    const Gpio &port = pins_.port('B');
    if (tripped_ && !(port.mode(reset_pin) == 1 && port.output(reset_pin))) {
        tripped_ = false;
        timer1_pins_.break_pin(true);
    }
    started_ = started_ || adc_.counters.sequences >= 7; /* of the first S(k) is the eighth */
    peak_at_ = chip_.now();
    counters.updates_elsewhere = timer1_.counters.updates_at_valley;
    rewrite();
    if (on_sample) {
        on_sample();
    }
}

int G071Board::difference(int phase) const
{
    const plant::Samples &samples = plant_.samples();
    return 2 * (phase == 0 ? samples.phase_voltage_a : samples.phase_voltage_b);
}

/* Seven samples of which the sum is 6 m + m_before, m the mean of the period. */
void G071Board::rewrite()
{
    for (int phase = 0; phase < 2; phase++) {
        std::vector<std::uint32_t> &plus = open_[2 * phase], &minus = open_[2 * phase + 1];
        const int mean = difference(phase);
        const int count = static_cast<int>(std::min(plus.size(), minus.size()));
        int left = 6 * mean + last_difference_[phase];
        for (int group = 0; group < count; group++) {
            const int remaining = count - group;
            const int part = left / remaining;
            const int up = middle + part / 2;
            left -= part;
            chip_.store(plus[static_cast<std::size_t>(group)], 2, static_cast<std::uint32_t>(up));
            chip_.store(minus[static_cast<std::size_t>(group)], 2,
                        static_cast<std::uint32_t>(up - part));
        }
        if (count > 0 && count != 7 && !adc_.deaf()) {
            chip_.fail("power stage: " + std::to_string(count) +
                       " groups of leg voltages before the peak; expected 7");
        }
        if (plus.size() > 7) { /* of the peak's group, converted before the peak */
            chip_.store(plus.back(), 2, static_cast<std::uint32_t>(middle + mean / 2));
        }
        last_difference_[phase] = mean;
        plus.clear();
        minus.clear();
    }
}

/* The plant knows the currents at the peak; between the last edge before it and the first behind
   it they may be taken for that. With all low sides on, a current from leg plus to leg minus comes
   up from ground through the shunt of leg plus, and goes down to it through that of leg minus. */
std::uint32_t G071Board::current(int leg)
{
    const bool phase_a = leg / 2 == 0;
    const Ticks half_us = ticks_per_s / 2000000; /* a conversion: the sample is that much older */
    const Ticks cycle = chip_.core_cycle();
    const Ticks sampled = chip_.now() - 25 * cycle;
    const bool near = chip_.now() - peak_at_ < 2 * half_us;
    if (!timer1_.all_low(sampled) || !timer1_.all_low(chip_.now())) {
        counters.outside_low_state += near ? 1 : 0;
        return zero_code;
    }
    if (near) {
        (phase_a ? counters.sampled_a_ticks : counters.sampled_b_ticks) =
            static_cast<std::int64_t>(sampled) - static_cast<std::int64_t>(peak_at_);
    }
    const plant::Samples &samples = plant_.samples();
    const int above_zero =
        (phase_a ? samples.current_a : samples.current_b) - static_cast<int>(zero_code);
    const int downwards = leg % 2 == 0 ? -above_zero : above_zero;
    return static_cast<std::uint32_t>(std::clamp(static_cast<int>(zero_code) + downwards, 0, 4095));
}

std::uint32_t G071Board::code(unsigned channel)
{
    const auto wired = [this, channel](const Wire &wire) {
        if (wire.channel == channel && !pins_.analog(wire.pin)) {
            chip_.fail("power stage: " + text(wire.pin) + " is measured while it is not analog");
        }
        return wire.channel == channel;
    };
    for (const Shunt &shunt : shunts) {
        if (wired(shunt.wire)) {
            return current(shunt.leg);
        }
    }
    if (wired(bus_in)) {
        return plant_.samples().bus_voltage;
    }
    if (wired(temperature_in)) {
        return plant_.samples().bridge_temperature;
    }
    for (int leg = 0; leg < legs; leg++) {
        if (wired(legs_in[leg])) {
            const int half = difference(leg / 2) / 2;
            return static_cast<std::uint32_t>(leg % 2 == 0 ? middle + half : middle - half);
        }
    }
    chip_.fail("ADC1 channel " + std::to_string(channel) + ": nothing is wired to it");
    return 0;
}

} // namespace virtual_board
