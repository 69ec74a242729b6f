/*
 * A CAN adapter as it is plugged into a computer: slcan text (firmware/link/slcan.h) on the one
 * side, frames of the bus on the other. It is no node: it sends what its client sends, and shows
 * what the drives send, while its channel is open.
 */
#ifndef STEADYSTEP_SERVE_CAN_ADAPTER_H
#define STEADYSTEP_SERVE_CAN_ADAPTER_H

#include <functional>
#include <string>

#include "hal/hal.h"

namespace serve
{

class CanAdapter
{
  public:
    /* Bytes of the client; its answers. `send`: a frame to the bus, false: it takes none now. */
    std::string take(const std::string &bytes, const std::function<bool(const can_frame &)> &send);

    /* A frame of the bus as the client gets it; "" while the channel is closed. */
    std::string show(const can_frame &frame) const;

  private:
    std::string answer(const std::function<bool(const can_frame &)> &send);

    std::string line_; /* that has not ended */
    bool open_ = false, listens_only_ = false;
};

} // namespace serve

#endif
