// SPDX-License-Identifier: Apache-2.0
#include "foundation/sandbox/sandbox.h"

#include <string>

#include <gtest/gtest.h>
#include <signal.h>

#include "foundation/base/error.h"
#include "support/environment_variable.h"

namespace airtruth::sandbox {
namespace {

TEST(Sandbox, AMissingProgramIsOneLine) {
  {
    const test_support::EnvironmentVariable stated("AIRTRUTH_NO_HELPER", "/nowhere/helper");
    try {
      path_of({"no-helper", "AIRTRUTH_NO_HELPER", "the reader of nothing"});
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()),
                "/nowhere/helper: is what AIRTRUTH_NO_HELPER names, but no program");
    }
  }
  EXPECT_THROW(path_of({"no-helper", "AIRTRUTH_NO_HELPER", "the reader of nothing"}), Error);
}

TEST(Sandbox, EndsInWords) {
  EXPECT_EQ(end_in_words(SIGSEGV), std::string("its reader broke on it (Segmentation fault)"));
  EXPECT_EQ(end_in_words(SIGKILL), "its reader took too much time or memory and was ended");
  EXPECT_EQ(end_in_words(3 << 8), "its reader ended with code 3");
}

}  // namespace
}  // namespace airtruth::sandbox
