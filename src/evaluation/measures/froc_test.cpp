// SPDX-License-Identifier: Apache-2.0
#include <airtruth/froc.h>
#include <gtest/gtest.h>

namespace airtruth::evaluation {
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
  // In 100 images N false alarms are N / 100 an image, also where N / 100 * 100 is not N, as of 29.
  for (int alarms = 1; alarms <= 100; ++alarms) {
    FrocSequence many{.images = 100};
    many.false_alarm_scores.assign(static_cast<std::size_t>(alarms - 1), 0.6);
    many.false_alarm_scores.push_back(0.5);
    EXPECT_EQ(score_at_false_alarms(std::vector{many}, alarms / 100.), 0.5) << alarms;
  }
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

}  // namespace
}  // namespace airtruth::evaluation
