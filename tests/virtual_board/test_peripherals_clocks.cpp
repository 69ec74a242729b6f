/* Clocks, flash, watchdog and the refusals of registers, against RM0440. */
#include "sil/virtual_board/peripherals/stm32g071_board.h"
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

void test_the_crystal_and_the_pll_give_170_MHz()
{
    Bench bench;
    TEST_ASSERT_TRUE(bench.chip.core_cycle() == 340); /* HSI16 after reset */
    bench.start_clocks();
    TEST_ASSERT_TRUE(bench.chip.core_cycle() == cycle);
    TEST_ASSERT_TRUE(bench.device.rcc().hclk_Hz() == 170e6);
    TEST_ASSERT_TRUE((bench.chip.read(rcc + 0x08) & 0xf) == 0xf); /* SW and SWS */
}

void test_a_crystal_that_does_not_start_is_never_ready()
{
    Stm32g474Config config = Bench::make_config();
    config.clock.crystal_starts = false;
    Bench bench(config);
    bench.chip.write(rcc, 0x10500);
    bench.chip.run_for(100000 * microsecond);
    TEST_ASSERT_TRUE((bench.chip.read(rcc) & 1 << 17) == 0);
}

void test_the_clock_needs_wait_states_boost_and_the_step_over_half_speed()
{
    Bench bench;
    bench.start_clocks();
    bench.refused("LATENCY", flash_registers, 0x40703);
    bench.refused("supply range", pwr + 0x80, 0x100);
    bench.refused("reserved", pwr + 0x80, 0x1); /* R1MODE is bit 8 */
    bench.refused("while the PLL is on", rcc + 0x0c, 3 | 4 << 4 | 85 << 8 | 1 << 24);
    bench.refused("SYSCLK", rcc, 0x10500);

    Bench slow;
    slow.chip.write(rcc + 0x58, 1 << 28);
    slow.chip.write(pwr + 0x80, 0);
    slow.chip.write(flash_registers, 0x40704);
    slow.chip.write(rcc + 0x0c, 2 | 3 << 4 | 85 << 8 | 1 << 24);
    slow.chip.write(rcc, 0x1000500);
    slow.refused("not ready", rcc + 0x08, 8 << 4 | 3);
    slow.chip.run_for(40 * microsecond);
    slow.refused("one step", rcc + 0x08, 3);
    slow.chip.write(rcc + 0x08, 1);
    slow.chip.write(rcc + 0x08, 8 << 4 | 3);
    slow.refused("1 us", rcc + 0x08, 3);
}

void test_a_block_without_its_clock_an_unknown_offset_and_a_half_access_are_refused()
{
    Bench bench;
    bench.refused("clock is off", tim1, 0);
    bench.refused("no register", rcc + 0x3f0, 0);
    bench.start_clocks();
    bench.refused("reserved", tim1, 1u << 30);
    try {
        bench.chip.store(rcc + 0x08, 2, 3);
        TEST_FAIL_MESSAGE("half access");
    } catch (const Refusal &) {
    }
}

void test_the_cause_of_a_reset_stays_until_it_is_removed()
{
    Bench bench;
    TEST_ASSERT_EQUAL_HEX32(0x0c000000, bench.chip.read(rcc + 0x94));
    bench.chip.write(rcc + 0x94, 1 << 23);
    TEST_ASSERT_EQUAL_HEX32(0, bench.chip.read(rcc + 0x94));
    bench.start_clocks();
    bench.device.reset("watchdog");
    TEST_ASSERT_EQUAL_HEX32(0x24000000, bench.chip.read(rcc + 0x94));
    TEST_ASSERT_TRUE(bench.chip.core_cycle() == 340);
}

void unlock(Bench &bench)
{
    bench.chip.write(flash_registers + 0x08, 0x45670123);
    bench.chip.write(flash_registers + 0x08, 0xcdef89ab);
}

/* ACR with the data cache off: nothing is written while it is on. */
void data_cache_off(Bench &bench)
{
    bench.chip.write(flash_registers, 0x40304);
}

bool busy(Bench &bench)
{
    return (bench.chip.read(flash_registers + 0x10) & 1 << 16) != 0;
}

