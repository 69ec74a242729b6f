/* How many bytes a serial line of 8N1 carries in each control period: 9.2 at 921,600 baud. */
#ifndef STEADYSTEP_SERVE_SERIAL_PACE_H
#define STEADYSTEP_SERVE_SERIAL_PACE_H

#include <algorithm>
#include <string>

namespace serve
{

class SerialPace
{
  public:
    explicit SerialPace(double bytes_per_period) : bytes_per_period_(bytes_per_period)
    {
    }

    /* In each period: what of the waiting bytes goes now. An idle line saves nothing up. */
    std::string take(std::string &waiting)
    {
        allowed_ = std::min(allowed_ + bytes_per_period_, bytes_per_period_ + 1);
        const std::size_t count = std::min(waiting.size(), static_cast<std::size_t>(allowed_));
        const std::string taken = waiting.substr(0, count);
        waiting.erase(0, count);
        allowed_ -= static_cast<double>(count);
        return taken;
    }

  private:
    double bytes_per_period_, allowed_ = 0;
};

} // namespace serve

#endif
