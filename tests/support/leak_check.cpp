// SPDX-License-Identifier: Apache-2.0
// Part of each sanitized test program: LeakSanitizer looks for leaks when the last test has ended.
// By itself it looks after the destructors of static objects, when oneTBB's threads are ending, and
// its reading of their memory then fails now and then.
#include <gtest/gtest.h>
#include <sanitizer/lsan_interface.h>

namespace {

class LeakCheck : public ::testing::Environment {
 public:
  void TearDown() override { __lsan_do_leak_check(); }
};

[[maybe_unused]] const ::testing::Environment* const kLeakCheck =
    ::testing::AddGlobalTestEnvironment(new LeakCheck);

}  // namespace
