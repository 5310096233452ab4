// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/in_parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <sched.h>

#include "foundation/base/error.h"

namespace airtruth {

int usable_processors() {
  cpu_set_t usable;
  CPU_ZERO(&usable);
  // It fails on machines with more processors than the set has places for.
  if (::sched_getaffinity(0, sizeof usable, &usable) == 0) return std::max(1, CPU_COUNT(&usable));
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

// These are plain threads and not tasks of oneTBB. A job may wait for a tracker in a child process,
// or limit oneTBB while it renders; even then as many jobs run as the user asked for
// (docs/decisions/0002).
void in_parallel(std::size_t count,
                 int jobs,
                 const std::function<void(std::size_t)>& each,
                 const std::function<void(std::int64_t done, std::int64_t total)>& progress,
                 const std::stop_token& stop) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> is_over = false;
  std::mutex mutex;
  std::int64_t done = 0;
  std::exception_ptr failure;
  const auto work = [&] {
    for (;;) {
      const std::size_t i = next.fetch_add(1);
      if (i >= count || is_over || stop.stop_requested()) return;
      try {
        each(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        is_over = true;
        return;
      }
      const std::lock_guard lock(mutex);
      ++done;
      if (progress) progress(done, static_cast<std::int64_t>(count));
    }
  };
  {
    const auto wanted = static_cast<std::size_t>(jobs > 0 ? jobs : usable_processors());
    std::vector<std::jthread> threads;
    for (std::size_t k = 0; k < std::min(wanted, count); ++k) threads.emplace_back(work);
  }
  if (stop.stop_requested()) throw Interrupted();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace airtruth
