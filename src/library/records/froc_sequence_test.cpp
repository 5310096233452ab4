// SPDX-License-Identifier: Apache-2.0
#include <airtruth/froc.h>
#include <gtest/gtest.h>

namespace airtruth::evaluation {
namespace {

TEST(FrocSequence, HoldsTheBestScoreOfEachAircraftAndWhatFindsNothing) {
  ScoredImage image;
  image.truths.push_back({.box_px = {0, 0, 20, 10}});
  image.truths.push_back({.box_px = {100, 0, 20, 10}});
  image.truths.push_back({.box_px = {200, 0, 20, 10}, .is_ignored = true});
  image.truths.push_back({.box_px = {300, 0, 50, 50}, .is_region = true});
  // Two on the first aircraft, one 11 px from the second, one on the ignored, one in the region.
  image.detections = {{{1, 0, 20, 10}, 0.4},
                      {{5, 0, 20, 10}, 0.7},
                      {{111, 0, 20, 10}, 0.9},
                      {{200, 0, 20, 10}, 0.8},
                      {{340, 30, 10, 10}, 0.6}};
  const FrocSequence sequence = froc_sequence(std::vector{image, ScoredImage{}}, 0.2, 10);
  EXPECT_EQ(sequence.best_scores, (std::vector<std::optional<double>>{0.7, {}}));
  EXPECT_EQ(sequence.false_alarm_scores, std::vector<double>{0.9});
  EXPECT_EQ(counts_neither_way(image, 10), (std::vector{false, false, false, true, true}));
  EXPECT_EQ(sequence.images, 2);
  EXPECT_EQ(sequence.duration_s, 0.2);
  // Half of the longer side is near enough where it is more than the distance.
  EXPECT_TRUE(froc_sequence(std::vector{image}, 0, 0).best_scores[0]);
  EXPECT_FALSE(froc_sequence(std::vector{image}, 0, 11).best_scores[1] == std::nullopt);
}

TEST(ClaimsAircraft, AsAllWordsDoThatNameNothingElse) {
  for (const char* word : {"aircraft", "Airplane", "aeroplanes", "helicopter", "738", "kite", ""})
    EXPECT_TRUE(claims_aircraft(word)) << word;
  for (const char* word : {"bird", "Drones", "UAV", "balloon", "insect", "ignored region"})
    EXPECT_FALSE(claims_aircraft(word)) << word;
}

}  // namespace
}  // namespace airtruth::evaluation
