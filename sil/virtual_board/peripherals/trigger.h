/* Trigger outputs of timers, and interrupt lines that several sources share. */
#ifndef STEADYSTEP_VIRTUAL_BOARD_TRIGGER_H
#define STEADYSTEP_VIRTUAL_BOARD_TRIGGER_H

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

class Triggers
{
  public:
    struct Listener {
        std::function<void(Trigger, TriggerEdge)> act;
        unsigned sources = every_trigger; /* a bit each; it is called for these only; see choose */
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

  private:
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
