/* ADC: triggers, sequences, timing of conversions, results. */
#include "sil/virtual_board/peripherals/adc.h"

#include "sil/virtual_board/peripherals/adc_registers.h"

namespace virtual_board
{

using namespace adc_registers;

namespace
{

/* Sampling time in half ADC clocks by SMP. */
constexpr unsigned sampling_halves[8] = {5, 13, 25, 49, 95, 185, 495, 1281};

/* Trigger numbers that the model knows: RM0440, tables of external triggers. */
bool regular_source(unsigned number, Trigger *source)
{
    switch (number) {
    case 4:
        *source = Trigger::tim3;
        return true;
    case 9:
        *source = Trigger::tim1;
        return true;
    case 10:
        *source = Trigger::tim1_2;
        return true;
    case 11:
        *source = Trigger::tim2;
        return true;
    case 12:
        *source = Trigger::tim4;
        return true;
    case 13:
        *source = Trigger::tim6;
        return true;
    case 14:
        *source = Trigger::tim15;
        return true;
    case 30:
        *source = Trigger::tim7;
        return true;
    default:
        return false;
    }
}

bool injected_source(unsigned number, Trigger *source)
{
    switch (number) {
    case 0:
        *source = Trigger::tim1;
        return true;
    case 2:
        *source = Trigger::tim2;
        return true;
    case 5:
        *source = Trigger::tim4;
        return true;
    case 8:
        *source = Trigger::tim1_2;
        return true;
    case 12:
        *source = Trigger::tim3;
        return true;
    case 14:
        *source = Trigger::tim6;
        return true;
    case 15:
        *source = Trigger::tim15;
        return true;
    case 30:
        *source = Trigger::tim7;
        return true;
    default:
        return false;
    }
}

} // namespace

/* Those that the registers choose; while one of them is none that is modelled, every trigger comes
   and is refused. */
void Adc::choose_triggers()
{
    Trigger chosen;
    injected_sources_ = regular_sources_ = 0;
    if ((at(CR) & JADSTART) != 0) {
        const bool known = injected_source(field(at(JSQR), 2, 5), &chosen);
        injected_sources_ = known ? only(chosen) : every_trigger;
    }
    if ((at(CR) & ADSTART) != 0 && field(at(CFGR), 10, 2) != 0) {
        const bool known = regular_source(field(at(CFGR), 5, 5), &chosen);
        regular_sources_ = known ? only(chosen) : every_trigger;
    }
    triggers_.choose(*listener_, injected_sources_ | regular_sources_);
}

void Adc::triggered(Trigger source, TriggerEdge edge)
{
    if (edge != TriggerEdge::rising || !clocked()) {
        return;
    }
    require(injected_sources_ != every_trigger, JSQR, at(JSQR),
            "JEXTSEL: this trigger is not modelled");
    require(regular_sources_ != every_trigger, CFGR, at(CFGR),
            "EXTSEL: this trigger is not modelled");
    if ((injected_sources_ & only(source)) != 0) {
        start_injected();
    }
    if ((regular_sources_ & only(source)) != 0) {
        start_regular();
    }
}

void Adc::start_injected()
{
    if (injected_.running) {
        counters.ignored_triggers++;
        return;
    }
    require(!regular_.running && (due_ == Event::never || deferred_until_ < chip_.now()), CR,
            at(CR), "injected trigger during a regular conversion: not modelled");
    injected_ = Sequence{};
    injected_.running = true;
    injected_.ranks = field(at(JSQR), 0, 2) + 1;
    injected_.trigger = chip_.now();
    counters.injected_sequences++;
    counters.last_injected_trigger = injected_.trigger;
    next_rank(injected_, injected_event_, injected_.trigger + common_.latency());
}

void Adc::start_regular()
{
    const Ticks now = chip_.now();
    if (regular_.running || (due_ != Event::never && now <= deferred_until_)) {
        counters.ignored_triggers++;
        require(number_ < 3, CR, at(CR),
                "trigger during the conversions of the one before: ignored, the leg voltages that "
                "follow are out of step");
        return;
    }
    require(!injected_.running, CR, at(CR),
            "regular trigger during an injected conversion: not modelled");
    counters.regular_sequences++;
    if (defer(now)) {
        return;
    }
    regular_ = Sequence{};
    regular_.running = true;
    regular_.ranks = field(at(SQR1), 0, 4) + 1;
    regular_.trigger = now;
    next_rank(regular_, regular_event_, regular_.trigger + common_.latency());
}

unsigned Adc::channel(const Sequence &sequence) const
{
    if (&sequence == &injected_) {
        return field(at(JSQR), 9 + 6 * sequence.rank, 5);
    }
    return regular_channel(sequence.rank);
}

unsigned Adc::regular_channel(unsigned rank) const
{
    const unsigned place = rank + 1; /* SQ1 stands after the length */
    return field(at(SQR1 + 4 * (place / 5)), 6 * (place % 5), 5);
}

Ticks Adc::sampling(unsigned channel) const
{
    const std::uint32_t value = at(channel < 10 ? SMPR1 : SMPR2);
    const unsigned code = field(value, 3 * (channel % 10), 3);
    const bool plus = bit(at(SMPR1), 31) && code == 0; /* 3.5 clocks instead of 2.5 */
    return Ticks{sampling_halves[code] + (plus ? 2u : 0u)} * common_.half_clock();
}

unsigned Adc::oversampling() const
{
    return bit(at(CFGR2), 0) ? 2u << field(at(CFGR2), 2, 3) : 1u;
}

unsigned Adc::oversampling_shift() const
{
    return bit(at(CFGR2), 0) ? field(at(CFGR2), 5, 4) : 0;
}

Ticks Adc::conversion_time() const
{
    const unsigned bits_halves[4] = {25, 21, 17, 13};
    return Ticks{bits_halves[field(at(CFGR), 3, 2)]} * common_.half_clock();
}

DmaRequest Adc::dma_request() const
{
    static constexpr DmaRequest requests[5] = {DmaRequest::adc1, DmaRequest::adc2, DmaRequest::adc3,
                                               DmaRequest::adc4, DmaRequest::adc5};
    return requests[number_ - 1];
}

void Adc::next_rank(Sequence &sequence, Event &event, Ticks start)
{
    const Ticks sample = sampling(channel(sequence));
    const Ticks convert = conversion_time();
    const unsigned conversions = &sequence == &regular_ ? oversampling() : 1;
    const Ticks end = start + conversions * (sample + convert);
    sequence.sampled = end - convert;
    counters.conversions += conversions;
    chip_.schedule(event, end);
}

std::uint32_t Adc::resolved(std::uint32_t code) const
{
    return (stuck_code >= 0 ? static_cast<std::uint32_t>(stuck_code) : code) >>
           (2 * field(at(CFGR), 3, 2));
}

void Adc::end_of_injected()
{
    const Conversion conversion = {number_, channel(injected_), true, injected_.trigger,
                                   injected_.sampled};
    at(JDR1 + 4 * injected_.rank) = resolved(inputs_.code(conversion));
    newest_injected_ = injected_.rank;
    if (++injected_.rank < injected_.ranks) {
        flag(JEOC);
        next_rank(injected_, injected_event_, chip_.now());
    } else {
        injected_.running = false;
        counters.last_injected_end = chip_.now();
        flag(JEOC | JEOS);
    }
}

void Adc::end_of_regular()
{
    const Conversion conversion = {number_, channel(regular_), false, regular_.trigger,
                                   regular_.sampled};
    const std::uint32_t result = regular_result(conversion);
    const bool more = ++regular_.rank < regular_.ranks;
    if (more) {
        next_rank(regular_, regular_event_, chip_.now());
    } else {
        regular_.running = false;
    }
    deliver(result, conversion);
    if (!more) {
        flag(EOS);
    }
}

/* RM0440: the shifted sum is rounded to the nearest and cut to 16 bits. */
std::uint32_t Adc::regular_result(const Conversion &conversion) const
{
    const std::uint32_t sum = resolved(inputs_.code(conversion)) * oversampling();
    const unsigned shift = oversampling_shift();
    return (shift == 0 ? sum : (sum + (1u << (shift - 1))) >> shift) & 0xffffu;
}

void Adc::deliver(std::uint32_t data, const Conversion &conversion)
{
    const bool overrun = (at(ISR) & EOC) != 0;
    if (overrun) {
        counters.overruns++;
        flag(OVR);
        if ((at(CFGR) & OVRMOD) == 0) {
            return; /* the old result stays, and with DMA all requests stop */
        }
    }
    at(DR) = data;
    flag(EOC);
    if ((at(CFGR) & DMAEN) == 0 || (at(ISR) & OVR) != 0) {
        return;
    }
    std::uint32_t address = 0;
    const unsigned reads = read_by_dma_;
    moved_by_dma_ = dmamux_.request(dma_request(), &address) && read_by_dma_ != reads;
    if (moved_by_dma_ && stuck_code < 0) {
        const StoredResult result = {number_, conversion.channel, conversion.trigger,
                                     address, oversampling(),     oversampling_shift()};
        inputs_.stored(&result, 1);
    }
}

} // namespace virtual_board
