#include "sil/scenario/serial_line.h"

#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

bool begins(const std::string &line, const std::string &begin)
{
    return line.compare(0, begin.size(), begin) == 0;
}

bool is_answer(const std::string &line)
{
    return line == "ok" || begins(line, "ok ") || begins(line, "error:");
}

} // namespace

void SerialLine::type(const std::string &line, const std::string &origin, double time_s)
{
    board_.type(line);
    if (line.find_first_not_of(" \t\r") != std::string::npos) {
        unanswered_.push_back({line, origin, time_s});
    }
    note('>', line);
}

void SerialLine::listen()
{
    begun_ = true;
    const std::string output = board_.take_output();
    if (output.empty()) {
        return;
    }
    partial_ += output;
    for (std::size_t end = 0; (end = partial_.find('\n')) != std::string::npos;) {
        const std::string line = partial_.substr(0, end);
        partial_.erase(0, end + 1);
        hear(line);
    }
}

void SerialLine::hear(const std::string &line)
{
    note('<', line);
    heard_.push_back({line, is_answer(line) && !unanswered_.empty() ? answer(line) : no_refusal});
}

/* To the oldest line without one. */
std::size_t SerialLine::answer(const std::string &line)
{
    const Typed typed = unanswered_.front();
    unanswered_.pop_front();
    if (!begins(line, "error:")) {
        return no_refusal;
    }
    refusals_.push_back({typed.line, typed.origin, typed.time_s, line, false});
    return refusals_.size() - 1;
}

void SerialLine::forget()
{
    unanswered_.clear();
    partial_.clear();
    begun_ = false;
}

bool SerialLine::expect(const std::string &begin)
{
    for (std::size_t i = expected_; i < heard_.size(); ++i) {
        if (begins(heard_[i].line, begin)) {
            expected_ = i + 1;
            if (heard_[i].refusal != no_refusal) {
                refusals_[heard_[i].refusal].expected = true;
            }
            return true;
        }
    }
    return false;
}

std::string SerialLine::unread() const
{
    std::string lines;
    for (std::size_t i = expected_; i < heard_.size(); ++i) {
        lines += (lines.empty() ? "\"" : ", \"") + heard_[i].line + "\"";
    }
    return lines.empty() ? "nothing" : lines;
}

void SerialLine::note(char direction, const std::string &line)
{
    const unsigned next = direction == '>' ? 1 : 0; /* it arrives in the coming period */
    const unsigned period = begun_ ? board_.signals().period + next : 0;
    transcript_ += format("%10u %c ", period, direction) + line + "\n";
}

} // namespace scenario
