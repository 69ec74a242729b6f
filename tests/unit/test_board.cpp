/* The simulated board around a firmware image that only records what it is given. */
#include <cstring>
#include <stdexcept>
#include <string>
#include <unity.h>
#include <vector>

#include "hal/sil/hal_sil.h"
#include "sil/board/board.h"
#include "tests/unit/plant_bench.h"

void setUp()
{
}

void tearDown()
{
}

namespace
{

/* A drive that returns what the test wishes and keeps the samples it was given. */
struct Dummy {
    const hal *board;
    hal_samples samples;
    hal_outputs outputs;
    int cycles;
    int commands;
    bool brakes;
};

Dummy *dummy; /* the drive of the board under test */

bool dummy_init(void *drive, const hal *board, const drive_settings *settings, char *error)
{
    if (settings->current_limit_A < 0.0) {
        std::strcpy(error, "current_limit_A = -1: must be positive");
        return false;
    }
    dummy = static_cast<Dummy *>(drive);
    *dummy = Dummy();
    dummy->board = board;
    return true;
}

hal_outputs dummy_control_cycle(void *drive, const hal_samples *samples)
{
    Dummy *self = static_cast<Dummy *>(drive);
    self->samples = *samples;
    self->cycles++;
    return self->outputs;
}

bool dummy_brake(void *drive, const hal_samples *)
{
    return static_cast<const Dummy *>(drive)->brakes;
}

const char *dummy_law_gain(position_law, std::size_t)
{
    return nullptr;
}

bool dummy_command(void *drive, const drive_command *command, char *error)
{
    if (command->kind != DRIVE_COMMAND_ENABLE) {
        std::strcpy(error, "not now");
        return false;
    }
    static_cast<Dummy *>(drive)->commands++;
    return true;
}

void dummy_background(void *)
{
}

void dummy_signals(const void *drive, drive_signals *signals)
{
    signals->period = static_cast<std::uint32_t>(static_cast<const Dummy *>(drive)->cycles - 1);
}

std::uint64_t dummy_hash(const void *drive)
{
    return static_cast<std::uint64_t>(static_cast<const Dummy *>(drive)->cycles);
}

void dummy_put_memory(void *, std::uint32_t *, std::size_t)
{
}

void dummy_follow_control(void *)
{
}

const firmware_image image = {
    "dummy",     sizeof(Dummy),    dummy_init,           nullptr,          dummy_control_cycle,
    dummy_brake, dummy_law_gain,   dummy_command,        dummy_background, dummy_signals,
    dummy_hash,  dummy_put_memory, dummy_follow_control, nullptr};

plant::Config config()
{
    plant::Config config = bench::config();
    config.bridge.delay_periods = 1;
    return config;
}

void wish(double u_a_V, bool bridge_on)
{
    const plant::Duties duties = bench::voltages(u_a_V, 0.0);
    for (int leg = 0; leg < HAL_LEGS; leg++) {
        dummy->outputs.high_counts[leg] = duties.high_counts[leg];
    }
    dummy->outputs.bridge_on = bridge_on;
}

void run(sil::Board &board, int periods)
{
    for (int k = 0; k < periods; k++) {
        board.control();
        board.advance();
    }
}

void test_facts_are_those_of_the_stm32_board()
{
    plant::Config stm32 = config();
    stm32.sensors.exact = false;
    sil::Board board(stm32, image, drive_settings());
    const hal_facts &facts = board.facts();
    TEST_ASSERT_EQUAL_UINT32(8500, facts.pwm_half_period_counts);
    TEST_ASSERT_EQUAL_UINT32(170000000, facts.cycle_counter_Hz);
    TEST_ASSERT_TRUE(facts.control_period_s == 1e-4);
    TEST_ASSERT_TRUE(facts.dead_time_s == 1e-6);
    TEST_ASSERT_TRUE(facts.current_A_per_code == 12.0 / 4096.0);
    TEST_ASSERT_EQUAL_UINT16(2048, facts.current_zero_code);
    TEST_ASSERT_TRUE(facts.phase_voltage_V_per_code == 62.4 / 4096.0);
    TEST_ASSERT_TRUE(facts.bus_V_per_code == 31.2 / 4096.0);
    TEST_ASSERT_TRUE(facts.has_phase_voltages);
    TEST_ASSERT_EQUAL_UINT32(0, facts.encoder_counts_per_turn);
    TEST_ASSERT_FALSE(facts.zero_delay);
    TEST_ASSERT_EQUAL_PTR(&facts, dummy->board->facts);
}

void test_the_control_interrupt_sees_the_samples_of_its_own_period()
{
    sil::Board board(config(), image, drive_settings());
    dummy->board->bridge_enable(dummy->board->context);
    wish(6.0, true);
    for (int k = 0; k < 20; k++) {
        board.control();
        const plant::Samples &codes = board.plant().samples();
        TEST_ASSERT_EQUAL_INT(k + 1, dummy->cycles);
        TEST_ASSERT_EQUAL_UINT16(codes.current_a, dummy->samples.current_a);
        TEST_ASSERT_EQUAL_UINT16(codes.current_b, dummy->samples.current_b);
        TEST_ASSERT_EQUAL_UINT16(codes.bus_voltage, dummy->samples.bus_voltage);
        TEST_ASSERT_EQUAL_INT16(codes.phase_voltage_a, dummy->samples.phase_voltage_a);
        TEST_ASSERT_EQUAL_INT16(codes.phase_voltage_b, dummy->samples.phase_voltage_b);
        TEST_ASSERT_EQUAL_UINT32(static_cast<std::uint32_t>(k), board.signals().period);
        TEST_ASSERT_EQUAL_UINT32(0, dummy->samples.flags);
        board.advance();
    }
    TEST_ASSERT_TRUE(board.samples().current_a > 2048 + 300);
    TEST_ASSERT_EQUAL_UINT64(20, board.drive_hash());
}

void test_the_gates_follow_the_outputs_only_while_the_bridge_is_enabled()
{
    sil::Board board(config(), image, drive_settings());
    wish(6.0, true);
    run(board, 10);
    TEST_ASSERT_TRUE(board.plant().state().i_a_A == 0.0);
    TEST_ASSERT_TRUE(dummy->board->bridge_enable(dummy->board->context));
    run(board, 10);
    TEST_ASSERT_TRUE(board.plant().state().i_a_A > 1.0);
    dummy->board->bridge_disable(dummy->board->context);
    run(board, 20);
    TEST_ASSERT_TRUE(board.plant().state().i_a_A == 0.0);
}

void test_the_outputs_open_the_bridge_at_once()
{
    sil::Board board(config(), image, drive_settings());
    dummy->board->bridge_enable(dummy->board->context);
    wish(6.0, true);
    run(board, 10);
    const double before_A = board.plant().state().i_a_A;
    wish(6.0, false);
    run(board, 1);
    TEST_ASSERT_TRUE(board.plant().state().i_a_A < before_A - 1.0);
}

void test_the_comparator_opens_the_bridge_and_stays_latched_until_disabled()
{
    sil::Board board(config(), image, drive_settings(), 2.0);
    const hal *hal = dummy->board;
    hal->bridge_enable(hal->context);
    wish(12.0, true);
    run(board, 20);
    TEST_ASSERT_EQUAL_UINT32(HAL_FLAG_OVERCURRENT_TRIP, dummy->samples.flags);
    TEST_ASSERT_TRUE(board.plant().state().i_a_A == 0.0);
    TEST_ASSERT_FALSE(hal->bridge_enable(hal->context));
    hal->bridge_disable(hal->context);
    TEST_ASSERT_TRUE(hal->bridge_enable(hal->context));
    run(board, 2);
    TEST_ASSERT_EQUAL_UINT32(0, dummy->samples.flags);
}

/* 10 ohm behind 0.1 ohm take 1 % of the supply. */
void test_the_drive_switches_the_brake_where_it_is_not_a_chopper_of_its_own()
{
    plant::Config braked = config();
    braked.supply.bus_source_ohm = 0.1;
    braked.supply.brake_ohm = 10.0;
    for (const bool by_drive : {true, false}) {
        braked.supply.brake_by_drive = by_drive;
        sil::Board board(braked, image, drive_settings());
        TEST_ASSERT_EQUAL(by_drive, board.facts().has_brake);
        dummy->brakes = true;
        run(board, 20);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, by_drive ? 24.0 / 1.01 : 24.0, board.plant().state().bus_V);
        dummy->brakes = false;
        run(board, 20);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 24.0, board.plant().state().bus_V);
    }
}

