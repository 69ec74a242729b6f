/*
 * The simulated drive board: a firmware image and a plant in lock-step, joined by the same HAL
 * contract, converter scales and timer resolution as the STM32G474 board. Single-threaded,
 * deterministic, knows no wall clock.
 */
#ifndef STEADYSTEP_BOARD_H
#define STEADYSTEP_BOARD_H

#include <cstdint>
#include <memory>

#include "hal/sil/firmware_image.h"
#include "sil/plant/plant.h"

namespace sil
{

class Board
{
  public:
    /* Powers the board up: the image designs its gains. Throws std::invalid_argument with the
       drive's or the plant's own text when settings are refused. hardware_trip_A: a comparator
       opens the bridge at an S(k) where a phase current is beyond it; 0: not fitted. */
    Board(const plant::Config &plant, const firmware_image &image, const drive_settings &settings,
          double hardware_trip_A = 0.0);
    ~Board();
    Board(const Board &) = delete;
    Board &operator=(const Board &) = delete;

    /* Posts a command to the drive; throws std::invalid_argument with the drive's text. */
    void command(const drive_command &command);

    /* The supply fails and returns: the drive starts again, bridge off, with the parameter store as
       it was, while rotor and encoder go on. */
    void power_cycle();

    /* One PWM period: the control interrupt with the samples of the present S(k); signals() and
       plant().state() then both belong to S(k) until advance() takes the plant to S(k+1). */
    void control();
    void advance();

    const drive_signals &signals() const; /* after control(): of S(k) */
    std::uint64_t drive_hash() const;
    plant::Plant &plant();
    const hal_samples &samples() const;
    const hal_outputs &outputs() const;
    const hal_facts &facts() const;

  private:
    void sample();

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sil

#endif
