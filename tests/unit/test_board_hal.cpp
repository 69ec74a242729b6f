/* The parts of the simulated board that are not the plant: flash, byte stream, watchdog. */
#include <cstdint>
#include <cstring>
#include <memory>
#include <unity.h>

#include "hal/sil/hal_sil.h"

namespace
{

std::unique_ptr<hal_sil> sil;

const hal &board()
{
    return sil->board;
}

} // namespace

void setUp()
{
    hal_facts facts = {};
    facts.control_period_s = 1e-4;
    facts.pwm_half_period_counts = 8500;
    sil = std::make_unique<hal_sil>();
    hal_sil_init(sil.get(), &facts);
}

void tearDown()
{
}

namespace
{

void test_flash_is_erased_to_ones_and_read_back_as_programmed()
{
    const std::uint8_t data[16] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    std::uint8_t read[24];
    TEST_ASSERT_TRUE(board().parameters_program(board().context, 2048, data, sizeof data));
    TEST_ASSERT_TRUE(board().parameters_read(board().context, 2048, read, sizeof read));
    TEST_ASSERT_EQUAL_UINT8_ARRAY(data, read, sizeof data);
    for (int i = 16; i < 24; i++) {
        TEST_ASSERT_EQUAL_HEX8(0xff, read[i]);
    }
}

void test_flash_is_not_programmed_twice_without_an_erase()
{
    const std::uint8_t first[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    const std::uint8_t second[16] = {};
    std::uint8_t read[16];
    TEST_ASSERT_TRUE(board().parameters_program(board().context, 8, first, 8));
    TEST_ASSERT_FALSE(board().parameters_program(board().context, 8, second, 8));
    TEST_ASSERT_FALSE(board().parameters_program(board().context, 0, second, 16));
    TEST_ASSERT_TRUE(board().parameters_read(board().context, 0, read, 16));
    TEST_ASSERT_EQUAL_HEX8(0xff, read[0]); /* refused as a whole */
    TEST_ASSERT_EQUAL_HEX8(1, read[8]);
    TEST_ASSERT_TRUE(board().parameters_erase(board().context, 0));
    TEST_ASSERT_TRUE(board().parameters_program(board().context, 0, second, 16));
}

void test_flash_is_erased_by_the_page()
{
    const std::uint8_t data[8] = {};
    std::uint8_t read[8];
    TEST_ASSERT_TRUE(board().parameters_program(board().context, 2040, data, 8));
    TEST_ASSERT_TRUE(board().parameters_program(board().context, 2048, data, 8));
    TEST_ASSERT_TRUE(board().parameters_erase(board().context, 1));
    TEST_ASSERT_TRUE(board().parameters_read(board().context, 2040, read, 8));
    TEST_ASSERT_EQUAL_HEX8(0, read[0]);
    TEST_ASSERT_TRUE(board().parameters_read(board().context, 2048, read, 8));
    TEST_ASSERT_EQUAL_HEX8(0xff, read[0]);
}

void test_flash_refuses_what_is_out_of_range_or_not_whole_words()
{
    std::uint8_t data[16] = {};
    const std::uint32_t end = HAL_SIL_PAGES * HAL_SIL_PAGE_BYTES;
    TEST_ASSERT_FALSE(board().parameters_program(board().context, 4, data, 8));
    TEST_ASSERT_FALSE(board().parameters_program(board().context, 0, data, 7));
    TEST_ASSERT_FALSE(board().parameters_program(board().context, end - 8, data, 16));
    TEST_ASSERT_FALSE(board().parameters_read(board().context, end - 8, data, 16));
    TEST_ASSERT_FALSE(board().parameters_read(board().context, 0xfffffff8u, data, 16));
    TEST_ASSERT_FALSE(board().parameters_erase(board().context, HAL_SIL_PAGES));
    TEST_ASSERT_TRUE(board().parameters_read(board().context, end - 8, data, 8));
    TEST_ASSERT_EQUAL_UINT32(2048, board().facts->parameter_page_bytes);
    TEST_ASSERT_EQUAL_UINT32(8, board().facts->parameter_word_bytes);
}

std::size_t read_stream(std::uint8_t *bytes, std::size_t capacity, std::uint32_t *period)
{
    return board().stream_read(board().context, bytes, capacity, period);
}

void test_the_stream_keeps_the_order_and_never_blocks()
{
    constexpr std::size_t room = HAL_SIL_STREAM_BYTES;
    std::uint8_t bytes[room];
    std::uint8_t back[room];
    std::uint32_t period = 0;
    std::uint8_t next_in = 'a', next_out = 'a';
    const auto next = [](std::uint8_t &byte) { return byte == 'z' ? byte = 'a' : ++byte; };
    for (int round = 0; round < 10; round++) {
        for (std::uint8_t &byte : bytes) {
            byte = next(next_in);
        }
        TEST_ASSERT_EQUAL_size_t(room - 24, hal_sil_host_write(sil.get(), bytes, room - 24));
        TEST_ASSERT_EQUAL_size_t(24, hal_sil_host_write(sil.get(), bytes + room - 24, 1000));
        TEST_ASSERT_EQUAL_size_t(1000, read_stream(back, 1000, &period));
        TEST_ASSERT_EQUAL_size_t(room - 1000, read_stream(back + 1000, room, &period));
        for (std::uint8_t byte : back) {
            TEST_ASSERT_EQUAL_UINT8(next(next_out), byte);
        }
        TEST_ASSERT_EQUAL_size_t(0, read_stream(back, room, &period));
    }
    TEST_ASSERT_EQUAL_size_t(3, board().stream_write(board().context, bytes, 3));
    TEST_ASSERT_EQUAL_size_t(2, hal_sil_host_read(sil.get(), back, 2));
    TEST_ASSERT_EQUAL_size_t(1, hal_sil_host_read(sil.get(), back, 2));
}

std::size_t write_text(const char *text)
{
    return hal_sil_host_write(sil.get(), reinterpret_cast<const std::uint8_t *>(text),
                              std::strlen(text));
}

void test_a_line_is_read_alone_with_the_period_of_its_last_byte()
{
    std::uint8_t bytes[100];
    std::uint32_t period = 7;
    write_text("early\nhal");
    hal_sil_control_begins(sil.get()); /* 0 */
    hal_sil_control_begins(sil.get()); /* 1 */
    write_text("f\n\nrest");
    hal_sil_control_begins(sil.get());
    TEST_ASSERT_EQUAL_size_t(6, read_stream(bytes, sizeof bytes, &period));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, period); /* before the first control interrupt */
    TEST_ASSERT_EQUAL_size_t(5, read_stream(bytes, sizeof bytes, &period));
    TEST_ASSERT_EQUAL_UINT32(1, period);
    TEST_ASSERT_EQUAL_size_t(1, read_stream(bytes, sizeof bytes, &period));
    period = 7;
    TEST_ASSERT_EQUAL_size_t(4, read_stream(bytes, sizeof bytes, &period));
    TEST_ASSERT_EQUAL_UINT32(7, period); /* no line has ended */
    TEST_ASSERT_EQUAL_size_t(0, read_stream(bytes, sizeof bytes, &period));
}

void test_a_restart_keeps_the_parameters_and_the_time_alone()
{
    const std::uint8_t data[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    std::uint8_t bytes[8];
    std::uint32_t period = 0;
    TEST_ASSERT_EQUAL_STRING("power-on", board().start_cause(board().context));
    hal_sil_control_begins(sil.get());
    hal_sil_next_period(sil.get());
    board().parameters_program(board().context, 0, data, 8);
    board().watchdog_feed(board().context);
    TEST_ASSERT_TRUE(board().bridge_enable(board().context));
    write_text("lost\n");
    hal_sil_restart(sil.get());
    TEST_ASSERT_FALSE(hal_sil_bridge_on(sil.get()));
    TEST_ASSERT_EQUAL_size_t(0, read_stream(bytes, sizeof bytes, &period));
    TEST_ASSERT_TRUE(board().parameters_read(board().context, 0, bytes, 8));
    TEST_ASSERT_EQUAL_UINT8_ARRAY(data, bytes, 8);
    TEST_ASSERT_EQUAL_UINT64(100, board().time_us(board().context));
    for (int k = 0; k < 1000; k++) {
        hal_sil_next_period(sil.get());
    }
    TEST_ASSERT_FALSE(hal_sil_watchdog_expired(sil.get()));
    write_text("new\n");
    TEST_ASSERT_EQUAL_size_t(4, read_stream(bytes, sizeof bytes, &period));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, period);
    TEST_ASSERT_EQUAL_STRING("power-on after a power cycle", board().start_cause(board().context));
}

void pass_periods(int periods)
{
    for (int k = 0; k < periods; k++) {
        hal_sil_next_period(sil.get());
    }
}

void test_the_watchdog_expires_when_it_is_no_longer_fed()
{
    pass_periods(1000);
    TEST_ASSERT_FALSE(hal_sil_watchdog_expired(sil.get())); /* not started */
    board().watchdog_feed(board().context);
    pass_periods(500);
    TEST_ASSERT_FALSE(hal_sil_watchdog_expired(sil.get()));
    pass_periods(1);
    TEST_ASSERT_TRUE(hal_sil_watchdog_expired(sil.get()));
    board().watchdog_feed(board().context);
    TEST_ASSERT_FALSE(hal_sil_watchdog_expired(sil.get()));
}

void test_the_cycle_counter_wraps_and_the_time_does_not()
{
    sil->period = 300000;
    TEST_ASSERT_EQUAL_UINT32(static_cast<std::uint32_t>(300000ULL * 17000ULL),
                             board().cycle_count(board().context));
    TEST_ASSERT_EQUAL_UINT64(30000000, board().time_us(board().context));
    sil->period = 100000000000; /* four months */
    TEST_ASSERT_EQUAL_UINT64(10000000000000, board().time_us(board().context));
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_flash_is_erased_to_ones_and_read_back_as_programmed);
    RUN_TEST(test_flash_is_not_programmed_twice_without_an_erase);
    RUN_TEST(test_flash_is_erased_by_the_page);
    RUN_TEST(test_flash_refuses_what_is_out_of_range_or_not_whole_words);
    RUN_TEST(test_the_stream_keeps_the_order_and_never_blocks);
    RUN_TEST(test_a_line_is_read_alone_with_the_period_of_its_last_byte);
    RUN_TEST(test_a_restart_keeps_the_parameters_and_the_time_alone);
    RUN_TEST(test_the_watchdog_expires_when_it_is_no_longer_fed);
    RUN_TEST(test_the_cycle_counter_wraps_and_the_time_does_not);
    return UNITY_END();
}
