/* FDCAN3: bit timing, filters, both FIFOs, the time of a frame, errors up to bus-off and back. */
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

constexpr std::uint32_t fdcan = 0x40006c00, ram = 0x4000aaa0;
constexpr std::uint32_t CCCR = fdcan + 0x18, NBTP = fdcan + 0x1c, PSR = fdcan + 0x44;
constexpr std::uint32_t ECR = fdcan + 0x40, IR = fdcan + 0x50, IE = fdcan + 0x54;
constexpr std::uint32_t ILE = fdcan + 0x5c, RXGFC = fdcan + 0x80, RXF0S = fdcan + 0x90;
constexpr std::uint32_t RXF0A = fdcan + 0x94, TXFQS = fdcan + 0xc4, TXBRP = fdcan + 0xc8;
constexpr std::uint32_t TXBAR = fdcan + 0xcc;
constexpr std::uint32_t INIT = 1, CCE = 2, BO = 1u << 7, EP = 1u << 5;
constexpr std::uint32_t timing = 8u << 25 | 4u << 16 | 57u << 8 | 8u; /* 5 x 68 of 170 MHz */
constexpr Ticks bit_time = 2 * microsecond;
constexpr unsigned line = Fdcan::interrupt_line;

struct CanBench : Bench {
    explicit CanBench(std::uint32_t nbtp = timing)
    {
        start_clocks();
        route('A', 15, 11);
        route('B', 3, 11);
        chip.set(rcc + 0x58, 1u << 25);
        chip.set(rcc + 0x88, 2u << 24);
        chip.write(CCCR, INIT | CCE);
        chip.write(NBTP, nbtp);
        chip.write(RXGFC, 2u << 16 | 2u << 4 | 2u << 2 | 3u);
        filter(0, 0x000, 0x601);
        filter(1, 0x080, 0x705);
        chip.write(IE, 1);
        chip.write(ILE, 1);
    }
    void filter(unsigned at, unsigned first, unsigned second)
    {
        chip.write(ram + 4 * at, 1u << 30 | 1u << 27 | first << 16 | second);
    }
    void join()
    {
        chip.write(CCCR, 0);
    }
    void come(std::uint16_t id, std::uint8_t length, std::uint8_t first = 0)
    {
        can_frame frame = {id, length, {first, 2, 3, 4, 5, 6, 7, 8}};
        TEST_ASSERT_TRUE(device.can().send(frame));
    }
    /* Requests the next buffer of the FIFO. */
    void request(unsigned id, unsigned length)
    {
        const unsigned at = chip.read(TXFQS) >> 16 & 3u;
        const std::uint32_t element = ram + 0x278 + 72 * at;
        chip.write(element, id << 18);
        chip.write(element + 4, length << 16);
        chip.write(element + 8, 0x44332211);
        chip.write(element + 12, 0x88776655);
        chip.write(TXBAR, 1u << at);
    }
    void expect(unsigned fill, unsigned get)
    {
        TEST_ASSERT_EQUAL_UINT(fill, chip.read(RXF0S) & 15u);
        TEST_ASSERT_EQUAL_UINT(get, chip.read(RXF0S) >> 8 & 3u);
    }
};

void test_the_bit_timing_is_that_of_the_bus_or_refused()
{
    CanBench right;
    right.join();
    TEST_ASSERT_EQUAL_DOUBLE(500e3, right.device.can().bit_Hz());
    TEST_ASSERT_EQUAL_DOUBLE(59.0 / 68.0, right.device.can().sample_point());
    CanBench slow(timing + (1u << 16));
    expect_refused(slow.chip, "error frames", CCCR, 0);
    CanBench late(8u << 25 | 4u << 16 | 58u << 8 | 7u); /* 60 of 68: 88.2 % */
    expect_refused(late.chip, "sample point", CCCR, 0);
    CanBench wide(9u << 25 | (timing & 0x1ffffff));
    expect_refused(wide.chip, "jump", CCCR, 0);
    CanBench crystal;
    crystal.chip.write(rcc + 0x88, 0);
    expect_refused(crystal.chip, "kernel clock", CCCR, 0);
    CanBench loose;
    loose.route('A', 15, 0);
    expect_refused(loose.chip, "TX is routed to no pin", CCCR, 0);
}

