// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>

namespace airtruth {

// How many processors this process may use, 1 or more: those that taskset or a cluster's scheduler
// left it.
int usable_processors();

// Calls each(0) to each(count - 1) on `jobs` threads (0: one a usable processor). After the first
// failure the other threads finish their current calls, and the function rethrows the failure. It
// throws Interrupted after a stop. It calls `progress` after each finished call, one call at a
// time.
void in_parallel(std::size_t count,
                 int jobs,
                 const std::function<void(std::size_t)>& each,
                 const std::function<void(std::int64_t done, std::int64_t total)>& progress,
                 const std::stop_token& stop);

// The same with the jobs, the progress and the stop of these options.
template <typename Options>
void in_parallel(std::size_t count,
                 const Options& options,
                 const std::function<void(std::size_t)>& each) {
  in_parallel(count, options.jobs, each, options.progress, options.stop);
}

}  // namespace airtruth
