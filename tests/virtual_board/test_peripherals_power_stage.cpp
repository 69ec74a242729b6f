/* Converters, DMA and the power stage: what the firmware measures and what moves the motor. */
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

/* A board whose PWM runs, with currents sampled and taken at every peak. */
struct DriveBench : Bench {
    explicit DriveBench(Stm32g474Config config = make_config()) : Bench(config)
    {
        start_clocks();
        route_gates();
        configure_pwm();
        configure_currents();
        chip.on_interrupt = [this](unsigned line) {
            if (line == 18) {
                code_a = chip.read(adc1 + 0x80);
                bus = chip.read(adc1 + 0x84);
                chip.write(adc1, 0x60);
                taken++;
            }
        };
    }
    void start()
    {
        start_pwm();
        begin = chip.now();
    }
    /* Runs to counts after the n-th peak. */
    void after_peak(unsigned n, Ticks counts)
    {
        chip.run_until(begin + half + n * 2 * half + counts * cycle);
        code_b = chip.read(adc2 + 0x80);
        temperature = chip.read(adc2 + 0x84);
    }
    void bridge(bool on)
    {
        const std::uint32_t bdtr = chip.read(tim1 + 0x44) & ~(1u << 15);
        chip.write(tim1 + 0x44, bdtr | (on ? 1u << 15 : 0u));
    }
    PowerStage &stage()
    {
        return device.power_stage();
    }

    std::uint32_t code_a = 0, code_b = 0, bus = 0, temperature = 0;
    unsigned taken = 0;
    Ticks begin = 0;
};

void test_the_order_of_power_up_is_kept()
{
    Bench bench;
    bench.start_clocks();
    bench.refused("deep power-down", adc1 + 0x08, 1u << 28 | 1u << 29);
    bench.chip.write(adc1 + 0x08, 0);
    bench.chip.write(adc1 + 0x08, 1u << 28);
    bench.refused("start-up", adc1 + 0x08, 1u << 28 | 1u << 31);
    bench.chip.run_for(20 * microsecond);
    bench.refused("before a calibration", adc1 + 0x08, 1u << 28 | 1);
    bench.refused("CKMODE", adc1 + 0x08, 1u << 28 | 1u << 31);

    Bench whole;
    whole.start_clocks();
    whole.chip.write(0x50000308, 3 << 16);
    whole.power_up(adc1);
    whole.refused("group is enabled", 0x50000308, 1 << 16);
}

void test_starting_before_ready_is_refused()
{
    Bench bench;
    bench.start_clocks();
    bench.chip.write(0x50000308, 3 << 16);
    bench.chip.write(adc1 + 0x08, 0);
    bench.chip.write(adc1 + 0x08, 1u << 28);
    bench.chip.run_for(20 * microsecond);
    bench.chip.write(adc1 + 0x08, 1u << 28 | 1u << 31);
    const Ticks begin = bench.chip.now();
    bench.chip.run_until(begin + 116 * 4 * cycle - 1);
    TEST_ASSERT_TRUE(bench.chip.read(adc1 + 0x08) >> 31 == 1);
    bench.chip.run_until(begin + 116 * 4 * cycle);
    TEST_ASSERT_TRUE(bench.chip.read(adc1 + 0x08) >> 31 == 0);
    bench.refused("4 ADC clocks", adc1 + 0x08, 1u << 28 | 1);
    bench.chip.run_for(4 * 4 * cycle);
    bench.chip.write(adc1 + 0x08, 1u << 28 | 1);
    bench.refused("ADRDY", adc1 + 0x08, 1u << 28 | 1 << 3);
}

/* Trigger one cycle before the peak, 2.125 clocks of latency, two times 24.5 + 12.5 clocks. */
void test_the_injected_sequence_ends_when_the_data_sheet_says()
{
    DriveBench bench;
    bench.start();
    const Ticks clock = 4 * cycle;
    const Ticks length = clock * 17 / 8 + 2 * 37 * clock;
    bench.chip.run_until(bench.begin + half - cycle + length - 1);
    TEST_ASSERT_EQUAL_UINT(0, bench.taken);
    bench.chip.run_until(bench.begin + half - cycle + length);
    TEST_ASSERT_EQUAL_UINT(1, bench.taken);
    TEST_ASSERT_TRUE(bench.stage().counters.trigger_from_peak == -static_cast<int>(cycle));
    TEST_ASSERT_TRUE(bench.stage().counters.sample_from_peak > 0);
}

