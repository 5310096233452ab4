// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "encounter/tracks_file/formats.h"
#include "foundation/base/error.h"
#include "support/error_of.h"

namespace airtruth::tracks_file {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// Writes the fields of the format one by one, independently of waypoints_of().
struct Bytes {
  std::string text;
  template <typename Value>
  Bytes& operator<<(Value value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    text.append(raw, sizeof value);
    return *this;
  }
};

Bytes two_encounters() {
  Bytes bytes;
  bytes << std::uint32_t{2} << std::uint32_t{2};
  bytes << 0.0 << 0.0 << 1000.0;       // encounter 1: own at north, east, altitude
  bytes << 5000.0 << 100.0 << 1100.0;  // intruder
  bytes << std::uint16_t{2} << 1.0 << 150.0 << 0.0 << 1000.0 << 2.0 << 300.0 << 0.0 << 1000.0;
  bytes << std::uint16_t{1} << 2.0 << 4700.0 << 100.0 << 1090.0;
  bytes << 1.0 << 2.0 << 3.0 << 4.0 << 5.0 << 6.0;  // encounter 2
  bytes << std::uint16_t{0};
  bytes << std::uint16_t{1} << 0.5 << 4.0 << 6.0 << 6.0;
  return bytes;
}

std::string fault_of_waypoint(const std::string& bytes) {
  return test_support::error_of([&] { parse_waypoints(bytes, "a.dat"); });
}

TEST(WaypointFile, ReadsFeetAndUpdates) {
  const auto encounters = parse_waypoints(two_encounters().text, "a.dat");
  ASSERT_EQ(encounters.size(), 2u);
  const track::Track& own = encounters[0].aircraft[0];
  EXPECT_EQ(own.name, "own");
  EXPECT_EQ(own.times_s, (std::vector<double>{0, 1, 2}));
  EXPECT_LT((own.positions_ned_m[2] - Vector3(91.44, 0, -304.8)).norm(), 1e-9);
  EXPECT_TRUE(own.velocities_ned_mps.empty());
  EXPECT_EQ(encounters[0].aircraft[1].times_s, (std::vector<double>{0, 2}));
  EXPECT_EQ(encounters[1].aircraft[0].size(), 1u);
  EXPECT_LT((encounters[1].aircraft[1].positions_ned_m[1] - 0.3048 * Vector3(4, 6, -6)).norm(),
            1e-9);
}

TEST(WaypointFile, WritesTheSameBytes) {
  const auto encounters = parse_waypoints(two_encounters().text, "a.dat");
  std::string written = waypoint_head(2, 2);
  for (const track::Encounter& encounter : encounters) written += waypoints_of(encounter, 2);
  EXPECT_EQ(written, two_encounters().text);
}

TEST(WaypointFile, AFirstUpdateAtTimeZeroRepeatsThePosition) {
  Bytes bytes;
  bytes << std::uint32_t{1} << std::uint32_t{1} << 1.0 << 2.0 << 3.0;
  Bytes other = bytes;
  bytes << std::uint16_t{2} << 0.0 << 1.0 << 2.0 << 3.0 << 1.0 << 2.0 << 2.0 << 3.0;
  EXPECT_EQ(parse_waypoints(bytes.text, "a.dat")[0].aircraft[0].size(), 2u);
  EXPECT_EQ(parse_waypoints(bytes.text, "a.dat")[0].aircraft[0].name, "track");
  other << std::uint16_t{1} << 0.0 << 1.0 << 2.0 << 4.0;
  EXPECT_THAT(fault_of_waypoint(other.text), HasSubstr("time 0 s follows 0 s"));
}

TEST(WaypointFile, EveryCutOffFileIsAnError) {
  const std::string whole = two_encounters().text;
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(parse_waypoints(whole.substr(0, size), "a.dat"), Error) << size;
  EXPECT_THAT(fault_of_waypoint(whole.substr(0, 40)),
              StartsWith("a.dat: announces 2 encounters of 2 aircraft in 32 bytes; expected 104"));
  EXPECT_THAT(fault_of_waypoint(whole.substr(0, whole.size() - 1)),
              StartsWith("a.dat: encounter 2, aircraft 2: has 1 updates and 31 bytes behind them"));
  EXPECT_THAT(fault_of_waypoint(whole + "x"), HasSubstr("goes on for 1 bytes after encounter 2"));
}

TEST(WaypointFile, CountsAndNumbersThatCannotBeAreErrors) {
  Bytes none, huge;
  none << std::uint32_t{0} << std::uint32_t{2};
  EXPECT_THAT(fault_of_waypoint(none.text), HasSubstr("holds 0 encounters of 2 aircraft"));
  huge << std::uint32_t{0xffffffff} << std::uint32_t{1000} << 0.0 << 0.0 << 0.0;
  EXPECT_THAT(fault_of_waypoint(huge.text), HasSubstr("announces 4294967295 encounters"));
  for (const double number : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, 2e9}) {
    Bytes bytes;
    bytes << std::uint32_t{1} << std::uint32_t{1} << 0.0 << number << 0.0 << std::uint16_t{0};
    EXPECT_THAT(fault_of_waypoint(bytes.text), HasSubstr("encounter 1, aircraft 1: east is "));
  }
  Bytes twice;
  twice << std::uint32_t{1} << std::uint32_t{1} << 0.0 << 0.0 << 0.0 << std::uint16_t{2};
  twice << 1.0 << 0.0 << 0.0 << 0.0 << 1.0 << 0.0 << 0.0 << 0.0;
  EXPECT_THAT(fault_of_waypoint(twice.text),
              HasSubstr("time 1 s follows 1 s; expected times that increase"));
}

TEST(WaypointFile, WhatItCannotHoldIsAnError) {
  const track::Track track{"a", {5, 6}, {{0, 0, 0}, {1, 0, 0}}, {}};
  track::Track late = track;
  late.times_s = {6, 7};
  EXPECT_THROW(waypoints_of({{track}, 1}, 2), Error);
  EXPECT_THROW(waypoints_of({{track, late}, 1}, 2), Error);
  track::Track longest;
  for (int i = 0; i < 65537; ++i) {
    longest.times_s.push_back(i);
    longest.positions_ned_m.emplace_back(0, 0, 0);
  }
  EXPECT_THROW(waypoints_of({{longest}, 1}, 1), Error);
  longest.times_s.pop_back();
  longest.positions_ned_m.pop_back();
  EXPECT_EQ(parse_waypoints(waypoint_head(1, 1) + waypoints_of({{longest}, 1}, 1), "a")[0]
                .aircraft[0]
                .size(),
            65536u);
  // Times are counted from the beginning.
  EXPECT_EQ(parse_waypoints(waypoint_head(1, 1) + waypoints_of({{track}, 1}, 1), "a")[0]
                .aircraft[0]
                .times_s,
            (std::vector<double>{0, 1}));
}

}  // namespace
}  // namespace airtruth::tracks_file
