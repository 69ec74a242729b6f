/*
 * ADC1...ADC5 and their common registers: power-up sequence, injected and regular sequences on
 * triggers, oversampling, DMA, flags. Independent mode, no injected queue beyond one context, no
 * continuous or discontinuous mode, no analog watchdog. RM0440, chapter ADC.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_ADC_H
#define STEADYSTEP_VIRTUAL_BOARD_ADC_H

#include <array>

#include "sil/virtual_board/peripherals/clock_tree.h"
#include "sil/virtual_board/peripherals/dma.h"
#include "sil/virtual_board/peripherals/trigger.h"

namespace virtual_board
{

class AdcCommon : public RegisterBlock
{
  public:
    AdcCommon(Chip &chip, const char *name);

    /* Half a period of the ADC clock; 0 while no clock is chosen. */
    Ticks half_clock() const;
    /* HCLK periods of latency between a trigger and the start of sampling. */
    Ticks latency() const;

    std::function<bool()> any_enabled;
    /* Flags of master and slave: ADC1 and ADC2, ADC3 and ADC4. */
    std::function<std::uint32_t()> master_flags, slave_flags;

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;
};

/* One conversion as the analog side sees it. */
struct Conversion {
    unsigned adc; /* 1...5 */
    unsigned channel;
    bool injected;
    Ticks trigger; /* of its sequence */
    Ticks sampled; /* end of the sampling time (of the last conversion of an oversampled rank) */
};

/* `factor` x code >> `shift` at an address. */
struct StoredResult {
    unsigned adc, channel;
    Ticks trigger; /* of its sequence */
    std::uint32_t address;
    unsigned factor, shift;
};

/* The analog side: codes of 12 bits. */
class AnalogInputs
{
  public:
    virtual ~AnalogInputs() = default;
    virtual std::uint32_t code(const Conversion &conversion) = 0;
    /* Rises whenever regular conversions of legs may give other codes than before, but by a write
       of the core. */
    virtual unsigned changes() const = 0;
    /* The results of regular conversions were stored by DMA. */
    virtual void stored(const StoredResult *results, std::size_t count) = 0;
    /* The core has read JDR1. */
    virtual void injected_result_taken(unsigned adc) = 0;
};

class Adc : public RegisterBlock
{
  public:
    Adc(Chip &chip, unsigned number, AdcCommon &common, Triggers &triggers, Dmamux &dmamux,
        AnalogInputs &inputs, std::function<void(bool)> interrupt);

    void reset() override;
    bool enabled() const;
    /* ISR, as CSR shows it to the core. */
    std::uint32_t flags();

    /* Results that have been put off (adc_deferred.cpp) come: those that are due up to a time, of
       sequences that were triggered before another. */
    void settle(Ticks until, Ticks triggered_before = Event::never);
    /* The core is about to read what those results have changed, or to change what they do. */
    void look(Access access);

    struct Counters {
        std::uint64_t conversions = 0, injected_sequences = 0, regular_sequences = 0;
        std::uint64_t ignored_triggers = 0, overruns = 0;
        Ticks last_injected_trigger = 0, last_injected_end = 0;
    };
    Counters counters;
    int stuck_code = -1; /* a fault for tests: every conversion gives this code */

  protected:
    std::uint32_t fetch(std::uint32_t offset, Master master) override;
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    struct Rank {
        unsigned channel;
        Ticks sampled, end; /* from the trigger on */
    };
    struct Sequence {
        bool running = false;
        unsigned rank = 0, ranks = 0;
        Ticks trigger = 0, sampled = 0;
    };

    void control(std::uint32_t value);
    void power_up(std::uint32_t value);
    void calibrated();
    void ready();
    void triggered(Trigger source, TriggerEdge edge);
    void start_injected();
    void start_regular();
    void next_rank(Sequence &sequence, Event &event, Ticks start);
    void end_of_injected();
    void injected_result_read(unsigned rank);
    void end_of_regular();
    void deliver(std::uint32_t data, const Conversion &conversion);
    void choose_triggers();
    unsigned channel(const Sequence &sequence) const;
    unsigned regular_channel(unsigned rank) const;
    Ticks sampling(unsigned channel) const;
    Ticks conversion_time() const;
    unsigned oversampling() const;
    unsigned oversampling_shift() const;
    std::uint32_t regular_result(const Conversion &conversion) const;
    DmaRequest dma_request() const;

    void plan();
    bool silent();
    bool defer(Ticks trigger);
    void put_off(Ticks trigger);
    bool patient(Ticks period);
    void triggered_late(Ticks first, Ticks period, unsigned count);
    std::uint32_t planned_result(std::size_t rank, Ticks trigger);
    void forget_results();
    template <typename Take> void form(Ticks until, Ticks triggered_before, Take take);
    void deferred_due();
    std::uint32_t resolved(std::uint32_t code) const;
    void flag(std::uint32_t flags);

    unsigned number_;
    AdcCommon &common_;
    Triggers &triggers_;
    Dmamux &dmamux_;
    AnalogInputs &inputs_;
    std::function<void(bool)> interrupt_;
    Ticks regulator_ready_ = Event::never, calibration_end_ = 0;
    bool calibrated_ = false, ready_ = false;
    bool dma_stopped_ = false;
    Sequence injected_, regular_;
    unsigned newest_injected_ = 0; /* rank of the result that came last */
    Event calibration_event_, ready_event_, injected_event_, regular_event_;
    Triggers::Listener *listener_ = nullptr;
    unsigned injected_sources_ = 0, regular_sources_ = 0; /* as Listener::sources */

    /* regular sequences that are put off: times of their triggers, the rank that the first is at,
       and when that is due */
    std::vector<Ticks> deferred_;
    std::size_t deferred_rank_ = 0;
    Ticks due_ = Event::never, deferred_until_ = 0;
    std::vector<Rank> plan_;
    Ticks planned_half_clock_ = 0, planned_latency_ = 0;
    /* what the ranks of the plan give while the inputs stand still, and those that are known */
    std::array<std::uint32_t, 16> results_{};
    std::uint32_t known_results_ = 0;
    unsigned inputs_changes_ = 0;
    int results_stuck_code_ = -1;
    std::vector<StoredResult> stored_; /* of one settle */
    Dmamux::Route route_;
    unsigned route_changes_ = 0;
    bool moved_by_dma_ = false; /* the route is known to read DR */
    unsigned read_by_dma_ = 0;  /* times that DR was */
};

} // namespace virtual_board

#endif
