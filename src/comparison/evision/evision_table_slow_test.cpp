// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "comparison/evision/evision_table.h"
#include "support/shared_folder.h"

namespace airtruth::evision {
namespace {

TEST(EvisionTable, SizesAreAsPublishedAndNoFrameInViewLacksABox) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr)
    GTEST_SKIP() << "AIRTRUTH_SHARED is unset: the published annotations are not here";
  const auto rows = evision_table(fs::path(shared) / "evision", {});
  ASSERT_EQ(rows.size(), 12u);
  for (const EvisionRow& row : rows) {
    EXPECT_TRUE(row.sizes_hold()) << row.sequence << ": " << row.width_off_px << " x "
                                  << row.height_off_px << " px";
    EXPECT_EQ(row.without_box_ours, 0) << row.sequence;
    EXPECT_LT(row.centre_off_px, 5) << row.sequence;
    EXPECT_GT(row.compared, 200) << row.sequence;
  }
}

// With another aircraft the sizes differ, which shows that the test above can fail.
TEST(EvisionTable, ALongerAirlinerDoesNotFit) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr)
    GTEST_SKIP() << "AIRTRUTH_SHARED is unset: the published annotations are not here";
  EvisionOptions options;
  options.airliner = "739/739-Delta";
  int hold = 0;
  for (const EvisionRow& row : evision_table(fs::path(shared) / "evision", options))
    hold += row.sizes_hold() ? 1 : 0;
  EXPECT_LT(hold, 10);
}

}  // namespace
}  // namespace airtruth::evision
