/* SIGINT and SIGTERM: runs end where they are, and the program says what was done. */
#ifndef STEADYSTEP_SCENARIO_INTERRUPTION_H
#define STEADYSTEP_SCENARIO_INTERRUPTION_H

#include <exception>
#include <string>
#include <utility>

namespace scenario
{

/* Thrown by what has been interrupted; no std::runtime_error, so that no run takes it for its own
   failure. */
class Interrupted : public std::exception
{
  public:
    explicit Interrupted(std::string done = "") : done_(std::move(done))
    {
    }
    const char *what() const noexcept override
    {
        return done_.c_str();
    }

  private:
    std::string done_; /* what was, in words */
};

/* From now on SIGINT and SIGTERM are noted, and a closed pipe is an error of who writes. */
void note_signals();

void throw_if_interrupted();

/* Ends the program by the signal that was noted, as whoever waits for it expects. */
[[noreturn]] void end_by_signal();

} // namespace scenario

#endif
