/*
 * General and basic timers (TIM2, 3, 4, 6, 7, 15): up-counting with prescaler and auto-reload,
 * update event, compare flags and their interrupt, TRGO on reset, enable or update, slave modes
 * reset and trigger from another timer, encoder mode 3 and captures of its count by channels 3
 * and 4. Time between events is computed, not stepped, and overflows that nobody can see but by
 * registers and by triggers that may come late cost no event each. RM0440, chapters
 * "General-purpose timers" and "Basic timers".
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_TIMER_H
#define STEADYSTEP_VIRTUAL_BOARD_TIMER_H

#include <array>

#include "sil/virtual_board/peripherals/register_block.h"
#include "sil/virtual_board/peripherals/trigger.h"

namespace virtual_board
{

struct TimerKind {
    const char *name;
    Trigger output;
    int interrupt_line; /* below 0: shared with a line that the model gives to another timer */
    bool general;       /* slave controller and encoder interface */
    bool wide;          /* 32 bits */
};

class Timer : public RegisterBlock, private LatePulses
{
  public:
    Timer(Chip &chip, const TimerKind &kind, Triggers &triggers, std::function<Ticks()> clock);

    void reset() override;

    /* Encoder interface: the position of the encoder in counts, and whether its signals reach the
       timer's pins. */
    std::function<std::int32_t()> encoder;
    std::function<bool()> encoder_routed;
    /* An edge at the input of a channel, 3 or 4, while the encoder was at this position. */
    void capture(unsigned channel, bool rising, std::int32_t position);

    Ticks count_ticks() const; /* duration of one count */
    std::uint32_t count() const;
    std::uint32_t count_at(std::int32_t position) const; /* of the encoder */
    bool counting() const
    {
        return bit(at(0x00), 0);
    }
    std::uint64_t updates(); /* events since the reset */
    /* Stops the count, as at a halt of the core with DBG_TIMx_STOP set; goes on where it stood. */
    void hold(bool held);

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    static constexpr Ticks slave_delay_cycles = 2; /* resynchronisation of the trigger input */

    void control(std::uint32_t value);
    void slave_mode(std::uint32_t value);
    void start();
    void stop();
    void overflow();
    bool may_be_late(Ticks period) const;
    void catch_up(Ticks until) override;
    void come_promptly() override;
    void update(bool by_software);
    void triggered(Trigger source, TriggerEdge edge);
    void act_on_trigger();
    void take_flags()
    {
        take_flags(chip_.now());
    }
    void take_flags(Ticks until);
    void schedule_compare();
    bool output(int channel) const;
    void interrupt();
    bool encoder_mode() const
    {
        return field(at(0x08), 0, 3) == 3 && !bit(at(0x08), 16);
    }
    std::uint32_t top() const
    {
        return reload_;
    }

    TimerKind kind_;
    Triggers &triggers_;
    std::function<Ticks()> clock_;
    std::uint32_t prescaler_ = 0, reload_ = 0; /* in force */
    std::uint32_t frozen_ = 0;                 /* count while stopped */
    Ticks origin_ = 0;                         /* time of count 0 while counting */
    std::int32_t encoder_origin_ = 0;          /* encoder position where the count was frozen_ */
    std::array<std::uint32_t, 4> compare_{};   /* in force */
    std::uint32_t compare_flags_ = 0x1e;       /* of the channels that are outputs */
    Ticks flags_until_ = 0;
    std::uint64_t updates_ = 0;
    Ticks late_period_ = 0;           /* 0: every overflow is an event */
    Ticks held_since_ = Event::never; /* never: it is not held */
    Event overflow_event_, trigger_event_, compare_event_;
    Triggers::Listener *triggers_in_ = nullptr;
};

} // namespace virtual_board

#endif
