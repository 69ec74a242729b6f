#include "sil/scenario/batch.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <unistd.h>

#include "sil/scenario/interruption.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

using Clock = std::chrono::steady_clock;

/* "runs 37 of 896, 12 s": in place on a terminal, else a line every few seconds. */
class Progress
{
  public:
    explicit Progress(std::size_t count) : count_(count)
    {
    }
    ~Progress()
    {
        clear();
    }

    void show(std::size_t done)
    {
        const Clock::time_point now = Clock::now();
        const auto interval =
            terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(5000);
        if (now - start_ < std::chrono::seconds(2) || now - last_ < interval) {
            return;
        }
        last_ = now;
        const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now - start_);
        std::fprintf(stderr, "%ssteadystep-sil: runs %zu of %zu, %lld s%s", terminal_ ? "\r" : "",
                     done, count_, static_cast<long long>(seconds.count()), terminal_ ? "" : "\n");
        shown_ = true;
    }

    /* Makes room on a terminal for what is printed next. */
    void clear()
    {
        if (terminal_ && shown_) {
            std::fprintf(stderr, "\r\033[K");
            shown_ = false;
        }
    }

  private:
    std::size_t count_;
    bool terminal_ = isatty(STDERR_FILENO) != 0;
    bool shown_ = false;
    Clock::time_point start_ = Clock::now(), last_ = start_;
};

struct Shared {
    std::mutex mutex;
    std::condition_variable changed;
    std::size_t next = 0, finished = 0, delivered = 0;
    std::vector<bool> done;
    std::exception_ptr error;
};

void work_through(Shared &shared, const std::function<void(std::size_t)> &work)
{
    std::unique_lock<std::mutex> lock(shared.mutex);
    while (shared.next < shared.done.size() && !shared.error) {
        const std::size_t i = shared.next++;
        lock.unlock();
        std::exception_ptr error;
        try {
            work(i);
        } catch (...) {
            error = std::current_exception();
        }
        lock.lock();
        if (error && !shared.error) {
            shared.error = error;
        }
        shared.done[i] = true;
        ++shared.finished;
        shared.changed.notify_one();
    }
}

[[noreturn]] void rethrow(const Shared &shared)
{
    try {
        std::rethrow_exception(shared.error);
    } catch (const Interrupted &) {
        throw Interrupted(format("%zu of %zu runs are reported, no file is left half-written",
                                 shared.delivered, shared.done.size()));
    }
}

void deliver_in_order(Shared &shared, Progress &progress,
                      const std::function<void(std::size_t)> &deliver)
{
    std::unique_lock<std::mutex> lock(shared.mutex);
    for (std::size_t i = 0; i < shared.done.size(); ++i) {
        while (!shared.done[i] && !shared.error) {
            shared.changed.wait_for(lock, std::chrono::milliseconds(200));
            progress.show(shared.finished);
        }
        if (shared.error) {
            return;
        }
        lock.unlock();
        std::exception_ptr error;
        try {
            progress.clear();
            deliver(i);
        } catch (...) {
            error = std::current_exception();
        }
        lock.lock();
        if (error) {
            shared.error = error;
        }
        ++shared.delivered;
    }
}

} // namespace

void run_batch(std::size_t count, unsigned workers, const std::function<void(std::size_t)> &work,
               const std::function<void(std::size_t)> &deliver)
{
    Shared shared;
    shared.done.resize(count);
    Progress progress(count);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < std::min<std::size_t>(workers, count); ++i) {
        threads.emplace_back([&] { work_through(shared, work); });
    }
    deliver_in_order(shared, progress, deliver);
    for (std::thread &thread : threads) {
        thread.join();
    }
    if (shared.error) {
        rethrow(shared);
    }
}

unsigned default_workers()
{
    return std::max(1u, std::thread::hardware_concurrency());
}

} // namespace scenario
