/*
 * The simulated drive as if it were on the table: it lives in real time, or a multiple of it,
 * behind a line of bytes that any terminal or program opens, and its motor's world has knobs on a
 * second.
 */
#ifndef STEADYSTEP_SERVE_SERVER_H
#define STEADYSTEP_SERVE_SERVER_H

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sil/scenario/scenario_file.h"
#include "sil/serve/byte_port.h"
#include "sil/serve/can_adapter.h"
#include "sil/serve/knobs.h"
#include "sil/serve/serial_pace.h"
#include "sil/serve/wall_clock.h"

namespace serve
{

struct ServeOptions {
    PortPlace serial, knobs;
    std::optional<PortPlace> can; /* of an adapter on the boards' CAN bus */
    double speed = 1;             /* simulated seconds in a second */
    double baud = 921600;
};

/* A board on the bus: its own motor, one serial line and one link, all of which share a client. */
struct Station {
    Station(const scenario::Scenario &scenario, std::unique_ptr<sil::DriveBoard> its,
            const SerialPace &pace);

    std::unique_ptr<sil::DriveBoard> board;
    Knobs knobs;
    SerialPace pace_in, pace_out;
    std::string to_drive, from_drive;
    std::string line; /* of the drive's, that has not ended */
};

class Server
{
  public:
    /* Opens the ports; throws scenario::InputError. Of several boards, node 1 first, the client
       hears every frame, and so does each of the others; console and acknowledgements are the
       first one's. On a CAN bus, of boards that have one, all hear all. */
    Server(const scenario::Scenario &scenario, std::vector<std::unique_ptr<sil::DriveBoard>> boards,
           const ServeOptions &options);

    /* "serial: /dev/pts/3", "knobs: ...", a line each. */
    std::string places() const;

    /* Until INT or TERM, then "served ..." in a line. Throws what the board does where a real one
       would be reset. */
    std::string run();

  private:
    void wait();
    void exchange();
    std::string turn_knobs(const std::string &bytes);
    void pass_period();
    void pass_period_of(Station &station);
    void share_frames(Station &station, const std::string &bytes);
    bool carry(const can_frame &frame, const Station *from);

    double period_s_;
    BytePort serial_, knob_port_;
    std::optional<BytePort> can_port_;
    CanAdapter adapter_;
    WallClock clock_;
    std::vector<std::unique_ptr<Station>> stations_;
    std::string knob_line_; /* that has not ended */
    std::uint32_t period_ = 0;
    std::uint32_t heard_in_ = 0; /* bytes have come from outside last */
    bool warned_slow_ = false;
};

} // namespace serve

#endif