/* RM0440: JEOC goes with the result that has set it, JEOS stays; CSR shows both converters. */
void test_reading_the_newest_injected_result_clears_its_flag()
{
    constexpr std::uint32_t csr = 0x50000300, flags = 0x60;
    DriveBench bench;
    bench.chip.write(adc1 + 0x04, 0);
    bench.start();
    bench.chip.run_until(bench.begin + half + 1000 * cycle);
    TEST_ASSERT_EQUAL_HEX32(flags << 16 | flags, bench.chip.read(csr) & (flags << 16 | flags));
    (void)bench.chip.read(adc1 + 0x80);
    TEST_ASSERT_EQUAL_HEX32(flags, bench.chip.read(adc1) & flags);
    (void)bench.chip.read(adc1 + 0x84);
    TEST_ASSERT_EQUAL_HEX32(0x40, bench.chip.read(adc1) & flags);
    TEST_ASSERT_EQUAL_HEX32(flags << 16 | 0x40, bench.chip.read(csr) & (flags << 16 | flags));
    bench.after_peak(1, 1000);
    TEST_ASSERT_EQUAL_HEX32(flags, bench.chip.read(adc1) & flags);
}

void test_the_first_step_is_at_the_peak_after_the_first_sample_set_taken()
{
    DriveBench bench;
    bench.chip.write(adc1 + 0x04, 0);
    bench.start();
    bench.after_peak(3, 1000);
    TEST_ASSERT_TRUE(bench.stage().period() == -1);
    bench.chip.write(adc1, 0x60);
    bench.chip.write(adc1 + 0x04, 1 << 6);
    bench.after_peak(4, 1000);
    TEST_ASSERT_TRUE(bench.stage().period() == 0);
    bench.after_peak(5, 0);
    TEST_ASSERT_TRUE(bench.stage().period() == 1);
}

/* Compares written in period k load at S(k+1) and move the plant from there to S(k+2): the plant
   alone with the same duties gives the same codes. */
void test_the_plant_sees_the_compares_and_the_bridge_of_each_period()
{
    DriveBench bench;
    plant::Config config = Bench::make_config().power_stage.plant;
    plant::Plant alone(config);
    bench.start();
    bench.after_peak(0, 1000); /* S(0) taken */
    plant::Duties in_force;
    for (unsigned k = 0; k < 50; k++) {
        TEST_ASSERT_EQUAL_UINT32(alone.samples().current_a, bench.code_a);
        TEST_ASSERT_EQUAL_UINT32(alone.samples().current_b, bench.code_b);
        TEST_ASSERT_EQUAL_UINT32(alone.samples().bus_voltage, bench.bus);
        TEST_ASSERT_EQUAL_UINT32(2048, bench.temperature);
        const plant::Duties next = bench::voltages(4.0 + 0.1 * k, -3.0);
        const bool on = k >= 3 && k != 20;
        bench.bridge(on);
        bench.compares(next.high_counts[0], next.high_counts[1], next.high_counts[2],
                       next.high_counts[3]);
        bench.after_peak(k + 1, 1000);
        in_force.bridge_on = on;
        alone.step(in_force);
        in_force = next;
    }
    TEST_ASSERT_TRUE(bench.code_a > 2100 && bench.code_b < 2000);
    TEST_ASSERT_EQUAL_UINT(51, bench.taken);
}

void test_a_current_outside_the_low_state_reads_zero()
{
    DriveBench bench;
    bench.chip.write(tim1 + 0x48, 8400);
    bench.start();
    bench.compares(8300, 100, 4250, 4250); /* low from 8300 + 170 on */
    bench.after_peak(3, 1000);
    TEST_ASSERT_EQUAL_UINT32(2048, bench.code_a);
    TEST_ASSERT_TRUE(bench.stage().counters.outside_low_state > 0);
}

void expect_bridge_refused(DriveBench &bench, const char *text)
{
    bench.start();
    bench.after_peak(0, 1000);
    bench.refused(text, tim1 + 0x44, bench.chip.read(tim1 + 0x44) | 1 << 15);
}

