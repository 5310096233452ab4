// SPDX-License-Identifier: Apache-2.0
#include "dataset/sequences/condition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "support/error_of.h"

namespace airtruth::sequences {
namespace {

TEST(Condition, HoldsWithinItsRangeAndNotWithoutTheFact) {
  const std::map<std::string, double> facts = {{"noise", 1.5}, {"visibility_m", 5000}};
  const auto holds = [&](const char* text) { return hold({condition_from(text)}, facts); };
  EXPECT_TRUE(holds("noise=1.5..2"));
  EXPECT_TRUE(holds("noise=1..1.5"));
  EXPECT_TRUE(holds("noise=1.2.."));
  EXPECT_TRUE(holds("visibility_m=..5e3"));
  EXPECT_FALSE(holds("noise=1.6.."));
  EXPECT_FALSE(holds("visibility_m=..4999"));
  EXPECT_FALSE(holds("blur=0..10"));
  EXPECT_FALSE(hold({condition_from("noise=1..2"), condition_from("blur=0..10")}, facts));
  EXPECT_TRUE(hold({}, facts));
}

TEST(Condition, AFaultIsOneLine) {
  const auto error = [](const char* text) -> std::string {
    return test_support::error_of([&] { condition_from(text); });
  };
  EXPECT_EQ(error("noise"), "--where: is 'noise'; expected KEY=LOW..HIGH, as in noise=1..2");
  EXPECT_THAT(error("noise=.."), testing::HasSubstr("expected KEY=LOW..HIGH"));
  EXPECT_THAT(error("noise=2..1"), testing::HasSubstr("falls"));
  EXPECT_THAT(error("nois=1..2"), testing::HasSubstr("did you mean 'noise'?"));
  EXPECT_THAT(error("noise=a..2"), testing::HasSubstr("--where: "));
  EXPECT_THAT(error("noise=1..nan"), testing::HasSubstr("--where: "));
}

}  // namespace
}  // namespace airtruth::sequences
