/*
 * The image of the board on the virtual board: the same drive, bit for bit, as on the SIL board,
 * and an overrun of its control interrupt opens the bridge. Run by preset board-stm32g474, which
 * builds the image.
 */
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include <unity.h>

#include "sil/board/board.h"
#include "sil/virtual_board/peripherals/stm32g474_device.h"
#include "sil/virtual_board/virtual_board.h"

using virtual_board::VirtualBoard;

namespace
{

constexpr std::uint32_t ready = 2100; /* periods; enabling takes fewer */

std::string image;
const firmware_image *simulated_firmware;

plant::Config plant_config()
{
    plant::Config config;
    config.motor = {1.8, 2.5e-3, 0.24, 1e-4, 2.2e-5, 50};
    return config;
}

drive_settings settings()
{
    const plant::MotorConfig motor = plant_config().motor;
    motor_params params = {};
    params.resistance_ohm = motor.resistance_ohm;
    params.inductance_H = motor.inductance_H;
    params.torque_constant_Nm_A = motor.torque_constant_Nm_A;
    params.viscous_friction_Nms_rad = motor.viscous_friction_Nms_rad;
    params.inertia_kgm2 = motor.inertia_kgm2;
    params.rotor_teeth = motor.rotor_teeth;
    params.rated_current_A = 2.0;
    params.supply_V = 24.0;
    drive_settings settings = {};
    drive_settings_default(&settings, &params);
    return settings;
}

void run(sil::DriveBoard &board, std::uint32_t periods)
{
    for (std::uint32_t k = 0; k < periods; ++k) {
        board.control();
        board.advance();
    }
}

/* Enables, moves, is interrupted by a loss of power, and enables again. */
void drive(sil::DriveBoard &board)
{
    board.type("enable");
    run(board, ready);
    board.type("move-trapezoid position_rad=1.5 duration_s=0.05 ramp_s=0.02");
    run(board, 300);
    board.plant().set_load_torque(0.05);
    run(board, 200);
    board.power_cycle();
    board.type("enable");
    run(board, 400);
}

void drives_as_the_sil_board_does_bit_for_bit()
{
    sil::Board simulated(plant_config(), *simulated_firmware, settings());
    VirtualBoard board(plant_config(), image, simulated_firmware->numeric, settings());
    drive(simulated);
    drive(board);
    TEST_ASSERT_EQUAL_HEX64(simulated.drive_hash(), board.drive_hash());
    TEST_ASSERT_TRUE(simulated.plant().state().theta_rad == board.plant().state().theta_rad);
}

void overrun_opens_the_bridge_within_the_period_and_is_reported()
{
    VirtualBoard board(plant_config(), image, simulated_firmware->numeric, settings());
    board.type("enable");
    run(board, ready);
    TEST_ASSERT_TRUE(board.device().power_stage().bridge_on());
    board.stall_control_interrupt(92e-6);
    board.control();
    TEST_ASSERT_FALSE(board.device().power_stage().bridge_on());
    board.advance();
    board.control();
    TEST_ASSERT_EQUAL(DRIVE_FAULT, board.signals().state);
    TEST_ASSERT_EQUAL(DRIVE_FAULT_DEADLINE_MISSED, board.signals().fault);
}

void control_interrupt_stays_within_its_budget_and_its_memory()
{
    VirtualBoard board(plant_config(), image, simulated_firmware->numeric, settings());
    board.type("enable");
    run(board, ready);
    const virtual_board::BoardReport report = board.report();
    TEST_ASSERT_EQUAL_UINT64(ready, report.interrupt.interrupts);
    TEST_ASSERT_TRUE(report.interrupt.total.worst.worst < report.budget_cycles);
    TEST_ASSERT_EQUAL_UINT64(0, report.interrupt.outside_fast_code);
    TEST_ASSERT_TRUE(report.interrupt.latency.least > 0);
}

} // namespace

void setUp()
{
}

void tearDown()
{
}

int main(int argc, char **argv)
{
    image = argc > 1 ? argv[1] : "";
    if (!std::filesystem::exists(image)) {
        std::printf("no image of the board at '%s': build preset board-stm32g474\n", image.c_str());
        return 1;
    }
    const bool fixed = VirtualBoard::numeric_of(image) == firmware_image_fixed.numeric;
    simulated_firmware = fixed ? &firmware_image_fixed : &firmware_image_float;
    UNITY_BEGIN();
    RUN_TEST(drives_as_the_sil_board_does_bit_for_bit);
    RUN_TEST(overrun_opens_the_bridge_within_the_period_and_is_reported);
    RUN_TEST(control_interrupt_stays_within_its_budget_and_its_memory);
    return UNITY_END();
}
