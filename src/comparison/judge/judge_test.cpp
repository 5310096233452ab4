// SPDX-License-Identifier: Apache-2.0
#include "comparison/judge/judge.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/seed.h"

namespace airtruth::judge {
namespace {

TEST(Areas, AnAreaIsTheShareOfPairsInOrderAndFoldsAboutOneHalf) {
  // Real 3, 1; inserted 2, 0: 3 of 4 pairs are in order.
  EXPECT_DOUBLE_EQ(area_under_curve({3, 2, 1, 0}, {1, 0, 1, 0}), 0.75);
  EXPECT_DOUBLE_EQ(area_under_curve({1, 1}, {1, 0}), 0.5);
  EXPECT_DOUBLE_EQ(folded(0.005), 0.995);
  EXPECT_DOUBLE_EQ(folded(0.75), 0.75);
}

TEST(Areas, IntervalsOfClipsHoldWhatIsKnownOfThem) {
  const Interval same = mean_over_clips({0.7, 0.7, 0.7}, 1);
  EXPECT_DOUBLE_EQ(same.value, 0.7);
  EXPECT_NEAR(same.low, 0.7, 1e-12);
  EXPECT_NEAR(same.high, 0.7, 1e-12);
  // 16 values 0 and 1 in turn: the mean's standard error is 0.125.
  std::vector<double> values;
  for (int i = 0; i < 16; ++i) values.push_back(i % 2);
  const Interval half = mean_over_clips(values, 1);
  EXPECT_DOUBLE_EQ(half.value, 0.5);
  EXPECT_NEAR(half.low, 0.5 - 1.96 * 0.125, 0.07);
  EXPECT_NEAR(half.high, 0.5 + 1.96 * 0.125, 0.07);
  EXPECT_DOUBLE_EQ(median_over_clips({4, 1, 100}, 1).value, 4);
  EXPECT_DOUBLE_EQ(median_over_clips({4, 1, 100, 2}, 1).value, 3);
}

// A clip whose first feature parts real from inserted by `apart` deviations; 25 features as the
// program writes them.
std::string patches(double apart, std::uint64_t seed) {
  Random random(seed);
  std::string text = "real,frame,features...\n";
  for (int frame = 0; frame < 48; ++frame)
    for (const int real : {1, 0}) {
      text += fmt::format("{},{}", real, frame);
      for (int f = 0; f < 25; ++f)
        text += fmt::format(",{:.4f}",
                            random.normal() + (f == 0 ? (real == 1 ? apart : -apart) / 2 : 0.0));
      text += '\n';
    }
  return text;
}

class Judge : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::temp_directory_path() / fmt::format("airtruth_judge_{}", ::getpid());
    fs::remove_all(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  fs::path clip(const std::string& name, double apart, const std::string& measures) {
    fs::create_directories(root_ / name);
    write_file(root_ / name / "patches.csv", patches(apart, name.size() * 7 + name.back()));
    write_file(root_ / name / "comparison.json", R"({"measures": [)" + measures + "]}");
    return root_ / name;
  }
  static std::string measure(double real, double made) {
    return fmt::format(R"({{"name": "edge", "real": {}, "inserted": {}}})", real, made);
  }

  fs::path root_;
};

TEST_F(Judge, AClipThatIsTheOtherWayRoundIsToldApartAllTheSame) {
  std::vector<fs::path> clips = {
      clip("a", 6, measure(2, 3)), clip("b", 6, measure(2, 5)), clip("c", -6, measure(1, 2))};
  for (const char* name : {"d", "e", "f"})
    clips.push_back(clip(name, 6, R"({"name": "edge", "real": null, "inserted": null})"));
  const Verdict verdict = verdict_on(clips, 1);
  // Trained on the others the judge is always wrong on c: folded that is as good as right.
  EXPECT_LT(verdict.clips[2].across, 0.2);
  EXPECT_GT(verdict.across.value, 0.85);
  EXPECT_GT(verdict.within.value, 0.95);
  EXPECT_GE(verdict.across.value, verdict.across.low);
  EXPECT_LE(verdict.across.value, verdict.across.high);
  ASSERT_EQ(verdict.gaps.size(), 1u);
  EXPECT_EQ(verdict.gaps[0].clips, 3u);
  EXPECT_DOUBLE_EQ(verdict.gaps[0].real, 2);
  EXPECT_DOUBLE_EQ(verdict.gaps[0].made, 3);
  EXPECT_DOUBLE_EQ(verdict.gaps[0].difference.value, 1);
  EXPECT_THAT(text_of(verdict), testing::HasSubstr("| edge | 3 | 2 | 3 | +1 (+1 to +3) |"));
  EXPECT_THAT(json_of(verdict), testing::HasSubstr("\"across\""));
}

TEST_F(Judge, WhatIsAlikeIsNotToldApart) {
  std::vector<fs::path> clips;
  for (const char* name : {"a", "b", "c", "d", "e", "f"})
    clips.push_back(clip(name, 0, measure(1, 1)));
  const Verdict verdict = verdict_on(clips, 1);
  // 48 pairs a clip: an area's standard error is 0.059, and its folded mean 0.5 + 0.8 x 0.059.
  EXPECT_LT(verdict.across.value, 0.60);
  EXPECT_LT(verdict.within.value, 0.67);  // 12 pairs a stretch: 0.5 + 0.8 x 0.118
  EXPECT_DOUBLE_EQ(verdict.gaps[0].difference.value, 0);
}

// Clips whose two aircraft differ, but not all the same way round, are separated by chance as
// well.
TEST_F(Judge, ChanceGivesHighAreasWhereClipsDifferInWhateverWay) {
  std::vector<fs::path> alike, either, common;
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
    alike.push_back(clip(fmt::format("alike{}", name), 0, measure(1, 1)));
    either.push_back(clip(fmt::format("either{}", name), *name % 2 == 0 ? 6 : -6, measure(1, 1)));
    common.push_back(clip(fmt::format("common{}", name), 6, measure(1, 1)));
  }
  constexpr int kDraws = 6;
  const auto of_alike = verdict_on(alike, 1, kDraws).by_chance;
  ASSERT_TRUE(of_alike);
  EXPECT_LT(of_alike->mean, 0.6);
  const Verdict of_either = verdict_on(either, 1, kDraws),
                of_common = verdict_on(common, 1, kDraws);
  EXPECT_GT(of_either.by_chance->mean, 0.7);
  EXPECT_GT(of_either.by_chance->as_high, 0);
  EXPECT_LT(of_common.by_chance->mean, of_common.across.value);
  EXPECT_LE(of_common.by_chance->as_high, 2);  // all six one way round: 2 draws of 64
  EXPECT_FALSE(verdict_on(alike, 1).by_chance);
  EXPECT_THAT(text_of(of_common), testing::HasSubstr("drawn for each clip"));
}

TEST_F(Judge, RefusesWhatIsNoComparison) {
  const fs::path a = clip("a", 1, measure(1, 1)), b = clip("b", 1, measure(1, 1));
  EXPECT_THROW(verdict_on({a, b}, 1), Error);
  EXPECT_THROW(verdict_on({a, b, root_}, 1), Error);
  const fs::path c = clip("c", 1, "3");
  EXPECT_THROW(verdict_on({a, b, c}, 1), Error);
}

}  // namespace
}  // namespace airtruth::judge
