/*
 * The simulated drive as if it were on the table: it lives in real time, or a multiple of it,
 * behind a line of bytes that any terminal or program opens, and its motor's world has knobs on a
 * second.
 */
#ifndef STEADYSTEP_SERVE_SERVER_H
#define STEADYSTEP_SERVE_SERVER_H

#include <memory>

#include "sil/scenario/scenario_file.h"
#include "sil/serve/byte_port.h"
#include "sil/serve/knobs.h"
#include "sil/serve/serial_pace.h"
#include "sil/serve/wall_clock.h"

namespace serve
{

struct ServeOptions {
    PortPlace serial, knobs;
    double speed = 1; /* simulated seconds in a second */
    double baud = 921600;
};

class Server
{
  public:
    /* Opens the ports; throws scenario::InputError. */
    Server(const scenario::Scenario &scenario, std::unique_ptr<sil::DriveBoard> board,
           const ServeOptions &options);

    /* "serial: /dev/pts/3", "knobs: ...", a line each. */
    std::string places() const;

    /* Until INT or TERM, then "served ..." in a line. Throws what the board does where a real one
       would be reset. */
    std::string run();

  private:
    void wait();
    void exchange();
    void pass_period();

    std::unique_ptr<sil::DriveBoard> board_;
    double period_s_;
    BytePort serial_, knob_port_;
    Knobs knobs_;
    SerialPace pace_in_, pace_out_;
    WallClock clock_;
    std::string to_drive_, from_drive_;
    std::uint32_t period_ = 0;
    bool warned_slow_ = false;
};

} // namespace serve

#endif