void test_a_wrong_dead_time_a_loose_gate_and_an_inverted_one_are_refused()
{
    DriveBench none;
    none.chip.write(tim1 + 0x44, none.chip.read(tim1 + 0x44) & ~0xffu);
    expect_bridge_refused(none, "shoot-through");
    DriveBench shorter;
    shorter.chip.write(tim1 + 0x44, (shorter.chip.read(tim1 + 0x44) & ~0xffu) | 127);
    expect_bridge_refused(shorter, "shoot-through");
    DriveBench loose;
    loose.route('C', 1, 3);
    expect_bridge_refused(loose, "only some gates");
    DriveBench half_enabled;
    half_enabled.chip.write(tim1 + 0x20, 0x5551);
    expect_bridge_refused(half_enabled, "only some gates");
    DriveBench inverted;
    inverted.chip.write(tim1 + 0x20, 0x5557);
    expect_bridge_refused(inverted, "shoot-through");
    DriveBench slow;
    slow.chip.write(tim1 + 0x28, 1);
    slow.chip.write(tim1 + 0x44, (slow.chip.read(tim1 + 0x44) & ~0xffu) | 0x80 | 21);
    slow.chip.write(tim1 + 0x14, 1);
    slow.start_pwm();
    slow.refused("half period", tim1 + 0x44, slow.chip.read(tim1 + 0x44) | 1 << 15);
}

void test_gates_that_are_not_routed_leave_the_bridge_off()
{
    DriveBench bench;
    for (char port : {'A', 'B', 'C'}) {
        bench.chip.write(0x48000000 + 0x400 * static_cast<std::uint32_t>(port - 'A'), 0xffffffff);
    }
    bench.start();
    bench.bridge(true);
    TEST_ASSERT_FALSE(bench.stage().bridge_on());
}

void configure_trip(DriveBench &bench)
{
    bench.chip.write(dac3 + 0x3c, 2 << 14 | 3 | 3 << 16);
    bench.chip.write(dac3, 0x10001);
    bench.chip.write(dac3 + 0x08, 555);
    bench.chip.write(dac3 + 0x14, 555);
    for (std::uint32_t i = 0; i < 4; i++) {
        bench.chip.write(comp + 4 * i, 1 | 4 << 4 | 1 << 16);
    }
    bench.chip.run_for(10 * microsecond);
}

void test_a_short_circuit_opens_the_bridge_within_a_microsecond()
{
    for (int leg = 0; leg < PowerStage::legs; leg++) {
        DriveBench bench;
        configure_trip(bench);
        bench.start();
        bench.bridge(true);
        const Ticks at = bench.begin + 5 * half + 1234 * cycle;
        bench.stage().short_circuit(at, leg, 20.0);
        bench.chip.run_until(at);
        TEST_ASSERT_TRUE(bench.stage().bridge_on());
        bench.chip.run_until(at + microsecond);
        TEST_ASSERT_FALSE(bench.stage().bridge_on());
        TEST_ASSERT_TRUE((bench.chip.read(tim1 + 0x10) & 1 << 7) != 0);
    }
}

void test_comparators_without_their_threshold_are_refused()
{
    DriveBench bench;
    bench.refused("disabled", comp, 1 | 4 << 4);
    bench.refused("HFSEL", dac3, 1);
}

void test_an_amplifier_of_another_gain_is_refused()
{
    DriveBench bench;
    bench.chip.write(opamp, 1 | 2 << 5 | 1 << 8 | 3 << 14);
    bench.start();
    try {
        bench.after_peak(0, 1000);
    } catch (const Refusal &refusal) {
        TEST_ASSERT_TRUE(std::string(refusal.what()).find("gain 16") != std::string::npos);
        return;
    }
    TEST_FAIL_MESSAGE("gain");
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_the_order_of_power_up_is_kept);
    RUN_TEST(test_starting_before_ready_is_refused);
    RUN_TEST(test_the_injected_sequence_ends_when_the_data_sheet_says);
    RUN_TEST(test_reading_the_newest_injected_result_clears_its_flag);
    RUN_TEST(test_the_first_step_is_at_the_peak_after_the_first_sample_set_taken);
    RUN_TEST(test_the_plant_sees_the_compares_and_the_bridge_of_each_period);
    RUN_TEST(test_a_current_outside_the_low_state_reads_zero);
    RUN_TEST(test_a_wrong_dead_time_a_loose_gate_and_an_inverted_one_are_refused);
    RUN_TEST(test_gates_that_are_not_routed_leave_the_bridge_off);
    RUN_TEST(test_a_short_circuit_opens_the_bridge_within_a_microsecond);
    RUN_TEST(test_comparators_without_their_threshold_are_refused);
    RUN_TEST(test_an_amplifier_of_another_gain_is_refused);
    return UNITY_END();
}
