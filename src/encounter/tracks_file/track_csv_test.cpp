// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "encounter/tracks_file/formats.h"
#include "encounter/tracks_file/tracks_file.h"
#include "foundation/base/error.h"
#include "support/error_of.h"

namespace airtruth::tracks_file {
namespace {

using ::testing::HasSubstr;

// 200 ft/s northward, then a turn to the right (east) with a climb, as sample2track.m prints it.
constexpr const char* kTrack = "time_s,x_ft,y_ft,z_ft\n0,0,0,1500\n1,200,0,1510\n2,399,17,1520\n";

std::string fault_of_track_csv(const std::string& text) {
  return test_support::error_of([&] { parse_encounters(text, "a.csv"); });
}

TEST(TrackCsv, FeetBecomeMetresNorthEastDown) {
  const auto encounters = parse_encounters(kTrack, "BAYES_t2_id1_alt1500_speed200.csv");
  ASSERT_EQ(encounters.size(), 1u);
  ASSERT_EQ(encounters[0].aircraft.size(), 1u);
  const track::Track& track = encounters[0].aircraft[0];
  EXPECT_EQ(track.name, "track");
  EXPECT_EQ(track.times_s, (std::vector<double>{0, 1, 2}));
  EXPECT_LT((track.positions_ned_m[2] - Vector3(121.6152, 5.1816, -463.296)).norm(), 1e-9);
  EXPECT_TRUE(track.velocities_ned_mps.empty());
  // Windows line ends, and the columns in another order.
  const auto other = parse_encounters("z_ft,time_s,x_ft,y_ft\r\n10,0,1,2\r\n", "a.csv");
  EXPECT_LT((other[0].aircraft[0].positions_ned_m[0] - Vector3(0.3048, 0.6096, -3.048)).norm(),
            1e-12);
}

TEST(TrackCsv, FaultsNameFileAndLine) {
  EXPECT_EQ(fault_of_track_csv("time_s,x_ft,y_ft\n0,0,0\n"),
            "a.csv:1: the header is 'time_s,x_ft,y_ft'; expected time_s,x_ft,y_ft,z_ft");
  EXPECT_THAT(fault_of_track_csv("time_s,x_ft,x_ft,z_ft\n"), HasSubstr("a.csv:1: the header is "));
  EXPECT_THAT(fault_of_track_csv("time_s,x_ft,y_ft,z_ft,w\n"),
              HasSubstr("a.csv:1: the header is "));
  EXPECT_THAT(fault_of_track_csv("time_s,x_ft,y_ft,z_ft\n"), HasSubstr("has no rows"));
  EXPECT_THAT(fault_of_track_csv("time_s,x_ft,y_ft,z_ft\n0,0,0\n"),
              HasSubstr("a.csv:2: has 3 cells"));
  EXPECT_THAT(fault_of_track_csv("time_s,x_ft,y_ft,z_ft\n0,0,inf,0\n"), HasSubstr("a.csv:2: y_ft"));
  EXPECT_THAT(fault_of_track_csv("time_s,x_ft,y_ft,z_ft\n0,0,0,0\n0,1,0,0\n"),
              HasSubstr("a.csv:3: "));
}

}  // namespace
}  // namespace airtruth::tracks_file
