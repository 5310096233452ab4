// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/declaration.h"

#include <gtest/gtest.h>

#include "evaluation/scores/galleries.h"

namespace airtruth::scores {
namespace {

constexpr double kRate_hz = 10;
constexpr int kFrames = 200;
const Box kThere{100, 100, 6, 3};
const Box kElsewhere{400, 300, 6, 3};

// The encounter of declaration.h's example at 10 frames/s, here over 20 s: the range falls by 100 m
// a second from 3000 m, the closest approach is at 40 s, and the volume is violated at 33 s.
TruthSequence encounter() {
  TruthSequence truth;
  truth.name = "pass";
  truth.duration_s = kFrames / kRate_hz;
  for (int i = 0; i < kFrames; ++i) {
    TruthFrame& frame = truth.frames.emplace_back();
    frame.frame = i;
    frame.time_s = i / kRate_hz;
    TruthObject& object = frame.objects.emplace_back();
    object.id = 1;
    object.box_px = kThere;
    object.range_m = 3000 - 100 * frame.time_s;
    object.to_closest_approach_s = 40 - frame.time_s;
  }
  truth.encounters = {{1, "intruder", 40, 200, 33, true}};
  return truth;
}

results::SequenceDetections nothing() {
  results::SequenceDetections detections;
  detections.frames.resize(kFrames);
  return detections;
}

void add(results::SequenceDetections& detections,
         int from,
         int to,
         std::int64_t track,
         double score = 1) {
  for (int i = from; i < to; ++i)
    detections.frames[static_cast<std::size_t>(i)].push_back({kThere, score, "aircraft", track});
}

EncounterScore scored(const results::SequenceDetections& detections,
                      std::optional<double> manoeuvre_s = {},
                      std::optional<double> score = {},
                      const TruthSequence& truth = encounter()) {
  const ScoredDetections all{0, detections, matches_of(detections, truth, 10)};
  const auto scores = encounters_of(0, truth, all, score, manoeuvre_s);
  EXPECT_EQ(scores.size(), 1u);
  return scores.front();
}

TEST(Declaration, TheExampleOfTheHeader) {
  results::SequenceDetections detections = nothing();
  add(detections, 60, 61, 3);
  add(detections, 90, kFrames, 3);
  const EncounterScore score = scored(detections, 20);
  ASSERT_TRUE(score.declaration);
  EXPECT_EQ(score.declaration->frame, 90u);
  EXPECT_NEAR(*score.declaration->range_m, 2100, 1e-9);
  EXPECT_NEAR(*score.declaration->to_closest_approach_s, 31, 1e-9);
  EXPECT_EQ(score.in_time, InTime::kYes);
  EXPECT_EQ(scored(detections, 24.1).in_time, InTime::kNo);
  EXPECT_EQ(scored(detections, 34).in_time, InTime::kImpossible);
  EXPECT_EQ(scored(detections).in_time, InTime::kUnknown);
  EXPECT_EQ(score.frames_seen, kFrames);
  EXPECT_EQ(*score.first_seen_range_m, 3000);
  EXPECT_NEAR(*score.least_range_m, 3000 - 100 * 19.9, 1e-9);
}

TEST(Declaration, HalfOfTheNextThreeSecondsKeepsATrack) {
  results::SequenceDetections half = nothing();
  for (int i = 50; i < 80; i += 2) add(half, i, i + 1, 3);
  EXPECT_EQ(scored(half).declaration->frame, 50u);
  // 14 of 30 frames do not; from a later frame on no window has half, until the last.
  results::SequenceDetections less = nothing();
  for (int i = 50; i < 78; i += 2) add(less, i, i + 1, 3);
  EXPECT_FALSE(scored(less).declaration);
  // Two tracks that share the frames are no track.
  results::SequenceDetections shared = nothing();
  for (int i = 50; i < 80; ++i) add(shared, i, i + 1, i % 3 == 0 ? 3 : i % 3 == 1 ? 4 : 5);
  EXPECT_FALSE(scored(shared).declaration);
}

TEST(Declaration, TheEndOfTheSequenceShortensTheWindow) {
  results::SequenceDetections detections = nothing();
  add(detections, kFrames - 3, kFrames, 1);
  EXPECT_EQ(scored(detections).declaration->frame, kFrames - 3u);
}

TEST(Declaration, WithoutTimesNothingIsKnownOfIt) {
  TruthSequence truth = encounter();
  truth.has_times = false;
  results::SequenceDetections detections = nothing();
  add(detections, 0, kFrames, 1);
  const ScoredDetections all{0, detections, matches_of(detections, truth, 10)};
  EXPECT_TRUE(encounters_of(0, truth, all, {}, {}).empty());
}

TEST(Declaration, ScoresBelowTheThresholdDoNotCount) {
  results::SequenceDetections detections = nothing();
  add(detections, 10, 100, 1, 0.5);
  add(detections, 100, kFrames, 1, 0.9);
  EXPECT_EQ(scored(detections).declaration->frame, 10u);
  EXPECT_EQ(scored(detections, {}, 0.6).declaration->frame, 100u);
  EXPECT_FALSE(scored(detections, {}, 1).declaration);
}

TEST(Declaration, AnEncounterWithoutAViolationNeedsNoManoeuvre) {
  TruthSequence truth = encounter();
  truth.encounters[0].violation_s.reset();
  EXPECT_EQ(scored(nothing(), 20, {}, truth).in_time, InTime::kNoViolation);
  truth.encounters[0].violation_s = truth.frames.front().time_s;
  EXPECT_EQ(scored(nothing(), 0, {}, truth).in_time, InTime::kImpossible);
  truth.encounters[0].has_volume = false;
  EXPECT_EQ(scored(nothing(), 20, {}, truth).in_time, InTime::kUnknown);
}

TEST(Declaration, SharesAndMeansWithWeights) {
  results::SequenceDetections early = nothing();
  add(early, 0, kFrames, 1);
  results::SequenceDetections late = nothing();
  add(late, 150, kFrames, 1);
  std::vector<EncounterScore> scores;
  const std::vector<results::SequenceDetections> all = {early, late, nothing()};
  for (std::size_t i = 0; i < all.size(); ++i) {
    scores.push_back(scored(all[i], 20));
    scores.back().sequence = i;
  }
  const DeclarationSummary plain = summarised(scores, {});
  EXPECT_NEAR(plain.declared.value, 2.0 / 3, 1e-9);
  EXPECT_NEAR(plain.range_m->mean, (3000 + 1500) / 2.0, 1e-9);
  EXPECT_NEAR(plain.in_time->value, 1.0 / 3, 1e-9);
  const DeclarationSummary weighted = summarised(scores, std::vector<double>{2, 1, 1});
  EXPECT_NEAR(weighted.declared.value, 0.75, 1e-9);
  EXPECT_NEAR(weighted.range_m->mean, (2 * 3000 + 1500) / 3.0, 1e-9);
  EXPECT_NEAR(weighted.in_time->value, 0.5, 1e-9);
}

TEST(Declaration, CopiesOfAnAircraftInItsSequenceNarrowNoInterval) {
  const auto range_of_copies = [](int copies) {
    std::vector<EncounterScore> encounters;
    for (std::size_t i = 0; i < 4; ++i) {
      EncounterScore one;
      one.sequence = i;
      one.declaration = Declaration{.range_m = 100.0 * static_cast<double>(i + 1)};
      encounters.insert(encounters.end(), static_cast<std::size_t>(copies), one);
    }
    return *summarised(encounters, {}).range_m;
  };
  // Of the 256 draws of four values, one has the mean 100 and four have 125: the 2.5th percentile
  // is at 150, which ten more have.
  for (const int copies : {1, 5}) {
    const WeightedMean range = range_of_copies(copies);
    EXPECT_EQ(range.mean, 250);
    EXPECT_EQ(range.interval->low, 150);
    EXPECT_EQ(range.interval->high, 350);
    EXPECT_EQ(range.count, 4 * copies);
  }
}

TEST(Declaration, ATrackIsFalseWhereMostOfItIs) {
  const TruthSequence truth = encounter();
  results::SequenceDetections detections = nothing();
  add(detections, 0, 5, 1);
  for (std::size_t i = 5; i < 10; ++i)
    detections.frames[i].push_back({kElsewhere, 1, "aircraft", 1});
  const auto count = [&] {
    return false_tracks({0, detections, matches_of(detections, truth, 10)}, {});
  };
  EXPECT_EQ(count(), 0);  // half of it is on the aircraft
  detections.frames[10].push_back({kElsewhere, 1, "aircraft", 1});
  EXPECT_EQ(count(), 1);
}

TEST(Declaration, TheOperatingCurve) {
  const TruthSequence truth = encounter();
  results::SequenceDetections detections = nothing();
  add(detections, 100, kFrames, 1, 0.9);
  for (std::size_t i = 0; i < 30; ++i)
    detections.frames[i].push_back({kElsewhere, 0.5, "aircraft", 2});
  add(detections, 50, 100, 1, 0.4);
  const ScoredDetections all{0, detections, matches_of(detections, truth, 10)};
  const std::vector<ScoredDetections> sequences = {all};
  const std::vector<TruthSequence> truths = {truth};
  const auto curve = operating_curve(sequences, truths);
  ASSERT_EQ(curve.size(), 3u);
  EXPECT_EQ(curve[0].score, 0.9);
  EXPECT_EQ(curve[0].false_tracks_per_hour, 0);
  EXPECT_NEAR(curve[0].range_m->mean, 2000, 1e-9);
  EXPECT_NEAR(curve[1].false_tracks_per_hour, 1 / (20.0 / 3600), 1e-9);
  EXPECT_NEAR(curve[2].range_m->mean, 2500, 1e-9);
  EXPECT_NEAR(curve[2].range_all_m->mean, 2500, 1e-9);
}

TEST(Declaration, ALongOperatingCurveIsThinned) {
  const TruthSequence truth = encounter();
  results::SequenceDetections detections = nothing();
  for (int i = 0; i < kFrames; ++i) add(detections, i, i + 1, 1, 1.0 / (i + 1));
  const ScoredDetections all{0, detections, matches_of(detections, truth, 10)};
  const std::vector<ScoredDetections> sequences = {all};
  const std::vector<TruthSequence> truths = {truth};
  const auto curve = operating_curve(sequences, truths, 20);
  EXPECT_LE(curve.size(), 20u);
  EXPECT_GE(curve.size(), 12u);
  EXPECT_EQ(curve.front().score, 1);
  EXPECT_EQ(curve.back().score, 1.0 / kFrames);
}

TEST(Galleries, RunsAreListedOnce) {
  const TruthSequence truth = encounter();
  results::SequenceDetections detections = nothing();
  add(detections, 20, kFrames, 1);
  for (std::size_t i = 0; i < 12; ++i) {
    const double score = i == 4 ? 9 : 2;
    // Moves by 3 px a frame, and is away for frames 6 to 8.
    if (i < 6 || i > 8)
      detections.frames[i].push_back(
          {{400 + 3.0 * static_cast<double>(i), 300, 6, 3}, score, "aircraft", {}});
  }
  detections.frames[2].push_back({{10, 10, 6, 3}, 5, "aircraft", {}});
  const ScoredDetections all{0, detections, matches_of(detections, truth, 10)};
  const auto alarms = false_alarms_of(0, truth, all, 1);
  ASSERT_EQ(alarms.size(), 2u);
  EXPECT_EQ(alarms[0].frame, 4u);
  EXPECT_EQ(alarms[0].frames, 9);
  EXPECT_EQ(alarms[0].what, kBackground);
  EXPECT_NEAR(*alarms[0].to_aircraft_px, std::hypot(312, 200), 1e-9);
  EXPECT_EQ(alarms[1].score, 5);
  const auto misses = misses_of(0, truth, all, 1);
  ASSERT_EQ(misses.size(), 1u);
  EXPECT_EQ(misses[0].first_frame, 0u);
  EXPECT_EQ(misses[0].frames, 20);
  EXPECT_TRUE(false_alarms_of(0, truth, all, 10).empty());
  // Two sequences over one background repeat it; over others they do not.
  std::vector<FalseAlarm> twice = alarms;
  for (FalseAlarm alarm : alarms) {
    alarm.sequence = 1;
    twice.push_back(alarm);
  }
  EXPECT_EQ(strongest(twice, std::vector<std::string>{"a", "b"}).size(), 4u);
  EXPECT_EQ(strongest(twice, std::vector<std::string>{"", ""}).size(), 4u);
  const auto merged = strongest(twice, std::vector<std::string>{"a", "a"});
  ASSERT_EQ(merged.size(), 2u);
  EXPECT_EQ(merged[0].sequences, 2);
}

}  // namespace
}  // namespace airtruth::scores
