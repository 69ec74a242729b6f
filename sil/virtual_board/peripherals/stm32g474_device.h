/* All peripherals of the STM32G474RE on the reference board, wired to each other and the plant. */
#ifndef STEADYSTEP_VIRTUAL_BOARD_STM32G474_DEVICE_H
#define STEADYSTEP_VIRTUAL_BOARD_STM32G474_DEVICE_H

#include <memory>

#include "sil/virtual_board/peripherals/adc.h"
#include "sil/virtual_board/peripherals/advanced_timer.h"
#include "sil/virtual_board/peripherals/analog.h"
#include "sil/virtual_board/peripherals/clock_tree.h"
#include "sil/virtual_board/peripherals/dma.h"
#include "sil/virtual_board/peripherals/fdcan.h"
#include "sil/virtual_board/peripherals/flash.h"
#include "sil/virtual_board/peripherals/gpio.h"
#include "sil/virtual_board/peripherals/lpuart.h"
#include "sil/virtual_board/peripherals/power_stage.h"
#include "sil/virtual_board/peripherals/timer.h"
#include "sil/virtual_board/peripherals/watchdog.h"

namespace virtual_board
{

struct Stm32g474Config {
    PowerStageConfig power_stage;
    ClockConfig clock;
    double host_baud = 921600;
    double can_bit_Hz = 500e3;
};

class Stm32g474Device : public Device
{
  public:
    Stm32g474Device(Chip &chip, const Stm32g474Config &config);

    std::vector<Mapping> mappings() override;
    FlashMemory &flash() override
    {
        return flash_;
    }
    void reset(const std::string &cause) override;
    /* A debugger has halted the core, or lets it go on: DBGMCU says which timers stand still. */
    void halt(bool halted);

    Rcc &rcc()
    {
        return rcc_;
    }
    Pwr &pwr()
    {
        return pwr_;
    }
    Pins &pins()
    {
        return pins_;
    }
    AdvancedTimer &tim1()
    {
        return tim1_;
    }
    Timer &timer(Trigger which);
    Adc &adc(unsigned number) /* 1...5 */
    {
        return *adcs_[number - 1];
    }
    Lpuart &serial_line()
    {
        return lpuart_;
    }
    Fdcan &can()
    {
        return fdcan_;
    }
    Watchdog &watchdog()
    {
        return watchdog_;
    }
    Flash &flash_controller()
    {
        return flash_;
    }
    PowerStage &power_stage()
    {
        return power_stage_;
    }

  private:
    void add(const char *name, std::uint32_t base, std::uint32_t bytes, RegisterBlock &block,
             std::uint32_t enable_offset, unsigned position);
    void add(const char *name, std::uint32_t base, std::uint32_t bytes, RegisterBlock &block);
    void map();

    Chip &chip_;
    Triggers triggers_;
    Pwr pwr_;
    Rcc rcc_;
    Flash flash_;
    Pins pins_;
    Dma dma1_, dma2_;
    Dmamux dmamux_;
    AdvancedTimer tim1_;
    std::vector<std::unique_ptr<Timer>> timers_;
    Opamps opamps_;
    Dac dac1_, dac3_;
    Comparators comparators_;
    PowerStage power_stage_;
    AdcCommon adc12_, adc345_;
    SharedLine adc12_line_;
    std::vector<std::unique_ptr<Adc>> adcs_;
    Lpuart lpuart_;
    Fdcan fdcan_;
    Watchdog watchdog_;
    std::unique_ptr<RegisterBlock> syscfg_, dbgmcu_;
    std::vector<Mapping> mappings_;
};

} // namespace virtual_board

#endif