void test_refusals_carry_the_text_of_the_drive_or_the_plant()
{
    drive_settings settings = {};
    settings.current_limit_A = -1.0;
    try {
        sil::Board board(config(), image, settings);
        TEST_FAIL_MESSAGE("settings accepted");
    } catch (const std::invalid_argument &error) {
        TEST_ASSERT_EQUAL_STRING("current_limit_A = -1: must be positive", error.what());
    }
    plant::Config impossible = config();
    impossible.motor.inductance_H = -1.0;
    try {
        sil::Board board(impossible, image, drive_settings());
        TEST_FAIL_MESSAGE("plant accepted");
    } catch (const std::invalid_argument &error) {
        TEST_ASSERT_NOT_NULL(std::strstr(error.what(), "inductance_H = -1"));
    }
    sil::Board board(config(), image, drive_settings());
    drive_command command = {};
    command.kind = DRIVE_COMMAND_ENABLE;
    board.command(command);
    TEST_ASSERT_EQUAL_INT(1, dummy->commands);
    command.kind = DRIVE_COMMAND_STEP;
    try {
        board.command(command);
        TEST_FAIL_MESSAGE("command accepted");
    } catch (const std::invalid_argument &error) {
        TEST_ASSERT_EQUAL_STRING("not now", error.what());
    }
}

