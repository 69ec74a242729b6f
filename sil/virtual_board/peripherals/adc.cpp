#include "sil/virtual_board/peripherals/adc.h"

#include "sil/virtual_board/peripherals/adc_registers.h"

namespace virtual_board
{

using namespace adc_registers;

namespace
{

constexpr Ticks regulator_start = ticks_per_s / 1000000 * 20; /* tADCVREG_STUP, DS12288 */
constexpr Ticks calibration_clocks = 116;
constexpr Ticks ready_time = ticks_per_s / 1000000; /* tSTAB */

std::vector<Register> registers()
{
    return {{ISR, "ISR", 0, 0, 0x7ff},
            {IER, "IER", 0x7f},
            {CR, "CR", 0xf000003f & ~0x40000000u, DEEPPWD},
            {CFGR, "CFGR", 0x80201ffb, JQDIS},
            {CFGR2, "CFGR2", 0x3fd},
            {SMPR1, "SMPR1", 0xbfffffff},
            {SMPR2, "SMPR2", 0x07ffffff},
            {SQR1, "SQR1", 0x1f7df7cf},
            {SQR2, "SQR2", 0x1f7df7df},
            {SQR3, "SQR3", 0x1f7df7df},
            {SQR4, "SQR4", 0x7df},
            {DR, "DR", 0, 0, 0, true},
            {JSQR, "JSQR", 0xfbefbfff},
            {JDR1, "JDR1", 0, 0, 0, true},
            {JDR1 + 4, "JDR2", 0, 0, 0, true},
            {JDR1 + 8, "JDR3", 0, 0, 0, true},
            {JDR1 + 12, "JDR4", 0, 0, 0, true},
            {0xa0, "AWD2CR", 0},
            {0xa4, "AWD3CR", 0},
            {0xb0, "DIFSEL", 0},
            {0xb4, "CALFACT", 0x7f}};
}

} // namespace

AdcCommon::AdcCommon(Chip &chip, const char *name)
    : RegisterBlock(chip, name, {{0x00, "CSR", 0}, {0x08, "CCR", 0x01c30000 | 0x1f}})
{
}

/* CSR: an image of both ISRs, in half words. */
std::uint32_t AdcCommon::fetch(std::uint32_t offset, Master)
{
    return offset == 0x00 ? slave_flags() << 16 | master_flags() : at(offset);
}

void AdcCommon::put(std::uint32_t offset, std::uint32_t value, Master)
{
    require(!any_enabled(), offset, value, "written while an ADC of the group is enabled");
    require(field(value, 0, 5) == 0, offset, value, "DUAL: only independent mode is modelled");
    keep(offset, value);
}

Ticks AdcCommon::half_clock() const
{
    const unsigned mode = field(at(0x08), 16, 2);
    return mode == 0 ? 0 : chip_.core_cycle() * (mode == 1 ? 1u : mode == 2 ? 2u : 4u) / 2;
}

/* tLATR of DS12288 with a synchronous clock: 2, 2.25 and 2.125 ADC clocks. */
Ticks AdcCommon::latency() const
{
    const unsigned mode = field(at(0x08), 16, 2);
    return half_clock() * (mode == 1 ? 16u : mode == 2 ? 18u : 17u) / 4;
}

Adc::Adc(Chip &chip, unsigned number, AdcCommon &common, Triggers &triggers, Dmamux &dmamux,
         AnalogInputs &inputs, std::function<void(bool)> interrupt)
    : RegisterBlock(chip, "ADC" + std::to_string(number), registers()), number_(number),
      common_(common), triggers_(triggers), dmamux_(dmamux), inputs_(inputs),
      interrupt_(std::move(interrupt)), calibration_event_([this] { calibrated(); }),
      ready_event_([this] { ready(); }), injected_event_([this] { end_of_injected(); }),
      regular_event_([this] {
          if (regular_.running) {
              end_of_regular();
          } else {
              deferred_due();
          }
      })
{
    listener_ =
        &triggers.listen([this](Trigger source, TriggerEdge edge) { triggered(source, edge); });
    listener_->patient = [this](Ticks period) { return patient(period); };
    listener_->act_late = [this](Ticks first, Ticks period, unsigned count) {
        triggered_late(first, period, count);
    };
    choose_triggers();
}

void Adc::reset()
{
    triggers_.come_promptly(regular_sources_);
    RegisterBlock::reset();
    regulator_ready_ = Event::never;
    calibrated_ = ready_ = dma_stopped_ = false;
    injected_ = regular_ = Sequence{};
    deferred_.clear();
    deferred_rank_ = 0;
    due_ = Event::never;
    deferred_until_ = 0;
    plan_.clear();
    moved_by_dma_ = false;
    choose_triggers();
    for (Event *event : {&calibration_event_, &ready_event_, &injected_event_, &regular_event_}) {
        chip_.schedule(*event, Event::never);
    }
    interrupt_(false);
}

bool Adc::enabled() const
{
    return (at(CR) & (ADEN | ADCAL)) != 0;
}

std::uint32_t Adc::flags()
{
    look(Access::read);
    return at(ISR);
}

std::uint32_t Adc::fetch(std::uint32_t offset, Master master)
{
    if (master == Master::core && (offset == ISR || offset == DR)) {
        look(Access::read);
    }
    if (offset == DR) {
        read_by_dma_ += master == Master::dma ? 1u : 0u;
        at(ISR) &= ~EOC;
        if (at(IER) != 0) {
            interrupt_((at(ISR) & at(IER)) != 0);
        }
    } else if (offset >= JDR1 && offset < JDR1 + 16 && master == Master::core) {
        injected_result_read((offset - JDR1) / 4);
    }
    return at(offset);
}

/* RM0440: JEOC is cleared by reading the result that has set it, JEOS is not. */
void Adc::injected_result_read(unsigned rank)
{
    if (rank == newest_injected_) {
        at(ISR) &= ~JEOC;
        interrupt_((at(ISR) & at(IER)) != 0);
    }
    if (rank == 0) {
        inputs_.injected_result_taken(number_);
    }
}

void Adc::put(std::uint32_t offset, std::uint32_t value, Master)
{
    look(Access::write);
    const bool started = (at(CR) & (ADSTART | JADSTART)) != 0;
    switch (offset) {
    case ISR:
        at(ISR) &= ~value;
        interrupt_((at(ISR) & at(IER)) != 0);
        return;
    case IER:
        keep(offset, value);
        interrupt_((at(ISR) & at(IER)) != 0);
        return;
    case CR:
        control(value);
        return;
    case CFGR:
        require(!started, offset, value, "written while a conversion is started");
        require((value & 3u) != 1, offset, value, "DMAEN with DMACFG = 0 (one shot): not modelled");
        require(field(value, 10, 2) != 2, offset, value, "EXTEN: falling edge is not modelled");
        break;
    case CFGR2:
        require(!started, offset, value, "written while a conversion is started");
        require((value & (1u << 1)) == 0 && (value & (1u << 9)) == 0, offset, value,
                "JOVSE and TROVS are not modelled");
        break;
    case JSQR:
        require((at(CR) & JADSTART) == 0, offset, value, "written while JADSTART is set");
        require(field(value, 7, 2) <= 1, offset, value, "JEXTEN: only the rising edge is modelled");
        break;
    case DR:
    case JDR1:
    case JDR1 + 4:
    case JDR1 + 8:
    case JDR1 + 12:
        refuse(offset, value, "read only");
    default:
        require(!started, offset, value, "written while a conversion is started");
    }
    keep(offset, value);
    choose_triggers();
}

void Adc::control(std::uint32_t value)
{
    const std::uint32_t before = at(CR);
    const std::uint32_t set = value & ~before;
    require((value & (ADDIS | ADSTP | JADSTP)) == 0, CR, value,
            "ADDIS, ADSTP and JADSTP are not modelled");
    power_up(value);
    const std::uint32_t sticky = before & (ADEN | ADSTART | JADSTART | ADCAL);
    at(CR) = value | sticky;
    if ((set & ADCAL) != 0) {
        require(common_.half_clock() != 0, CR, value, "ADCAL while CKMODE chooses no HCLK clock");
        chip_.schedule(calibration_event_,
                       chip_.now() + 2 * calibration_clocks * common_.half_clock());
    }
    if ((set & ADEN) != 0) {
        require(common_.half_clock() * 2 * 60'000'000 >= ticks_per_s, CR, value,
                "ADC clock above 60 MHz");
        chip_.schedule(ready_event_, chip_.now() + ready_time);
    }
    if ((set & JADSTART) != 0) {
        if (field(at(JSQR), 7, 2) == 0) {
            at(CR) &= ~JADSTART;
            start_injected();
        }
    }
    if ((set & ADSTART) != 0 && deferred_.empty()) {
        plan_.clear();
    }
    if ((set & ADSTART) != 0 && field(at(CFGR), 10, 2) == 0) {
        start_regular();
        at(CR) &= ~ADSTART;
    }
    choose_triggers();
}

/* The order RM0440 asks for: out of deep power-down, regulator and its start-up time,
   calibration, enable, ready, start. */
void Adc::power_up(std::uint32_t value)
{
    const std::uint32_t before = at(CR), set = value & ~before;
    const Ticks now = chip_.now();
    if ((set & ADVREGEN) != 0) {
        require((value & DEEPPWD) == 0, CR, value, "ADVREGEN set in deep power-down");
        regulator_ready_ = now + regulator_start;
    }
    require((value & DEEPPWD) == 0 || (value & ADVREGEN) == 0, CR, value,
            "DEEPPWD set while the regulator is on");
    require((value & ADVREGEN) != 0 || (before & ADVREGEN) == 0, CR, value,
            "regulator switched off: not modelled");
    if ((set & (ADCAL | ADEN)) != 0) {
        require((before & ADVREGEN) != 0 && now >= regulator_ready_, CR, value,
                "before the regulator's start-up time (20 us) is over");
        require((before & ADCAL) == 0, CR, value, "while a calibration is running");
    }
    if ((set & ADCAL) != 0) {
        require((value & ADEN) == 0, CR, value, "ADCAL while enabled");
    }
    if ((set & ADEN) != 0) {
        require(calibrated_, CR, value, "ADEN before a calibration");
        require(now >= calibration_end_ + 8 * common_.half_clock(), CR, value,
                "ADEN sooner than 4 ADC clocks after the calibration");
    }
    if ((set & (ADSTART | JADSTART)) != 0) {
        require(ready_, CR, value, "started before ADRDY");
    }
}

void Adc::calibrated()
{
    at(CR) &= ~ADCAL;
    at(CALFACT) = 0x40;
    calibrated_ = true;
    calibration_end_ = chip_.now();
}

void Adc::ready()
{
    ready_ = true;
    flag(ADRDY);
}

void Adc::flag(std::uint32_t flags)
{
    at(ISR) |= flags;
    if (at(IER) != 0) {
        interrupt_((at(ISR) & at(IER)) != 0);
    }
}

} // namespace virtual_board
