/*
 * The simulated drive board: a firmware image and a plant in lock-step, joined by the same HAL
 * contract, converter scales and timer resolution as the STM32G474 board. Its background runs once
 * after each control interrupt, infinitely fast. Single-threaded, deterministic, knows no wall
 * clock.
 */
#ifndef STEADYSTEP_BOARD_H
#define STEADYSTEP_BOARD_H

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/sil/firmware_image.h"
#include "sil/board/drive_board.h"
#include "sil/plant/plant.h"

namespace sil
{

/* Of an offset, what calibration leaves: as the reference board. */
constexpr double current_offset_codes = 4.0;

/* What its HAL says of a board with this plant. */
hal_facts facts_of(const plant::Config &plant);

class Board : public DriveBoard
{
  public:
    /* Powers the board up: the image designs its gains. Throws std::invalid_argument with the
       drive's or the plant's own text when settings are refused. hardware_trip_A: comparators
       open the bridge where a phase current is beyond it at an S(k); 0: not fitted. */
    Board(const plant::Config &plant, const firmware_image &image, const drive_settings &settings,
          double hardware_trip_A = 0.0);
    /* As a board starts: the settings lie in its parameter store, and those that its drive has
       stored since are in force after a power cycle. */
    static std::unique_ptr<Board> flashed(const plant::Config &plant, const firmware_image &image,
                                          const drive_settings &settings, double hardware_trip_A);
    ~Board() override;
    Board(const Board &) = delete;
    Board &operator=(const Board &) = delete;

    /* Posts a command to the drive, past the typed lines; throws std::invalid_argument with the
       drive's text. */
    void command(const drive_command &command);

    /* Throws std::runtime_error: more in one period than its stream holds. What a slow reader
       leaves no room for is lost, as on a wire. */
    void send(const std::string &bytes) override;
    void power_cycle() override;
    void short_circuit(int leg, double current_A) override;
    void stall_control_interrupt(double until_s) override;
    void put_inputs(std::uint32_t levels) override;
    std::uint32_t machine_outputs() const override;
    void control() override;
    void advance() override;
    const drive_signals &signals() const override;
    std::uint64_t drive_hash() const override;
    plant::Plant &plant() override;
    const hal_facts &facts() const override;
    std::string take_output() override;

    const hal_samples &samples() const;
    const hal_outputs &outputs() const;
    /* By name, in the drive's order; a name may come several times. */
    std::vector<std::pair<std::string, double>> coefficients() const;

  private:
    void start();
    void sample();

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sil

#endif