void test_configuration_is_protected()
{
    CanBench bench;
    bench.join();
    expect_refused(bench.chip, "protected", NBTP, timing);
    expect_refused(bench.chip, "protected", RXGFC, 0);
    expect_refused(bench.chip, "CCE set while INIT is 0", CCCR, CCE);
    bench.chip.write(rcc + 0x58, bench.chip.read(rcc + 0x58) & ~(1u << 25));
    expect_refused(bench.chip, "clock is off", CCCR, 1);
    expect_refused(bench.chip, "clock is off", ram, 0);
}

void test_a_frame_takes_its_bits_and_comes_through_its_filter()
{
    CanBench bench;
    bench.join();
    const Ticks begin = bench.chip.now();
    bench.come(0x602, 8); /* another node's */
    bench.come(0x601, 8, 0x40);
    bench.chip.run_until(begin + 2 * 111 * bit_time - 10);
    bench.expect(0, 0);
    TEST_ASSERT_FALSE(bench.chip.lines[line]);
    bench.chip.run_until(begin + 2 * 111 * bit_time + 10);
    bench.expect(1, 0);
    TEST_ASSERT_TRUE(bench.chip.lines[line]);
    TEST_ASSERT_EQUAL_HEX32(0x601u << 18, bench.chip.read(ram + 0xb0));
    TEST_ASSERT_EQUAL_HEX32(8u << 16, bench.chip.read(ram + 0xb4));
    TEST_ASSERT_EQUAL_HEX32(0x04030240, bench.chip.read(ram + 0xb8));
    TEST_ASSERT_EQUAL_HEX32(0x08070605, bench.chip.read(ram + 0xbc));
    bench.chip.write(IR, 1);
    TEST_ASSERT_FALSE(bench.chip.lines[line]);
    expect_refused(bench.chip, "oldest", RXF0A, 1);
    bench.chip.write(RXF0A, 0);
    bench.expect(0, 1);
    TEST_ASSERT_EQUAL_UINT64(1, bench.device.can().counters.filtered);
}

void test_a_fourth_frame_is_lost_and_flagged()
{
    CanBench bench;
    bench.join();
    for (std::uint8_t i = 0; i < 4; i++) {
        bench.come(0x080, 1, i);
    }
    bench.chip.run_for(1000 * microsecond);
    bench.expect(3, 0);
    TEST_ASSERT_EQUAL_HEX32(1u << 25 | 1u << 24, bench.chip.read(RXF0S) & 3u << 24);
    TEST_ASSERT_EQUAL_HEX32(1u << 2, bench.chip.read(IR) & 1u << 2);
    bench.chip.write(IR, 1u << 2);
    TEST_ASSERT_EQUAL_HEX32(0, bench.chip.read(RXF0S) & 1u << 25);
    for (unsigned i = 0; i < 3; i++) { /* the oldest first, what came last is not there */
        TEST_ASSERT_EQUAL_HEX32(0x04030200 | i,
                                bench.chip.read(ram + 0xb0 + 72 * i + 8) & 0xffffffffu);
        bench.chip.write(RXF0A, i);
    }
    bench.expect(0, 0);
}

void test_frames_are_sent_in_turn_and_the_lower_identifier_wins()
{
    CanBench bench;
    bench.join();
    bench.request(0x701, 1);
    bench.request(0x081, 8);
    bench.come(0x080, 0);
    bench.request(0x581, 8);
    TEST_ASSERT_EQUAL_HEX32(1u << 21, bench.chip.read(TXFQS) & (1u << 21 | 7u));
    expect_refused(bench.chip, "another buffer", TXBAR, 2);
    bench.chip.run_for((55 + 47) * bit_time + 10);
    TEST_ASSERT_EQUAL_HEX32(6, bench.chip.read(TXBRP));
    bench.expect(1, 0); /* 080h went before 081h */
    bench.chip.run_for(2 * 111 * bit_time);
    const std::vector<can_frame> sent = bench.device.can().take_output();
    TEST_ASSERT_EQUAL_size_t(3, sent.size());
    TEST_ASSERT_EQUAL_HEX16(0x701, sent[0].id);
    TEST_ASSERT_EQUAL_HEX8(1, sent[0].length);
    TEST_ASSERT_EQUAL_HEX8(0x11, sent[0].data[0]);
    TEST_ASSERT_EQUAL_HEX16(0x081, sent[1].id);
    TEST_ASSERT_EQUAL_HEX8(0x88, sent[1].data[7]);
    TEST_ASSERT_EQUAL_HEX16(0x581, sent[2].id);
    TEST_ASSERT_EQUAL_UINT(3, bench.chip.read(TXFQS) & 7u);
}

