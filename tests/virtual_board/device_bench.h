/* The STM32G474's peripherals on a fake chip, and the steps of start-up that tests share. */
#ifndef STEADYSTEP_TESTS_DEVICE_BENCH_H
#define STEADYSTEP_TESTS_DEVICE_BENCH_H

#include <unity.h>

#include "sil/virtual_board/peripherals/stm32g474_device.h"
#include "tests/unit/plant_bench.h"
#include "tests/virtual_board/fake_chip.h"

namespace virtual_board
{

constexpr Ticks microsecond = ticks_per_s / 1000000;
constexpr Ticks cycle = 32; /* of 170 MHz */

constexpr std::uint32_t rcc = 0x40021000, pwr = 0x40007000, flash_registers = 0x40022000;
constexpr std::uint32_t tim1 = 0x40012c00, tim3 = 0x40000400, tim4 = 0x40000800;
constexpr std::uint32_t adc1 = 0x50000000, adc2 = 0x50000100, adc3 = 0x50000400;
constexpr std::uint32_t dma1 = 0x40020000, dmamux = 0x40020800, lpuart = 0x40008000;
constexpr std::uint32_t iwdg = 0x40003000, comp = 0x40010200, opamp = 0x40010300;
constexpr std::uint32_t dac3 = 0x50001000;

/* A write that the chip refuses with this text. */
inline void expect_refused(FakeChip &chip, const char *text, std::uint32_t address,
                           std::uint32_t value)
{
    try {
        chip.write(address, value);
    } catch (const Refusal &refusal) {
        if (std::string(refusal.what()).find(text) == std::string::npos) {
            TEST_FAIL_MESSAGE(refusal.what());
        }
        return;
    }
    TEST_FAIL_MESSAGE(text);
}

struct Bench {
    explicit Bench(Stm32g474Config config = make_config()) : device(chip, config)
    {
        chip.mappings = device.mappings();
        device.reset("power-on");
    }

    static Stm32g474Config make_config()
    {
        Stm32g474Config config;
        config.power_stage.plant = bench::config();
        config.power_stage.plant.sensors.exact = false;
        config.power_stage.plant.sensors.encoder_counts_per_turn = 4000;
        config.power_stage.plant.track_energy = false;
        return config;
    }

    /* 24 MHz / 6 x 85 / 2 = 170 MHz, boost, four wait states. */
    void start_clocks()
    {
        chip.write(rcc + 0x58, 0x10000400 | 0x1f); /* PWR, TIM2, 3, 4, 6 */
        chip.write(pwr + 0x80, 0);
        chip.write(flash_registers, 0x40704);
        chip.write(rcc, 0x10500);
        chip.run_for(2000 * microsecond);
        chip.write(rcc + 0x0c, 3 | 5 << 4 | 85 << 8 | 1 << 24);
        chip.write(rcc, 0x1010500);
        chip.run_for(40 * microsecond);
        chip.write(rcc + 0x08, 8 << 4 | 1);
        chip.write(rcc + 0x08, 8 << 4 | 3);
        chip.run_for(1 * microsecond);
        chip.write(rcc + 0x08, 3);
        chip.write(rcc + 0x48, 0x107);                  /* DMA1, DMA2, DMAMUX, FLASH */
        chip.write(rcc + 0x4c, 0x7 | 0x50000 | 0x6000); /* GPIOA...C, DAC1, DAC3, ADCs */
        chip.write(rcc + 0x5c, 1);                      /* LPUART1 */
        chip.write(rcc + 0x60, 0x801);                  /* SYSCFG, TIM1 */
    }

    void route(char port, unsigned pin, unsigned alternate)
    {
        const std::uint32_t base = 0x48000000 + 0x400 * static_cast<std::uint32_t>(port - 'A');
        const std::uint32_t half = base + (pin < 8 ? 0x20 : 0x24);
        chip.write(half, (chip.read(half) & ~(15u << 4 * (pin % 8))) | alternate << 4 * (pin % 8));
        chip.write(base, (chip.read(base) & ~(3u << 2 * pin)) | 2u << 2 * pin);
    }

    void route_gates()
    {
        for (unsigned pin = 0; pin < 4; pin++) {
            route('C', pin, 2);
        }
        route('A', 11, 6);
        route('A', 12, 6);
        route('B', 15, 4);
        route('C', 5, 6);
    }

