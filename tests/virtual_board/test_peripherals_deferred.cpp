/* Results that a converter puts off until somebody looks: nobody can see it. */
#include <cstring>

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
constexpr std::uint32_t control = dma1 + 0x08, left = dma1 + 0x0c;
constexpr std::uint32_t timer_control = tim3, timer_flags = tim3 + 0x10, timer_count = tim3 + 0x24;

/* The same converter twice: with interrupts of its DMA channel, so that nothing is put off, and
   without. Duties of the bridge change, so that every period has a voltage of its own. */
struct Pair {
    explicit Pair(std::uint32_t first_count = 992)
        : prompt(6, first_count), deferred(0, first_count)
    {
        for (LegBench *const bench : {&prompt, &deferred}) {
            bench->chip.run_until(bench->begin + half + 1000 * cycle);
            bench->chip.write(tim1 + 0x44, bench->chip.read(tim1 + 0x44) | 1 << 15);
        }
    }

    void run_for(Ticks time)
    {
        const std::uint32_t high = 3000 + random() % 2000;
        for (LegBench *const bench : {&prompt, &deferred}) {
            bench->compares(high, 8500 - high, 4000, 4500);
            bench->chip.run_for(time);
        }
    }
    std::uint32_t random()
    {
        random_ = random_ * 1664525 + 1013904223;
        return random_ >> 8;
    }
    void write(std::uint32_t address, std::uint32_t value)
    {
        prompt.chip.write(address, value);
        deferred.chip.write(address, value);
    }
    /* By registers first: that is the look. Not by DR: behind a peak it holds the value of the
       period before if the result came promptly. */
    void same()
    {
        for (const std::uint32_t address :
             {left, dma1, adc3, timer_flags, timer_count, timer_control}) {
            TEST_ASSERT_EQUAL_HEX32(prompt.chip.read(address), deferred.chip.read(address));
        }
        TEST_ASSERT_EQUAL_MEMORY(prompt.chip.memory.data(), deferred.chip.memory.data(), 2 * 68);
        TEST_ASSERT_EQUAL_UINT64(prompt.device.timer(Trigger::tim3).updates(),
                                 deferred.device.timer(Trigger::tim3).updates());
        const Adc::Counters &a = prompt.device.adc(3).counters;
        const Adc::Counters &b = deferred.device.adc(3).counters;
        TEST_ASSERT_EQUAL_UINT64(a.regular_sequences, b.regular_sequences);
        TEST_ASSERT_EQUAL_UINT64(a.overruns, b.overruns);
        TEST_ASSERT_EQUAL_UINT(prompt.device.power_stage().counters.groups,
                               deferred.device.power_stage().counters.groups);
    }

    LegBench prompt, deferred;

  private:
    std::uint32_t random_ = 1;
};

void test_whenever_the_core_looks_it_finds_what_it_would_have_found()
{
    Pair pair;
    for (int i = 0; i < 1000; ++i) {
        pair.run_for(1 + pair.random() % (i % 2 == 0 ? half : 600 * cycle));
        pair.same();
    }
    TEST_ASSERT_TRUE(pair.prompt.device.adc(3).counters.regular_sequences > 2000);
}

void test_behind_a_peak_the_ring_holds_the_period_without_a_look()
{
    for (const std::uint32_t first_count : {992u, 500u}) { /* 500: a group spans the peak */
        Pair pair(first_count);
        pair.run_for(2 * half - 995 * cycle);
        for (int k = 1; k < 20; ++k) { /* 5 cycles behind each peak */
            pair.run_for(2 * half);
            TEST_ASSERT_EQUAL_MEMORY(pair.prompt.chip.memory.data(),
                                     pair.deferred.chip.memory.data(), 2 * 68);
        }
    }
}

void test_what_is_put_off_costs_no_event()
{
    Pair pair;
    const unsigned long prompt = pair.prompt.chip.scheduled;
    const unsigned long deferred = pair.deferred.chip.scheduled;
    pair.run_for(20 * half);
    const unsigned long spared =
        pair.prompt.chip.scheduled - prompt - (pair.deferred.chip.scheduled - deferred);
    /* results, and overflows of the timer that triggers them, of which every 32nd is one */
    TEST_ASSERT_UINT_WITHIN(4, 10 * 2 * 17 + 10 * 17 * 31 / 32, static_cast<unsigned>(spared));
}

