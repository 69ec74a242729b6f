/*
 * The STM32G071 and the board around it (hal/stm32g071): integrated double bridge with one input
 * per half-bridge, motor, shunts, dividers. The power stage follows the rules of power_stage.h: the
 * plant is stepped at each peak of TIM1 with the compares that were in force.
 *
 * What the dividers' filters let pass is known at the end of a period only. The eighth samples of
 * the legs are taken then; the seven before are rewritten in memory at the peak, such that the
 * filter's equation (hal/stm32g071/leg_voltage.h) yields the plant's mean of the period exactly.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_STM32G071_BOARD_H
#define STEADYSTEP_VIRTUAL_BOARD_STM32G071_BOARD_H

#include "sil/plant/plant.h"
#include "sil/virtual_board/chip_description.h"
#include "sil/virtual_board/peripherals/gpio.h"
#include "sil/virtual_board/peripherals/lpuart.h"
#include "sil/virtual_board/peripherals/stm32g071_blocks.h"
#include "sil/virtual_board/peripherals/timer.h"
#include "sil/virtual_board/peripherals/watchdog.h"

namespace virtual_board
{

/* As this board uses it: code in RAM, DMA channel 1 raises the control interrupt. */
const ChipDescription &stm32g071_board();

class G071Board final : public Device
{
  public:
    /* The plant's delay is taken as 0: the timer's preload is the delay. */
    G071Board(Chip &chip, const plant::Config &config, double host_baud);

    std::vector<Mapping> mappings() override;
    G071Flash &flash() override
    {
        return flash_;
    }
    void reset(const std::string &cause) override;

    const Pins &pins() const
    {
        return pins_;
    }
    plant::Plant &plant()
    {
        return plant_;
    }
    Lpuart &serial()
    {
        return lpuart_;
    }
    bool bridge_on() const;
    /* Compare in force of leg 0...3: A+, A-, B+, B-. */
    std::uint32_t compare(int leg) const
    {
        return timer1_.active_compare(leg);
    }
    /* The bridge's own overcurrent protection: FAULT low, half-bridges open until RESET is low. */
    void trip();
    /* The converter, to be disturbed. */
    G071Adc &converter()
    {
        return adc_;
    }
    /* DBG: what stands still while a debugger halts the core. */
    RegisterBlock &debug_support()
    {
        return dbg_;
    }
    const Watchdog &watchdog() const
    {
        return watchdog_;
    }

    struct Counters {
        std::uint64_t outside_low_state = 0;                   /* currents at the peak */
        std::int64_t sampled_a_ticks = 0, sampled_b_ticks = 0; /* end of sampling from the peak */
        std::uint64_t updates_elsewhere = 0;
    };
    Counters counters;
    std::function<void()> on_sample; /* at each peak, plant up to date */

  private:
    static constexpr int legs = 4;

    void peak();
    void outputs_enabled() const;
    void rewrite();
    std::uint32_t code(unsigned channel);
    std::uint32_t current(int leg);  /* code of the amplified shunt of a leg, 0...3 */
    int difference(int phase) const; /* of the legs' codes, mean over the last period */

    Chip &chip_;
    G071Lines numbers_;
    Triggers triggers_;
    G071Rcc rcc_;
    G071Flash flash_;
    Pins pins_;
    AdvancedTimer timer1_;
    G071Timer1 timer1_pins_;
    Timer timer2_, timer3_;
    Dma dma_, no_dma_;
    Dmamux dmamux_;
    G071Dmamux dmamux_numbers_;
    G071Adc adc_;
    Lpuart lpuart_;
    Watchdog watchdog_;
    RegisterBlock dbg_;

    plant::Plant plant_;
    bool started_ = false, tripped_ = false;
    Ticks peak_at_ = 0;
    int last_difference_[2] = {0, 0};
    std::vector<std::uint32_t> open_[legs]; /* addresses of this period's leg codes */
};

} // namespace virtual_board

#endif
