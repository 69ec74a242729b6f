/*
 * The drive as it lies in the memory of an image that runs: its signals and its hash, by the
 * addresses of the image's map.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_DRIVE_MEMORY_H
#define STEADYSTEP_VIRTUAL_BOARD_DRIVE_MEMORY_H

#include <cstdint>
#include <string>

#include "firmware/drive/drive_hash.h"
#include "firmware/interface/dictionary.h"
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
    struct Signal {
        Place place, with; /* with: the fraction of an angle's turns, the base of a real number */
    };

    Place place(Machine &machine, const ImageMap &map, const std::string &name, bool is_num) const;
    double angle_rad(const Signal &angle) const;
    static std::uint64_t position(const Signal &angle);

    Place gains_, high_counts_[4], bridge_on_;
    Place teeth_;
    Signal offset_; /* of the user's coordinates */
    Signal signals_[SIGNALS];
};

} // namespace virtual_board

#endif
