/* Timers against RM0440: dead time, repetition counter, preload, triggers, compare, encoder. */
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
constexpr std::uint32_t sr = tim1 + 0x10, cnt = tim1 + 0x24;

struct PwmBench : Bench {
    PwmBench()
    {
        start_clocks();
        configure_pwm();
    }
    void start()
    {
        start_pwm();
        begin = chip.now();
    }
    void at_phase(unsigned period, Ticks counts)
    {
        chip.run_until(begin + period * 2 * half + counts * cycle);
    }
    Ticks begin = 0;
};

void test_the_dead_time_code_has_four_ranges()
{
    TEST_ASSERT_EQUAL_UINT(0, dead_time_clocks(0));
    TEST_ASSERT_EQUAL_UINT(127, dead_time_clocks(0x7f));
    TEST_ASSERT_EQUAL_UINT(128, dead_time_clocks(0x80));
    TEST_ASSERT_EQUAL_UINT(170, dead_time_clocks(0x80 | 21));
    TEST_ASSERT_EQUAL_UINT(254, dead_time_clocks(0xbf));
    TEST_ASSERT_EQUAL_UINT(256, dead_time_clocks(0xc0));
    TEST_ASSERT_EQUAL_UINT(504, dead_time_clocks(0xdf));
    TEST_ASSERT_EQUAL_UINT(512, dead_time_clocks(0xe0));
    TEST_ASSERT_EQUAL_UINT(1008, dead_time_clocks(0xff));
}

void test_the_count_goes_up_to_arr_and_down_again()
{
    PwmBench bench;
    bench.start();
    bench.at_phase(0, 100);
    TEST_ASSERT_EQUAL_UINT32(100, bench.chip.read(cnt));
    TEST_ASSERT_EQUAL_UINT32(0, bench.chip.read(tim1) & 1 << 4);
    bench.at_phase(0, 8500);
    TEST_ASSERT_EQUAL_UINT32(8500, bench.chip.read(cnt));
    bench.at_phase(0, 8501);
    TEST_ASSERT_EQUAL_UINT32(8499, bench.chip.read(cnt));
    TEST_ASSERT_EQUAL_UINT32(1 << 4, bench.chip.read(tim1) & 1 << 4);
    bench.at_phase(1, 3);
    TEST_ASSERT_EQUAL_UINT32(3, bench.chip.read(cnt));
}

/* RCR = 1 over a counter that an update has left at 0: the first peak updates, then every second
   extreme, so each peak. */
void test_compares_load_at_the_peaks_only()
{
    PwmBench bench;
    bench.start();
    bench.compares(100, 200, 300, 400);
    bench.at_phase(0, 8499);
    TEST_ASSERT_EQUAL_UINT32(0, bench.device.tim1().active_compare(0));
    bench.at_phase(0, 8500);
    TEST_ASSERT_EQUAL_UINT32(100, bench.device.tim1().active_compare(0));
    TEST_ASSERT_EQUAL_UINT32(400, bench.device.tim1().active_compare(3));
    bench.compares(1, 2, 3, 4);
    bench.at_phase(1, 8499);
    TEST_ASSERT_EQUAL_UINT32(100, bench.device.tim1().active_compare(0));
    bench.at_phase(1, 8500);
    TEST_ASSERT_EQUAL_UINT32(1, bench.device.tim1().active_compare(0));
    bench.at_phase(9, 8500);
    TEST_ASSERT_TRUE(bench.device.tim1().counters.updates_at_peak == 10);
    TEST_ASSERT_TRUE(bench.device.tim1().counters.updates_at_valley == 0);
}

/* RCR = 1 loaded before the start: the first underflow updates. */
void test_a_repetition_count_loaded_before_the_start_updates_at_the_valleys()
{
    PwmBench bench;
    bench.chip.write(tim1 + 0x14, 1);
    bench.start();
    bench.at_phase(10, 0);
    TEST_ASSERT_TRUE(bench.device.tim1().counters.updates_at_peak == 0);
    TEST_ASSERT_TRUE(bench.device.tim1().counters.updates_at_valley == 10);
}

void test_without_repetition_both_extremes_update()
{
    PwmBench bench;
    bench.chip.write(tim1 + 0x30, 0);
    bench.chip.write(tim1 + 0x14, 1);
    bench.start();
    bench.at_phase(10, 0);
    TEST_ASSERT_TRUE(bench.device.tim1().counters.updates_at_peak == 10);
    TEST_ASSERT_TRUE(bench.device.tim1().counters.updates_at_valley == 10);
}