    /* Centre-aligned, 8500 counts, compares in force at the peaks; dead time 170 cycles. */
    void configure_pwm(std::uint32_t dtg = 0x80 | 21)
    {
        chip.write(tim1 + 0x00, 1 << 5 | 1 << 7);
        chip.write(tim1 + 0x2c, 8500);
        chip.write(tim1 + 0x18, 0x6868);
        chip.write(tim1 + 0x1c, 0x6868);
        chip.write(tim1 + 0x50, 0x70);
        chip.write(tim1 + 0x48, 8499);
        chip.write(tim1 + 0x04, 2 << 4 | 8 << 20);
        chip.write(tim1 + 0x20, 0x5555);
        chip.write(tim1 + 0x60, 0x1e);
        chip.write(tim1 + 0x44, dtg | 1 << 10 | 1 << 11 | 1 << 12 | 1 << 13);
        chip.write(tim1 + 0x14, 1);
        chip.write(tim1 + 0x30, 1);
        chip.write(tim1 + 0x10, 0);
    }
    void start_pwm()
    {
        chip.set(tim1, 1);
    }
    void compares(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d)
    {
        const std::uint32_t values[4] = {a, b, c, d};
        for (std::uint32_t i = 0; i < 4; i++) {
            chip.write(tim1 + 0x34 + 4 * i, values[i]);
        }
    }

    void power_up(std::uint32_t adc)
    {
        chip.write(adc + 0x08, 0);
        chip.write(adc + 0x08, 1u << 28);
        chip.run_for(20 * microsecond);
        chip.write(adc + 0x08, 1u << 28 | 1u << 31);
        chip.run_for(10 * microsecond);
        chip.write(adc + 0x08, 1u << 28 | 1);
        chip.run_for(2 * microsecond);
        TEST_ASSERT_TRUE((chip.read(adc) & 1) != 0);
    }
    /* HCLK / 4, amplifiers of gain 8, ADC1 and ADC2 on TRGO2. */
    void configure_currents()
    {
        chip.write(opamp + 0x00, 1 | 2 << 5 | 1 << 8 | 2 << 14);
        chip.write(opamp + 0x04, 1 | 2 << 5 | 1 << 8 | 2 << 14);
        chip.run_for(10 * microsecond);
        chip.write(0x50000308, 3 << 16);
        const std::uint32_t channels[2] = {13u << 9 | 14u << 15, 16u << 9 | 5u << 15};
        for (std::uint32_t i = 0; i < 2; i++) {
            const std::uint32_t adc = i == 0 ? adc1 : adc2;
            power_up(adc);
            chip.write(adc + 0x18, 3u << 9 | 3u << 12 | 3u << 18);
            chip.write(adc + 0x14, 3u << 15);
            chip.write(adc + 0x4c, 1 | 8 << 2 | 1 << 7 | channels[i]);
        }
        chip.write(adc1 + 0x04, 1 << 6);
        chip.write(adc1 + 0x08, 1u << 28 | 1 << 3);
        chip.write(adc2 + 0x08, 1u << 28 | 1 << 3);
    }

    /* A channel of DMA1, switched on. */
    void channel(unsigned number, std::uint32_t request, std::uint32_t peripheral,
                 std::uint32_t memory, std::uint32_t items, std::uint32_t control)
    {
        const std::uint32_t base = dma1 + 0x08 + 0x14 * number;
        chip.write(dmamux + 4 * number, request);
        chip.write(base + 4, items);
        chip.write(base + 8, peripheral);
        chip.write(base + 12, memory);
        chip.write(base, control | 1);
    }

    void refused(const char *text, std::uint32_t address, std::uint32_t value)
    {
        expect_refused(chip, text, address, value);
    }

    FakeChip chip;
    Stm32g474Device device;
};

/* The legs of phase a over ADC3: 17 groups of 8 + 8 conversions in a period, in a ring of two. */
struct LegBench : Bench {
    explicit LegBench(std::uint32_t dma_interrupts = 6, /* TCIE, HTIE */
                      std::uint32_t first_count = 992)  /* of TIM3; 1000 triggers */
    {
        start_clocks();
        route_gates();
        configure_pwm();
        configure_currents();
        chip.write(0x50000708, 3 << 16);
        chip.write(tim3 + 0x2c, 999);
        chip.write(tim3 + 0x14, 1);
        chip.write(tim3 + 0x24, first_count);
        chip.write(tim3 + 0x04, 2 << 4);
        chip.write(tim3 + 0x08, 6);
        channel(0, 37, adc3 + 0x40, FakeChip::ram, 68,
                1 << 5 | 1 << 7 | 1 << 8 | 1 << 10 | dma_interrupts);
        power_up(adc3);
        chip.write(adc3 + 0x30, 1 | 1 << 6 | 5 << 12);
        chip.write(adc3 + 0x10, 1 | 2 << 2);
        chip.write(adc3 + 0x0c, 3 | 4 << 5 | 1 << 10 | 1u << 31);
        chip.write(adc3 + 0x08, 1u << 28 | 1 << 2);
        chip.on_interrupt = [this](unsigned line) {
            if (line == 18) {
                (void)chip.read(adc1 + 0x80);
                chip.write(adc1, 0x60);
            }
        };
        start_pwm();
        begin = chip.now();
    }
    unsigned sum(unsigned index)
    {
        return chip.memory[2 * index] + 256u * chip.memory[2 * index + 1];
    }
    Ticks begin = 0;
};

} // namespace virtual_board

#endif
