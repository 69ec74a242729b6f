/* The virtual board's core executes exceptions, sleep, faults and time as a Cortex-M4F does, and
   the instructions of the core that it is. */
#include <string>
#include <vector>

#include <unity.h>

#include "sil/virtual_board/machine.h"
#include "tests/virtual_board/probe_device.h"

using virtual_board::ElfImage;
using virtual_board::Failure;
using virtual_board::Machine;

namespace
{

/* How the machine watches a program: by the instruction, as without a map of the image, or by the
   block, as with one. */
enum class Watched { by_instruction, by_block };

/* A program that has run to its end, or to what stopped it. */
struct Run {
    explicit Run(const std::string &program,
                 const virtual_board::ChipDescription &chip = virtual_board::stm32g474(),
                 Watched watched = Watched::by_instruction, unsigned stop_every_cycles = 0)
        : image(ElfImage::read(PROGRAMS "/" + program + ".elf")), machine(chip),
          probe(machine, chip)
    {
        machine.attach(probe);
        if (watched == Watched::by_block) {
            know_all_instructions();
        }
        machine.load(image);
        machine.power_on();
        virtual_board::Event stop([this] { machine.stop(); });
        try {
            while (!probe.ended) {
                if (stop_every_cycles > 0) {
                    machine.schedule(stop,
                                     machine.now() + stop_every_cycles * machine.core_cycle());
                }
                machine.run();
                ++runs;
            }
        } catch (const Failure &stopped) {
            failure = stopped.what();
        }
        machine.schedule(stop, virtual_board::Event::never);
    }

    ElfImage image;
    Machine machine;
    ProbeDevice probe;
    std::string failure;
    unsigned runs = 0;

