// SPDX-License-Identifier: Apache-2.0
// Values worked by hand; tests/detection_measures_test.py compares random sets with COCO's rules
// written down once more, and with the public toolkit where it is at hand.
#include <airtruth/average_precision.h>
#include <gtest/gtest.h>

namespace airtruth::evaluation {
namespace {

const Box kFirst{10, 10, 20, 10};
const Box kSecond{100, 50, 20, 10};
const Box kNowhere{300, 300, 20, 10};

double ap_of(const ScoredImage& image, PrecisionOptions options = {}) {
  const auto curve = precision_curve({&image, 1}, options);
  return curve ? curve->average_precision : -1;
}

TEST(AveragePrecision, TheExampleOfTheHeader) {
  const ScoredImage image{{{kFirst}, {kSecond}}, {{kFirst, 0.9}, {kNowhere, 0.8}, {kSecond, 0.7}}};
  EXPECT_NEAR(ap_of(image), (51 + 50 * 2.0 / 3) / 101, 1e-9);
}

TEST(AveragePrecision, IsNotDefinedWithoutATruth) {
  EXPECT_NEAR(ap_of({{}, {{kFirst, 1}}}), -1, 1e-9);
  EXPECT_NEAR(ap_of({{{kFirst, true}}, {{kFirst, 1}}}), -1, 1e-9);
  EXPECT_NEAR(ap_of({{{kFirst}}, {}}), 0, 1e-9);
}

TEST(AveragePrecision, TheSecondDetectionOfOneTruthIsFalse) {
  // Precision 1/2 from the true positive on.
  EXPECT_NEAR(ap_of({{{kFirst}}, {{kFirst, 0.9}, {kFirst, 0.8}}}), 1, 1e-9);
  EXPECT_NEAR(ap_of({{{kFirst}, {kSecond}}, {{kFirst, 0.9}, {kFirst, 0.8}, {kSecond, 0.7}}}),
              (51 + 50 * 2.0 / 3) / 101,
              1e-9);
}

TEST(AveragePrecision, AnExactOverlapOfTheThresholdIsEnough) {
  // 20 x 10 against 10 x 10 of it: overlap 0.5.
  const ScoredImage half{{{kFirst}}, {{{10, 10, 10, 10}, 1}}};
  EXPECT_NEAR(ap_of(half), 1, 1e-9);
  EXPECT_NEAR(ap_of(half, {Likeness::kOverlap, 0.51}), 0, 1e-9);
}

TEST(AveragePrecision, CrowdsTakeAnyNumberAndCountNeitherWay) {
  const LabelledBox crowd{{0, 0, 100, 100}, true};
  // Two detections lie in the crowd: they are ignored. The third is false.
  const ScoredImage image{
      {crowd, {kSecond}},
      {{{5, 5, 10, 10}, 0.9}, {{50, 5, 10, 10}, 0.8}, {kNowhere, 0.7}, {kSecond, 0.6}}};
  EXPECT_NEAR(ap_of(image), 0.5, 1e-9);
}

// As cocoeval.py's eval["scores"]: numpy.searchsorted of a recall of 0 is the first detection.
TEST(AveragePrecision, TheFirstDetectionReachesARecallOf0) {
  ScoredImage image{{{kFirst}}, {{kNowhere, 0.9}, {kFirst, 0.5}}};
  const auto curve = precision_curve({&image, 1}, {}).value();
  EXPECT_EQ(curve.score[0], 0.9);
  EXPECT_EQ(curve.score[1], 0.5);
  EXPECT_EQ(curve.precision[0], curve.precision[1]);
  image.detections.pop_back();
  EXPECT_EQ(precision_curve({&image, 1}, {})->score[0], 0.9);
  image.detections.clear();
  EXPECT_EQ(precision_curve({&image, 1}, {})->score[0], 0);
}

TEST(AveragePrecision, EqualScoresGoByTheNumbersOfTheImages) {
  std::vector<ScoredImage> images = {{{{kFirst}}, {{kFirst, 0.5}}}, {{}, {{kNowhere, 0.5}}}};
  const auto ap = [&] { return precision_curve(images, {})->average_precision; };
  EXPECT_NEAR(ap(), 1, 1e-9);
  images[0].image_id = 2;
  EXPECT_NEAR(ap(), 1, 1e-9);
  images[1].image_id = 1;
  EXPECT_NEAR(ap(), 0.5, 1e-9);
  // Of several sequences together.
  const std::vector<std::vector<ScoredImage>> apart = {{images[0]}, {images[1]}};
  EXPECT_NEAR(average_precision(apart, 10).ap_50.value(), 0.5, 1e-9);
}

TEST(AveragePrecision, AreasSelectTruthsAndUnmatchedDetections) {
  // A truth of 40 x 40 is medium. Of small ones there is none; a small false detection does not
  // count for medium.
  const Box medium{0, 0, 40, 40};
  const ScoredImage image{{{medium}}, {{kNowhere, 0.9}, {medium, 0.5}}};
  EXPECT_NEAR(ap_of(image, {Likeness::kOverlap, 0.5, kSmall}), -1, 1e-9);
  EXPECT_NEAR(ap_of(image, {Likeness::kOverlap, 0.5, kMedium}), 1, 1e-9);
  EXPECT_NEAR(ap_of(image), 0.5, 1e-9);
}

TEST(AveragePrecision, TheAreaOfATruthIsThatOfItsPixelsWhereTheyAreKnown) {
  // The box of 40 x 40 is medium, its 900 pixels are small.
  const Box medium{0, 0, 40, 40};
  const ScoredImage image{{{medium, false, false, 900}}, {{medium, 0.5}}};
  EXPECT_NEAR(ap_of(image, {Likeness::kOverlap, 0.5, kSmall}), 1, 1e-9);
  EXPECT_NEAR(ap_of(image, {Likeness::kOverlap, 0.5, kMedium}), -1, 1e-9);
}

TEST(AveragePrecision, OnlyTheBestDetectionsAreTaken) {
  const ScoredImage image{{{kFirst}}, {{kNowhere, 0.9}, {kFirst, 0.8}}};
  EXPECT_NEAR(ap_of(image, {Likeness::kOverlap, 0.5, kAllAreas, 1}), 0, 1e-9);
  EXPECT_NEAR(ap_of(image, {Likeness::kOverlap, 0.5, kAllAreas, 2}), 0.5, 1e-9);
}

TEST(AveragePrecision, ByCentreASmallAircraftIsFoundBesideItsBox) {
  const ScoredImage image{{{{100, 100, 6, 3}}}, {{{108, 100, 6, 3}, 1}}};
  EXPECT_NEAR(ap_of(image), 0, 1e-9);
  EXPECT_NEAR(ap_of(image, {Likeness::kCentre, 10}), 1, 1e-9);
  EXPECT_NEAR(ap_of(image, {Likeness::kCentre, 7.9}), 0, 1e-9);
}

TEST(AveragePrecision, MeansOverOverlapsAndSequences) {
  // An overlap of 0.75 passes .50, .55, .60, .65, .70 and .75: 6 of 10.
  const std::vector<std::vector<ScoredImage>> sequences = {
      {{{{{0, 0, 40, 10}}}, {{{0, 0, 30, 10}, 1}}}}, {{{{{0, 0, 40, 10}}}, {{{0, 0, 30, 10}, 1}}}}};
  const AveragePrecision result = average_precision(sequences, 10);
  EXPECT_NEAR(*result.ap, 0.6, 1e-9);
  EXPECT_NEAR(*result.ap_50, 1, 1e-9);
  EXPECT_NEAR(*result.ap_75, 1, 1e-9);
  EXPECT_NEAR(*result.ap_small, 0.6, 1e-9);
  EXPECT_FALSE(result.ap_large);
  EXPECT_NEAR(*result.ar_1, 0.6, 1e-9);
  EXPECT_NEAR(*result.ap_centre, 1, 1e-9);
  EXPECT_NEAR(result.ap_50_interval->low, 1, 1e-9);
}

TEST(AveragePrecision, TheIntervalIsThatOfTheSequences) {
  // One of two sequences is found: a draw has both (AP 0.5..), one twice (1) or the other twice
  // (0), so the 95 % interval is from 0 to 1.
  const std::vector<std::vector<ScoredImage>> sequences = {{{{{kFirst}}, {{kFirst, 1}}}},
                                                           {{{{kFirst}}, {}}}};
  const AveragePrecision result = average_precision(sequences, 10);
  EXPECT_NEAR(*result.ap_50, 51.0 / 101, 1e-9);
  EXPECT_EQ(result.ap_50_interval->low, 0);
  EXPECT_EQ(result.ap_50_interval->high, 1);
  EXPECT_EQ(result.band_50->low[0], 0);
  EXPECT_EQ(result.band_50->high[100], 1);
}

}  // namespace
}  // namespace airtruth::evaluation
