/*
 * A drive board whose firmware is the image of the real one: the STM32G474 executes it from its
 * reset vector, with modelled peripherals, and the plant hangs on its timer and converters. Same
 * use and, for the same typed lines, same drive_hash as sil::Board.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_VIRTUAL_BOARD_H
#define STEADYSTEP_VIRTUAL_BOARD_VIRTUAL_BOARD_H

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sil/board/drive_board.h"
#include "sil/virtual_board/interrupt_account.h"

namespace virtual_board
{

class Machine;
class Stm32g474Device;

/* What is known of the control interrupt and the chip after a run. */
struct BoardReport {
    /* Most cycles from S(k) to the end of the control interrupt, in the worst column. */
    std::uint64_t budget_cycles = 0;
    InterruptAccount::Summary interrupt;
    std::optional<std::uint32_t> stack_used_bytes;
    std::vector<std::string> resets;
    std::uint64_t bytes_received = 0, bytes_sent = 0;   /* on the serial line, moved by DMA */
    std::uint64_t flash_erases = 0, flash_programs = 0; /* pages, double words */
    double simulated_s = 0;                             /* from power-on, start-up included */
};

class VirtualBoard : public sil::DriveBoard
{
  public:
    /*
     * Flashes the image and the settings and switches the supply on. The image's map lies beside
     * it. Throws std::invalid_argument if the files do not fit each other or the chip, and if the
     * image cannot be what the scenario asks for: named by its key, with what the image has.
     */
    VirtualBoard(const plant::Config &plant, const std::string &image_file,
                 const std::string &numeric, const drive_settings &settings);
    ~VirtualBoard() override;

    void send(const std::string &bytes) override;
    bool send_frame(const can_frame &frame) override;
    std::vector<can_frame> take_frames() override;
    void power_cycle() override;
    void short_circuit(int leg, double current_A) override;
    void stall_control_interrupt(double until_s) override;
    void put_inputs(std::uint32_t levels) override;
    std::uint32_t machine_outputs() const override;
    /* These two throw virtual_board::Failure when the firmware misuses the hardware, is reset or
       stops controlling. */
    void control() override;
    void advance() override;
    const drive_signals &signals() const override;
    std::uint64_t drive_hash() const override;
    plant::Plant &plant() override;
    const hal_facts &facts() const override;
    std::string take_output() override;

    BoardReport report() const;
    /* Number format that an image was built for. Throws std::invalid_argument: it cannot be read,
       or is for another core than this board's. */
    static std::string numeric_of(const std::string &image_file);
    /* Throws std::invalid_argument: as board_facts.h, if the image is not for such a plant. */
    static void require(const std::string &image_file, const plant::Config &plant,
                        const std::string &numeric);

    /* For tests. */
    Machine &machine();
    Stm32g474Device &device();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

constexpr double core_Hz = 170e6;

} // namespace virtual_board

#endif
