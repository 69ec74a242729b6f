#include "sil/virtual_board/peripherals/stm32g474_device.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    AHB1ENR = 0x48,
    AHB2ENR = 0x4c,
    APB1ENR1 = 0x58,
    APB1ENR2 = 0x5c,
    APB2ENR = 0x60
};
constexpr std::uint32_t CFGR2 = 0x1c; /* of SYSCFG */
constexpr unsigned PVDL = 2;

struct TimerPlace {
    TimerKind kind;
    std::uint32_t base, enable;
    unsigned position, bus;
};
const TimerPlace timer_places[] = {
    {{"TIM2", Trigger::tim2, 28, true, true}, 0x40000000, APB1ENR1, 0, 1},
    {{"TIM3", Trigger::tim3, 29, true, false}, 0x40000400, APB1ENR1, 1, 1},
    {{"TIM4", Trigger::tim4, 30, true, false}, 0x40000800, APB1ENR1, 2, 1},
    {{"TIM6", Trigger::tim6, 54, false, false}, 0x40001000, APB1ENR1, 4, 1},
    {{"TIM7", Trigger::tim7, 55, false, false}, 0x40001400, APB1ENR1, 5, 1},
    {{"TIM15", Trigger::tim15, -1, true, false}, 0x40014000, APB2ENR, 16, 2},
};

constexpr std::uint32_t adc_bases[5] = {0x50000000, 0x50000100, 0x50000400, 0x50000500, 0x50000600};
constexpr const char *adc_names[5] = {"ADC1", "ADC2", "ADC3", "ADC4", "ADC5"};
constexpr const char *port_names[Pins::ports] = {"GPIOA", "GPIOB", "GPIOC", "GPIOD",
                                                 "GPIOE", "GPIOF", "GPIOG"};

} // namespace

Stm32g474Device::Stm32g474Device(Chip &chip, const Stm32g474Config &config)
    : chip_(chip), pwr_(chip), rcc_(chip, pwr_, config.clock), flash_(chip, rcc_), pins_(chip),
      dma1_(chip, 1), dma2_(chip, 2), dmamux_(chip, dma1_, dma2_),
      tim1_(chip, triggers_, [this] { return rcc_.timer_clock(2); }), opamps_(chip),
      dac1_(chip, 1, rcc_), dac3_(chip, 3, rcc_), comparators_(chip, dac1_, dac3_),
      power_stage_(chip, config.power_stage, tim1_, pins_, opamps_, comparators_),
      adc12_(chip, "ADC12_COMMON"), adc345_(chip, "ADC345_COMMON"), adc12_line_(chip, 18),
      lpuart_(chip, rcc_, dmamux_, config.host_baud), fdcan_(chip, rcc_, config.can_bit_Hz),
      watchdog_(chip), syscfg_(make_syscfg(chip)), dbgmcu_(make_dbgmcu(chip))
{
    for (const TimerPlace &place : timer_places) {
        const unsigned bus = place.bus;
        timers_.push_back(std::make_unique<Timer>(chip, place.kind, triggers_,
                                                  [this, bus] { return rcc_.timer_clock(bus); }));
    }
    const unsigned lines[5] = {18, 18, 47, 61, 62};
    for (unsigned i = 0; i < 5; i++) {
        const unsigned line = lines[i];
        auto interrupt = [this, i, line](bool level) {
            if (i < 2) {
                adc12_line_.set(i, level);
            } else {
                chip_.interrupt(line, level);
            }
        };
        adcs_.push_back(std::make_unique<Adc>(chip, i + 1, i < 2 ? adc12_ : adc345_, triggers_,
                                              dmamux_, power_stage_, interrupt));
    }
    const auto look = [this](Access access) {
        for (auto &adc : adcs_) {
            adc->look(access);
        }
    };
    for (RegisterBlock *const block : std::initializer_list<RegisterBlock *>{
             &rcc_, &dma1_, &dma2_, &dmamux_, &pins_.port('B')}) {
        block->before_access(look);
    }
    for (auto &adc : adcs_) {
        power_stage_.settle_at_peaks(*adc);
    }
    adc12_.any_enabled = [this] { return adc(1).enabled() || adc(2).enabled(); };
    adc345_.any_enabled = [this] {
        return adc(3).enabled() || adc(4).enabled() || adc(5).enabled();
    };
    adc12_.master_flags = [this] { return adc(1).flags(); };
    adc12_.slave_flags = [this] { return adc(2).flags(); };
    adc345_.master_flags = [this] { return adc(3).flags(); };
    adc345_.slave_flags = [this] { return adc(4).flags(); };
    Timer &encoder = timer(Trigger::tim4);
    encoder.encoder = [this] { return power_stage_.plant().samples().encoder_count; };
    encoder.encoder_routed = [this] {
        return pins_.routed({'B', 6}, 2) && pins_.routed({'B', 7}, 2);
    };
    power_stage_.on_index = [this, &encoder](bool rising, std::int32_t count) {
        if (encoder.clocked() && pins_.routed({'B', 9}, 2)) {
            encoder.capture(4, rising, count);
        }
    };
    lpuart_.tx_routed = [this] { return pins_.routed({'A', 2}, 12); };
    lpuart_.rx_routed = [this] { return pins_.routed({'A', 3}, 12); };
    fdcan_.tx_routed = [this] { return pins_.routed({'A', 15}, 11); };
    fdcan_.rx_routed = [this] { return pins_.routed({'B', 3}, 11); };
    pwr_.on_change = [this] { rcc_.check(); };
    pwr_.on_supply = [this](bool low) {
        tim1_.system_break(low && bit(syscfg_->kept(CFGR2), PVDL));
    };
    map();
}

