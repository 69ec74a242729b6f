#include "sil/scenario/interruption.h"

#include <csignal>
#include <cstdlib>

namespace scenario
{

namespace
{

volatile std::sig_atomic_t noted_signal = 0;

void note(int signal)
{
    noted_signal = signal;
}

} // namespace

void note_signals()
{
    std::signal(SIGINT, note);
    std::signal(SIGTERM, note);
    std::signal(SIGPIPE, SIG_IGN);
}

void throw_if_interrupted()
{
    if (noted_signal != 0) {
        throw Interrupted();
    }
}

void end_by_signal()
{
    std::signal(noted_signal, SIG_DFL);
    std::raise(noted_signal);
    std::abort();
}

} // namespace scenario
