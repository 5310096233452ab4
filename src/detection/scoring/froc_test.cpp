// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/froc.h"

#include <limits>

#include <gtest/gtest.h>

#include "detection/scoring/bearing_error.h"
#include "detection/scoring/breakdown.h"

namespace airtruth::detection {
namespace {

// The example of froc.h.
FrocSequence example() {
  FrocSequence sequence;
  sequence.images = 10;
  sequence.duration_s = 1;
  sequence.best_scores.assign(6, 9.0);
  sequence.best_scores.resize(10);
  sequence.false_alarm_scores = {5};
  return sequence;
}

TEST(Froc, TheExampleOfTheHeader) {
  const std::vector<FrocSequence> sequences = {example()};
  const Froc froc = froc_of(sequences);
  ASSERT_EQ(froc.points.size(), 2u);
  EXPECT_EQ(froc.points[0].score, 9);
  EXPECT_NEAR(froc.points[0].detection.value, 0.6, 1e-9);
  EXPECT_EQ(froc.points[0].false_alarms_per_image, 0);
  EXPECT_NEAR(froc.points[1].detection.value, 0.6, 1e-9);
  EXPECT_NEAR(froc.points[1].false_alarms_per_image, 0.1, 1e-9);
  EXPECT_NEAR(froc.points[1].false_alarms_per_hour, 3600, 1e-9);
  EXPECT_NEAR(froc.points[1].false_alarms_per_flight, 1, 1e-9);
  EXPECT_EQ(froc.aircraft, 10);
  EXPECT_EQ(froc.images, 10);
}

TEST(Froc, TheScoreOfARate) {
  const std::vector<FrocSequence> sequences = {example()};
  EXPECT_EQ(score_at_false_alarms(sequences, 0), 9);
  EXPECT_EQ(score_at_false_alarms(sequences, 0.09), 9);
  EXPECT_EQ(score_at_false_alarms(sequences, 0.1), 5);
  FrocSequence alarm_first;
  alarm_first.images = 1;
  alarm_first.false_alarm_scores = {7};
  EXPECT_FALSE(score_at_false_alarms(std::vector<FrocSequence>{alarm_first}, 0.5));
  EXPECT_FALSE(score_at_false_alarms({}, 0.5));
  EXPECT_NEAR(froc_at(sequences, 5).false_alarms_per_image, 0.1, 1e-12);
}

TEST(Froc, LongCurvesAreThinnedAndKeepTheirEnds) {
  FrocSequence sequence;
  sequence.images = 1000;
  sequence.duration_s = 100;
  for (int i = 0; i < 50'000; ++i) sequence.false_alarm_scores.push_back(i);
  for (int i = 0; i < 1000; ++i) sequence.best_scores.push_back(i * 50 + 0.5);
  const Froc froc = froc_of(std::vector<FrocSequence>{sequence}, 200);
  EXPECT_LE(froc.points.size(), 202u);
  EXPECT_GE(froc.points.size(), 90u);
  EXPECT_EQ(froc.points.front().score, 49950.5 > 49999 ? 49950.5 : 49999);
  EXPECT_EQ(froc.points.back().score, 0);
  EXPECT_EQ(froc.points.back().false_alarms_per_image, 50);
  EXPECT_EQ(froc.points.back().detection.value, 1);
}

TEST(Breakdown, BinsHoldTheirLowerEdge) {
  const std::vector<AircraftInFrame> sightings = {
      {0, 0, 0, true}, {0, 1, 0, false}, {1, 0, 0, true}, {1, 1, 0, true}, {1, 2, 0, false}};
  const std::vector<std::optional<double>> values = {100, 199.9, 200, 5000, std::nullopt};
  const std::vector<double> edges = {100, 200, 300};
  const auto bins = detection_by(sightings, values, edges, 2);
  ASSERT_EQ(bins.size(), 3u);
  EXPECT_EQ(bins[0].from, 100);
  EXPECT_EQ(bins[0].to, 200);
  EXPECT_EQ(bins[0].detection.value, 0.5);
  EXPECT_EQ(bins[0].detection.trials, 2);
  EXPECT_EQ(bins[1].detection.value, 1);
  EXPECT_EQ(bins[2].from, 300);
  EXPECT_EQ(bins[2].to, std::numeric_limits<double>::infinity());
  const std::vector<std::optional<std::string>> names = {
      "above", "above", "below", std::nullopt, "below"};
  const auto by_name = detection_by_name(sightings, names, 2);
  ASSERT_EQ(by_name.size(), 2u);
  EXPECT_EQ(by_name[0].name, "above");
  EXPECT_EQ(by_name[0].detection.value, 0.5);
  EXPECT_EQ(by_name[1].detection.value, 0.5);
}

TEST(BearingError, MeansDeviationsAndRates) {
  // Errors of 1, 3 and 2 mrad at 0, 1 and 2 s: rates of 2 and -1 mrad/s. The sample of the other
  // sequence has none to compare with.
  const std::vector<BearingSample> samples = {
      {0, 1, 0, 1, 0}, {0, 1, 1, 3, 0}, {0, 1, 2, 2, 0}, {1, 1, 1, 2, 4}};
  const auto error = bearing_error(samples);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->azimuth.mean, 2, 1e-12);
  EXPECT_NEAR(error->azimuth.deviation, std::sqrt(2.0 / 3), 1e-12);
  EXPECT_NEAR(error->azimuth.rms, std::sqrt(18.0 / 4), 1e-12);
  EXPECT_EQ(error->elevation.count, 4);
  EXPECT_NEAR(error->elevation.mean, 1, 1e-12);
  // Sorted 0 0 0 4: at 2.85 between the last two.
  EXPECT_NEAR(error->elevation.within_95, 0.85 * 4, 1e-12);
  ASSERT_TRUE(error->azimuth_rate);
  EXPECT_EQ(error->azimuth_rate->count, 2);
  EXPECT_NEAR(error->azimuth_rate->mean, 0.5, 1e-12);
  EXPECT_NEAR(error->azimuth_rate->deviation, std::sqrt(4.5), 1e-12);
  EXPECT_FALSE(bearing_error({}));
}

TEST(BearingError, ARateNeedsASampleASecondBefore) {
  const std::vector<BearingSample> samples = {
      {0, 1, 0, 1, 0}, {0, 1, 0.5, 3, 0}, {0, 1, 1.25, 3, 0}};
  EXPECT_FALSE(bearing_error(samples)->azimuth_rate);
  const std::vector<BearingSample> near = {{0, 1, 0, 1, 0}, {0, 1, 1.05, 2.05, 0}};
  EXPECT_NEAR(bearing_error(near)->azimuth_rate->mean, 1, 1e-12);
}

}  // namespace
}  // namespace airtruth::detection