    /* A map as tools/image_map makes one; every instruction costs what it does without. */
    void know_all_instructions()
    {
        machine.costs().stand_in = false;
        for (const virtual_board::Segment &segment : image.segments()) {
            for (std::uint32_t i = 0; i + 1 < segment.bytes.size(); i += 2) {
                const unsigned half = segment.bytes[i] | unsigned{segment.bytes[i + 1]} << 8;
                const std::uint32_t address = segment.address + i;
                *machine.costs().find(address) =
                    virtual_board::stand_in_cost(address, half >= 0xe800 ? 4 : 2);
            }
        }
    }
    std::string place(std::size_t entry) const
    {
        return image.place(probe.log.at(entry).value);
    }
    std::uint64_t cycle(std::size_t entry) const
    {
        return probe.log.at(entry).at / machine.core_cycle();
    }
};

void assert_contains(const char *part, const std::string &text)
{
    if (text.find(part) == std::string::npos) {
        TEST_FAIL_MESSAGE(("expected \"" + std::string(part) + "\" in: " + text).c_str());
    }
}

void assert_logs(const Run &run, const std::vector<std::uint32_t> &expected)
{
    TEST_ASSERT_EQUAL_STRING("", run.failure.c_str());
    TEST_ASSERT_EQUAL_size_t(expected.size(), run.probe.log.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        TEST_ASSERT_EQUAL_HEX32(expected[i], run.probe.log[i].value);
    }
}

void registers_survive_thousands_of_interrupts()
{
    for (const char *program : {"fp_context", "status_flags"}) {
        for (const Watched watched : {Watched::by_instruction, Watched::by_block}) {
            const Run run(program, virtual_board::stm32g474(), watched);
            TEST_ASSERT_EQUAL_STRING("", run.failure.c_str());
            TEST_ASSERT_TRUE(run.probe.ended);
            TEST_ASSERT_EQUAL_UINT32(0, run.probe.result);
        }
    }
}

/* The test above bites. */
void floating_point_registers_are_lost_without_aspen()
{
    const Run run("fp_context_lost");
    TEST_ASSERT_EQUAL_STRING("", run.failure.c_str());
    TEST_ASSERT_TRUE(run.probe.result >= 6);
}

void exceptions_nest_and_follow_by_priority()
{
    const std::vector<std::uint32_t> round = {1,     0x110, 0x100, 0x111, 0x120, 0x130,
                                              2,     3,     0x100, 4,     0x100, 5,
                                              0x120, 0x100, 6,     0x1e0, 0x1b0, 7};
    std::vector<std::uint32_t> expected;
    for (int i = 0; i < 4; ++i) {
        expected.insert(expected.end(), round.begin(), round.end());
    }
    for (const Watched watched : {Watched::by_instruction, Watched::by_block}) {
        assert_logs(Run("nesting", virtual_board::stm32g474(), watched), expected);
    }
}

/* 3: 0x111 is the end of handler 1, 0x120 and 0x130 follow without return to the thread. */
void tail_chaining_is_shorter_than_return_and_entry()
{
    const Run run("nesting");
    TEST_ASSERT_TRUE(run.cycle(4) - run.cycle(3) < 20);
    TEST_ASSERT_TRUE(run.cycle(5) - run.cycle(4) < 20);
}

void sleep_ends_with_its_interrupt()
{
    for (const Watched watched : {Watched::by_instruction, Watched::by_block}) {
        const Run run("sleep", virtual_board::stm32g474(), watched);
        assert_logs(run, {1, 0x100, 2, 3, 4, 0x100, 5});
        TEST_ASSERT_UINT64_WITHIN(40, 100000, run.cycle(1) - run.cycle(0));
        TEST_ASSERT_UINT64_WITHIN(40, 5000, run.cycle(4) - run.cycle(3));
    }
}

void cycle_counter_counts_the_time()
{
    const Run run("cycle_counter");
    TEST_ASSERT_EQUAL_STRING("", run.failure.c_str());
    const std::uint64_t passed = run.cycle(1) - run.cycle(0);
    TEST_ASSERT_TRUE(passed >= 10000);
    TEST_ASSERT_UINT64_WITHIN(20, passed, run.probe.log.at(2).value);
}

void access_to_nothing_is_a_hard_fault_at_its_instruction()
{
    const Run run("bad_access");
    TEST_ASSERT_EQUAL_STRING("", run.failure.c_str());
    TEST_ASSERT_EQUAL_UINT32(7, run.probe.result);
    assert_contains("reads_nothing+0x0", run.machine.fault());
    assert_contains(run.place(0).c_str(), run.machine.fault());
    TEST_ASSERT_EQUAL_HEX32(virtual_board::fault_bus_precise |
                                virtual_board::fault_bus_address_valid,
                            run.probe.log.at(1).value);
    TEST_ASSERT_EQUAL_HEX32(virtual_board::fault_forced, run.probe.log.at(2).value);
}

void assert_faults_are_at(const Run &run, const std::vector<std::string> &places)
{
    TEST_ASSERT_EQUAL_STRING("", run.failure.c_str());
    TEST_ASSERT_EQUAL_size_t(places.size(), run.probe.log.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        assert_contains((places[i] + "+0x0").c_str(), run.place(i));
    }
    assert_contains("undefined instruction", run.machine.fault());
}

/* An image that runs here but not on the chip would be worse than none. */
void instructions_of_other_cores_are_undefined()
{
    assert_faults_are_at(Run("other_cores"),
                         {"armv8m_test_target", "armv8m_load_acquire", "double_precision"});
    assert_faults_are_at(Run("other_cores_m0plus", virtual_board::stm32g071()),
                         {"armv7m_divide", "armv7m_move", "armv7m_float"});
}

/* The Cortex-M4 reads it in two; the M0+ has a HardFault. */
void word_across_a_boundary_is_read_or_a_fault()
{
    const Run in_two("unaligned");
    TEST_ASSERT_EQUAL_size_t(0, in_two.probe.log.size());
    TEST_ASSERT_EQUAL_HEX32(0x44332211, in_two.probe.result);

    const Run refused("unaligned_m0plus", virtual_board::stm32g071());
    TEST_ASSERT_EQUAL_STRING("", refused.failure.c_str());
    TEST_ASSERT_EQUAL_size_t(1, refused.probe.log.size());
    assert_contains("reads_across+0x0", refused.place(0));
    assert_contains("unaligned", refused.machine.fault());
    TEST_ASSERT_EQUAL_HEX32(0, refused.probe.result);
}

void jump_astray_is_a_bus_fault()
{
    const Run run("jump_astray");
    assert_logs(run, {0x60000000, virtual_board::fault_bus_fetch, 0xfffffff8,
                      virtual_board::fault_bus_fetch});
    TEST_ASSERT_EQUAL_UINT32(1, run.probe.result);
}

void unprivileged_code_is_refused()
{
    const Run run("unprivileged");
    assert_contains("unprivileged code (CONTROL.nPRIV) is not modelled", run.failure);
    TEST_ASSERT_EQUAL_size_t(1, run.probe.log.size());
}

void stack_below_its_limit_is_reported()
{
    const Run run("deep_stack");
    assert_contains("stack overflow", run.failure);
    TEST_ASSERT_EQUAL_size_t(1, run.probe.log.size()); /* the shallower descent went well */
    TEST_ASSERT_TRUE(run.machine.stack_used().value_or(0) >= 1020);
}

/* Whoever runs the machine may stop it at any instant, asleep or awake: neither the result nor its
   time depends on that, although the emulator does not stop inside an IT block. */
void stops_between_instructions_change_nothing()
{
    const auto &chip = virtual_board::stm32g474();
    for (const char *program : {"conditional", "sleep", "nesting"}) {
        for (const Watched watched : {Watched::by_instruction, Watched::by_block}) {
            const Run undisturbed(program, chip, watched), stopped(program, chip, watched, 7);
            TEST_ASSERT_EQUAL_STRING("", stopped.failure.c_str());
            TEST_ASSERT_TRUE(stopped.runs > 10 * undisturbed.runs);
            TEST_ASSERT_EQUAL_UINT32(undisturbed.probe.result, stopped.probe.result);
            TEST_ASSERT_EQUAL_UINT64(undisturbed.machine.now(), stopped.machine.now());
        }
    }
    TEST_ASSERT_EQUAL_UINT32(8000, Run("conditional").probe.result);
}

void reset_starts_anew_and_keeps_memory()
{
    Machine machine(virtual_board::stm32g474());
    ProbeDevice probe(machine);
    machine.attach(probe);
    machine.load(ElfImage::read(PROGRAMS "/reset_request.elf"));
    machine.power_on();
    machine.run();
    TEST_ASSERT_EQUAL_size_t(1, machine.resets().size());
    TEST_ASSERT_EQUAL_STRING("software", machine.resets()[0].c_str());
    machine.run();
    TEST_ASSERT_TRUE(probe.ended);
    TEST_ASSERT_EQUAL_HEX32(0xfa05, probe.result);
    TEST_ASSERT_EQUAL_size_t(2, probe.resets.size());
}

} // namespace

void setUp()
{
}

void tearDown()
{
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(registers_survive_thousands_of_interrupts);
    RUN_TEST(floating_point_registers_are_lost_without_aspen);
    RUN_TEST(exceptions_nest_and_follow_by_priority);
    RUN_TEST(tail_chaining_is_shorter_than_return_and_entry);
    RUN_TEST(sleep_ends_with_its_interrupt);
    RUN_TEST(cycle_counter_counts_the_time);
    RUN_TEST(access_to_nothing_is_a_hard_fault_at_its_instruction);
    RUN_TEST(instructions_of_other_cores_are_undefined);
    RUN_TEST(word_across_a_boundary_is_read_or_a_fault);
    RUN_TEST(jump_astray_is_a_bus_fault);
    RUN_TEST(unprivileged_code_is_refused);
    RUN_TEST(stack_below_its_limit_is_reported);
    RUN_TEST(stops_between_instructions_change_nothing);
    RUN_TEST(reset_starts_anew_and_keeps_memory);
    return UNITY_END();
}