void test_a_compare_flag_falls_by_writing_0_and_comes_while_counting_down()
{
    PwmBench bench;
    bench.compares(6800, 0, 0, 0);
    bench.chip.write(tim1 + 0x14, 1);
    bench.chip.write(tim1 + 0x0c, 1 << 1);
    bench.start();
    bench.chip.write(sr, 0);
    bench.at_phase(0, 6800);
    TEST_ASSERT_EQUAL_UINT32(0, bench.chip.read(sr) & 2); /* CMS = 1: downwards only */
    bench.at_phase(0, 2 * 8500 - 6800);
    TEST_ASSERT_TRUE(bench.chip.lines[27]);
    TEST_ASSERT_EQUAL_UINT32(2, bench.chip.read(sr) & 2);
    bench.chip.write(sr, ~2u);
    TEST_ASSERT_FALSE(bench.chip.lines[27]);
    TEST_ASSERT_EQUAL_UINT32(0, bench.chip.read(sr) & 2);
}

void test_the_lock_keeps_dead_time_and_break()
{
    PwmBench bench;
    bench.chip.write(tim1 + 0x44, bench.chip.read(tim1 + 0x44) | 1 << 8);
    bench.refused("LOCK", tim1 + 0x44, bench.chip.read(tim1 + 0x44) ^ 1);
    bench.refused("LOCK", tim1 + 0x60, 0);
    bench.chip.write(tim1 + 0x20, 0); /* level 1 leaves CCER */
}

void test_a_break_clears_MOE_and_refuses_it_while_it_lasts()
{
    PwmBench bench;
    bench.start();
    const std::uint32_t bdtr = bench.chip.read(tim1 + 0x44);
    bench.chip.write(tim1 + 0x0c, 1 << 7);
    bench.chip.write(tim1 + 0x20, 0);
    bench.chip.write(tim1 + 0x44, bdtr | 1 << 15);
    bench.device.tim1().comparator(2, true);
    TEST_ASSERT_FALSE(bench.device.tim1().outputs_enabled());
    TEST_ASSERT_TRUE(bench.chip.lines[24]);
    bench.refused("break input is active", tim1 + 0x44, bdtr | 1 << 15);
    bench.device.tim1().comparator(2, false);
    TEST_ASSERT_TRUE(bench.chip.lines[24]); /* the flag stays */
    bench.chip.write(sr, ~(1u << 7));
    TEST_ASSERT_FALSE(bench.chip.lines[24]);
    bench.chip.write(tim1 + 0x44, bdtr | 1 << 15);
    TEST_ASSERT_TRUE(bench.device.tim1().outputs_enabled());
}

/* With BKP = 0 an input that rests low is a break, as after a reset of AF1 and BKE set. */
void test_break_polarity_low_is_active_at_rest()
{
    PwmBench bench;
    const std::uint32_t bdtr = bench.chip.read(tim1 + 0x44) & ~(1u << 13);
    bench.refused("break input is active", tim1 + 0x44, bdtr | 1 << 15);
}

void test_a_slave_starts_with_the_trigger_and_updates_each_period()
{
    PwmBench bench;
    bench.chip.write(tim3 + 0x2c, 999);
    bench.chip.write(tim3 + 0x14, 1);
    bench.chip.write(tim3 + 0x24, 992);
    bench.chip.write(tim3 + 0x10, 0);
    bench.chip.write(tim3 + 0x04, 2 << 4);
    bench.chip.write(tim3 + 0x08, 6);
    bench.chip.write(tim3 + 0x0c, 1);
    bench.start();
    bench.at_phase(0, 8499);
    TEST_ASSERT_EQUAL_UINT32(0, bench.chip.read(tim3) & 1);
    bench.at_phase(0, 8500 + 2);
    TEST_ASSERT_EQUAL_UINT32(1, bench.chip.read(tim3) & 1);
    TEST_ASSERT_EQUAL_UINT32(992, bench.chip.read(tim3 + 0x24));
    bench.at_phase(0, 8500 + 9);
    TEST_ASSERT_FALSE(bench.chip.lines[29]);
    bench.at_phase(0, 8500 + 10);
    TEST_ASSERT_TRUE(bench.chip.lines[29]);
    const std::uint64_t before = bench.device.timer(Trigger::tim3).updates();
    bench.at_phase(10, 8500 + 10);
    TEST_ASSERT_TRUE(bench.device.timer(Trigger::tim3).updates() == before + 170);
}