void test_what_a_slow_reader_leaves_no_room_for_is_lost()
{
    sil::Board board(config(), image, drive_settings());
    const std::string piece(HAL_SIL_STREAM_BYTES / 2, 'x');
    for (int period = 0; period < 5; period++) {
        board.send(piece);
        run(board, 1);
    }
    const hal *hal = dummy->board;
    std::vector<std::uint8_t> read(2 * HAL_SIL_STREAM_BYTES);
    std::uint32_t period = 0;
    TEST_ASSERT_EQUAL_size_t(HAL_SIL_STREAM_BYTES,
                             hal->stream_read(hal->context, read.data(), read.size(), &period));
    try {
        board.send(piece + piece + piece);
        TEST_FAIL_MESSAGE("accepted at once");
    } catch (const std::runtime_error &error) {
        TEST_ASSERT_NOT_NULL(std::strstr(error.what(), "more lines are typed"));
    }
}

void test_time_and_cycles_advance_with_the_periods_only()
{
    sil::Board board(config(), image, drive_settings());
    const hal *hal = dummy->board;
    TEST_ASSERT_EQUAL_UINT32(0, hal->cycle_count(hal->context));
    run(board, 123);
    TEST_ASSERT_EQUAL_UINT32(123 * 17000, hal->cycle_count(hal->context));
    TEST_ASSERT_EQUAL_UINT64(12300, hal->time_us(hal->context));
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_facts_are_those_of_the_stm32_board);
    RUN_TEST(test_the_control_interrupt_sees_the_samples_of_its_own_period);
    RUN_TEST(test_the_gates_follow_the_outputs_only_while_the_bridge_is_enabled);
    RUN_TEST(test_the_outputs_open_the_bridge_at_once);
    RUN_TEST(test_the_comparator_opens_the_bridge_and_stays_latched_until_disabled);
    RUN_TEST(test_the_drive_switches_the_brake_where_it_is_not_a_chopper_of_its_own);
    RUN_TEST(test_refusals_carry_the_text_of_the_drive_or_the_plant);
    RUN_TEST(test_what_a_slow_reader_leaves_no_room_for_is_lost);
    RUN_TEST(test_time_and_cycles_advance_with_the_periods_only);
    return UNITY_END();
}
