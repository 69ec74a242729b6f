#include "sil/serve/server.h"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include <poll.h>

#include "sil/scenario/interruption.h"
#include "sil/scenario/text.h"

namespace serve
{

namespace
{

constexpr long nap_ns = 500000;      /* between two looks at the clock */
constexpr long short_nap_ns = 50000; /* while somebody waits for an answer */
constexpr std::uint32_t answer_periods = 30;
constexpr double bits_per_byte = 10;        /* 8N1 */
constexpr std::size_t most_waiting = 65536; /* bytes for the drive; what comes beyond is lost */
constexpr double most_in_period = 1024;     /* bytes, whatever the baud rate: what a board takes */
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

Station::Station(const scenario::Scenario &scenario, std::unique_ptr<sil::DriveBoard> its,
                 const SerialPace &pace)
    : board(std::move(its)), knobs(scenario, *board), pace_in(pace), pace_out(pace)
{
}

Server::Server(const scenario::Scenario &scenario,
               std::vector<std::unique_ptr<sil::DriveBoard>> boards, const ServeOptions &options)
    : period_s_(scenario.plant.bridge.period_s), serial_(options.serial), knob_port_(options.knobs),
      clock_(options.speed, period_s_)
{
    if (options.can) {
        can_port_.emplace(*options.can);
    }
    const SerialPace pace(std::min(options.baud / bits_per_byte * period_s_, most_in_period));
    for (std::unique_ptr<sil::DriveBoard> &board : boards) {
        stations_.push_back(std::make_unique<Station>(scenario, std::move(board), pace));
    }
}

std::string Server::places() const
{
    return joined("serial:", serial_.places()) + joined("knobs:", knob_port_.places()) +
           (can_port_ ? joined("can:", can_port_->places()) : "");
}

void Server::wait()
{
    std::vector<pollfd> watched;
    serial_.watch(watched);
    knob_port_.watch(watched);
    if (can_port_) {
        can_port_->watch(watched);
    }
    const timespec nap = {0, period_ - heard_in_ < answer_periods ? short_nap_ns : nap_ns};
    ppoll(watched.data(), watched.size(), &nap, nullptr);
}

void Server::exchange()
{
    const std::string bytes = serial_.read();
    heard_in_ = bytes.empty() ? heard_in_ : period_;
    for (const std::unique_ptr<Station> &station : stations_) {
        if (station->to_drive.size() + bytes.size() <= most_waiting) {
            station->to_drive += bytes;
        }
    }
    knob_port_.write(turn_knobs(knob_port_.read()));
    if (can_port_) {
        const std::string typed = can_port_->read();
        heard_in_ = typed.empty() ? heard_in_ : period_;
        can_port_->write(
            adapter_.take(typed, [this](const can_frame &frame) { return carry(frame, nullptr); }));
    }
}

/* To every board but the one that it is from. false: one of them takes none now. */
bool Server::carry(const can_frame &frame, const Station *from)
{
    bool taken = true;
    for (const std::unique_ptr<Station> &station : stations_) {
        if (station.get() != from && !station->board->send_frame(frame)) {
            taken = false;
        }
    }
    return taken;
}

/* "2: load_torque_Nm = 0.1" is for node 2; without a number a line is for node 1. */
std::string Server::turn_knobs(const std::string &bytes)
{
    std::string answers;
    knob_line_ += bytes;
    for (std::size_t end = 0; (end = knob_line_.find('\n')) != std::string::npos;) {
        std::string line = knob_line_.substr(0, end + 1);
        knob_line_.erase(0, end + 1);
        const std::size_t colon = line.find(':');
        std::size_t node = 1;
        if (colon != std::string::npos && colon <= 3 &&
            line.find_first_not_of("0123456789") == colon) {
            node = std::stoul("0" + line.substr(0, colon));
            line.erase(0, colon + 1);
        }
        if (node < 1 || node > stations_.size()) {
            answers += scenario::format("error: expected a node 1...%zu\n", stations_.size());
            continue;
        }
        Station &station = *stations_[node - 1];
        answers += station.knobs.turn(line, period_);
        if (station.knobs.take_restart()) {
            station.from_drive.clear();
            station.line.clear();
        }
    }
    return answers;
}

void Server::pass_period()
{
    for (const std::unique_ptr<Station> &station : stations_) {
        pass_period_of(*station);
    }
    ++period_;
}

void Server::pass_period_of(Station &station)
{
    station.knobs.act(period_);
    const std::string bytes = station.pace_in.take(station.to_drive);
    if (!bytes.empty()) {
        station.board->send(bytes);
    }
    station.board->control();
    station.from_drive += station.board->take_output();
    station.board->advance();
    const std::string sent = station.pace_out.take(station.from_drive);
    if (stations_.size() == 1) {
        serial_.write(sent, !station.from_drive.empty());
    } else {
        share_frames(station, sent);
    }
    for (const can_frame &frame : station.board->take_frames()) {
        (void)carry(frame, &station);
        if (can_port_) {
            can_port_->write(adapter_.show(frame));
        }
    }
}

/* As a bus would: whole frames, each to the client and to every other node. */
void Server::share_frames(Station &station, const std::string &bytes)
{
    const bool first = &station == stations_.front().get();
    for (const char byte : bytes) {
        station.line += byte;
        if (byte != '\r' && byte != '\n' && byte != '\a') {
            continue;
        }
        const bool is_frame = byte == '\r' && station.line.size() > 4 && station.line[0] == 't';
        if (first || is_frame) {
            serial_.write(station.line);
        }
        for (const std::unique_ptr<Station> &other : stations_) {
            if (is_frame && other.get() != &station) {
                other->to_drive += station.line;
            }
        }
        station.line.clear();
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