void test_a_general_timer_compares_over_its_overflow()
{
    Bench bench;
    bench.start_clocks();
    constexpr std::uint32_t tim2 = 0x40000000;
    bench.chip.write(tim2 + 0x24, 0xffffff00);
    bench.chip.write(tim2 + 0x34, 0x100);
    bench.chip.write(tim2 + 0x0c, 2);
    const Ticks begin = bench.chip.now();
    bench.chip.write(tim2, 1);
    bench.chip.run_until(begin + 0x1ff * cycle);
    TEST_ASSERT_FALSE(bench.chip.lines[28]);
    bench.chip.run_until(begin + 0x200 * cycle);
    TEST_ASSERT_TRUE(bench.chip.lines[28]);
    TEST_ASSERT_EQUAL_UINT32(0x100, bench.chip.read(tim2 + 0x24));
    bench.chip.write(tim2 + 0x10, ~2u);
    TEST_ASSERT_FALSE(bench.chip.lines[28]);
}

void test_a_compare_above_the_reload_never_matches()
{
    constexpr std::uint32_t tim2 = 0x40000000, ccr1 = tim2 + 0x34, ccr2 = tim2 + 0x38;
    Bench bench;
    bench.start_clocks();
    bench.chip.write(tim2 + 0x2c, 999);
    bench.chip.write(tim2 + 0x14, 1);
    bench.chip.write(ccr1, 1000);
    bench.chip.write(ccr2, 999);
    bench.chip.write(tim2 + 0x10, 0);
    bench.chip.write(tim2, 1);
    bench.chip.run_for(2500 * cycle);
    TEST_ASSERT_EQUAL_HEX32(4 | 1, bench.chip.read(tim2 + 0x10) & 7);
}

void test_a_prescaler_acts_from_the_update_on()
{
    Bench bench;
    bench.start_clocks();
    bench.chip.write(tim3 + 0x28, 169);
    bench.chip.write(tim3 + 0x14, 1);
    bench.chip.write(tim3, 1);
    bench.chip.run_for(25 * microsecond);
    TEST_ASSERT_EQUAL_UINT32(25, bench.chip.read(tim3 + 0x24));
}

void test_rcr_written_behind_the_start_loads_at_peaks_by_either_reading_of_the_manual()
{
    for (const bool fills : {false, true}) {
        Bench bench;
        bench.start_clocks();
        bench.device.tim1().rcr_fills_while_stopped = fills;
        bench.chip.write(tim1, 1 << 5 | 1 << 7);
        bench.chip.write(tim1 + 0x2c, 8500);
        bench.chip.write(tim1 + 0x30, 0);
        bench.chip.write(tim1 + 0x14, 1);
        bench.chip.write(sr, 0);
        bench.chip.set(tim1, 1);
        bench.chip.write(tim1 + 0x30, 1);
        bench.chip.run_for(half * 9);
        TEST_ASSERT_TRUE(bench.device.tim1().counters.updates_at_peak == 5);
        TEST_ASSERT_TRUE(bench.device.tim1().counters.updates_at_valley == 0);
    }
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_the_dead_time_code_has_four_ranges);
    RUN_TEST(test_the_count_goes_up_to_arr_and_down_again);
    RUN_TEST(test_compares_load_at_the_peaks_only);
    RUN_TEST(test_a_repetition_count_loaded_before_the_start_updates_at_the_valleys);
    RUN_TEST(test_without_repetition_both_extremes_update);
    RUN_TEST(test_a_compare_flag_falls_by_writing_0_and_comes_while_counting_down);
    RUN_TEST(test_the_lock_keeps_dead_time_and_break);
    RUN_TEST(test_a_break_clears_MOE_and_refuses_it_while_it_lasts);
    RUN_TEST(test_break_polarity_low_is_active_at_rest);
    RUN_TEST(test_a_slave_starts_with_the_trigger_and_updates_each_period);
    RUN_TEST(test_a_general_timer_compares_over_its_overflow);
    RUN_TEST(test_a_compare_above_the_reload_never_matches);
    RUN_TEST(test_a_prescaler_acts_from_the_update_on);
    RUN_TEST(test_rcr_written_behind_the_start_loads_at_peaks_by_either_reading_of_the_manual);
    return UNITY_END();
}