void test_flash_erases_in_22_ms_programs_in_85_us_and_keeps_its_contents()
{
    Bench bench;
    bench.start_clocks();
    Flash &flash = bench.device.flash_controller();
    const std::uint32_t page = 0x08000000 + 256 * 1024 + 124 * 2048;
    flash.memory()[page - Flash::base] = 0x12;
    bench.refused("locked", flash_registers + 0x14, 1);
    unlock(bench);
    bench.refused("data cache", flash_registers + 0x14, 1);
    bench.refused("data cache", flash_registers + 0x14, 2 | 1 << 16);
    data_cache_off(bench);
    bench.chip.write(flash_registers + 0x14, 2 | 124 << 3 | 1 << 11 | 1 << 16);
    TEST_ASSERT_TRUE(flash.busy_until(page) == bench.chip.now() + 22000 * microsecond);
    TEST_ASSERT_TRUE(flash.busy_until(0x08000000) == bench.chip.now()); /* the other bank */
    bench.refused("DCEN", flash_registers, 0x40704);
    bench.chip.run_for(22000 * microsecond - 1);
    TEST_ASSERT_TRUE(busy(bench));
    bench.chip.run_for(1);
    TEST_ASSERT_FALSE(busy(bench));
    TEST_ASSERT_EQUAL_HEX8(0xff, flash.memory()[page - Flash::base]);

    bench.chip.write(flash_registers + 0x14, 1);
    flash.store(page, 4, 0x11223344);
    TEST_ASSERT_FALSE(busy(bench));
    flash.store(page + 4, 4, 0x55667788);
    bench.chip.run_for(85 * microsecond - 1);
    TEST_ASSERT_TRUE(busy(bench));
    bench.chip.run_for(1);
    TEST_ASSERT_FALSE(busy(bench));
    TEST_ASSERT_EQUAL_HEX8(0x44, flash.memory()[page - Flash::base]);
    TEST_ASSERT_EQUAL_HEX8(0x55, flash.memory()[page - Flash::base + 7]);
    bench.device.reset("software");
    TEST_ASSERT_EQUAL_HEX8(0x44, flash.memory()[page - Flash::base]);
}

void test_the_debugger_stays_on_over_every_write_of_the_flash_s_access_control()
{
    Bench bench;
    TEST_ASSERT_EQUAL_HEX32(0x40600, bench.chip.read(flash_registers)); /* RM0440: reset value */
    bench.refused("DBG_SWEN", flash_registers, 0x704);
    bench.start_clocks();
    bench.refused("DBG_SWEN", flash_registers, 0x304);

    FakeChip small;
    G071Board board(small, bench::config(), 115200.0);
    small.mappings = board.mappings();
    board.reset("power-on");
    TEST_ASSERT_EQUAL_HEX32(0x40600, small.read(flash_registers)); /* RM0444: reset value */
    expect_refused(small, "DBG_SWEN", flash_registers, 0x302);
    small.write(flash_registers, 0x40302);
}

void expect_store_refused(Bench &bench, const char *text, std::uint32_t address, unsigned size)
{
    try {
        bench.device.flash_controller().store(address, size, 1);
    } catch (const Refusal &refusal) {
        TEST_ASSERT_TRUE(std::string(refusal.what()).find(text) != std::string::npos);
        return;
    }
    TEST_FAIL_MESSAGE(text);
}

void test_flash_refuses_what_silicon_refuses()
{
    Bench bench;
    bench.start_clocks();
    const std::uint32_t page = 0x08040000;
    bench.refused("wrong key", flash_registers + 0x08, 0xcdef89ab);
    expect_store_refused(bench, "locked", page, 4);
    unlock(bench);
    expect_store_refused(bench, "PG", page, 4);
    data_cache_off(bench);
    bench.chip.write(flash_registers + 0x14, 1);
    expect_store_refused(bench, "SIZERR", page, 2);
    expect_store_refused(bench, "PGAERR", page + 4, 4);
    bench.device.flash_controller().memory()[page - Flash::base + 3] = 0;
    bench.device.flash_controller().store(page, 4, 1);
    expect_store_refused(bench, "not erased", page + 4, 4);
}

