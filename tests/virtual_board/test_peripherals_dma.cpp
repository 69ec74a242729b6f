/* DMA, leg voltages over ADC3, the serial line and the encoder. */
#include "tests/virtual_board/device_bench.h"

void setUp()
{
}

void tearDown()
{
}

using namespace virtual_board;

namespace
{

constexpr Ticks half = 8500 * cycle;
constexpr std::uint32_t ram = FakeChip::ram;

void test_17_groups_of_a_period_give_the_plants_phase_voltage()
{
    LegBench bench;
    PowerStage &stage = bench.device.power_stage();
    bench.chip.run_until(bench.begin + half + 1000 * cycle); /* S(0) */
    bench.chip.write(tim1 + 0x44, bench.chip.read(tim1 + 0x44) | 1 << 15);
    for (unsigned k = 1; k < 12; k++) {
        const plant::Duties duties = bench::voltages(10.0 - 2.0 * k, 5.0);
        bench.compares(duties.high_counts[0], duties.high_counts[1], duties.high_counts[2],
                       duties.high_counts[3]);
        bench.chip.run_until(bench.begin + half + k * 2 * half + 5 * cycle);
        const unsigned done = bench.chip.read(dma1 + 0x0c) > 34 ? 34 : 0;
        int difference = 0;
        for (unsigned group = 0; group < 17; group++) {
            difference += static_cast<int>(bench.sum(done + 2 * group));
            difference -= static_cast<int>(bench.sum(done + 2 * group + 1));
        }
        TEST_ASSERT_EQUAL_INT(17 * 8 * 2 * stage.plant().samples().phase_voltage_a, difference);
        TEST_ASSERT_EQUAL_UINT(34, stage.counters.groups);
    }
    TEST_ASSERT_TRUE(stage.plant().samples().phase_voltage_a < -300);
    TEST_ASSERT_TRUE(bench.device.adc(3).counters.ignored_triggers == 0);
    TEST_ASSERT_TRUE(bench.device.adc(3).counters.overruns == 0);
}

/* 8 x 15 ADC clocks of 4 cycles for each rank, after 2.125 clocks of latency. */
void test_an_oversampled_rank_takes_15_clocks_for_each_conversion()
{
    LegBench bench;
    const Ticks trigger = bench.begin + half + 10 * cycle;
    const Ticks rank = trigger + 4 * cycle * 17 / 8 + 8 * 15 * 4 * cycle;
    bench.chip.run_until(rank - 1);
    TEST_ASSERT_EQUAL_UINT32(68, bench.chip.read(dma1 + 0x0c));
    bench.chip.run_until(rank);
    TEST_ASSERT_EQUAL_UINT32(67, bench.chip.read(dma1 + 0x0c));
    bench.chip.run_until(rank + 8 * 15 * 4 * cycle);
    TEST_ASSERT_EQUAL_UINT32(66, bench.chip.read(dma1 + 0x0c));
}

void test_a_circular_channel_flags_its_half_and_its_end_and_goes_on()
{
    LegBench bench;
    bench.chip.run_until(bench.begin + half + 17 * 1000 * cycle);
    TEST_ASSERT_EQUAL_HEX32(5, bench.chip.read(dma1));
    TEST_ASSERT_TRUE(bench.chip.lines[11]);
    bench.chip.write(dma1 + 4, 1);
    TEST_ASSERT_EQUAL_HEX32(0, bench.chip.read(dma1));
    TEST_ASSERT_FALSE(bench.chip.lines[11]);
    bench.chip.run_until(bench.begin + half + 34 * 1000 * cycle);
    TEST_ASSERT_EQUAL_HEX32(3, bench.chip.read(dma1));
    TEST_ASSERT_EQUAL_UINT32(68, bench.chip.read(dma1 + 0x0c));
    bench.refused("channel is enabled", dma1 + 0x0c, 1);
    bench.refused("routing", dmamux, 38);
}

void test_without_dma_a_second_result_is_an_overrun()
{
    LegBench bench;
    bench.chip.write(dma1 + 0x08, 0);
    bench.chip.run_until(bench.begin + 2 * half);
    TEST_ASSERT_TRUE((bench.chip.read(adc3) & 1 << 4) != 0);
    TEST_ASSERT_TRUE(bench.device.adc(3).counters.overruns > 0);
}

struct LineBench : Bench {
    LineBench()
    {
        start_clocks();
        route('A', 2, 12);
        route('A', 3, 12);
        chip.write(lpuart + 0x0c, 47222); /* 256 x 170 MHz / 921600 */
        chip.write(lpuart + 0x04, 10u << 24);
    }
};

void test_a_byte_takes_ten_bits()
{
    LineBench bench;
    bench.chip.write(lpuart, 0xd);
    const Ticks begin = bench.chip.now();
    bench.chip.write(lpuart + 0x28, 'x');
    TEST_ASSERT_TRUE((bench.chip.read(lpuart + 0x1c) & 0xc0) == 0x80);
    const Ticks length = bench.device.serial_line().byte_time();
    TEST_ASSERT_UINT64_WITHIN(2, 10 * ticks_per_s / 921600, length);
    bench.chip.run_until(begin + length - 1);
    TEST_ASSERT_TRUE((bench.chip.read(lpuart + 0x1c) & 0x40) == 0);
    bench.chip.run_until(begin + length);
    TEST_ASSERT_TRUE((bench.chip.read(lpuart + 0x1c) & 0x40) != 0);
    TEST_ASSERT_EQUAL_STRING("x", bench.device.serial_line().take_output().c_str());
}

void test_a_line_comes_in_by_dma_and_its_end_raises_the_match()
{
    LineBench bench;
    bench.channel(2, 34, lpuart + 0x24, ram, 16, 1 << 5 | 1 << 7);
    bench.chip.write(lpuart + 0x08, 1 << 6);
    bench.chip.write(lpuart, 0xd | 1 << 14);
    const Ticks begin = bench.chip.now();
    bench.device.serial_line().send(begin, "on\n");
    bench.chip.run_until(begin + 30 * ticks_per_s / 921600 - 100);
    TEST_ASSERT_FALSE(bench.chip.lines[91]);
    bench.chip.run_until(begin + 30 * ticks_per_s / 921600 + 100);
    TEST_ASSERT_TRUE(bench.chip.lines[91]);
    TEST_ASSERT_EQUAL_MEMORY("on\n", bench.chip.memory.data(), 3);
    TEST_ASSERT_EQUAL_UINT32(13, bench.chip.read(dma1 + 0x08 + 0x14 * 2 + 4));
    bench.chip.write(lpuart + 0x20, 1 << 17);
    TEST_ASSERT_FALSE(bench.chip.lines[91]);
}

void test_a_text_goes_out_by_dma_whole()
{
    LineBench bench;
    const std::string text = "steadystep";
    std::copy(text.begin(), text.end(), bench.chip.memory.begin());
    bench.chip.write(lpuart + 0x08, 1 << 7);
    bench.chip.write(lpuart, 0xd);
    bench.channel(3, 35, lpuart + 0x28, ram, 10, 1 << 4 | 1 << 7);
    bench.chip.run_for(200 * microsecond);
    TEST_ASSERT_EQUAL_STRING(text.c_str(), bench.device.serial_line().take_output().c_str());
    TEST_ASSERT_EQUAL_UINT32(0, bench.chip.read(dma1 + 0x08 + 0x14 * 3 + 4));
}

void test_an_unread_byte_is_overrun_and_a_wrong_speed_is_refused()
{
    LineBench bench;
    bench.chip.write(lpuart, 0xd);
    bench.device.serial_line().send(bench.chip.now(), "ab");
    bench.chip.run_for(30 * microsecond);
    TEST_ASSERT_TRUE((bench.chip.read(lpuart + 0x1c) & 1 << 3) != 0);
    TEST_ASSERT_EQUAL_UINT32('a', bench.chip.read(lpuart + 0x24));
    LineBench other;
    other.chip.write(lpuart + 0x0c, 47222 * 2);
    other.refused("baud", lpuart, 0xd);
}

void test_the_encoder_counts_from_where_it_was_enabled()
{
    Stm32g474Config config = Bench::make_config();
    config.power_stage.plant.initial_theta_rad = -0.01;
    Bench bench(config);
    bench.start_clocks();
    bench.route('B', 6, 2);
    bench.route('B', 7, 2);
    bench.chip.write(tim4 + 0x2c, 0xffff);
    bench.chip.write(tim4 + 0x18, 0x101);
    bench.chip.write(tim4 + 0x08, 3);
    bench.chip.write(tim4, 1);
    TEST_ASSERT_EQUAL_UINT32(0, bench.chip.read(tim4 + 0x24));
    plant::Plant &plant = bench.device.power_stage().plant();
    const std::int32_t before = plant.samples().encoder_count;
    plant.set_load_torque(0.5);
    for (int i = 0; i < 400; i++) {
        plant.step(bench::off());
    }
    const std::int32_t moved = plant.samples().encoder_count - before;
    TEST_ASSERT_TRUE(moved < -3);
    TEST_ASSERT_EQUAL_INT16(moved, static_cast<std::int16_t>(bench.chip.read(tim4 + 0x24)));
}

/* The count is 0 at the encoder's 10; channel 4 is its input, the index begins at count 100. */
struct IndexBench : Bench {
    IndexBench() : Bench(config())
    {
        start_clocks();
        route('B', 6, 2);
        route('B', 7, 2);
        chip.write(tim4 + 0x2c, 0xffff);
        chip.write(tim4 + 0x18, 0x101);
        chip.write(tim4 + 0x1c, 0x3100);
        chip.write(tim4 + 0x08, 3);
        chip.write(tim4, 1);
    }
    static Stm32g474Config config()
    {
        Stm32g474Config config = Bench::make_config();
        config.power_stage.plant.initial_theta_rad = 10.5 * 2 * bench::pi / 4000;
        return config;
    }
    void edge(bool rising, std::int32_t position)
    {
        device.power_stage().on_index(rising, position);
    }
    std::uint32_t flags()
    {
        return chip.read(tim4 + 0x10) & 0x1010;
    }
};

void test_an_edge_of_the_index_captures_the_count()
{
    IndexBench bench;
    bench.chip.write(tim4 + 0x20, 0x1000);
    bench.edge(true, 100);
    TEST_ASSERT_EQUAL_HEX32(0, bench.flags()); /* the pin is not its */
    bench.route('B', 9, 2);
    bench.edge(false, 100);
    TEST_ASSERT_EQUAL_HEX32(0, bench.flags());
    bench.edge(true, 100);
    TEST_ASSERT_EQUAL_HEX32(0x10, bench.flags());
    bench.edge(true, 5);
    TEST_ASSERT_EQUAL_HEX32(0x1010, bench.flags()); /* one that nobody has read is lost */
    TEST_ASSERT_EQUAL_HEX32(65536 - 5, bench.chip.read(tim4 + 0x40));
    TEST_ASSERT_EQUAL_HEX32(0x1000, bench.flags());
}

void test_a_capture_has_its_edge_and_is_off_until_it_is_on()
{
    IndexBench bench;
    bench.route('B', 9, 2);
    bench.edge(true, 100);
    bench.chip.write(tim4 + 0x20, 0x2000);
    bench.edge(false, 100);
    TEST_ASSERT_EQUAL_HEX32(0, bench.flags());
    bench.chip.write(tim4 + 0x20, 0x3000);
    bench.edge(true, 100);
    TEST_ASSERT_EQUAL_HEX32(0, bench.flags());
    bench.edge(false, 100);
    TEST_ASSERT_EQUAL_HEX32(0x10, bench.flags());
    TEST_ASSERT_EQUAL_HEX32(90, bench.chip.read(tim4 + 0x40));
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_17_groups_of_a_period_give_the_plants_phase_voltage);
    RUN_TEST(test_an_oversampled_rank_takes_15_clocks_for_each_conversion);
    RUN_TEST(test_a_circular_channel_flags_its_half_and_its_end_and_goes_on);
    RUN_TEST(test_without_dma_a_second_result_is_an_overrun);
    RUN_TEST(test_a_byte_takes_ten_bits);
    RUN_TEST(test_a_line_comes_in_by_dma_and_its_end_raises_the_match);
    RUN_TEST(test_a_text_goes_out_by_dma_whole);
    RUN_TEST(test_an_unread_byte_is_overrun_and_a_wrong_speed_is_refused);
    RUN_TEST(test_the_encoder_counts_from_where_it_was_enabled);
    RUN_TEST(test_an_edge_of_the_index_captures_the_count);
    RUN_TEST(test_a_capture_has_its_edge_and_is_off_until_it_is_on);
    return UNITY_END();
}