void test_the_timer_that_triggers_is_written_on_the_way()
{
    struct Write {
        std::uint32_t offset, value;
    };
    const Write stop = {0, 0}, go_on = {0, 1}, clear = {0x10, 0}, move = {0x24, 0};
    const Write interrupt = {0x0c, 1}, no_interrupt = {0x0c, 0};
    const Write no_trigger = {0x04, 0}, trigger = {0x04, 2 << 4}, compare = {0x34, 500};
    const Write writes[] = {stop,         go_on,      clear,   move,   interrupt,
                            no_interrupt, no_trigger, trigger, compare};
    Pair pair;
    for (int i = 0; i < 2000; ++i) {
        pair.run_for(1 + pair.random() % (3 * half));
        TEST_ASSERT_EQUAL(pair.prompt.chip.lines[29], pair.deferred.chip.lines[29]);
        if (i % 2 == 0) {
            TEST_ASSERT_EQUAL_HEX32(pair.prompt.chip.read(timer_flags),
                                    pair.deferred.chip.read(timer_flags));
        }
        const Write &write = writes[pair.random() % std::size(writes)];
        pair.write(tim3 + write.offset, write.value);
        pair.same();
    }
    TEST_ASSERT_TRUE(pair.prompt.device.adc(3).counters.regular_sequences > 9000);
}

void test_an_interrupt_that_is_enabled_on_the_way_comes_at_its_time()
{
    for (const std::uint32_t begin : {100u, 700u, 8300u, 15200u, 15700u}) {
        Pair pair;
        Ticks at[2] = {0, 0};
        std::size_t i = 0;
        for (LegBench *const bench : {&pair.prompt, &pair.deferred}) {
            bench->chip.run_for(begin * cycle);
            bench->chip.write(control, bench->chip.read(control) | 6);
            bench->chip.on_interrupt = [&at, bench, i](unsigned line) {
                at[i] = line == 11 && at[i] == 0 ? bench->chip.now() : at[i];
            };
            ++i;
            bench->chip.run_for(3 * half);
        }
        TEST_ASSERT_TRUE(at[0] != 0);
        TEST_ASSERT_EQUAL_UINT64(at[0], at[1]);
    }
}

void test_a_channel_switched_off_on_the_way_leads_to_an_overrun()
{
    Pair pair;
    pair.run_for(5300 * cycle);
    pair.write(control, 0);
    pair.run_for(700 * cycle);
    pair.same();
    pair.run_for(4000 * cycle);
    pair.same();
    TEST_ASSERT_TRUE(pair.deferred.device.adc(3).counters.overruns > 0);
}

/* A channel that fetches from elsewhere must not be taken for one that fetches results. */
void test_a_channel_that_reads_another_register_stores_what_that_holds()
{
    constexpr std::uint32_t injected_result = adc3 + 0x80; /* 0: there was none */
    LegBench bench(0);
    bench.chip.run_for(half);
    bench.chip.write(control, 0);
    bench.channel(0, 37, injected_result, FakeChip::ram, 68, 1 << 5 | 1 << 7 | 1 << 8 | 1 << 10);
    std::fill(bench.chip.memory.begin(), bench.chip.memory.end(), std::uint8_t{0xee});
    bench.chip.write(adc3, 1 << 4 | 1 << 2);
    bench.chip.run_for(6 * half);
    TEST_ASSERT_TRUE(bench.chip.read(adc3 + 0x40) != 0);
    TEST_ASSERT_EQUAL_UINT(0, bench.sum(0));
}

/* The voltage of a leg is asked for once in a period; its pin may change in between. */
void test_a_pin_that_is_not_analog_any_more_is_refused_at_the_next_conversion()
{
    constexpr std::uint32_t modes_of_b = 0x48000400;
    for (const std::uint32_t interrupts : {6u, 0u}) {
        LegBench bench(interrupts);
        bench.chip.run_for(4 * half + 4000 * cycle);
        (void)bench.chip.read(left); /* results of this period have been formed */
        bench.chip.write(modes_of_b, bench.chip.read(modes_of_b) & ~(3u << 2)); /* PB1: input */
        try {
            bench.chip.run_for(2000 * cycle);
            (void)bench.chip.read(left);
            TEST_FAIL_MESSAGE("measured from an input");
        } catch (const Refusal &refusal) {
            TEST_ASSERT_NOT_NULL(std::strstr(refusal.what(), "PB1"));
        }
    }
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_whenever_the_core_looks_it_finds_what_it_would_have_found);
    RUN_TEST(test_behind_a_peak_the_ring_holds_the_period_without_a_look);
    RUN_TEST(test_what_is_put_off_costs_no_event);
    RUN_TEST(test_the_timer_that_triggers_is_written_on_the_way);
    RUN_TEST(test_an_interrupt_that_is_enabled_on_the_way_comes_at_its_time);
    RUN_TEST(test_a_channel_switched_off_on_the_way_leads_to_an_overrun);
    RUN_TEST(test_a_channel_that_reads_another_register_stores_what_that_holds);
    RUN_TEST(test_a_pin_that_is_not_analog_any_more_is_refused_at_the_next_conversion);
    return UNITY_END();
}
