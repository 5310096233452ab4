// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/detection_match.h"

#include <gtest/gtest.h>

namespace airtruth::scores {
namespace {

// A box of this size about a centre.
Box at(double x, double y, double width = 6, double height = 3) {
  return {x - width / 2, y - height / 2, width, height};
}

TruthObject object(std::int64_t id, const Box& box, const std::string& what = "aircraft") {
  TruthObject made;
  made.id = id;
  made.box_px = box;
  made.object_class = what;
  return made;
}

TEST(Found, TheExampleOfTheHeader) {
  TruthFrame frame;
  frame.objects = {object(1, at(100, 100))};
  EXPECT_EQ(match_of(at(108, 106), frame, 10).kind, MatchKind::kTruePositive);
  EXPECT_EQ(match_of(at(111, 100), frame, 10).kind, MatchKind::kFalseAlarm);
  frame.objects = {object(1, at(100, 100, 60, 20))};
  EXPECT_EQ(match_of(at(130, 100), frame, 10).kind, MatchKind::kTruePositive);
  EXPECT_EQ(match_of(at(130.1, 100), frame, 10).kind, MatchKind::kFalseAlarm);
}

TEST(Found, TheNearestOfTwoAircraft) {
  TruthFrame frame;
  frame.objects = {object(1, at(100, 100)), object(2, at(110, 100))};
  EXPECT_EQ(match_of(at(104, 100), frame, 10).object, 1);
  EXPECT_EQ(match_of(at(106, 100), frame, 10).object, 2);
}

TEST(Found, ABirdIsAFalseAlarmByItsName) {
  TruthFrame frame;
  frame.objects = {object(1, at(100, 100), "bird")};
  const Match bird = match_of(at(101, 100), frame, 10);
  EXPECT_EQ(bird.kind, MatchKind::kFalseAlarm);
  EXPECT_EQ(bird.what, "bird");
  EXPECT_EQ(bird.object, 1);
  const Match nothing = match_of(at(300, 100), frame, 10);
  EXPECT_EQ(nothing.what, kBackground);
  EXPECT_FALSE(nothing.object);
  // An aircraft beside it comes first.
  frame.objects.push_back(object(2, at(108, 100)));
  EXPECT_EQ(match_of(at(101, 100), frame, 10).kind, MatchKind::kTruePositive);
}

TEST(Found, FaintAircraftAndIgnoredRegionsCountNeitherWay) {
  TruthFrame frame;
  frame.objects = {object(1, at(100, 100))};
  frame.objects[0].counts = false;
  frame.ignored_px = {{200, 200, 50, 50}};
  EXPECT_EQ(match_of(at(100, 100), frame, 10).kind, MatchKind::kIgnored);
  EXPECT_EQ(match_of(at(100, 100), frame, 10).object, 1);
  EXPECT_EQ(match_of(at(249, 249), frame, 10).kind, MatchKind::kIgnored);
  EXPECT_EQ(match_of(at(251, 249), frame, 10).kind, MatchKind::kFalseAlarm);
}

TEST(Found, WhatDoesNotClaimAnAircraftIsIgnored) {
  for (const char* word : {"aircraft", "738", "Airplane", "UFO"})
    EXPECT_TRUE(claims_aircraft(word, {})) << word;
  for (const char* word : {"bird", "Bird", "birds", "drone", "UAV", "ignore", "Ignored regions"})
    EXPECT_FALSE(claims_aircraft(word, {})) << word;
  // What the labels of the set say comes before the words of what is no aircraft.
  TruthSequence labelled;
  labelled.class_of = {{"drone", "aircraft"}, {"gull", "bird"}, {"airplane", "bird"}};
  EXPECT_TRUE(claims_aircraft("drone", labelled));
  EXPECT_TRUE(claims_aircraft("airplane", labelled));
  EXPECT_FALSE(claims_aircraft("gull", labelled));
  results::SequenceDetections detections;
  detections.frames = {{{at(100, 100), 1, "bird", {}}, {at(100, 100), 1, "738", {}}}, {}};
  TruthSequence truth;
  truth.frames.resize(2);
  truth.frames[0].objects = {object(1, at(100, 100))};
  const auto matches = matches_of(detections, truth, 10);
  ASSERT_EQ(matches.size(), 2u);
  EXPECT_EQ(matches[0][0].kind, MatchKind::kIgnored);
  EXPECT_EQ(matches[0][1].kind, MatchKind::kTruePositive);
}

}  // namespace
}  // namespace airtruth::scores
