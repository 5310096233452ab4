// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>

#include <time.h>

namespace airtruth {

// The wall time since construction, in seconds, from a clock that never goes back.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

// CPU seconds of the calling thread and of the whole process, as far as the kernel has counted
// them.
inline double cpu_seconds(clockid_t clock) {
  timespec time{};
  return ::clock_gettime(clock, &time) == 0
             ? static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec)
             : 0;
}
inline double thread_cpu_seconds() { return cpu_seconds(CLOCK_THREAD_CPUTIME_ID); }
inline double process_cpu_seconds() { return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID); }

// Wall and CPU time that several threads add to.
struct SharedTime {
  std::atomic<double> wall_s = 0;
  std::atomic<double> cpu_s = 0;  // of the threads themselves, without threads that they wait for
};

// Adds the time from its construction to its destruction to a shared total. A Timed of the same
// thread within it, as when a thread that waits takes up another task, counts for its own total
// alone: the totals of all do not exceed the time of the threads.
class Timed {
 public:
  explicit Timed(SharedTime& total) : total_(total), outer_(innermost_) { innermost_ = this; }
  ~Timed() {
    const double wall_s = wall_.seconds(), cpu_s = thread_cpu_seconds() - cpu_start_s_;
    total_.wall_s += wall_s - inner_wall_s_;
    total_.cpu_s += cpu_s - inner_cpu_s_;
    innermost_ = outer_;
    if (outer_ == nullptr) return;
    outer_->inner_wall_s_ += wall_s;
    outer_->inner_cpu_s_ += cpu_s;
  }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  SharedTime& total_;
  Timed* outer_;
  Stopwatch wall_;
  double cpu_start_s_ = thread_cpu_seconds();
  double inner_wall_s_ = 0, inner_cpu_s_ = 0;
  static inline thread_local Timed* innermost_ = nullptr;
};

}  // namespace airtruth
