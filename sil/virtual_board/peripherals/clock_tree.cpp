#include "sil/virtual_board/peripherals/clock_tree.h"

#include <cmath>

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    CR = 0x00,
    ICSCR = 0x04,
    CFGR = 0x08,
    PLLCFGR = 0x0c,
    CIER = 0x18,
    CIFR = 0x1c,
    CICR = 0x20,
    AHB1RSTR = 0x28,
    APB2RSTR = 0x40,
    CCIPR = 0x88,
    BDCR = 0x90,
    CSR = 0x94
};
enum : std::uint32_t { HSION = 1u << 8, HSIRDY = 1u << 10, HSEON = 1u << 16, HSERDY = 1u << 17 };
enum : std::uint32_t { PLLON = 1u << 24, PLLRDY = 1u << 25, RMVF = 1u << 23 };

/* Start-up times of DS12288, the longest ones. */
constexpr double hse_start_s = 2e-3, hsi_start_s = 4e-6, pll_lock_s = 40e-6, lsi_start_s = 80e-6;

Ticks ticks(double seconds)
{
    return static_cast<Ticks>(std::floor(seconds * static_cast<double>(ticks_per_s) + 0.5));
}

unsigned ahb_divider(std::uint32_t cfgr)
{
    static const unsigned divider[8] = {2, 4, 8, 16, 64, 128, 256, 512};
    const unsigned code = field(cfgr, 4, 4);
    return code < 8 ? 1 : divider[code - 8];
}

unsigned apb_divider(std::uint32_t cfgr, unsigned bus)
{
    const unsigned code = field(cfgr, bus == 1 ? 8 : 11, 3);
    return code < 4 ? 1 : 2u << (code - 4);
}

const std::vector<Register> rcc_registers = {
    {CR, "CR", HSION | (1u << 9) | HSEON | (3u << 18) | PLLON, 0x500, HSIRDY | HSERDY | PLLRDY},
    {ICSCR, "ICSCR", 0x7f000000, 0x40000000, 0x00ff0000},
    {CFGR, "CFGR", 0x3ff3, 0x5, 0xc},
    {PLLCFGR, "PLLCFGR", 0xfb737ff3 | 0x8000, 0x1000},
    {CIER, "CIER", 0, 0},
    {CIFR, "CIFR", 0, 0},
    {CICR, "CICR", 0, 0, 0x73b},
    {0x28, "AHB1RSTR", 0x111f},
    {0x2c, "AHB2RSTR", 0x050f607f},
    {0x30, "AHB3RSTR", 0x101},
    {0x38, "APB1RSTR1", 0xd2fec13f},
    {0x3c, "APB1RSTR2", 0x103},
    {0x40, "APB2RSTR", 0x0437f801},
    {0x48, "AHB1ENR", 0x111f, 0x100},
    {0x4c, "AHB2ENR", 0x050f607f},
    {0x50, "AHB3ENR", 0x101},
    {0x58, "APB1ENR1", 0xd2fecd3f, 0x400},
    {0x5c, "APB1ENR2", 0x103},
    {0x60, "APB2ENR", 0x0437f801},
    {0x68, "AHB1SMENR", 0x130f | 0x1010, 0x131f},
    {0x6c, "AHB2SMENR", 0x050f667f, 0x050f667f},
    {0x70, "AHB3SMENR", 0x101, 0x101},
    {0x78, "APB1SMENR1", 0xd2fecd3f, 0xd2fecd3f},
    {0x7c, "APB1SMENR2", 0x103, 0x103},
    {0x80, "APB2SMENR", 0x0437f801, 0x0437f801},
    {CCIPR, "CCIPR", 0xf3000c00},
    {BDCR, "BDCR", 0},
    {CSR, "CSR", 0x1, 0x0c000000, 0xfe800002},
};

} // namespace

Rcc::Rcc(Chip &chip, const Pwr &pwr, const ClockConfig &config)
    : RegisterBlock(chip, "RCC", rcc_registers), pwr_(pwr), config_(config)
{
    record_cause("power-on");
}

void Rcc::reset()
{
    RegisterBlock::reset();
    ready_hsi_ = 0;
    ready_hse_ = ready_pll_ = ready_lsi_ = Event::never;
    wait_states = 0;
    hclk_Hz_ = 16e6;
    apply();
}

