// SPDX-License-Identifier: Apache-2.0
#include "comparison/match/real.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/files.h"
#include "support/shared_folder.h"
#include "support/temporary_folder.h"

namespace airtruth::match {
namespace {

TEST(Real, SizesThatJumpAreLeftOut) {
  RealBoxes boxes;
  for (int i = 0; i < 20; ++i) boxes[i] = {0, 0, i == 9 ? 34.0 : 20.0, 8};
  const RealBoxes kept = without_jumps(boxes);
  EXPECT_EQ(kept.size(), 19u);
  EXPECT_FALSE(kept.contains(9));
}

TEST(Real, BoxesAreReadBehindAByteOrderMark) {
  const test_support::TemporaryFolder folder;
  const fs::path file = folder / "boxes.csv";
  write_file(file,
             "\xEF\xBB\xBF"
             "frame,x,y,w,h\n0,1,2,3,4\n1,1,2,3,4\n");
  EXPECT_EQ(read_boxes(file, 0).size(), 2u);
}

// The clips that came with tight boxes made by others.
class Footage : public testing::Test {
 protected:
  void SetUp() override {
    const char* shared = test_support::shared_folder();
    if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is not set: no footage";
    folder_ = fs::path(shared) / "footage" / "ground-real";
    if (!fs::is_directory(folder_)) GTEST_SKIP() << "no " << folder_;
  }
  fs::path folder_;
};

TEST_F(Footage, BoxesWithinLooseOnesAreTheTightOnesThatOthersMade) {
  for (const char* name : {"V_AIRPLANE_003", "V_AIRPLANE_018", "V_AIRPLANE_049"}) {
    const RealBoxes loose = read_boxes(folder_ / (std::string(name) + ".csv"), 1);
    const RealBoxes tight = read_boxes(folder_ / "tight" / (std::string(name) + ".csv"), 0);
    const RealAircraft found = find_real(folder_ / (std::string(name) + ".mp4"), loose, 60, {}, {});
    EXPECT_GE(found.boxes.size(), 50u) << name;
    std::vector<double> off;
    for (const auto& [frame, box] : found.boxes) {
      const auto other = tight.find(frame);
      if (other == tight.end()) continue;
      const Box& t = other->second;
      off.push_back(std::max({std::abs(box.x - t.x),
                              std::abs(box.y - t.y),
                              std::abs(box.right() - t.right()),
                              std::abs(box.bottom() - t.bottom())}));
    }
    std::sort(off.begin(), off.end());
    ASSERT_FALSE(off.empty());
    EXPECT_LE(off[off.size() / 2], 2) << name;
  }
}

TEST_F(Footage, ACutIsSeenAndNotRunAcross) {
  const RealBoxes loose = read_boxes(folder_ / "more" / "V_AIRPLANE_015.csv", 1);
  std::string said;
  const RealAircraft found = find_real(folder_ / "more" / "V_AIRPLANE_015.mp4",
                                       loose,
                                       0,
                                       [&](const std::string& message) { said += message; },
                                       {});
  EXPECT_EQ(found.cuts, std::vector<std::int64_t>{139});
  EXPECT_GE(found.boxes.begin()->first, 139);
  EXPECT_THAT(said, testing::HasSubstr("cut at frame 139"));
}

}  // namespace
}  // namespace airtruth::match
