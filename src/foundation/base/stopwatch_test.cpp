// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/stopwatch.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace airtruth {
namespace {

// Uses the processor until the thread has had that much of it.
void work_for(double seconds) {
  const double end_s = thread_cpu_seconds() + seconds;
  while (thread_cpu_seconds() < end_s) {
  }
}

TEST(Timed, AWaitTakesWallTimeAndNoCpuTime) {
  SharedTime total;
  {
    const Timed timed(total);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_GE(total.wall_s, 0.1);
  EXPECT_LT(total.cpu_s, total.wall_s / 2);
}

TEST(Timed, WhatLiesWithinCountsForItsOwnTotalAlone) {
  SharedTime outer, inner;
  const double before_s = thread_cpu_seconds();
  {
    const Timed whole(outer);
    work_for(0.02);
    {
      const Timed part(inner);
      work_for(0.05);
    }
    work_for(0.01);
  }
  const double all_s = thread_cpu_seconds() - before_s;
  EXPECT_GE(inner.cpu_s, 0.05);
  EXPECT_GE(outer.cpu_s, 0.03 - 1e-9);
  EXPECT_LE(outer.cpu_s + inner.cpu_s, all_s);
}

TEST(Timed, OtherThreadsHaveTheirOwn) {
  SharedTime here, there;
  const Timed timed(here);
  std::thread([&] {
    const Timed of_thread(there);
    work_for(0.03);
  }).join();
  EXPECT_GE(there.cpu_s, 0.03);
}

TEST(CpuSeconds, OfTheProcessAreThoseOfItsThreads) {
  const double before_s = process_cpu_seconds();
  std::thread first(work_for, 0.03), second(work_for, 0.03);
  first.join();
  second.join();
  EXPECT_GE(process_cpu_seconds() - before_s, 0.06);
}

}  // namespace
}  // namespace airtruth