void Rcc::record_cause(const std::string &cause)
{
    /* Every reset of the chip pulls the reset pin too. */
    const std::uint32_t pin = 1u << 26;
    causes_ = cause == "power-on" ? 0u : causes_; /* it forgets what was before */
    causes_ |= cause == "power-on"   ? pin | (1u << 27)
               : cause == "software" ? pin | (1u << 28)
               : cause == "watchdog" ? pin | (1u << 29)
                                     : pin;
}

void Rcc::owns(Peripheral &block, std::uint32_t enable_offset, unsigned position)
{
    owned_.push_back({&block, enable_offset - 0x20, position});
}

std::uint32_t Rcc::fetch(std::uint32_t offset, Master)
{
    const Ticks now = chip_.now();
    std::uint32_t value = at(offset);
    switch (offset) {
    case CR:
        value &= ~(HSIRDY | HSERDY | PLLRDY);
        value |= now >= ready_hsi_ ? HSIRDY : 0u;
        value |= now >= ready_hse_ ? HSERDY : 0u;
        value |= now >= ready_pll_ ? PLLRDY : 0u;
        return value;
    case CFGR:
        return (value & ~0xcu) | (value & 3u) << 2;
    case CSR:
        return (value & 1u) | causes_ | (now >= ready_lsi_ ? 2u : 0u);
    default:
        return value;
    }
}

void Rcc::put(std::uint32_t offset, std::uint32_t value, Master)
{
    if (offset == CR) {
        control(value);
    } else if (offset == CFGR) {
        configure(value);
    } else if (offset == PLLCFGR) {
        pll_configuration(value);
    } else if (offset == CSR) {
        if (bit(value, 0) != bit(at(CSR), 0)) {
            ready_lsi_ = bit(value, 0) ? chip_.now() + ticks(lsi_start_s) : Event::never;
        }
        keep(offset, value);
        if ((value & RMVF) != 0) {
            causes_ = 0;
        }
    } else {
        keep(offset, value);
        if (offset >= AHB1RSTR && offset <= APB2RSTR) {
            for (const Owned &owned : owned_) {
                if (owned.offset == offset && bit(value, owned.position)) {
                    owned.block->reset();
                }
            }
        } else if (offset == CCIPR && on_clock) {
            on_clock();
        }
    }
}

void Rcc::control(std::uint32_t value)
{
    const std::uint32_t before = at(CR);
    const unsigned used = at(CFGR) & 3u;
    const bool pll_uses_hse = (at(PLLCFGR) & 3u) == 3;
    const bool hse_used = used == 2 || ((before & PLLON) != 0 && pll_uses_hse);
    const bool hsi_used = used == 1 || ((before & PLLON) != 0 && !pll_uses_hse);
    require((value & HSEON) != 0 || !hse_used, CR, value, "HSE switched off while it is used");
    require((value & HSION) != 0 || !hsi_used, CR, value, "HSI16 switched off while it is used");
    require((value & PLLON) != 0 || used != 3, CR, value, "PLL switched off while it is SYSCLK");
    keep(CR, value);
    const Ticks now = chip_.now();
    const std::uint32_t on = value & ~before, off = before & ~value;
    if ((on & HSION) != 0) {
        ready_hsi_ = now + ticks(hsi_start_s);
    }
    if ((on & HSEON) != 0) {
        ready_hse_ = config_.crystal_starts ? now + ticks(hse_start_s) : Event::never;
    }
    if ((on & PLLON) != 0) {
        const unsigned source = at(PLLCFGR) & 3u;
        require(source == 2 ? now >= ready_hsi_ : source == 3 && now >= ready_hse_, CR, value,
                "PLLON while the PLL's source is not ready or not chosen");
        const double input = source_Hz(source - 1) / (field(at(PLLCFGR), 4, 4) + 1);
        const double vco = input * field(at(PLLCFGR), 8, 7);
        require(field(at(PLLCFGR), 8, 7) >= 8, CR, value, "PLLN: expected 8...127");
        require(input >= 2.66e6 && input <= 16e6, CR, value, "PLL input: expected 2.66...16 MHz");
        require(vco >= 96e6 && vco <= 344e6, CR, value, "PLL VCO: expected 96...344 MHz");
        ready_pll_ = now + ticks(pll_lock_s);
    }
    ready_hsi_ = (off & HSION) != 0 ? Event::never : ready_hsi_;
    ready_hse_ = (off & HSEON) != 0 ? Event::never : ready_hse_;
    ready_pll_ = (off & PLLON) != 0 ? Event::never : ready_pll_;
}

