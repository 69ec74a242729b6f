/*
 * TIM1 in centre-aligned mode: up/down counting computed from time, repetition counter, preload
 * and active registers, six compare channels, TRGO and TRGO2, dead time, break. RM0440, chapter
 * "Advanced-control timers".
 *
 * Phase is the number of counts since the counter left 0 upwards: count = phase up to ARR (the
 * peak), 2 ARR - phase after it. PWM mode 1 is high in phases 0...CCR and 2 ARR - CCR...2 ARR.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_ADVANCED_TIMER_H
#define STEADYSTEP_VIRTUAL_BOARD_ADVANCED_TIMER_H

#include <array>

#include "sil/virtual_board/peripherals/register_block.h"
#include "sil/virtual_board/peripherals/trigger.h"

namespace virtual_board
{

/* Dead time in periods of the dead-time clock from the DTG field of BDTR. */
unsigned dead_time_clocks(unsigned dtg);

class AdvancedTimer : public RegisterBlock
{
  public:
    static constexpr int channels = 6, legs = 4;
    static constexpr unsigned line_break = 24, line_update = 25, line_compare = 27;

    AdvancedTimer(Chip &chip, Triggers &triggers, std::function<Ticks()> clock);

    void reset() override;

    /* Called at each counter peak, before the update event that the peak may cause. */
    std::function<void()> on_peak;
    /* Called when MOE has been set, with the outputs as configured: may refuse. */
    std::function<void()> on_outputs_enabled;

    bool outputs_enabled() const /* MOE */
    {
        return bit(at(0x44), 15);
    }
    bool counting() const
    {
        return bit(at(0x00), 0);
    }
    unsigned half_period() const
    {
        return reload_;
    }
    /* Compare in force of channel 0...5 */
    std::uint32_t active_compare(int channel) const
    {
        return active_[static_cast<std::size_t>(channel)];
    }
    unsigned output_mode(int channel) const;
    bool preloaded(int channel) const;
    /* The CCER bits of a channel: CCxE, CCxP, CCxNE, CCxNP from bit 0 on. */
    unsigned output_control(int channel) const
    {
        return field(at(0x20), static_cast<unsigned>(4 * channel), 4);
    }
    std::uint32_t control_2() const
    {
        return at(0x04);
    }
    bool idle_outputs_off() const;
    Ticks dead_time() const;
    Ticks count_ticks() const
    {
        return clock_() * (prescaler_ + 1);
    }
    Ticks phase_ticks(Ticks time) const; /* since the counter left 0 */
    /* All four legs low, dead time of the falling edge over, at this time. */
    bool all_low(Ticks time) const;

    /* Output of COMP1...COMP7 (index 0...6). */
    void comparator(unsigned index, bool level);
    /* Of what the system watches, by SYSCFG_CFGR2. */
    void system_break(bool level);
    bool break_active() const;

    /* Stops the count and holds all outputs off, as at a halt of the core with DBG_TIM1_STOP set;
       goes on where it stood. RM0440, TIM1, debug mode. */
    void hold(bool held);
    bool held() const
    {
        return held_since_ != Event::never;
    }

    struct Counters {
        std::uint64_t peaks = 0, updates_at_peak = 0, updates_at_valley = 0, breaks = 0;
        Ticks last_load = 0; /* time of the last update event */
    };
    Counters counters;

    /* The other reading of RM0440 on the repetition counter: a write of RCR while the counter
       stands fills it at once. For tests of firmware against both. */
    bool rcr_fills_while_stopped = false;

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    void control(std::uint32_t value);
    void break_and_dead_time(std::uint32_t value);
    void check_lock(std::uint32_t offset, std::uint32_t value) const;
    void compare(int channel, std::uint32_t offset, std::uint32_t value);
    void start();
    void turning_point();
    void update(bool at_peak);
    void generate(std::uint32_t value);
    void take_flags();
    void schedule_compare();
    void compare_event();
    void schedule_trigger();
    void trigger_event();
    void check_break();
    void interrupt();
    std::uint32_t count() const;
    Ticks period_ticks() const
    {
        return 2 * Ticks{reload_} * count_ticks();
    }
    Ticks next_phase(std::uint32_t phase, Ticks after) const;
    int match_phases(int channel, std::uint32_t *phases) const;

    Triggers &triggers_;
    std::function<Ticks()> clock_;
    std::uint32_t prescaler_ = 0, reload_ = 0xffff, repetition_ = 0;
    std::array<std::uint32_t, channels> active_{};
    Ticks origin_ = 0; /* a time at which the phase was 0 */
    std::uint32_t frozen_ = 0;
    bool up_ = true; /* the next turning point is the peak */
    Ticks flags_until_ = 0;
    Ticks held_since_ = Event::never; /* never: it is not */
    unsigned comparators_ = 0;
    bool system_break_ = false;
    unsigned lock_level_ = 0;
    bool moe_written_ = false;

    struct Edge {
        int channel;
        TriggerEdge edge;
        bool pulse;
    };
    std::vector<Edge> trigger_edges() const;
    std::vector<Edge> due_;
    Event turning_event_, compare_event_, trigger_event_;
};

} // namespace virtual_board

#endif
