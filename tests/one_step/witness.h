/*
 * An image whose control interrupts are computed twice: by the image that is tested, which the
 * board gets, and in double, from the same state and samples. Each period begins anew with the
 * state of the image that is tested, so that what differs behind it is the rounding of one period.
 *
 * What that rounding may be is shown by the same interrupt in double whose operations are rounded
 * at random as those of the format (rounding.h), several times from the same state. A value is
 * explained if it lies within those, or beside them by no more than they lie apart. What decides (a
 * flag, a state, a counter) must be as in one of them, and only these count then. Without rounding
 * it must be the interrupt of the image in double, bit for bit.
 */
#ifndef STEADYSTEP_ONE_STEP_WITNESS_H
#define STEADYSTEP_ONE_STEP_WITNESS_H

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "hal/sil/firmware_image.h"
#include "tests/one_step/layout.h"

namespace one_step
{

/* What was seen of the fields of a block. */
struct Seen {
    double places = 0; /* of numbers: largest difference from double, in last places */
    double angle = 0;  /* of positions and angles: the same, in 2^-32 turn */
    std::string places_of, angle_of;
};

struct Findings {
    std::uint64_t periods = 0;
    std::uint64_t draws = 0;
    std::map<std::string, Seen> blocks;
    std::map<std::string, std::uint64_t> decided; /* otherwise than in double: periods by field */
    std::uint64_t decided_periods = 0;
    std::map<std::string, std::uint64_t> unexplained; /* periods by field */
    std::uint64_t unexplained_periods = 0;
    std::vector<std::string> examples;
};

/* Where so many periods are not explained, the run ends: nothing more is to be learned. */
constexpr std::uint64_t unexplained_max = 50;
struct Unexplained : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/* The image to give to a board; one board at a time. `layout` and `findings` outlive it. */
firmware_image witnessed(const firmware_image &tested, const Layout &layout, Findings &findings);

} // namespace one_step

#endif
