/* The scenario's end of a drive's serial line: types, listens, and keeps the transcript. */
#ifndef STEADYSTEP_SCENARIO_SERIAL_LINE_H
#define STEADYSTEP_SCENARIO_SERIAL_LINE_H

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "sil/board/board.h"

namespace scenario
{

class SerialLine
{
  public:
    explicit SerialLine(sil::DriveBoard &board) : board_(board)
    {
    }

    /* Types a line of the timeline: as it is, whatever the answer. */
    void type(const std::string &line);
    /* Types a command that must be obeyed; `origin` is where it was asked for. */
    void type_command(const std::string &line, const std::string &origin);

    /* After each control(): takes what the drive has written. Throws std::invalid_argument if it
       has refused a command. */
    void listen();

    /* The drive has restarted: what was typed has no answer any more. */
    void forget();

    /* Whether a line that begins so has come since the one that was expected last. */
    bool expect(const std::string &begin);
    /* The lines that have come since then, for a complaint. */
    std::string unread() const;

    /* "     period > typed" and "     period < written" by the drive, a line each. */
    const std::string &transcript() const
    {
        return transcript_;
    }

  private:
    struct Typed {
        std::string line;
        std::string origin; /* of a command that must be obeyed, else "" */
    };

    void send(const std::string &line, const std::string &origin);
    void hear(const std::string &line);
    void note(char direction, const std::string &line);

    sil::DriveBoard &board_;
    std::deque<Typed> unanswered_;
    std::string partial_; /* line of the drive that has not ended */
    std::vector<std::string> heard_;
    std::size_t expected_ = 0; /* lines of heard_ that are behind the last expectation */
    std::string transcript_;
    bool begun_ = false; /* a period of the drive's has been */
};

} // namespace scenario

#endif