void test_cells_that_a_reset_cut_off_raise_the_nmi_until_they_are_erased()
{
    Bench bench;
    const std::uint32_t page = 0x08000000 + 256 * 1024 + 124 * 2048;
    Flash &flash = bench.device.flash_controller();
    const auto begin = [&bench](std::uint32_t operation) {
        bench.start_clocks();
        unlock(bench);
        data_cache_off(bench);
        bench.chip.write(flash_registers + 0x14, operation);
    };
    begin(1);
    flash.store(page + 8, 4, 1);
    flash.store(page + 12, 4, 2);
    bench.chip.run_for(40 * microsecond);
    flash.core_reads(page, 4); /* whole so far */
    TEST_ASSERT_EQUAL_UINT(0, bench.chip.non_maskable_interrupts);
    bench.device.reset("power-on");

    flash.core_reads(page + 4, 4);
    flash.core_reads(page + 16, 4);
    TEST_ASSERT_EQUAL_UINT(0, bench.chip.non_maskable_interrupts);
    flash.core_reads(page + 12, 1);
    TEST_ASSERT_EQUAL_UINT(1, bench.chip.non_maskable_interrupts);
    bench.start_clocks();
    TEST_ASSERT_EQUAL_HEX32(1u << 31 | 1u << 21 | (124 * 2048 + 8),
                            bench.chip.read(flash_registers + 0x18));
    bench.chip.write(flash_registers + 0x18, 1u << 31);
    TEST_ASSERT_EQUAL_HEX32(0, bench.chip.read(flash_registers + 0x18) >> 31);
    bench.device.reset("software");

    begin(2 | 124 << 3 | 1 << 11 | 1 << 16);
    bench.device.reset("power-on"); /* cut off as well: the whole page */
    flash.core_reads(page + 2040, 4);
    TEST_ASSERT_EQUAL_UINT(2, bench.chip.non_maskable_interrupts);
    begin(2 | 124 << 3 | 1 << 11 | 1 << 16);
    bench.chip.run_for(22000 * microsecond);
    flash.core_reads(page + 2040, 4);
    flash.core_reads(page + 8, 4);
    TEST_ASSERT_EQUAL_UINT(2, bench.chip.non_maskable_interrupts);
}

void test_the_watchdog_resets_after_its_time()
{
    Bench bench;
    bench.chip.write(iwdg, 0xcccc);
    bench.refused("access key", iwdg + 0x04, 0);
    bench.chip.write(iwdg, 0x5555);
    bench.chip.write(iwdg + 0x04, 0);   /* divided by 4 */
    bench.chip.write(iwdg + 0x08, 399); /* 400 x 4 / 32 kHz = 50 ms */
    TEST_ASSERT_EQUAL_HEX32(3, bench.chip.read(iwdg + 0x0c));
    bench.chip.run_for(200 * microsecond);
    TEST_ASSERT_EQUAL_HEX32(0, bench.chip.read(iwdg + 0x0c));
    bench.chip.write(iwdg, 0xaaaa);
    bench.chip.run_for(49999 * microsecond);
    TEST_ASSERT_TRUE(bench.chip.reset_cause.empty());
    bench.chip.write(iwdg, 0xaaaa);
    bench.chip.run_for(50000 * microsecond - 1);
    TEST_ASSERT_TRUE(bench.chip.reset_cause.empty());
    bench.chip.run_for(1);
    TEST_ASSERT_EQUAL_STRING("watchdog", bench.chip.reset_cause.c_str());
}

void test_resetting_a_block_through_the_clock_tree_clears_it()
{
    Bench bench;
    bench.start_clocks();
    bench.chip.write(tim3 + 0x28, 7);
    bench.chip.write(rcc + 0x38, 2);
    bench.chip.write(rcc + 0x38, 0);
    TEST_ASSERT_EQUAL_UINT32(0, bench.chip.read(tim3 + 0x28));
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_the_crystal_and_the_pll_give_170_MHz);
    RUN_TEST(test_a_crystal_that_does_not_start_is_never_ready);
    RUN_TEST(test_the_clock_needs_wait_states_boost_and_the_step_over_half_speed);
    RUN_TEST(test_a_block_without_its_clock_an_unknown_offset_and_a_half_access_are_refused);
    RUN_TEST(test_the_cause_of_a_reset_stays_until_it_is_removed);
    RUN_TEST(test_flash_erases_in_22_ms_programs_in_85_us_and_keeps_its_contents);
    RUN_TEST(test_the_debugger_stays_on_over_every_write_of_the_flash_s_access_control);
    RUN_TEST(test_flash_refuses_what_silicon_refuses);
    RUN_TEST(test_cells_that_a_reset_cut_off_raise_the_nmi_until_they_are_erased);
    RUN_TEST(test_the_watchdog_resets_after_its_time);
    RUN_TEST(test_resetting_a_block_through_the_clock_tree_clears_it);
    return UNITY_END();
}
