#include "sil/virtual_board/peripherals/stm32g071_blocks.h"

namespace virtual_board
{

namespace
{

enum : std::uint32_t {
    ISR = 0x00,
    IER = 0x04,
    CR = 0x08,
    CFGR1 = 0x0c,
    CFGR2 = 0x10,
    SMPR = 0x14,
    CHSELR = 0x28,
    DR = 0x40
};
enum : std::uint32_t { ADRDY = 1u << 0, EOC = 1u << 2, EOS = 1u << 3, OVR = 1u << 4 };
enum : std::uint32_t { CCRDY = 1u << 13 };
enum : std::uint32_t { ADEN = 1u << 0, ADSTART = 1u << 2, ADVREGEN = 1u << 28, ADCAL = 1u << 31 };
enum : std::uint32_t { DMAEN = 1u << 0, DMACFG = 1u << 1, OVRMOD = 1u << 12 };
enum : std::uint32_t { CHSELRMOD = 1u << 21 };

constexpr Ticks regulator_start = ticks_per_s / 1000000 * 20;
constexpr unsigned trigger_latency = 3, calibration_clocks = 82, conversion_half_clocks = 25;

/* Sampling time by SMP1, in half periods of the converter's clock. */
constexpr unsigned sampling_half_clocks[8] = {3, 7, 15, 25, 39, 79, 159, 321};

} // namespace

G071Adc::G071Adc(Chip &chip, Triggers &triggers, Dmamux &dmamux)
    : RegisterBlock(chip, "ADC1",
                    {{ISR, "ISR", 0, 0, 0xffffffff},
                     {IER, "IER", 0},
                     {CR, "CR", ADVREGEN | ADEN, 0, ADCAL | ADSTART},
                     {CFGR1, "CFGR1", DMAEN | DMACFG | 0x1c0 | 0xc00 | OVRMOD | CHSELRMOD},
                     {CFGR2, "CFGR2", 0xc0000000},
                     {SMPR, "SMPR", 0x7},
                     {CHSELR, "CHSELR", 0xffffffff},
                     {DR, "DR", 0, 0, 0, true}}),
      dmamux_(dmamux), end_([this] { converted(); })
{
    triggers.listen([this](Trigger source, TriggerEdge edge) { triggered(source, edge); });
}

void G071Adc::reset()
{
    RegisterBlock::reset();
    busy_ = calibrated_ = deaf_ = false;
    regulator_ready_ = ready_at_ = Event::never;
    calibration_end_ = 0;
    counters = {};
    chip_.schedule(end_, Event::never);
}

Ticks G071Adc::clock() const
{
    static const unsigned divider[4] = {0, 2, 4, 1};
    return chip_.core_cycle() * divider[at(CFGR2) >> 30];
}

Ticks G071Adc::conversion() const
{
    return clock() * (sampling_half_clocks[at(SMPR) & 7u] + conversion_half_clocks) / 2;
}

std::uint32_t G071Adc::fetch(std::uint32_t offset, Master)
{
    const Ticks now = chip_.now();
    if (offset == CR) {
        return (at(CR) & ~ADCAL) | (now < calibration_end_ ? ADCAL : 0u);
    }
    if (offset == ISR) {
        return at(ISR) | (now >= ready_at_ ? ADRDY : 0u);
    }
    if (offset == DR) {
        at(ISR) &= ~EOC;
    }
    return at(offset);
}

void G071Adc::put(std::uint32_t offset, std::uint32_t value, Master)
{
    if (offset == CR) {
        control(value);
        return;
    }
    if (offset == ISR) {
        at(ISR) &= ~value;
        return;
    }
    require((at(CR) & ADSTART) == 0, offset, value, "written while ADSTART is set");
    if (offset == CFGR2) {
        require((at(CR) & ADEN) == 0, offset, value, "CKMODE changed while ADEN is set");
        require(value >> 30 != 0, offset, value, "CKMODE: the asynchronous clock is not modelled");
    }
    if (offset == CFGR1) {
        require(field(value, 6, 3) == 3, offset, value, "EXTSEL: only TIM3 TRGO is modelled");
        require(field(value, 10, 2) == 1, offset, value, "EXTEN: only the rising edge is modelled");
        at(ISR) |= ((at(CFGR1) ^ value) & CHSELRMOD) != 0 ? CCRDY : 0u;
    }
    if (offset == CHSELR) {
        require((at(CFGR1) & CHSELRMOD) != 0, offset, value, "CHSELRMOD = 0 is not modelled");
        at(ISR) |= CCRDY;
    }
    keep(offset, value);
}

void G071Adc::control(std::uint32_t value)
{
    const Ticks now = chip_.now();
    const std::uint32_t rising = value & ~at(CR);
    if ((rising & ADVREGEN) != 0) {
        regulator_ready_ = now + regulator_start;
    }
    if ((value & ADCAL) != 0) {
        require((value & ADEN) == 0 && now >= regulator_ready_, CR, value,
                "ADCAL before the regulator is ready, or while ADEN is set");
        calibration_end_ = now + calibration_clocks * clock();
        calibrated_ = true;
    }
    if ((rising & ADEN) != 0) {
        require(calibrated_ && now >= calibration_end_, CR, value,
                "ADEN while the converter is not calibrated");
        const double frequency_Hz = static_cast<double>(ticks_per_s) / static_cast<double>(clock());
        require(frequency_Hz <= 35e6, CR, value, "the converter's clock is above 35 MHz");
        ready_at_ = now + 2 * clock();
    }
    if ((value & ADSTART) != 0 && (at(CR) & ADSTART) == 0) {
        require(now >= ready_at_, CR, value, "ADSTART before ADRDY");
        at(CR) |= ADSTART;
        rank_ = 0;
    }
    at(CR) = (at(CR) & ADSTART) | (value & (ADVREGEN | ADEN));
}

void G071Adc::triggered(Trigger source, TriggerEdge edge)
{
    if (source != Trigger::tim3 || edge != TriggerEdge::rising || !clocked() ||
        (at(CR) & ADSTART) == 0 || deaf_) {
        return;
    }
    if (busy_) {
        counters.missed_triggers++;
        chip_.fail("ADC1: triggered while its sequence runs");
    }
    busy_ = true;
    rank_ = 0;
    chip_.schedule(end_, chip_.now() + trigger_latency * clock() + conversion());
}

void G071Adc::converted()
{
    const unsigned channel = field(at(CHSELR), 4 * rank_, 4);
    if ((at(ISR) & EOC) != 0) {
        at(ISR) |= OVR;
        counters.overruns++;
        chip_.fail("ADC1: overrun, the DMA has not taken the last result");
    }
    at(DR) = input(channel);
    at(ISR) |= EOC;
    std::uint32_t address = 0;
    if ((at(CFGR1) & DMAEN) != 0 && dmamux_.request(DmaRequest::adc1, &address) && moved) {
        moved(channel, address);
    }
    rank_++;
    if (rank_ == 8 || field(at(CHSELR), 4 * rank_, 4) == 15) {
        at(ISR) |= EOS;
        busy_ = false;
        counters.sequences++;
    } else {
        chip_.schedule(end_, chip_.now() + conversion());
    }
}

} // namespace virtual_board
