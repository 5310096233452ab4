// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "evaluation/matching/boxes.h"

namespace airtruth::evaluation {
namespace {

TEST(Overlap, ClosedForms) {
  EXPECT_EQ(overlap({0, 0, 10, 10}, {0, 0, 10, 10}), 1);
  EXPECT_EQ(overlap({0, 0, 10, 10}, {10, 0, 10, 10}), 0);
  EXPECT_DOUBLE_EQ(overlap({0, 0, 10, 10}, {5, 0, 10, 10}), 50.0 / 150);
  EXPECT_DOUBLE_EQ(overlap({0, 0, 10, 10}, {2, 2, 5, 5}), 0.25);
  EXPECT_EQ(overlap({0, 0, 0, 0}, {0, 0, 0, 0}), 0);
}

// The overlap of each of these boxes with itself is 1 + 1e-15 in double precision. The GOT-10k
// toolkit (0.1.3, rect_iou) bounds it to 1.
const std::vector<Box> kRoundingBoxes = {{307.581, 570.328, 8.735, 56.924},
                                         {187.787, 254.573, 49.679, 24.611},
                                         {330.207, 17.508, 45.235, 32.335},
                                         {81.291, 242.465, 12.287, 15.813}};

TEST(Overlap, IsNeverAboveOne) {
  for (const Box& box : kRoundingBoxes) {
    EXPECT_EQ(overlap(box, box), 1);
    EXPECT_LE(overlap(box, {box.x, box.y, std::nextafter(box.width, 0), box.height}), 1);
    EXPECT_LE(overlap({std::nextafter(box.x, 0), box.y, box.width, box.height}, box), 1);
  }
}

TEST(Overlap, AsTheGot10kToolkitHasIt) {
  EXPECT_NEAR(overlap({100, 100, 20, 10}, {103, 104, 20, 10}), 0.3422818791946309, 1e-12);
  EXPECT_NEAR(overlap({103.5, 98.25, 18, 12.5}, {100, 100, 20, 10}), 0.6346153846153846, 1e-12);
  EXPECT_NEAR(overlap({0.1, 0.2, 0.3, 0.4}, {0.1, 0.2, 0.3, 0.4}), 0.9999999999999989, 1e-12);
}

// Overlaps of the second frame as rect_iou gives them with a bound of (480, 360), for boxes over
// the left and the right edge.
TEST(Score, BoundsBoxesAsTheGot10kToolkit) {
  const Box left{-6, 100, 20, 10}, left_answer{-3, 101, 22, 9};
  const Box right{470, 340, 20, 30}, right_answer{468, 338, 20, 30};
  for (const auto& [truth, answer, expected] :
       {std::tuple(left, left_answer, 0.8256880733944955),
        std::tuple(right, right_answer, 0.7402597402597403)}) {
    const Score s = score(std::vector<FramePair>{{truth, truth, 0}, {truth, answer, 0}}, 480, 360);
    EXPECT_NEAR(s.average_overlap.value(), expected, 1e-12);
  }
}

// No overlap exceeds the threshold of 1, so exact answers reach 20 of the 21 thresholds.
TEST(Score, ExactAnswersGainNothingByRounding) {
  std::vector<FramePair> frames;
  for (const Box& box : kRoundingBoxes) frames.push_back({box, box, 0});
  for (const auto& [width, height] : {std::pair(0, 0), std::pair(1280, 960)}) {
    const Score s = score(frames, width, height);
    EXPECT_EQ(s.success[20], 0);
    EXPECT_DOUBLE_EQ(s.auc.value(), 20.0 / 21);
    EXPECT_EQ(s.average_overlap, 1);
  }
}

// Perfect answers: the strict "more than" excludes the last of the 21 thresholds.
// NaN stands for "no box" in files of results.
TEST(Score, OfABoxOfNaNIsThatOfNoBox) {
  const double nan = std::nan("");
  const Box truth{0, 0, 9, 9};
  const auto alike = [](const Score& score) {
    return std::tuple(score.auc, score.average_overlap, score.centre_mean_px, score.precision);
  };
  const auto scored = [&](const std::optional<Box>& answer) {
    const std::vector<FramePair> frames(12, {truth, answer, 0});
    EXPECT_EQ(first_loss(frames), 1u);
    return alike(score(frames, 640, 480));
  };
  for (const Box& none : {Box{nan, nan, nan, nan}, Box{nan, 0, 9, 9}, Box{0, 0, 9, nan}}) {
    EXPECT_EQ(overlap(truth, none), 0);
    EXPECT_EQ(overlap(none, truth), 0);
    EXPECT_EQ(scored(none), scored(std::nullopt));
    EXPECT_EQ(alike(score(std::vector<FramePair>{{none, truth, 0}}, 640, 480)), alike(Score{}));
  }
}

TEST(Score, PerfectTracking) {
  const Box box{10, 20, 30, 40};
  const Score s = score(std::vector<FramePair>(5, {box, box, 0.01}), 640, 480);
  EXPECT_DOUBLE_EQ(s.auc.value(), 20.0 / 21);
  EXPECT_EQ(s.precision[0], 1);
  EXPECT_EQ(s.average_overlap, 1);
  EXPECT_EQ(s.success_75, 1);
  EXPECT_EQ(s.centre_mean_px, 0);
  EXPECT_DOUBLE_EQ(s.frames_per_second.value(), 100);
}

TEST(Score, ByHand) {
  const Box truth{100, 100, 20, 10};
  // The first frame counts as perfect for OTB and not at all for the other measures. The next
  // answers are 3 px right and 4 px down, without a target, and missing.
  const std::vector<FramePair> frames = {{truth, Box{0, 0, 1, 1}, 0},
                                         {truth, Box{103, 104, 20, 10}, 0.5},
                                         {std::nullopt, truth, 0.25},
                                         {truth, std::nullopt, 0.25}};
  const Score s = score(frames, 0, 0);
  EXPECT_EQ(s.frames, 4);
  EXPECT_EQ(s.counted, 3);
  const double shared = 17.0 * 6 / (400 - 17 * 6);
  EXPECT_DOUBLE_EQ(s.average_overlap.value(), shared / 2);
  EXPECT_DOUBLE_EQ(s.precision[4], 1.0 / 3);
  EXPECT_DOUBLE_EQ(s.precision[5], 2.0 / 3);
  EXPECT_DOUBLE_EQ(s.precision_20px.value(), 2.0 / 3);
  // The frame without an answer has no centre error.
  EXPECT_DOUBLE_EQ(s.x_mean_px.value(), 3);
  EXPECT_DOUBLE_EQ(s.y_most_px.value(), 4);
  EXPECT_DOUBLE_EQ(s.centre_mean_px.value(), 5);
  EXPECT_DOUBLE_EQ(s.frames_per_second.value(), (2 + 4 + 4) / 3.0);
  // An overlap of 0.427 exceeds 9 of the thresholds (0 to 0.4). Each frame has a weight of a third,
  // and the first one reaches 20 thresholds.
  EXPECT_GT(shared, 0.34);
  EXPECT_LT(shared, 0.35);
  EXPECT_DOUBLE_EQ(s.auc.value(), (20 + 7) / 3.0 / 21);
}

// The rates after the first frame are 2, 4 and 16 frames/s. The first frame's time is the start-up,
// and 0 means no time.
TEST(Score, MedianAndMeanOfTheRates) {
  const Box box{0, 0, 10, 10};
  std::vector<FramePair> frames;
  for (const double seconds : {9.0, 0.5, 0.0, 0.25, 0.0625}) frames.push_back({box, box, seconds});
  EXPECT_DOUBLE_EQ(score(frames, 0, 0).frames_per_second.value(), 22.0 / 3);
  EXPECT_DOUBLE_EQ(score(frames, 0, 0).frames_per_second_median.value(), 4);
  frames.push_back({box, box, 1e-6});
  EXPECT_DOUBLE_EQ(score(frames, 0, 0).frames_per_second_median.value(), 10);
  const std::vector<Score> scores = {score(frames, 0, 0), score({frames.data(), 1}, 0, 0)};
  EXPECT_EQ(scores[1].frames_per_second_median, std::nullopt);
  EXPECT_DOUBLE_EQ(mean_of(scores).frames_per_second_median.value(), 10);
}

TEST(Score, WhatNothingDefinesIsEmpty) {
  const Box box{10, 20, 30, 40};
  // The one frame of a sequence counts for OTB's curves alone.
  const Score one = score(std::vector<FramePair>{{box, box, 0.1}}, 0, 0);
  EXPECT_DOUBLE_EQ(one.auc.value(), 20.0 / 21);
  EXPECT_EQ(one.average_overlap, std::nullopt);
  EXPECT_EQ(one.success_50, std::nullopt);
  EXPECT_EQ(one.centre_mean_px, std::nullopt);
  EXPECT_EQ(one.frames_per_second, std::nullopt);
  const Score lost = score(std::vector<FramePair>{{box, box, 0}, {box, std::nullopt, 0}}, 0, 0);
  EXPECT_EQ(lost.average_overlap, 0);
  EXPECT_EQ(lost.centre_mean_px, std::nullopt);
  EXPECT_EQ(score({}, 0, 0).auc, std::nullopt);
  EXPECT_EQ(mean_of({}).auc, std::nullopt);
  // Means are over the sequences that have the measure.
  const Score perfect = score(std::vector<FramePair>(3, {box, box, 0}), 0, 0);
  const Score mean = mean_of(std::vector<Score>{one, lost, perfect});
  EXPECT_DOUBLE_EQ(mean.average_overlap.value(), 2.0 / 3);
  EXPECT_EQ(mean.centre_mean_px, 0);
}

TEST(Mean, WeighsSequencesForOtbAndFramesForGot) {
  const Box truth{0, 0, 10, 10};
  const std::vector<FramePair> good(3, {truth, truth, 0});
  std::vector<FramePair> bad(11, {truth, Box{100, 100, 10, 10}, 0});
  const std::vector<Score> scores = {score(good, 0, 0), score(bad, 0, 0)};
  const Score mean = mean_of(scores);
  EXPECT_DOUBLE_EQ(mean.auc.value(), (20.0 / 21 + 20.0 / 21 / 11) / 2);
  EXPECT_DOUBLE_EQ(mean.average_overlap.value(), 2.0 / 12);
  EXPECT_EQ(mean.counted, 14);
  // A mean has the weight of its 12 frames.
  EXPECT_DOUBLE_EQ(mean_of(std::vector<Score>{mean, scores[0]}).average_overlap.value(), 4.0 / 14);
}

// Four frames of an overlap of a third after a first frame without the target, and ten of 1.
TEST(Mean, WeighsAllFramesOfASequenceWhoseFirstHasNoTarget) {
  const Box truth{0, 0, 10, 10};
  std::vector<FramePair> late(5, {truth, Box{5, 0, 10, 10}, 0});
  late.front().truth.reset();
  const std::vector<FramePair> exact(11, {truth, truth, 0});
  const std::vector<Score> scores = {score(late, 0, 0), score(exact, 0, 0)};
  EXPECT_DOUBLE_EQ(mean_of(scores).average_overlap.value(), (4.0 / 3 + 10) / 14);
  const FramePair one{truth, Box{5, 0, 10, 10}, 0};
  const Score short_one = score(std::vector<FramePair>{{std::nullopt, truth, 0}, one}, 0, 0);
  EXPECT_DOUBLE_EQ(mean_of({&short_one, 1}).average_overlap.value(), 1.0 / 3);
}

}  // namespace
}  // namespace airtruth::evaluation
