// SPDX-License-Identifier: Apache-2.0
// Values worked by hand; tests/detection_measures_test.py compares random sets with Amazon's public
// code where it is at hand.
#include <airtruth/aot.h>
#include <gtest/gtest.h>

namespace airtruth::evaluation {
namespace {

// `frames` frames that show one object, whose range falls from `from_m` by 5 m a frame.
AotFlight flight(int frames, double from_m, int above_horizon = 1) {
  AotFlight made;
  for (int i = 0; i < frames; ++i)
    made.frames.push_back({i, {{1, {100, 100, 20, 10}, from_m - 5.0 * i, above_horizon}}, {}});
  return made;
}

void find(AotFlight& flight, int from, int to, std::int64_t track, double score = 0.9) {
  for (int i = from; i < to; ++i)
    flight.frames[static_cast<std::size_t>(i)].detections.push_back(
        {{100, 100, 20, 10}, score, track});
}

AotScore score_of(const AotFlight& flight, const AotOptions& options = {{}, 0.5, 0}) {
  return aot_score({&flight, 1}, options);
}

TEST(Aot, HalfOfThirtyFramesByOneTrackDetect) {
  // 100 frames from 600 to 105 m. The track matches from frame 20 on: at frame 34 it matches 15 of
  // the latest 30, at 430 m.
  AotFlight found = flight(100, 600);
  find(found, 20, 100, 7);
  EXPECT_EQ(score_of(found).edr_all.detected, 1);
  EXPECT_EQ(score_of(found).edr_all.total, 1);
  EXPECT_EQ(score_of(found).edr_above.total, 1);
  EXPECT_EQ(score_of(found).edr_below.total, 0);
  // From frame 46 on: the 15th match is frame 60, at exactly 300 m.
  AotFlight late = flight(100, 600);
  find(late, 46, 100, 7);
  EXPECT_EQ(score_of(late).edr_all.detected, 1);
  AotFlight too_late = flight(100, 600);
  find(too_late, 47, 100, 7);
  EXPECT_EQ(score_of(too_late).edr_all.detected, 0);
  // Two tracks that take turns do not detect; frames by any track do.
  AotFlight turns = flight(100, 600);
  for (int i = 20; i < 40; ++i) find(turns, i, i + 1, i % 2);
  EXPECT_EQ(score_of(turns).edr_all.detected, 0);
  EXPECT_EQ(score_of(turns).edr_frames_all.detected, 1);
}

TEST(Aot, AnEncounterThatBeginsNearMayBeDetectedFast) {
  AotFlight near = flight(40, 290);
  find(near, 0, 40, 1);
  EXPECT_EQ(score_of(near).edr_all.detected, 1);
  AotFlight slow = flight(40, 290);
  find(slow, 16, 40, 1);
  EXPECT_EQ(score_of(slow).edr_all.detected, 0);
}

TEST(Aot, WhichEncountersAreValid) {
  EXPECT_EQ(score_of(flight(29, 400)).edr_all.total, 0);  // too short
  EXPECT_EQ(score_of(flight(30, 400)).edr_all.total, 1);
  EXPECT_EQ(score_of(flight(40, 600)).edr_all.total, 0);  // 405 m at the least
  AotFlight gap = flight(60, 400);
  for (int i = 28; i < 31; ++i) gap.frames[static_cast<std::size_t>(i)].objects.clear();
  // A step of 4 frames divides it in 28 and 29 frames.
  EXPECT_EQ(score_of(gap).edr_all.total, 0);
  AotFlight small_gap = flight(60, 400);
  for (int i = 28; i < 30; ++i) small_gap.frames[static_cast<std::size_t>(i)].objects.clear();
  EXPECT_EQ(score_of(small_gap).edr_all.total, 1);
}

TEST(Aot, RatesOfFramesAndFalseAlarms) {
  AotFlight one = flight(50, 500);
  find(one, 0, 20, 1);
  // Two false tracks, one of them in three frames.
  const Box away{300, 300, 20, 10};
  for (std::size_t i = 0; i < 3; ++i) one.frames[i].detections.push_back({away, 0.5, 2});
  one.frames[9].detections.push_back({away, 0.5, 3});
  // An overlap between 0.02 and 0.2 is neither: 2 of 20 px wide, 20 / 380.
  one.frames[30].detections.push_back({{118, 100, 20, 10}, 0.5, 4});
  const AotScore score = score_of(one);
  EXPECT_EQ(score.afdr.detected, 20);
  EXPECT_EQ(score.afdr.total, 50);
  EXPECT_NEAR(score.fppi, 4.0 / 50, 1e-9);
  EXPECT_NEAR(score.hfar, 2 / 0.5, 1e-9);
  EXPECT_NEAR(score_of(one, {0.6, 0.5, 0}).fppi, 0, 1e-9);
  EXPECT_NEAR(*score.max_range_m, 500, 1e-9);
  // Only the third frame of track 2 has a track of three frames so far.
  EXPECT_NEAR(score_of(one, {{}, 0.5, 3}).fppi, 1.0 / 50, 1e-9);
  const AotRanks ranks = aot_ranks({&one, 1}, 0.5);
  EXPECT_EQ(ranks.by_hfar->score, 0.9);
  EXPECT_EQ(ranks.by_fppi->afdr.detected, 20);
}

TEST(Aot, SmallBoxesGrowToAHundredPixels) {
  // 4 x 4 px, and a detection of the same size 5 px beside it: both grow to 10 x 10, overlap
  // 50 / 150.
  AotFlight small;
  small.frames = {{0, {{1, {100, 100, 4, 4}, 200, 1}}, {{{105, 100, 4, 4}, 1, 1}}}};
  EXPECT_EQ(score_of(small).fppi, 0);
  // 9.8 px beside: 2 / 198 is below 0.02.
  small.frames[0].detections[0].box_px.x = 109.85;
  EXPECT_EQ(score_of(small).fppi, 1);
}

TEST(Aot, BirdsAreNoFalseAlarmsHere) {
  AotFlight birds;
  birds.frames = {{0, {{1, {100, 100, 20, 10}, {}, 1}}, {{{100, 100, 20, 10}, 1, 1}}}};
  EXPECT_EQ(score_of(birds).fppi, 0);
  EXPECT_EQ(score_of(birds).afdr.total, 0);
}

TEST(Aot, WithoutADetectionOrAnObject) {
  EXPECT_EQ(score_of(flight(50, 500)).edr_all.detected, 0);
  EXPECT_EQ(score_of({}).fppi, 0);
  EXPECT_FALSE(aot_ranks({}, 0).by_hfar);
}

}  // namespace
}  // namespace airtruth::evaluation