std::vector<Mapping> Stm32g474Device::mappings()
{
    return mappings_;
}

Timer &Stm32g474Device::timer(Trigger which)
{
    for (std::size_t i = 0; i < timers_.size(); i++) {
        if (timer_places[i].kind.output == which) {
            return *timers_[i];
        }
    }
    chip_.fail("no such timer in the model");
    return *timers_.front(); /* not reached */
}

void Stm32g474Device::add(const char *name, std::uint32_t base, std::uint32_t bytes,
                          RegisterBlock &block)
{
    mappings_.push_back({name, base, bytes, &block});
}

void Stm32g474Device::add(const char *name, std::uint32_t base, std::uint32_t bytes,
                          RegisterBlock &block, std::uint32_t enable_offset, unsigned position)
{
    add(name, base, bytes, block);
    block.clocked_by(
        [this, enable_offset, position] { return rcc_.enabled(enable_offset, position); });
    rcc_.owns(block, enable_offset, position);
}

void Stm32g474Device::map()
{
    add("RCC", 0x40021000, 0x400, rcc_);
    add("PWR", 0x40007000, 0x400, pwr_, APB1ENR1, 28);
    add("FLASH", 0x40022000, 0x400, flash_, AHB1ENR, 8);
    add("DMA1", 0x40020000, 0x400, dma1_, AHB1ENR, 0);
    add("DMA2", 0x40020400, 0x400, dma2_, AHB1ENR, 1);
    add("DMAMUX", 0x40020800, 0x400, dmamux_, AHB1ENR, 2);
    for (unsigned i = 0; i < Pins::ports; i++) {
        add(port_names[i], 0x48000000 + 0x400 * i, 0x400, pins_.port(static_cast<char>('A' + i)),
            AHB2ENR, i);
    }
    add("TIM1", 0x40012c00, 0x400, tim1_, APB2ENR, 11);
    for (std::size_t i = 0; i < timers_.size(); i++) {
        const TimerPlace &place = timer_places[i];
        add(place.kind.name, place.base, 0x400, *timers_[i], place.enable, place.position);
    }
    for (unsigned i = 0; i < 5; i++) {
        add(adc_names[i], adc_bases[i], 0x100, *adcs_[i], AHB2ENR, i < 2 ? 13 : 14);
    }
    add("ADC12_COMMON", 0x50000300, 0x100, adc12_, AHB2ENR, 13);
    add("ADC345_COMMON", 0x50000700, 0x100, adc345_, AHB2ENR, 14);
    add("DAC1", 0x50000800, 0x400, dac1_, AHB2ENR, 16);
    add("DAC3", 0x50001000, 0x400, dac3_, AHB2ENR, 18);
    add("SYSCFG", 0x40010000, 0x30, *syscfg_, APB2ENR, 0);
    add("COMP", 0x40010200, 0x100, comparators_, APB2ENR, 0);
    add("OPAMP", 0x40010300, 0x100, opamps_, APB2ENR, 0);
    add("LPUART1", 0x40008000, 0x400, lpuart_, APB1ENR2, 0);
    add("FDCAN3", 0x40006c00, 0x400, fdcan_, APB1ENR1, 25);
    mappings_.push_back({"message RAM of FDCAN3", 0x4000a400 + 2 * MessageRam::bytes_each,
                         MessageRam::bytes_each, &fdcan_.memory()});
    add("IWDG", 0x40003000, 0x400, watchdog_);
    add("DBGMCU", 0xe0042000, 0x400, *dbgmcu_);
}

void Stm32g474Device::reset(const std::string &cause)
{
    rcc_.record_cause(cause);
    for (const Mapping &mapping : mappings_) {
        if (mapping.peripheral != &rcc_) {
            mapping.peripheral->reset();
        }
    }
    rcc_.reset(); /* last: it gives the chip its clock */
    power_stage_.chip_reset();
}

} // namespace virtual_board
