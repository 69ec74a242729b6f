/* How many control periods are due, by the clock on the wall and the speed asked for. */
#ifndef STEADYSTEP_SERVE_WALL_CLOCK_H
#define STEADYSTEP_SERVE_WALL_CLOCK_H

#include <chrono>
#include <cstdint>

namespace serve
{

class WallClock
{
  public:
    /* Simulated seconds in a second. */
    WallClock(double speed, double period_s) : speed_(speed), period_s_(period_s)
    {
    }

    /* Periods due since the last call. Of more than most_behind_s of the wall's time the rest is
       let go: the simulation is slower than it was asked to be, and behind() counts that. */
    std::uint64_t due()
    {
        const double now_s = std::chrono::duration<double>(Clock::now() - start_).count() - lost_s_;
        double behind_s = now_s - static_cast<double>(done_) * period_s_ / speed_;
        if (behind_s > most_behind_s) {
            lost_s_ += behind_s - most_behind_s;
            behind_s = most_behind_s;
        }
        const auto periods =
            static_cast<std::uint64_t>(behind_s > 0 ? behind_s * speed_ / period_s_ : 0);
        done_ += periods;
        return periods;
    }

    /* Of the wall's time, in all. */
    double elapsed_s() const
    {
        return std::chrono::duration<double>(Clock::now() - start_).count();
    }
    double lost_s() const
    {
        return lost_s_;
    }

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr double most_behind_s = 0.02;

    double speed_, period_s_, lost_s_ = 0;
    std::uint64_t done_ = 0;
    Clock::time_point start_ = Clock::now();
};

} // namespace serve

#endif
