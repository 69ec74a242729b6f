/*
 * Trigger outputs of timers, and interrupt lines that several sources share.
 *
 * Pulses at regular times may come late: while all that listen allow it, their source does not
 * hand them on one by one but when somebody asks (catch_up), with their times.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_TRIGGER_H
#define STEADYSTEP_VIRTUAL_BOARD_TRIGGER_H

#include <algorithm>
#include <array>
#include <functional>
#include <list>
#include <vector>

#include "sil/virtual_board/chip.h"

namespace virtual_board
{

enum class Trigger { tim1, tim1_2, tim2, tim3, tim4, tim6, tim7, tim15, count };
enum class TriggerEdge { rising, falling };

constexpr unsigned every_trigger = (1u << static_cast<unsigned>(Trigger::count)) - 1;
constexpr unsigned only(Trigger source)
{
    return 1u << static_cast<unsigned>(source);
}

/* A source whose pulses come late. */
class LatePulses
{
  public:
    virtual ~LatePulses() = default;
    /* Hands on those up to a time. */
    virtual void catch_up(Ticks until) = 0;
    /* Hands on those up to now; the others come at their time. */
    virtual void come_promptly() = 0;
};

class Triggers
{
  public:
    struct Listener {
        std::function<void(Trigger, TriggerEdge)> act;
        unsigned sources = every_trigger; /* a bit each; it is called for these only; see choose */
        /* Whether pulses with this period may come late; empty: never. If that ends, by a write of
           the core, the listener calls come_promptly before. */
        std::function<bool(Ticks period)> patient = nullptr;
        std::function<void(Ticks first, Ticks period, unsigned count)> act_late = nullptr;
    };
    /* The listener stays where it is: its owner narrows it down as its registers choose. */
    Listener &listen(std::function<void(Trigger, TriggerEdge)> act)
    {
        listeners_.push_back({std::move(act)});
        sort();
        return listeners_.back();
    }
    void choose(Listener &listener, unsigned sources)
    {
        if (listener.sources != sources) {
            come_promptly(listener.sources | sources);
            listener.sources = sources;
            sort();
        }
    }
    /* Nothing that listens acts on a falling edge: registers that ask for it are refused. */
    void edge(Trigger source, TriggerEdge edge)
    {
        if (edge == TriggerEdge::falling) {
            return;
        }
        const auto &listening = by_source_[static_cast<std::size_t>(source)];
        for (std::size_t i = 0; i < listening.size(); ++i) {
            listening[i]->act(source, edge);
        }
    }
    void pulse(Trigger source)
    {
        edge(source, TriggerEdge::rising);
        edge(source, TriggerEdge::falling);
    }

    /* Whether all that listen to a source allow this, and somebody does. */
    bool all_patient(Trigger source, Ticks period) const
    {
        const auto &listening = by_source_[static_cast<std::size_t>(source)];
        return !listening.empty() &&
               std::all_of(listening.begin(), listening.end(), [&](const Listener *listener) {
                   return listener->patient && listener->patient(period);
               });
    }
    void begin_late(Trigger source, LatePulses &pulses)
    {
        late_[static_cast<std::size_t>(source)] = &pulses;
        late_sources_ |= only(source);
    }
    void end_late(Trigger source)
    {
        late_sources_ &= ~only(source);
    }
    void hand_on_late(Trigger source, Ticks first, Ticks period, unsigned count)
    {
        for (const Listener *const listener : by_source_[static_cast<std::size_t>(source)]) {
            listener->act_late(first, period, count);
        }
    }
    /* Whether pulses of one of these sources come late. */
    bool late(unsigned sources) const
    {
        return (late_sources_ & sources) != 0;
    }
    void catch_up(unsigned sources, Ticks until)
    {
        each_late(sources, [until](LatePulses &pulses) { pulses.catch_up(until); });
    }
    void come_promptly(unsigned sources)
    {
        each_late(sources, [](LatePulses &pulses) { pulses.come_promptly(); });
    }

  private:
    template <typename Call> void each_late(unsigned sources, Call call)
    {
        while ((sources & late_sources_) != 0) {
            const auto first = static_cast<unsigned>(__builtin_ctz(sources & late_sources_));
            sources &= ~(1u << first);
            call(*late_[first]);
        }
    }
    void sort()
    {
        for (std::size_t source = 0; source < by_source_.size(); ++source) {
            by_source_[source].clear();
            for (Listener &listener : listeners_) {
                if ((listener.sources >> source & 1u) != 0) {
                    by_source_[source].push_back(&listener);
                }
            }
        }
    }

    std::list<Listener> listeners_; /* their addresses are given away */
    std::array<std::vector<Listener *>, static_cast<std::size_t>(Trigger::count)> by_source_;
    std::array<LatePulses *, static_cast<std::size_t>(Trigger::count)> late_ = {};
    unsigned late_sources_ = 0; /* a bit each */
};

/* Several peripherals on one line of the NVIC: the line is high while one of them is. */
class SharedLine
{
  public:
    SharedLine(Chip &chip, unsigned line) : chip_(chip), line_(line)
    {
    }
    void set(unsigned source, bool level)
    {
        const unsigned mask = 1u << source;
        levels_ = level ? levels_ | mask : levels_ & ~mask;
        chip_.interrupt(line_, levels_ != 0);
    }

  private:
    Chip &chip_;
    unsigned line_;
    unsigned levels_ = 0;
};

} // namespace virtual_board

#endif
