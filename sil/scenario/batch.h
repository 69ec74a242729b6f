/* Many runs on several cores: results come in order and do not depend on how many. */
#ifndef STEADYSTEP_SCENARIO_BATCH_H
#define STEADYSTEP_SCENARIO_BATCH_H

#include <cstddef>
#include <functional>

namespace scenario
{

/*
 * Calls work(i) for i in 0...count - 1 on `workers` threads, and deliver(i) on the caller's
 * thread, in order, each once work(i) is done. The first exception of either is thrown on when
 * the threads have come to rest. A batch that lasts shows its progress on standard error.
 */
void run_batch(std::size_t count, unsigned workers, const std::function<void(std::size_t)> &work,
               const std::function<void(std::size_t)> &deliver);

/* Number of cores, at least 1. */
unsigned default_workers();

} // namespace scenario

#endif