void Rcc::pll_configuration(std::uint32_t value)
{
    const std::uint32_t outputs = (1u << 16) | (1u << 20) | (1u << 24);
    require((at(CR) & PLLON) == 0 || ((at(PLLCFGR) ^ value) & ~outputs) == 0, PLLCFGR, value,
            "written while the PLL is on");
    keep(PLLCFGR, value);
}

void Rcc::configure(std::uint32_t value)
{
    const Ticks now = chip_.now();
    const unsigned before = at(CFGR) & 3u, source = value & 3u;
    const double sysclk_before = source_Hz(before);
    const unsigned divided_before = ahb_divider(at(CFGR));
    if (source != before) {
        const Ticks ready = source == 1 ? ready_hsi_ : source == 2 ? ready_hse_ : ready_pll_;
        require(source != 0 && now >= ready, CFGR, value, "SW: the source is not ready");
        require(source != 3 || bit(at(PLLCFGR), 24), CFGR, value, "SW = PLL while PLLREN is 0");
    }
    keep(CFGR, value);
    const double sysclk = source_Hz(source);
    const unsigned divided = ahb_divider(value);
    if (sysclk > 80e6 && sysclk_before <= 80e6) {
        require(divided >= 2, CFGR, value,
                "SYSCLK raised above 80 MHz in one step; divide AHB by 2 for 1 us first");
        fast_since_ = now;
    } else if (divided < divided_before && sysclk > 80e6) {
        require(now - fast_since_ >= ticks(1e-6), CFGR, value,
                "AHB restored earlier than 1 us after SYSCLK was raised");
    }
    apply();
}

void Rcc::apply()
{
    hclk_Hz_ = sysclk_Hz() / ahb_divider(at(CFGR));
    const double exact = static_cast<double>(ticks_per_s) / hclk_Hz_;
    const double rounded = std::floor(exact + 0.5);
    if (std::fabs(exact - rounded) > 1e-9 * exact) {
        refuse(CFGR, at(CFGR), "HCLK is no whole number of the model's ticks: not modelled");
    }
    check();
    chip_.set_core_cycle(static_cast<Ticks>(rounded));
    for (unsigned bus : {1u, 2u}) {
        const unsigned divider = apb_divider(at(CFGR), bus);
        timer_clocks_[bus - 1] = static_cast<Ticks>(rounded) * (divider == 1 ? 1 : divider / 2);
    }
    if (on_clock) {
        on_clock();
    }
}

void Rcc::check()
{
    const double limit = pwr_.boost() ? 170e6 : pwr_.range_1() ? 150e6 : 26e6;
    if (hclk_Hz_ > limit) {
        refuse(CFGR, at(CFGR), "HCLK above what the supply range allows (boost: PWR CR5 R1MODE)");
    }
    /* One wait state per step; range 2 has three steps only. */
    const double step = pwr_.boost() ? 34e6 : pwr_.range_1() ? 30e6 : 12e6;
    const double top = pwr_.range_1() ? 1e12 : 26e6;
    if (hclk_Hz_ > std::fmin(step * (wait_states + 1), top)) {
        refuse(CFGR, at(CFGR),
               "FLASH_ACR LATENCY = " + std::to_string(wait_states) + " is too short for HCLK");
    }
}

double Rcc::source_Hz(unsigned source) const
{
    return source == 1 ? 16e6 : source == 2 ? config_.crystal_Hz : pll_Hz();
}

double Rcc::pll_Hz() const
{
    const std::uint32_t value = at(PLLCFGR);
    const double input = (value & 3u) == 3 ? config_.crystal_Hz : 16e6;
    return input * field(value, 8, 7) /
           ((field(value, 4, 4) + 1) * 2.0 * (field(value, 25, 2) + 1));
}

double Rcc::sysclk_Hz() const
{
    return source_Hz(at(CFGR) & 3u);
}

double Rcc::pclk_Hz(unsigned bus) const
{
    return hclk_Hz_ / apb_divider(at(CFGR), bus);
}

} // namespace virtual_board
