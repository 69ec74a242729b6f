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

    /* Types a line; `origin` is where it was asked for, and for which time. */
    void type(const std::string &line, const std::string &origin, double time_s);

    /* After each control(): takes what the drive has written. */
    void listen();

    /* A line that was answered with an error. */
    struct Refusal {
        std::string line, origin;
        double time_s;
        std::string answer;
        bool expected; /* expect() has met the answer */
    };

    const std::vector<Refusal> &refusals() const
    {
        return refusals_;
    }

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
        std::string line, origin;
        double time_s;
    };
    struct Heard {
        std::string line;
        std::size_t refusal; /* which of refusals_ it is, or no_refusal */
    };
    static constexpr std::size_t no_refusal = static_cast<std::size_t>(-1);

    std::size_t answer(const std::string &line);
    void hear(const std::string &line);
    void note(char direction, const std::string &line);

    sil::DriveBoard &board_;
    std::deque<Typed> unanswered_;
    std::string partial_; /* line of the drive that has not ended */
    std::vector<Heard> heard_;
    std::vector<Refusal> refusals_;
    std::size_t expected_ = 0; /* lines of heard_ that are behind the last expectation */
    std::string transcript_;
    bool begun_ = false; /* a period of the drive's has been */
};

} // namespace scenario

#endif
