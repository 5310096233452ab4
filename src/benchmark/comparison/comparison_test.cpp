// SPDX-License-Identifier: Apache-2.0
#include "benchmark/comparison/comparison.h"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "benchmark/comparison/areas.h"
#include "benchmark/comparison/background_shift.h"
#include "benchmark/comparison/measures.h"
#include "benchmark/comparison/real.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/seed.h"

namespace airtruth::comparison {
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
  const Verdict verdict = judge(clips, 1);
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
  const Verdict verdict = judge(clips, 1);
  // 48 pairs a clip: an area's standard error is 0.059, and its folded mean 0.5 + 0.8 x 0.059.
  EXPECT_LT(verdict.across.value, 0.60);
  EXPECT_LT(verdict.within.value, 0.67);  // 12 pairs a stretch: 0.5 + 0.8 x 0.118
  EXPECT_DOUBLE_EQ(verdict.gaps[0].difference.value, 0);
}

// Clips whose two aircraft differ, but not all the same way round, are told apart by chance as
// well.
TEST_F(Judge, ChanceGivesHighAreasWhereClipsDifferInWhateverWay) {
  std::vector<fs::path> alike, either, common;
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
    alike.push_back(clip(fmt::format("alike{}", name), 0, measure(1, 1)));
    either.push_back(clip(fmt::format("either{}", name), *name % 2 == 0 ? 6 : -6, measure(1, 1)));
    common.push_back(clip(fmt::format("common{}", name), 6, measure(1, 1)));
  }
  constexpr int kDraws = 6;
  const auto of_alike = judge(alike, 1, kDraws).by_chance;
  ASSERT_TRUE(of_alike);
  EXPECT_LT(of_alike->mean, 0.6);
  const Verdict of_either = judge(either, 1, kDraws), of_common = judge(common, 1, kDraws);
  EXPECT_GT(of_either.by_chance->mean, 0.7);
  EXPECT_GT(of_either.by_chance->as_high, 0);
  EXPECT_LT(of_common.by_chance->mean, of_common.across.value);
  EXPECT_LE(of_common.by_chance->as_high, 2);  // all six one way round: 2 draws of 64
  EXPECT_FALSE(judge(alike, 1).by_chance);
  EXPECT_THAT(text_of(of_common), testing::HasSubstr("drawn for each clip"));
}

TEST_F(Judge, RefusesWhatIsNoComparison) {
  const fs::path a = clip("a", 1, measure(1, 1)), b = clip("b", 1, measure(1, 1));
  EXPECT_THROW(judge({a, b}, 1), Error);
  EXPECT_THROW(judge({a, b, root_}, 1), Error);
  const fs::path c = clip("c", 1, "3");
  EXPECT_THROW(judge({a, b, c}, 1), Error);
  EXPECT_THROW(write_figure({a}, root_ / "all.png"), Error);
}

TEST(BackgroundShift, IsFoundWithoutTheAircraft) {
  Random random(5);
  cv::Mat ground(400, 500, CV_32F);
  for (int i = 0; i < ground.rows * ground.cols; ++i)
    ground.ptr<float>(0)[i] = static_cast<float>(128 + 25 * random.normal());
  const auto frame = [&](int x0, int y0, int aircraft_x) {
    image::Picture picture = image::make_picture(320, 240, {image::Chroma::kNone});
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x)
        picture.planes[0].row(y)[x] =
            std::abs(x - aircraft_x) < 20 && std::abs(y - 100) < 6
                ? std::uint8_t{10}
                : static_cast<std::uint8_t>(
                      std::clamp(double(ground.at<float>(y + y0, x + x0)), 0.0, 255.0));
    return picture;
  };
  BackgroundShift shift;
  EXPECT_FALSE(shift.add(frame(20, 20, 100), {{80, 94, 40, 12}}));
  const auto found = shift.add(frame(26, 16, 130), {{110, 94, 40, 12}});
  ASSERT_TRUE(found);  // the camera looks 6 px to the right: the ground goes 6 px to the left
  EXPECT_NEAR(found->x(), -6, 0.3);
  EXPECT_NEAR(found->y(), 4, 0.3);
  // A sky without anything in it says nothing.
  BackgroundShift blank;
  const image::Picture sky = image::make_picture(64, 64, {image::Chroma::kNone});
  std::fill_n(sky.planes[0].samples.get(), sky.planes[0].stride * 64, std::uint8_t{90});
  blank.add(sky, {});
  EXPECT_FALSE(blank.add(sky, {}));
}

TEST(Measures, MotionIsAgainstTheBackgroundAndUnsteadinessIsOffTheMiddle) {
  // The real one goes 3, 4 px a frame in a background that goes 3, 0; every third frame the
  // inserted one is 3 px off its line.
  std::vector<Compared> all(9);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].frame = static_cast<std::int64_t>(10 + i);
    all[i].background_shift_px = Pixel(3, 0);
    all[i].real.centre_px = double(i) * Pixel(3, 4);
    all[i].made.centre_px = double(i) * Pixel(3, 4) + Pixel(i % 3 == 1 ? 3 : 0, 0);
  }
  for (const Pair& pair : pairs_of(all)) {
    if (pair.name.starts_with("motion")) {
      EXPECT_DOUBLE_EQ(pair.real, 4);
    }
    if (pair.name.starts_with("unsteadiness")) {
      EXPECT_NEAR(pair.real, 0, 1e-9);
      EXPECT_NEAR(pair.made, 1.5, 1e-9);  // 3, 1.5 and 1.5 in turn
    }
    if (pair.name.starts_with("edge")) {
      EXPECT_TRUE(std::isnan(pair.real));  // none is clear
    }
  }
}

TEST(Real, SizesThatJumpAreLeftOut) {
  RealBoxes boxes;
  for (int i = 0; i < 20; ++i) boxes[i] = {0, 0, i == 9 ? 34.0 : 20.0, 8};
  const RealBoxes kept = without_jumps(boxes);
  EXPECT_EQ(kept.size(), 19u);
  EXPECT_FALSE(kept.contains(9));
}

// The clips that came with tight boxes made by others.
class Footage : public testing::Test {
 protected:
  void SetUp() override {
    const char* shared = std::getenv("AIRTRUTH_SHARED");
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
}  // namespace airtruth::comparison
