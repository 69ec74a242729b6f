#include "sil/serve/server.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <poll.h>

#include "sil/scenario/interruption.h"
#include "sil/scenario/text.h"

namespace serve
{

namespace
{

constexpr long nap_ns = 500000;             /* between two looks at the clock */
constexpr double bits_per_byte = 10;        /* 8N1 */
constexpr std::size_t most_waiting = 65536; /* bytes for the drive; what comes beyond is lost */
constexpr double shown_slow_s = 1;

std::string joined(const char *name, const std::vector<std::string> &places)
{
    std::string line = name;
    for (const std::string &place : places) {
        line += " " + place;
    }
    return line + "\n";
}

} // namespace

Server::Server(const scenario::Scenario &scenario, std::unique_ptr<sil::DriveBoard> board,
               const ServeOptions &options)
    : board_(std::move(board)), period_s_(scenario.plant.bridge.period_s), serial_(options.serial),
      knob_port_(options.knobs), knobs_(scenario, *board_),
      pace_in_(options.baud / bits_per_byte * period_s_), pace_out_(pace_in_),
      clock_(options.speed, period_s_)
{
}

std::string Server::places() const
{
    return joined("serial:", serial_.places()) + joined("knobs:", knob_port_.places());
}

void Server::wait()
{
    std::vector<pollfd> watched;
    serial_.watch(watched);
    knob_port_.watch(watched);
    const timespec nap = {0, nap_ns};
    ppoll(watched.data(), watched.size(), &nap, nullptr);
}

void Server::exchange()
{
    const std::string bytes = serial_.read();
    if (to_drive_.size() + bytes.size() <= most_waiting) {
        to_drive_ += bytes;
    }
    knob_port_.write(knobs_.turn(knob_port_.read(), period_));
    if (knobs_.take_restart()) {
        from_drive_.clear();
    }
}

void Server::pass_period()
{
    knobs_.act(period_);
    const std::string bytes = pace_in_.take(to_drive_);
    if (!bytes.empty()) {
        board_->send(bytes);
    }
    board_->control();
    from_drive_ += board_->take_output();
    board_->advance();
    ++period_;
    const std::string sent = pace_out_.take(from_drive_);
    if (!sent.empty()) {
        serial_.write(sent);
    }
}

std::string Server::run()
{
    try {
        while (true) {
            scenario::throw_if_interrupted();
            wait();
            exchange();
            for (std::uint64_t due = clock_.due(); due > 0; --due) {
                pass_period();
            }
            if (!warned_slow_ && clock_.lost_s() > shown_slow_s) {
                warned_slow_ = true;
                std::fprintf(stderr, "steadystep-sil: serve: this machine simulates more slowly "
                                     "than --speed asks for; it goes on as fast as it can\n");
            }
        }
    } catch (const scenario::Interrupted &) {
        return scenario::format("served %.3f s in %.3f s\n", period_ * period_s_,
                                clock_.elapsed_s());
    }
}

} // namespace serve
