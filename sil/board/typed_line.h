/*
 * Commands as lines that a drive's console understands: the tape on which two boards are compared.
 * Numbers are hexadecimal, so exact.
 */
#ifndef STEADYSTEP_TYPED_LINE_H
#define STEADYSTEP_TYPED_LINE_H

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/interface/drive_interface.h"

namespace sil
{

/* "move-trapezoid position_rad=0x1.4p+3 ..."; with " at=<period>" if one is given. */
std::string typed_line(const drive_command &command,
                       std::optional<std::uint32_t> at_period = std::nullopt);

/* Control periods from the one in which the line arrives to the one in which the command acts; of
   a store, which acts at once, 0. */
std::uint32_t typed_delay(drive_command_kind kind, double control_period_s);

} // namespace sil

#endif
