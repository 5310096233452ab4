// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <tuple>

#include <airtruth/error.h>
#include <airtruth/metrics.h>
#include <airtruth/vot.h>
#include <gtest/gtest.h>

namespace airtruth::evaluation {
namespace {

const Box kTruth{100, 100, 20, 10};
// Its columns with kTruth: 10 are shared, of 30.
const Box kHalf{110, 100, 20, 10};

Trajectory run_of(const std::string& marks) {
  // b: begun, f: failed, -: unknown, h: an overlap of a third, x: exact, n: no box.
  Trajectory run;
  for (const char c : marks) {
    VotFrame frame;
    frame.mark = c == 'b'   ? Mark::kBegun
                 : c == 'f' ? Mark::kFailed
                 : c == '-' ? Mark::kUnknown
                            : Mark::kAnswer;
    if (c == 'h') frame.box = kHalf;
    if (c == 'x') frame.box = kTruth;
    run.push_back(frame);
  }
  return run;
}

VotTruth still(std::size_t frames) {
  return {std::vector<std::optional<Box>>(frames, kTruth), 640, 480};
}

TEST(PixelOverlap, CountsWholePixelsAsTheToolkitDoes) {
  EXPECT_EQ(pixel_overlap({0, 0, 10, 10}, {0, 0, 10, 10}, 0, 0), 1);
  EXPECT_DOUBLE_EQ(pixel_overlap(kTruth, kHalf, 640, 480), 1.0 / 3);
  EXPECT_EQ(pixel_overlap({0.4, 0.4, 10, 10}, {0, 0, 10, 10}, 0, 0), 1);
  EXPECT_DOUBLE_EQ(pixel_overlap({0.6, 0, 10, 10}, {0, 0, 10, 10}, 0, 0), 90.0 / 110);
  // Halves are rounded to even: 0.5 becomes 0, and 1.5 becomes 2.
  EXPECT_EQ(pixel_overlap({0.5, 0, 10, 10}, {0, 0, 10, 10}, 0, 0), 1);
  EXPECT_DOUBLE_EQ(pixel_overlap({1.5, 0, 10, 10}, {0, 0, 10, 10}, 0, 0), 80.0 / 120);
  // The picture's edge clips the boxes: 5 columns of each remain.
  EXPECT_EQ(pixel_overlap({-5, 0, 10, 10}, {-5, 0, 10, 20}, 640, 10), 1);
  EXPECT_EQ(pixel_overlap({700, 0, 10, 10}, {700, 0, 10, 10}, 640, 480), 0);
}

// NaN stands for "no box" in files of results.
TEST(PixelOverlap, OfABoxOfNaNIsThatOfNoBox) {
  const double nan = std::nan("");
  const VotFrame answer{Mark::kAnswer, kTruth};
  for (const Box& none : {Box{nan, nan, nan, nan}, Box{nan, 100, 20, 5}}) {
    EXPECT_EQ(pixel_overlap(kTruth, none, 640, 480), 0);
    EXPECT_EQ(pixel_overlap(none, kTruth, 0, 0), 0);
    EXPECT_EQ(frame_overlap({Mark::kAnswer, none}, kTruth, 640, 480), 0);
    EXPECT_EQ(frame_overlap({Mark::kAnswer, none}, std::nullopt, 640, 480), 1);
    EXPECT_EQ(frame_overlap(answer, none, 640, 480), 0);
  }
}

TEST(Restart, ByHand) {
  // The run has 30 frames: begun, 11 answers of a third (9 of them in the burn-in), failed at 12,
  // begun again at 17, exact to the end.
  const std::string marks = "bhhhhhhhhhhhf----bxxxxxxxxxxxx";
  ASSERT_EQ(marks.size(), 30u);
  const RestartRuns runs{still(30), {run_of(marks)}};
  const Restart score = restart_score({&runs, 1}, {1, 2});
  // Two answers of a third count, and of the 12 exact ones the last three.
  EXPECT_DOUBLE_EQ(score.accuracy, (2.0 / 3 + 3) / 5);
  EXPECT_EQ(score.failures, 1);
  EXPECT_DOUBLE_EQ(score.reliability, std::exp(-1.0));
  // Both fragments are active at 1 and 2: the mean of a third and 1.
  EXPECT_DOUBLE_EQ(score.eao.value(), (1.0 / 3 + 1) / 2);
  ASSERT_EQ(score.eao_curve.size(), 13u);
  // At 12 the failed fragment is padded with 0, which gives 11 thirds over 12.
  EXPECT_DOUBLE_EQ(score.eao_curve[12], (11.0 / 3 / 12 + 1) / 2);
  EXPECT_FALSE(restart_score({&runs, 1}, {50, 60}).eao);
}

// vot-toolkit 0.8.0: compute_accuracy and compute_eao_curve give 0.375 and, over [1, 19],
// 0.9001656896 (in single precision).
TEST(Restart, WhereTheTargetIsAbsentAsTheToolkitHasIt) {
  RestartRuns runs{still(20), {run_of("bxxxxxxxxxxhh--nxxhx")}};
  for (const std::size_t absent : {13u, 16u, 17u}) runs.truth.boxes[absent].reset();
  const Restart score = restart_score({&runs, 1}, {1, 19});
  // From frame 10 on: 1 and a third twice; 13 and 14 are unknown; then no box, two answers where
  // the target is absent, a third, and 1. The mean is over eight frames.
  EXPECT_DOUBLE_EQ(score.accuracy, (1 + 1.0 / 3 + 1.0 / 3 + 0 + 0 + 0 + 1.0 / 3 + 1) / 8);
  EXPECT_NEAR(score.accuracy, 0.375, 1e-12);
  // No answer where the target is absent, as in frame 13, has an overlap of 1.
  EXPECT_DOUBLE_EQ(score.eao_curve[13], (10 + 2.0 / 3 + 1) / 13);
  EXPECT_NEAR(score.eao.value(), 0.9001656896, 1e-7);
}

TEST(FrameOverlap, OfEmptyRegionsAsTheToolkitHasIt) {
  const VotFrame answer{Mark::kAnswer, kTruth};
  const VotFrame none{Mark::kAnswer, {}};
  const VotFrame unknown{Mark::kUnknown, {}};
  for (const auto& [width, height] : {std::pair(0, 0), std::pair(640, 480)}) {
    EXPECT_EQ(frame_overlap(answer, kTruth, width, height), 1);
    EXPECT_EQ(frame_overlap(answer, std::nullopt, width, height), 0);
    EXPECT_EQ(frame_overlap(none, kTruth, width, height), 0);
    EXPECT_EQ(frame_overlap(unknown, kTruth, width, height), 0);
    EXPECT_EQ(frame_overlap(none, std::nullopt, width, height), 1);
    EXPECT_EQ(frame_overlap(unknown, std::nullopt, width, height), 1);
    EXPECT_EQ(frame_overlap({Mark::kAnswer, Box{-30, -30, 10, 10}}, std::nullopt, width, height),
              0);
  }
}

TEST(MultiStart, ByHand) {
  // The run fails at frame 5, where ten frames without an overlap begin.
  const MultiStartRuns runs{
      still(20),
      {{0, false, run_of("bxxxxnnnnnnnnnnnnnnn")}, {19, true, run_of("bhhhhhhhhhhhhhhhhhhh")}}};
  const MultiStart score = multistart_score({&runs, 1}, {4, 5});
  EXPECT_DOUBLE_EQ(score.robustness, 25.0 / 40);
  EXPECT_DOUBLE_EQ(score.accuracy, (4 + 19.0 / 3) / 25);
  EXPECT_DOUBLE_EQ(score.eao.value(), (1 + 1.0 / 3) / 2);
  // The curve ends before `high`. One point of it gives the score, and [4, 4] contains no point.
  EXPECT_EQ(score.eao_curve.size(), 5u);
  EXPECT_FALSE(multistart_score({&runs, 1}, {4, 4}).eao);
  // A failed run stays active beyond its end, with the toolkit's divisor j - 1.
  EXPECT_DOUBLE_EQ(multistart_score({&runs, 1}, {25, 26}).eao.value(), 4.0 / 24);
  // vot-toolkit 0.8.0, compute_eao_partial with high = 26.
  const MultiStart wide = multistart_score({&runs, 1}, {18, 26});
  ASSERT_EQ(wide.eao_curve.size(), 26u);
  EXPECT_NEAR(wide.eao.value(), 0.20913850007099433, 1e-12);
  EXPECT_NEAR(wide.eao_curve[19], 0.27192982456140347, 1e-12);
  EXPECT_NEAR(wide.accuracy, 0.4133333333333333, 1e-12);
}

// vot-toolkit 0.8.0: 0.625 and 0.8187074829931973.
TEST(MultiStart, AnAnchorIsInItsSequence) {
  for (const auto& [anchor, is_backward, frames] :
       {std::tuple(20, true, 21), std::tuple(-1, false, 11), std::tuple(50, false, 10)}) {
    const MultiStartRuns runs{
        still(10), {{anchor, is_backward, run_of(std::string(std::size_t(frames), 'x'))}}};
    EXPECT_THROW(multistart_score({&runs, 1}, {1, 1}), Error);
  }
}

TEST(MultiStart, WhereTheTargetIsAbsentAsTheToolkitHasIt) {
  MultiStartRuns runs{still(8), {{0, false, run_of("bxxnxhxx")}}};
  for (std::size_t i = 3; i < 6; ++i) runs.truth.boxes[i].reset();
  const MultiStart score = multistart_score({&runs, 1}, {1, 8});
  // No answer in frame 3 is correct (1), the two answers in 4 and 5 are wrong (0), and the start
  // has 0.
  EXPECT_DOUBLE_EQ(score.accuracy, 5.0 / 8);
  EXPECT_NEAR(score.eao.value(), 0.8187074829931973, 1e-12);
}

TEST(MultiStart, AFrameWithoutTargetIsNoFailure) {
  MultiStartRuns runs{still(25), {{0, false, run_of("bxxxxnnnnnnnnnnnnnnnxxxxx")}}};
  for (std::size_t i = 10; i < 12; ++i) runs.truth.boxes[i].reset();
  // The target is lost from 5 to 9, not visible at 10 and 11, and lost from 12 to 19: never for ten
  // frames in a row.
  EXPECT_EQ(multistart_score({&runs, 1}, {1, 1}).robustness, 1);
}

TEST(Vot, RunsAndStepsThatDoNotFitAreErrorsOfTheArgument) {
  const RestartRuns restarts{still(10), {run_of("bxx")}};
  EXPECT_THROW(restart_score({&restarts, 1}, {1, 1}), Error);
  const MultiStartRuns starts{still(10), {{0, false, run_of("bxx")}}};
  EXPECT_THROW(multistart_score({&starts, 1}, {1, 1}), Error);
  EXPECT_THROW(anchors_of(still(10), 0), Error);
}

TEST(Anchors, GoForwardInTheFirstHalfAndBackwardInTheSecond) {
  VotTruth truth = still(201);
  EXPECT_EQ(anchors_of(truth, 50),
            (std::vector<Anchor>{{0, false}, {50, false}, {100, false}, {150, true}, {200, true}}));
  for (std::size_t i = 45; i < 60; ++i) truth.boxes[i].reset();
  for (std::size_t i = 190; i < 201; ++i) truth.boxes[i].reset();
  EXPECT_EQ(anchors_of(truth, 50),
            (std::vector<Anchor>{{0, false}, {60, false}, {100, false}, {150, true}, {189, true}}));
  // 50 and 100 move forward to 150, where 150 would go backward.
  VotTruth hidden = still(240);
  for (std::size_t i = 40; i < 150; ++i) hidden.boxes[i].reset();
  EXPECT_EQ(anchors_of(hidden, 50), (std::vector<Anchor>{{0, false}, {150, false}, {239, true}}));
  EXPECT_EQ(anchors_of(still(1), 50), (std::vector<Anchor>{{0, false}}));
  EXPECT_TRUE(anchors_of({{std::nullopt, std::nullopt}, 0, 0}, 1).empty());
}

TEST(EaoRange, HoldsHalfAroundTheCommonLength) {
  const std::vector<std::int64_t> alike(9, 300);
  const auto [low, high] = eao_range(alike);
  EXPECT_GE(low, 299);
  EXPECT_EQ(high, 300);
  std::vector<std::int64_t> spread;
  for (int i = 0; i <= 400; ++i) spread.push_back(100 + i);
  const auto wide = eao_range(spread);
  EXPECT_NEAR(wide.second - wide.first, 200, 25);
  EXPECT_EQ(eao_range({}), std::pair(0, 0));
}

// A run of 60 frames has a curve from 0 to 59. A multi-start range [low, high] uses its points low
// to high - 1.
TEST(EaoRange, IsCutToTheCurves) {
  EXPECT_EQ(within_curves({60, 60}, 60), std::pair(58, 59));
  EXPECT_EQ(within_curves({59, 60}, 60), std::pair(58, 59));
  EXPECT_EQ(within_curves({20, 40}, 60), std::pair(20, 40));
  EXPECT_EQ(within_curves({2, 2}, 2), std::pair(1, 1));
  EXPECT_EQ(within_curves({1, 1}, 1), std::pair(1, 1));
  EXPECT_EQ(within_curves({0, 0}, 0), std::pair(0, 0));
}

TEST(FirstLoss, IsTheFirstOfTenOrOfTheLast) {
  const auto loss = [](const std::string& marks) {
    std::vector<FramePair> pairs;
    for (const VotFrame& frame : run_of(marks)) pairs.push_back({kTruth, frame.box, 0});
    return first_loss(pairs);
  };
  EXPECT_EQ(loss("xxxxnnnnnnnnnxxxx"), std::nullopt);
  EXPECT_EQ(loss("xxxxnnnnnnnnnnxxx"), 4u);
  EXPECT_EQ(loss("xxxxnnnxxxxxnnn"), 12u);
  EXPECT_EQ(loss("x"), std::nullopt);
}

}  // namespace
}  // namespace airtruth::evaluation
