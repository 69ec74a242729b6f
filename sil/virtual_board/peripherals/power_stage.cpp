#include "sil/virtual_board/peripherals/power_stage.h"

#include <algorithm>
#include <cmath>

namespace virtual_board
{

namespace
{

constexpr Ticks comparator_delay = ticks_per_s / 1000000000 * 30; /* tD of DS12288, at most */

/* Comparators by the leg whose shunt they watch: COMP1 A-, COMP2 B-, COMP3 A+, COMP4 B+. */
struct Watch {
    unsigned index;
    int leg;
    Pin pin;
};
constexpr Watch watches[4] = {
    {0, 1, {'A', 1}}, {1, 3, {'A', 7}}, {2, 0, {'A', 0}}, {3, 2, {'B', 0}}};

struct LegInput {
    unsigned adc, channel;
    Pin pin;
};
constexpr LegInput leg_inputs[PowerStage::legs] = {
    {3, 1, {'B', 1}}, {3, 5, {'B', 13}}, {4, 3, {'B', 12}}, {4, 4, {'B', 14}}};

/* Switch of the brake resistor, on while high. */
constexpr Pin brake = {'C', 6};

/* Leg by converter and channel; below 0: none. */
constexpr int leg_of(unsigned adc, unsigned channel)
{
    for (int leg = 0; leg < PowerStage::legs; leg++) {
        if (leg_inputs[leg].adc == adc && leg_inputs[leg].channel == channel) {
            return leg;
        }
    }
    return -1;
}

plant::Config without_delay(plant::Config config)
{
    config.bridge.delay_periods = 0;
    return config;
}

std::uint32_t scaled(std::uint32_t code, unsigned factor, unsigned shift)
{
    const std::uint32_t sum = code * factor;
    return shift == 0 ? sum : (sum + (1u << (shift - 1))) >> shift;
}

} // namespace

PowerStage::PowerStage(Chip &chip, const PowerStageConfig &config, AdvancedTimer &timer,
                       const Pins &pins, const Opamps &opamps, Comparators &comparators)
    : chip_(chip), config_(config), plant_(without_delay(config.plant)), timer_(timer), pins_(pins),
      opamps_(opamps), comparators_(comparators), comparator_event_([this] {
          for (unsigned i = 0; i < Comparators::count; i++) {
              timer_.comparator(i, bit(outputs_, i));
          }
      }),
      short_event_([this] {
          shorted_leg_ = next_short_leg_;
          compare();
      })
{
    timer_.on_peak = [this] { peak(); };
    timer_.on_outputs_enabled = [this] { outputs_enabled(); };
}

void PowerStage::peak()
{
    const Ticks before = chip_.now() - 1;
    for (Adc *const adc : converters_) {
        adc->settle(before, last_peak_);
    }
    if (started_) {
        plant::Duties duties;
        for (int leg = 0; leg < legs; leg++) {
            duties.high_counts[leg] = static_cast<std::uint16_t>(
                std::min(timer_.active_compare(leg), std::uint32_t{timer_.half_period()}));
        }
        duties.bridge_on = bridge_on();
        duties.brake_on = pins_.port(brake.port).drives_high(brake.number);
        plant_.step(duties);
        period_++;
        const plant::Samples &samples = plant_.samples();
        if (samples.index_rise.passed && on_index) {
            on_index(true, samples.index_rise.count);
        }
        if (samples.index_fall.passed && on_index) {
            on_index(false, samples.index_fall.count);
        }
    }
    changes_++;
    if (!bridge_on()) {
        shorted_leg_ = -1;
    }
    rewrite(); /* what the core has looked at, before what is younger */
    settling_ = true;
    for (Adc *const adc : converters_) {
        adc->settle(before);
    }
    settling_ = false;
    last_peak_ = chip_.now();
    counters.groups = groups_;
    groups_ = 0;
    compare();
    if (on_sample) {
        on_sample(period());
    }
}

void PowerStage::chip_reset()
{
    started_ = false;
    period_ = 0;
    open_.clear();
    outputs_ = 0;
    chip_.schedule(comparator_event_, Event::never);
}

void PowerStage::injected_result_taken(unsigned adc)
{
    started_ = started_ || adc == 1;
}

void PowerStage::rewrite()
{
    const std::uint32_t codes[legs] = {leg_code(0), leg_code(1), leg_code(2), leg_code(3)};
    for (const StoredResult &result : open_) {
        const std::uint32_t code = codes[leg_of(result.adc, result.channel)];
        chip_.store(result.address, 2, scaled(code, result.factor, result.shift));
    }
    open_.clear();
}

/* A positive phase current leaves leg +, enters leg - and flows through the shunt of - into ground:
   this shunt is amplified. Each comparator trips on current into ground. */
void PowerStage::compare()
{
    const plant::State &state = plant_.state();
    const double currents[legs] = {-state.i_a_A, state.i_a_A, -state.i_b_A, state.i_b_A};
    unsigned outputs = 0;
    for (const Watch &watch : watches) {
        if (!comparators_.enabled(watch.index)) {
            continue;
        }
        require_analog(watch.pin);
        if (comparators_.second_input(watch.index)) {
            chip_.fail("COMP" + std::to_string(watch.index + 1) +
                       ": INPSEL chooses a pin without a shunt");
        }
        const double current = watch.leg == shorted_leg_ ? short_A_ : currents[watch.leg];
        const double code = (config_.current_zero_code + current / config_.current_A_per_code) /
                            config_.amplifier_gain;
        outputs |= comparators_.compare(watch.index, code) ? 1u << watch.index : 0u;
    }
    if ((outputs & ~outputs_) != 0) {
        counters.last_trip = chip_.now();
    }
    outputs_ = outputs;
    chip_.schedule(comparator_event_, chip_.now() + comparator_delay);
}

void PowerStage::short_circuit(Ticks at, int leg, double current_A)
{
    next_short_leg_ = leg;
    short_A_ = current_A;
    chip_.schedule(short_event_, at);
}

void PowerStage::require_analog(Pin pin) const
{
    if (!pins_.analog(pin)) {
        chip_.fail("power stage: " + text(pin) + " is measured while its pin is not analog");
    }
}

/* Half the bus and the phase's code on either side of it; the middle gives way at the ends of the
   range so that the difference always is twice the code. */
std::uint32_t PowerStage::leg_code(int leg) const
{
    const plant::Samples &samples = plant_.samples();
    const int phase = leg < 2 ? samples.phase_voltage_a : samples.phase_voltage_b;
    const int size = std::min(std::abs(phase), 2047);
    const int middle =
        std::clamp(config_.leg_bias_code + samples.bus_voltage / 2, size, 4095 - size);
    return static_cast<std::uint32_t>(
        std::clamp(leg % 2 == 0 ? middle + phase : middle - phase, 0, 4095));
}

std::uint32_t PowerStage::current_code(const Conversion &conversion)
{
    const unsigned gain = opamps_.gain(conversion.adc);
    if (gain != config_.amplifier_gain) {
        chip_.fail("OPAMP" + std::to_string(conversion.adc) + ": gain " + std::to_string(gain) +
                   "; the shunts are made for " + std::to_string(config_.amplifier_gain));
    }
    require_analog(conversion.adc == 1 ? Pin{'A', 1} : Pin{'A', 7});
    const auto from_peak = [this](Ticks time) {
        const auto half = static_cast<std::int64_t>(timer_.half_period() * timer_.count_ticks());
        return static_cast<std::int64_t>(timer_.phase_ticks(time)) - half;
    };
    if (!timer_.all_low(conversion.trigger) || !timer_.all_low(conversion.sampled)) {
        counters.outside_low_state++;
        return config_.current_zero_code;
    }
    counters.trigger_from_peak = from_peak(conversion.trigger);
    counters.sample_from_peak = from_peak(conversion.sampled);
    if (counters.sample_from_peak < 0) {
        chip_.fail("ADC" + std::to_string(conversion.adc) +
                   ": the current is sampled before the peak: the model knows it at the peak only");
    }
    const plant::Samples &samples = plant_.samples();
    return conversion.adc == 1 ? samples.current_a : samples.current_b;
}

std::uint32_t PowerStage::code(const Conversion &conversion)
{
    const unsigned adc = conversion.adc, channel = conversion.channel;
    if ((adc == 1 && channel == 13) || (adc == 2 && channel == 16)) {
        return current_code(conversion);
    }
    if (adc == 1 && channel == 14) {
        require_analog({'B', 11});
        return std::min<std::uint32_t>(plant_.samples().bus_voltage, 4095);
    }
    if (adc == 2 && channel == 5) {
        require_analog({'C', 4});
        return plant_.samples().bridge_temperature;
    }
    const int leg = leg_of(adc, channel);
    if (leg < 0) {
        chip_.fail("ADC" + std::to_string(adc) + " channel " + std::to_string(channel) +
                   ": nothing is wired to it");
    }
    require_analog(leg_inputs[leg].pin);
    return leg_code(leg);
}

void PowerStage::stored(const StoredResult *results, std::size_t count)
{
    for (const StoredResult *result = results; result < results + count; ++result) {
        if (leg_of(result->adc, result->channel) < 0) {
            continue;
        }
        if (result->trigger >= last_peak_) {
            if (!settling_) {
                open_.push_back(*result);
            }
            groups_++;
        } else {
            counters.groups++; /* began before the peak */
        }
    }
}

} // namespace virtual_board
