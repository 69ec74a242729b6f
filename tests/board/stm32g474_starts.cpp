/* Start-ups of the STM32G474 image that fail, each for its own reason. */
#include "tests/board/stm32g474_bench.h"

namespace stm32g474_bench
{

namespace
{

enum : std::uint32_t { TIM1_BDTR = 0x40012c44 };
constexpr std::uint32_t MOE = 1u << 15;

/* Hardware that does not do what it must, by what a register then says; RM0440. */
struct Failure {
    PlantedBits bits;
    const char *reported; /* hal/stm32g474/faults.h */
};

constexpr PlantedBits pll_unlocked = {0x40021000, 1u << 25, 0}; /* RCC.CR PLLRDY */

const Failure failures[] = {
    {{0x40007014, 1u << 11, 1u << 11}, "the chip's supply is below"},   /* PWR.SR2 PVDO */
    {{0x40007014, 1u << 10, 1u << 10}, "core regulator not ready"},     /* PWR.SR2 VOSF */
    {{0x40022000, 0xfu, 0}, "flash wait states not taken"},             /* FLASH.ACR LATENCY */
    {pll_unlocked, "PLL does not lock"},                                /* */
    {{0x40021008, 0xcu, 0}, "system clock does not switch"},            /* RCC.CFGR SWS */
    {{0x40022020, 1u << 22, 0}, "flash option bytes"},                  /* FLASH.OPTR DBANK */
    {{0x50001034, 1u << 11, 0}, "DAC does not get ready"},              /* DAC3.SR DAC1RDY */
    {{0x50000008, 1u << 31, 1u << 31}, "ADC calibration does not end"}, /* ADC1.CR ADCAL */
    {{0x50000500, 1u << 0, 0}, "ADC does not get ready"},               /* ADC4.ISR ADRDY */
    {{0x40012c10, 1u << 0, 0}, "PWM timer gives no update"},            /* TIM1.SR UIF */
    {{0x40012c24, 0xffffu, 0}, "PWM timer loads its compares in the valley"}, /* TIM1.CNT */
    {{0x40021094, 1u << 1, 0}, "low-speed oscillator does not start"},        /* RCC.CSR LSIRDY */
    {{0x4000300c, 1u << 1, 1u << 1}, "watchdog does not take its period"},    /* IWDG.SR RVU */
    {{0x50000300, 1u << 21, 0}, "a current converter has not converted"},     /* ADC12 CSR, ADC2 */
    {{0x4002000c, 0x7fu, 50}, "leg-voltage conversions out of step or lost"}, /* DMA1.CNDTR1 */
};

/* Counts the writes that would close the bridge. */
void watch_bridge(Powered &run, int &closed)
{
    run.device.before_write = [&closed](std::uint32_t address, std::uint32_t value) {
        closed += address == TIM1_BDTR && (value & MOE) != 0 ? 1 : 0;
    };
}

void run_until_reset(Powered &run, std::size_t resets)
{
    for (int i = 0; i < 400 && run.machine.resets().size() < resets; ++i) {
        run.run_for(ms);
    }
}

} // namespace

/* A start that fails once; the next one succeeds and says why the first did not. */
void starts_fail(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    int closed = 0;
    watch_bridge(run, closed);
    for (const Failure &failure : failures) {
        run.machine.power_on();
        run.device.planted = {failure.bits};
        run_until_reset(run, 1);
        run.device.planted.clear();
        const std::string text = run.start();
        expectations.expect(
            run.machine.resets() == std::vector<std::string>{"software"} &&
                count(text, std::string("started by: crash: ") + failure.reported) == 1,
            std::string("reported: ") + failure.reported);
    }
    expectations.expect(closed == 0, "no failing start closes the bridge");
}

void starts_fail_for_ever(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    int closed = 0;
    watch_bridge(run, closed);
    run.device.planted = {pll_unlocked};
    run_until_reset(run, 3);
    run.run_for(20 * ms);
    const std::string why = "steadystep stays off, three starts failed: crash: PLL does not lock";
    expectations.expect(run.machine.resets().size() == 3 && count(run.output(), why) == 1,
                        "behind three starts that failed the board stays off and says why");
    expectations.expect(count(run.type("enable\n", 20 * ms), "ready") == 0 && closed == 0,
                        "and closes no bridge");
    run.device.planted.clear();
    run.machine.reset("pin");
    expectations.expect(count(run.start(), "started by: reset pin") == 1 && run.enable(),
                        "the reset pin starts it anew");
}

void starts_without_crystal(Expectations &expectations, const std::string &image)
{
    Stm32g474Config config = board_config();
    config.clock.crystal_starts = false;
    Powered run(image, config);
    expectations.expect(count(run.start(), "started by: power-on") == 1 && run.enable(),
                        "without its crystal the board runs from the oscillator of the chip");
}

/* For longer than a period, for longer than a start waits, and while it starts. */
void chip_supply_sags(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    expectations.expect(run.enable(), "the drive holds the motor");
    run.run_behind_peak(60 * us);
    run.device.pwr().set_supply(2.95);
    run.run_for(2 * ms);
    expectations.expect(run.bridge_on(), "a supply of 2.95 V is enough for the chip");
    run.device.pwr().set_supply(2.85);
    expectations.expect(!run.bridge_on(), "one of 2.85 V opens the bridge without the program");
    run.run_for(5 * ms);
    expectations.expect(run.machine.resets() == std::vector<std::string>{"software"},
                        "which stops");
    run.run_for(80 * ms);
    expectations.expect(run.machine.resets().size() == 1 && run.output().empty(),
                        "and waits for it to be back");
    run.device.pwr().set_supply(3.3);
    expectations.expect(count(run.start(), "started by: crash: the chip's supply is below 2.9 V") ==
                            1,
                        "says why it has stopped");
    expectations.expect(run.enable(), "and can be enabled again");
}

} // namespace stm32g474_bench
