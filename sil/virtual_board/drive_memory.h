/*
 * The drive as it lies in the memory of an image that runs: its signals and its hash, by the
 * addresses of the image's map.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_DRIVE_MEMORY_H
#define STEADYSTEP_VIRTUAL_BOARD_DRIVE_MEMORY_H

#include <cstdint>
#include <string>

#include "firmware/drive/drive_hash.h"
#include "firmware/interface/drive_interface.h"
#include "sil/virtual_board/image_map.h"
#include "sil/virtual_board/machine.h"

namespace virtual_board
{

class DriveMemory
{
  public:
    /* Throws std::invalid_argument if the map does not name what is read. */
    DriveMemory(Machine &machine, const ImageMap &map);

    /* To be read between control interrupts: period is that of the last one. */
    drive_signals signals() const;
    std::uint64_t gains_hash() const;
    struct drive_hash_row hash_row() const;

  private:
    /* Where a number is, and what it is. */
    struct Place {
        const std::uint8_t *bytes = nullptr;
        unsigned size = 0;
        enum Kind { integer, fixed_point, single, real } kind = integer;

        std::uint64_t bits() const;
        double number() const;
    };
    struct Estimate {
        Place turns, fraction, speed, load_torque, resistance;
    };

    Place place(Machine &machine, const ImageMap &map, const std::string &name, bool is_num) const;
    const Estimate &estimate() const;
    double angle_rad(const Place &turns, const Place &fraction) const;

    Place gains_, high_counts_[4], bridge_on_;
    Place state_, fault_, synchronism_, period_, bus_, holding_, estimator_, teeth_, underruns_,
        dropped_, dropped_kind_;
    Place reference_turns_, reference_fraction_, reference_speed_, reference_moving_;
    Place current_d_, current_q_, current_reference_d_, current_reference_q_, voltage_d_,
        voltage_q_;
    Place base_current_, base_voltage_, base_speed_, base_torque_, base_resistance_;
    Estimate estimates_[4]; /* in the order of enum estimator_kind, estimator/estimator.h */
};

} // namespace virtual_board

#endif