void test_who_is_alone_becomes_error_passive_and_no_more()
{
    CanBench bench;
    bench.join();
    bench.device.can().acknowledge(false);
    bench.request(0x701, 1);
    bench.chip.run_for(100000 * microsecond);
    TEST_ASSERT_EQUAL_HEX32(EP, bench.chip.read(PSR) & (EP | BO));
    TEST_ASSERT_EQUAL_UINT(128, bench.chip.read(ECR));
    bench.device.can().acknowledge(true);
    bench.chip.run_for(1000 * microsecond);
    TEST_ASSERT_EQUAL_UINT(127, bench.chip.read(ECR));
    TEST_ASSERT_EQUAL_size_t(1, bench.device.can().take_output().size());
}

void test_errors_end_in_bus_off_until_129_times_11_bits_behind_init()
{
    CanBench bench;
    bench.join();
    bench.device.can().disturb(32);
    bench.request(0x701, 1);
    bench.chip.run_for(10000 * microsecond);
    TEST_ASSERT_EQUAL_HEX32(BO, bench.chip.read(PSR) & BO);
    TEST_ASSERT_EQUAL_HEX32(INIT, bench.chip.read(CCCR));
    TEST_ASSERT_EQUAL_HEX32(1u << 19, bench.chip.read(IR) & 1u << 19);
    TEST_ASSERT_EQUAL_HEX32(1, bench.chip.read(TXBRP));
    bench.come(0x601, 8);
    bench.chip.run_for(1000 * microsecond);
    bench.expect(0, 0); /* it does not hear either */
    bench.chip.write(CCCR, INIT | CCE);
    TEST_ASSERT_EQUAL_HEX32(0, bench.chip.read(TXBRP)); /* what it was to send is dropped */
    bench.chip.write(CCCR, 0);
    bench.chip.run_for(1419 * bit_time - 10);
    TEST_ASSERT_EQUAL_HEX32(BO, bench.chip.read(PSR) & BO);
    bench.chip.run_for(20);
    TEST_ASSERT_EQUAL_HEX32(0, bench.chip.read(PSR) & (BO | EP));
    TEST_ASSERT_EQUAL_UINT(0, bench.chip.read(ECR));
    bench.come(0x601, 8);
    bench.chip.run_for(1000 * microsecond);
    bench.expect(1, 0);
}

void test_message_ram_is_anything_at_power_on_and_takes_whole_words()
{
    CanBench bench;
    TEST_ASSERT_NOT_EQUAL(0, bench.chip.read(ram + 8));
    try {
        bench.chip.store(ram + 8, 1, 0);
        TEST_FAIL_MESSAGE("a byte");
    } catch (const Refusal &) {
    }
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_the_bit_timing_is_that_of_the_bus_or_refused);
    RUN_TEST(test_configuration_is_protected);
    RUN_TEST(test_a_frame_takes_its_bits_and_comes_through_its_filter);
    RUN_TEST(test_a_fourth_frame_is_lost_and_flagged);
    RUN_TEST(test_frames_are_sent_in_turn_and_the_lower_identifier_wins);
    RUN_TEST(test_who_is_alone_becomes_error_passive_and_no_more);
    RUN_TEST(test_errors_end_in_bus_off_until_129_times_11_bits_behind_init);
    RUN_TEST(test_message_ram_is_anything_at_power_on_and_takes_whole_words);
    return UNITY_END();
}
