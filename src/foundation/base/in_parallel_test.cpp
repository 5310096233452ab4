// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/in_parallel.h"

#include <atomic>
#include <chrono>
#include <stop_token>
#include <thread>

#include <gtest/gtest.h>
#include <sched.h>

#include "foundation/base/error.h"

namespace airtruth {
namespace {

// Waits until `count` reaches `wanted`. Returns false after a minute, so that a failure does not
// hang.
bool reaches(const std::atomic<int>& count, int wanted) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (count < wanted) {
    if (std::chrono::steady_clock::now() > limit) return false;
    std::this_thread::yield();
  }
  return true;
}

TEST(InParallel, ProcessorsAreThoseThatTheProcessMayUse) {
  cpu_set_t before, one;
  ASSERT_EQ(::sched_getaffinity(0, sizeof before, &before), 0);
  EXPECT_EQ(usable_processors(), CPU_COUNT(&before));
  CPU_ZERO(&one);
  for (int k = 0; k < CPU_SETSIZE; ++k)
    if (CPU_ISSET(k, &before)) {
      CPU_SET(k, &one);
      break;
    }
  ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
  EXPECT_EQ(usable_processors(), 1);
  ::sched_setaffinity(0, sizeof before, &before);
}

TEST(InParallel, MakesEachCallOnceAndCountsThem) {
  std::vector<int> calls(100, 0);
  std::vector<std::int64_t> seen;
  in_parallel(
      calls.size(),
      3,
      [&](std::size_t i) { ++calls[i]; },
      [&](std::int64_t done, std::int64_t total) {
        EXPECT_EQ(total, 100);
        seen.push_back(done);
      },
      {});
  EXPECT_EQ(calls, std::vector<int>(100, 1));
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(seen.at(i), static_cast<std::int64_t>(i) + 1);
}

// Each of the eight calls waits for the seven others: with fewer threads the test would time out.
TEST(InParallel, HasAsManyCallsUnderWayAsItIsAskedForWhateverTheCores) {
  std::atomic<int> under_way = 0;
  std::atomic<bool> all_met = true;
  in_parallel(8,
              8,
              [&](std::size_t) {
                ++under_way;
                if (!reaches(under_way, 8)) all_met = false;
              },
              {},
              {});
  EXPECT_TRUE(all_met);
}

TEST(InParallel, NoMoreThanItIsAskedFor) {
  std::atomic<int> now = 0;
  std::atomic<int> most = 0;
  in_parallel(200,
              2,
              [&](std::size_t) {
                const int mine = ++now;
                if (mine > most) most = mine;
                std::this_thread::yield();
                --now;
              },
              {},
              {});
  EXPECT_LE(most, 2);
}

TEST(InParallel, AFailureEndsTheWorkAndIsThrown) {
  std::atomic<int> calls = 0;
  EXPECT_THROW(in_parallel(1000,
                           1,
                           [&](std::size_t i) {
                             ++calls;
                             if (i == 5) throw Error("no");
                           },
                           {},
                           {}),
               Error);
  EXPECT_EQ(calls, 6);
}

TEST(InParallel, AStopIsInterrupted) {
  std::stop_source stop;
  std::atomic<int> calls = 0;
  EXPECT_THROW(in_parallel(
                   1000,
                   1,
                   [&](std::size_t i) {
                     ++calls;
                     if (i == 5) stop.request_stop();
                   },
                   {},
                   stop.get_token()),
               Interrupted);
  EXPECT_EQ(calls, 6);
}

}  // namespace
}  // namespace airtruth
