// SPDX-License-Identifier: Apache-2.0
// HOTA, CLEAR and Identity on tracks whose values are known: those of TrackEval's own tests
// (tests/test_metrics.py) and cases worked by hand.
#include <cmath>

#include <airtruth/track_measures.h>
#include <gtest/gtest.h>

namespace airtruth::evaluation {
namespace {

// Boxes at different places do not overlap, and those at one place are equal.
Box place(int number) { return {100.0 * number, 0, 50, 50}; }

// A frame from (id, place) pairs.
using Pairs = std::vector<std::pair<std::int64_t, int>>;
TrackFrame frame(const Pairs& truths, const Pairs& answers) {
  TrackFrame made;
  for (const auto& [id, where] : truths) made.truths.push_back({id, place(where)});
  for (const auto& [id, where] : answers) made.answers.push_back({id, place(where)});
  return made;
}

// TrackEval's no_confusion.
TrackFrames no_confusion() {
  return {frame({{0, 0}, {1, 1}}, {{0, 1}, {1, 9}}),
          frame({{0, 0}, {1, 1}}, {{0, 1}, {1, 9}}),
          frame({{0, 0}, {1, 1}}, {{0, 8}, {1, 9}}),
          frame({{0, 0}}, {{0, 8}, {1, 0}}),
          frame({{0, 0}}, {{1, 0}})};
}

// Its with_confusion: in the third frame truth 0 overlaps answer 0, in the second truth 1 answer 1
// too.
TrackFrames with_confusion() {
  TrackFrames frames = no_confusion();
  frames[1] = frame({{0, 0}, {1, 1}}, {{0, 1}, {1, 1}});
  frames[2] = frame({{0, 0}, {1, 1}}, {{0, 0}, {1, 9}});
  return frames;
}

TrackFrames split_tracks() {
  return {frame({{0, 0}, {1, 1}}, {{0, 0}, {4, 1}}),
          frame({{0, 0}, {1, 1}}, {{0, 0}, {4, 1}}),
          frame({{1, 1}}, {{1, 1}, {3, 9}}),
          frame({{0, 0}, {1, 1}}, {{1, 1}, {3, 0}}),
          frame({{0, 0}, {1, 1}}, {{1, 9}, {2, 1}, {3, 0}})};
}

void expect_clear(const TrackFrames& frames, int tp, int fn, int fp, int switches) {
  const ClearMot clear = clear_mot_of(frames);
  EXPECT_EQ(clear.true_positives, tp);
  EXPECT_EQ(clear.false_negatives, fn);
  EXPECT_EQ(clear.false_positives, fp);
  EXPECT_EQ(clear.identity_switches, switches);
  EXPECT_NEAR(clear.mota(), static_cast<double>(tp - fp - switches) / (tp + fn), 1e-9);
}

TEST(Tracks, ClearOnTheToolkitsOwnCases) {
  expect_clear(no_confusion(), 4, 4, 5, 0);
  expect_clear(with_confusion(), 5, 3, 4, 1);
  expect_clear(split_tracks(), 9, 0, 2, 3);
}

TEST(Tracks, IdentityOnTheToolkitsOwnCases) {
  EXPECT_NEAR(identity_of(no_confusion()).idf1(), 8.0 / 17, 1e-9);
  EXPECT_NEAR(identity_of(no_confusion()).recall(), 4.0 / 8, 1e-9);
  EXPECT_NEAR(identity_of(no_confusion()).precision(), 4.0 / 9, 1e-9);
  EXPECT_NEAR(identity_of(with_confusion()).idf1(), 8.0 / 17, 1e-9);
  const Identity split = identity_of(split_tracks());
  EXPECT_EQ(split.true_positives, 4);
  EXPECT_EQ(split.false_negatives, 5);
  EXPECT_EQ(split.false_positives, 7);
  EXPECT_NEAR(split.idf1(), 8.0 / 20, 1e-9);
}

// The example of hota.h.
TEST(Tracks, HotaOfATrackThatIsCutOnce) {
  const TrackFrames frames = {frame({{1, 0}}, {{7, 0}}),
                              frame({{1, 0}}, {{7, 0}}),
                              frame({{1, 0}}, {{7, 0}}),
                              frame({{1, 0}}, {{8, 0}})};
  const Hota hota = hota_of(frames);
  EXPECT_NEAR(Hota::mean(hota.det_a), 1, 1e-9);
  EXPECT_NEAR(Hota::mean(hota.ass_a), 0.625, 1e-9);
  EXPECT_NEAR(Hota::mean(hota.hota), std::sqrt(0.625), 1e-9);
  EXPECT_NEAR(Hota::mean(hota.loc_a), 1, 1e-9);
  const ClearMot clear = clear_mot_of(frames);
  EXPECT_EQ(clear.identity_switches, 1);
  EXPECT_EQ(clear.mostly_tracked, 1);
  EXPECT_EQ(clear.fragmentations, 0);
}

// Overlap 0.6 (15 of 25) passes 12 of the 19 thresholds.
TEST(Tracks, HotaCountsThresholds) {
  TrackFrames frames(1);
  frames[0].truths = {{1, {0, 0, 20, 10}}};
  frames[0].answers = {{1, {5, 0, 20, 10}}};
  const Hota hota = hota_of(frames);
  EXPECT_NEAR(Hota::mean(hota.hota), 12.0 / 19, 1e-9);
  EXPECT_NEAR(hota.loc_a[0], 0.6, 1e-9);
  EXPECT_NEAR(hota.loc_a[18], 1, 1e-9);
  EXPECT_NEAR(clear_mot_of(frames).motp(), 0.6, 1e-9);
}

TEST(Tracks, NothingToFindAndNothingFound) {
  const TrackFrames only_truth = {frame({{1, 0}}, {})};
  const TrackFrames only_answers = {frame({}, {{1, 0}})};
  EXPECT_EQ(Hota::mean(hota_of(only_truth).hota), 0);
  EXPECT_EQ(hota_of(only_truth).false_negatives[0], 1);
  EXPECT_EQ(hota_of(only_answers).false_positives[0], 1);
  EXPECT_EQ(clear_mot_of(only_truth).mostly_lost, 1);
  EXPECT_EQ(identity_of(only_answers).false_positives, 1);
  EXPECT_EQ(identity_of({}).idf1(), 0);
}

TEST(Tracks, SequencesAreAdded) {
  const std::vector<Hota> hotas = {hota_of({frame({{1, 0}}, {{1, 0}})}),
                                   hota_of({frame({{1, 0}}, {})})};
  const Hota both = combined(hotas);
  // DetA 1/2, AssA 1.
  EXPECT_NEAR(both.hota[0], std::sqrt(0.5), 1e-9);
  const std::vector<ClearMot> clears = {clear_mot_of(no_confusion()), clear_mot_of(split_tracks())};
  EXPECT_EQ(combined(clears).true_positives, 13);
  EXPECT_NEAR(combined(clears).mota(), (13 - 7 - 3) / 17.0, 1e-9);
  const std::vector<Identity> identities = {identity_of(no_confusion()),
                                            identity_of(split_tracks())};
  EXPECT_NEAR(combined(identities).idf1(), 8 / (8 + 0.5 * 12 + 0.5 * 9), 1e-9);
}

}  // namespace
}  // namespace airtruth::evaluation
