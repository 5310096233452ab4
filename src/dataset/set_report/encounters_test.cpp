// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/encounters.h"

#include <numeric>

#include <gtest/gtest.h>

#include "dataset/set_report/totals.h"

namespace airtruth::set_report {
namespace {

// Both fly straight at 10 frames/s: the own aircraft north at 20 m/s, the intruder south at 30 m/s,
// 40 m to the east and 5 m below.
replay::Finished passing() {
  replay::Finished finished;
  for (int k = 0; k < 30; ++k) {
    annotation::Frame frame;
    frame.frame = k;
    frame.time_s = k / 10.0;
    frame.camera_position_ned_m = {2.0 * k, 0, -100};
    annotation::Intruder intruder;
    intruder.id = "one";
    intruder.position_ned_m = {100 - 3.0 * k, 40, -95};
    frame.intruders.push_back(intruder);
    finished.truth.frames.push_back(frame);
  }
  pipeline::EncounterRecord record;
  record.id = "one";
  // 50 m/s of closure over 100 m.
  record.closest = passage::Approach{1.97, 40.34, 40.03, {1.5, 40, -5}};
  finished.encounters = {record};
  return finished;
}

TEST(Encounters, TheClosestApproachLiesBetweenTwoFrames) {
  const replay::Finished finished = passing();
  const auto places = closest_places(finished.truth.frames, finished.encounters[0]);
  ASSERT_TRUE(places);
  const auto& [own, intruder] = *places;
  EXPECT_NEAR(own[0], 20 * 1.97, 1e-9);
  EXPECT_NEAR(own[2], -100, 1e-9);
  EXPECT_NEAR(intruder[0], 100 - 30 * 1.97, 1e-9);
  EXPECT_NEAR(intruder[1], 40, 1e-9);
}

TEST(Encounters, AfterTheClipItHasNoPlace) {
  const replay::Finished finished = passing();
  pipeline::EncounterRecord record = finished.encounters[0];
  record.closest->time_s = 2.91;
  EXPECT_FALSE(closest_places(finished.truth.frames, record));
  record.closest->time_s = 2.9;
  EXPECT_TRUE(closest_places(finished.truth.frames, record));
  record.id = "other";
  EXPECT_FALSE(closest_places(finished.truth.frames, record));
}

// A sequence of 300 frames weighs ten times one of 30.
TEST(Encounters, HistogramsCountEveryFrame) {
  replay::Finished finished = passing();
  for (int k = 30; k < 300; ++k) finished.truth.frames.push_back(finished.truth.frames[0]);
  for (annotation::Frame& frame : finished.truth.frames) {
    frame.intruders[0].visible_box_px = PixelBox{10, 10, 8, 4};
    frame.intruders[0].range_m = 500;
    frame.intruders[0].azimuth_deg = 5;
  }
  Portrait portrait;
  portrait.info.width = 64;
  portrait.info.height = 48;
  Totals totals;
  totals.add(finished, portrait);
  for (const Histogram* of :
       {&totals.range_m, &totals.size_px, &totals.azimuth_deg, &totals.to_closest_s})
    EXPECT_EQ(std::accumulate(of->counts.begin(), of->counts.end(), std::int64_t{0}), 300);
}

TEST(Encounters, TheCardCountsThem) {
  pipeline::EncounterRecord near;
  near.closest = passage::Approach{5, 20, 20, {}};
  near.meeting = passage::Meeting::kHeadOn;
  near.vertical_motion = passage::VerticalMotion::kLevel;
  near.first_seen = pipeline::FirstSeen{0, 1, 300, {}};
  near.horizon_when_first_seen = passage::AgainstHorizon::kAbove;
  near.violations = {{"nmac", {4, 6}}, {"nmac", {7, 8}}};
  pipeline::EncounterRecord far = near;
  far.closest->distance_m = 80;
  far.meeting.reset();
  far.first_seen.reset();
  far.horizon_when_first_seen.reset();
  far.violations.clear();
  EXPECT_EQ(
      encounters_text({near, near, far}, {"nmac", "f3442"}),
      "3, seen from the own aircraft: head-on 2, of no course (one of the two hovers, or both "
      "fly alike) 1; level 3; closest approach median 20 m (20 to 80 m); first seen at median "
      "300 m (300 to 300 m), median 4 s (4 to 4 s) before the closest approach, then against "
      "the horizon: above 2, never seen 1; volumes violated: nmac in 2, f3442 in 0");
  EXPECT_EQ(encounters_text({}, {"nmac"}), "");
}

}  // namespace
}  // namespace airtruth::set_report
