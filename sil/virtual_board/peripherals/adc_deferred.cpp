/*
 * Regular results that are put off. While their sequence raises no interrupt and DMA moves them
 * round a ring, nobody can see when they come but by registers: they are formed, in their order,
 * when the core looks at one of those (Adc::look), and at the latest at the next peak, for which
 * they are (Adc::settle). So 68 results of a period cost no event each, and neither do the triggers
 * of their sequences (trigger.h). What the core finds in the ring's memory without such a look may
 * be older than on the chip.
 */
#include "sil/virtual_board/peripherals/adc.h"

#include "sil/virtual_board/peripherals/adc_registers.h"

namespace virtual_board
{

using namespace adc_registers;

namespace
{

constexpr std::size_t most_deferred = 64; /* sequences; three times those of a period */

} // namespace

/* The sequence does not change while it is started; a clock may. */
void Adc::plan()
{
    const Ticks half_clock = common_.half_clock(), latency = common_.latency();
    if (!plan_.empty() && half_clock == planned_half_clock_ && latency == planned_latency_) {
        return;
    }
    planned_half_clock_ = half_clock;
    planned_latency_ = latency;
    plan_.clear();
    known_results_ = 0;
    Ticks start = latency;
    Sequence sequence;
    sequence.ranks = field(at(SQR1), 0, 4) + 1;
    for (; sequence.rank < sequence.ranks; ++sequence.rank) {
        const unsigned channel = regular_channel(sequence.rank);
        const Ticks end = start + oversampling() * (sampling(channel) + conversion_time());
        plan_.push_back({channel, end - conversion_time(), end});
        start = end;
    }
}

/* Whether a result that comes now can be seen in registers only. */
bool Adc::silent()
{
    if (dmamux_.changes() != route_changes_) {
        route_ = dmamux_.route(dma_request());
        route_changes_ = dmamux_.changes();
        moved_by_dma_ = false;
    }
    return moved_by_dma_ && route_.dma->silent(route_.channel) && at(IER) == 0 &&
           (at(CFGR) & DMAEN) != 0 && (at(ISR) & (EOC | OVR)) == 0;
}

bool Adc::defer(Ticks trigger)
{
    if (!silent()) {
        settle(trigger - 1); /* all of them: another cannot begin before */
        return false;
    }
    if (planned_half_clock_ != common_.half_clock()) {
        settle(trigger - 1);
    }
    put_off(trigger);
    return true;
}

void Adc::put_off(Ticks trigger)
{
    if (deferred_.size() == most_deferred) {
        settle(trigger - 1);
    }
    if (deferred_.empty()) {
        plan();
        due_ = trigger + plan_.front().end;
    }
    deferred_.push_back(trigger);
    deferred_until_ = trigger + plan_.back().end;
}

/* Whether each of such triggers would be put off. What changes that is a write of the core, which
   calls `look`; one by DMA would not. */
bool Adc::patient(Ticks period)
{
    if (!clocked() || !silent() || regular_.running || (at(CR) & JADSTART) != 0) {
        return false;
    }
    plan();
    return plan_.back().end < period;
}

void Adc::triggered_late(Ticks first, Ticks period, unsigned count)
{
    counters.regular_sequences += count;
    for (; count > 0; --count, first += period) {
        put_off(first);
    }
}

/* Of a rank; the same for all sequences while the inputs stand still. */
inline std::uint32_t Adc::planned_result(std::size_t rank, Ticks trigger)
{
    if ((known_results_ >> rank & 1) == 0) {
        known_results_ |= 1u << rank;
        const Rank &planned = plan_[rank];
        results_[rank] =
            regular_result({number_, planned.channel, false, trigger, trigger + planned.sampled});
    }
    return results_[rank];
}

void Adc::forget_results()
{
    known_results_ = 0;
    inputs_changes_ = inputs_.changes();
    results_stuck_code_ = stuck_code;
}

/* Forms the results that settle is to form; `take` gets each with its rank and trigger. */
template <typename Take> void Adc::form(Ticks until, Ticks triggered_before, Take take)
{
    if (inputs_changes_ != inputs_.changes() || results_stuck_code_ != stuck_code) {
        forget_results();
    }
    const std::size_t ranks = plan_.size(), sequences = deferred_.size();
    std::size_t done = 0, at_rank = deferred_rank_;
    unsigned formed = 0;
    while (done < sequences && deferred_[done] < triggered_before) {
        const Ticks trigger = deferred_[done];
        for (; at_rank < ranks && trigger + plan_[at_rank].end <= until; ++at_rank, ++formed) {
            take(planned_result(at_rank, trigger), plan_[at_rank], trigger);
        }
        if (at_rank < ranks) {
            break;
        }
        at_rank = 0;
        done++;
    }
    if (done > 0) {
        flag(EOS);
    }
    due_ = done < sequences ? deferred_[done] + plan_[at_rank].end : Event::never;
    deferred_rank_ = at_rank;
    deferred_.erase(deferred_.begin(), deferred_.begin() + static_cast<std::ptrdiff_t>(done));
    counters.conversions += formed * oversampling();
}

void Adc::settle(Ticks until, Ticks triggered_before)
{
    triggers_.catch_up(regular_sources_, until);
    if (due_ > until) {
        return;
    }
    if (!silent()) {
        form(until, triggered_before, [this](std::uint32_t data, const Rank &rank, Ticks trigger) {
            deliver(data, {number_, rank.channel, false, trigger, trigger + rank.sampled});
        });
        return;
    }
    const unsigned factor = oversampling(), shift = oversampling_shift();
    stored_.clear();
    {
        Dma::Ring ring(*route_.dma, route_.channel); /* which never ends: it stays silent */
        std::uint32_t last = at(DR);
        form(until, triggered_before, [&](std::uint32_t data, const Rank &rank, Ticks trigger) {
            last = data;
            stored_.push_back({number_, rank.channel, trigger, ring.put(data), factor, shift});
        });
        at(DR) = last;
    }
    if (stuck_code < 0) {
        inputs_.stored(stored_.data(), stored_.size());
    }
}

/* Up to now; behind a write what is still to come does so by an event, since it may be seen in more
   than registers from now on. */
void Adc::look(Access access)
{
    if (access == Access::write) { /* of a pin's mode, for instance */
        known_results_ = 0;
    }
    if (due_ == Event::never && !triggers_.late(regular_sources_)) {
        return;
    }
    settle(chip_.now());
    if (access == Access::write) {
        triggers_.come_promptly(regular_sources_);
        if (due_ != Event::never && regular_event_.at == Event::never) {
            chip_.schedule(regular_event_, due_);
        }
    }
}

void Adc::deferred_due()
{
    settle(chip_.now());
    if (due_ != Event::never && !silent()) {
        chip_.schedule(regular_event_, due_);
    }
}

} // namespace virtual_board
