/*
 * The wiring around the chip: double H-bridge, motor, shunts, dividers, encoder. Steps the plant at
 * each peak of TIM1 and answers the converters and comparators.
 *
 * The plant is stepped at S(k) for the whole period S(k-1)...S(k), with the compares in force
 * during it and bridge and brake as they are at its end. So the leg voltages of a period are known
 * at its end only: what DMA wrote during the period is rewritten in memory at S(k), before anything
 * can run. This is a device of the model; firmware that reads a group earlier sees the last
 * period's value. A group belongs to the period of its trigger.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_POWER_STAGE_H
#define STEADYSTEP_VIRTUAL_BOARD_POWER_STAGE_H

#include "sil/plant/plant.h"
#include "sil/virtual_board/peripherals/adc.h"
#include "sil/virtual_board/peripherals/advanced_timer.h"
#include "sil/virtual_board/peripherals/analog.h"
#include "sil/virtual_board/peripherals/gpio.h"

namespace virtual_board
{

struct PowerStageConfig {
    plant::Config plant;         /* its delay is taken as 0: the timer's preload is the delay */
    unsigned amplifier_gain = 8; /* what the shunts are made for */
    double current_A_per_code = 12.0 / 4096; /* behind the amplifier */
    std::uint16_t current_zero_code = 2048;
    std::uint16_t leg_bias_code = 256;
    double dead_time_tolerance = 0.05;
};

class PowerStage : public AnalogInputs
{
  public:
    static constexpr int legs = 4; /* A+, A-, B+, B-: TIM1 channels 1...4 by pin */

    PowerStage(Chip &chip, const PowerStageConfig &config, AdvancedTimer &timer, const Pins &pins,
               const Opamps &opamps, Comparators &comparators);

    plant::Plant &plant()
    {
        return plant_;
    }
    /* Index k of the last S(k); below 0 before the core has taken the first sample set. */
    std::int64_t period() const
    {
        return started_ ? period_ : -1;
    }
    /* Converters whose results may be put off until the peak (adc_deferred.cpp). */
    void settle_at_peaks(Adc &adc)
    {
        converters_.push_back(&adc);
    }
    /* Called at each S(k), plant and converters up to date, k as period(). */
    std::function<void(std::int64_t k)> on_sample;

    /* An edge of the encoder's index has passed since the last S(k), the encoder at this count. */
    std::function<void(bool rising, std::int32_t count)> on_index;

    bool bridge_on() const;

    /* The chip has been reset: the plant stays where it is, period() restarts from below 0. */
    void chip_reset();

    /* Fault for tests: at a time the current of a leg's shunt (0...3) takes this value, until the
       next peak with the bridge off. */
    void short_circuit(Ticks at, int leg, double current_A);

    struct Counters {
        std::int64_t trigger_from_peak = 0; /* ticks, of the last current sample's trigger */
        std::int64_t sample_from_peak = 0;  /* ticks, end of sampling */
        unsigned groups = 0;                /* regular results of the last whole period, all legs */
        std::uint64_t outside_low_state = 0;
        Ticks last_trip = 0; /* time the comparator saw it */
    };
    Counters counters;

    std::uint32_t code(const Conversion &conversion) override;
    unsigned changes() const override
    {
        return changes_;
    }
    void stored(const StoredResult *results, std::size_t count) override;
    void injected_result_taken(unsigned adc) override;

  private:
    void peak();
    void outputs_enabled() const;
    unsigned connected_outputs() const;
    void rewrite();
    void compare();
    std::uint32_t current_code(const Conversion &conversion);
    std::uint32_t leg_code(int leg) const;
    void require_analog(Pin pin) const;

    Chip &chip_;
    PowerStageConfig config_;
    plant::Plant plant_;
    AdvancedTimer &timer_;
    const Pins &pins_;
    const Opamps &opamps_;
    Comparators &comparators_;
    bool started_ = false;
    std::int64_t period_ = 0;
    Ticks last_peak_ = 0;
    unsigned groups_ = 0;
    unsigned changes_ = 0;           /* of what the converters see */
    std::vector<StoredResult> open_; /* results of the present period, to be rewritten */
    std::vector<Adc *> converters_;
    bool settling_ = false; /* what is stored has the period's value */
    unsigned outputs_ = 0;  /* comparator outputs on their way */
    int shorted_leg_ = -1, next_short_leg_ = -1;
    double short_A_ = 0;
    Event comparator_event_, short_event_;
};

} // namespace virtual_board

#endif
