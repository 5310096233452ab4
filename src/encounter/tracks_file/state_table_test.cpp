// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "encounter/track/track.h"
#include "encounter/tracks_file/formats.h"
#include "encounter/tracks_file/tracks_file.h"
#include "foundation/base/error.h"
#include "foundation/geometry/units.h"
#include "support/error_of.h"
#include "support/shared_folder.h"

namespace airtruth::tracks_file {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kDaa = R"(## A head-on encounter
NAME sx sy sz trk gs vs time
[none] [nmi] [nmi] [ft] [deg] [knot] [fpm] [s]
Own 0 0 1000 0 100 0 0
Other 0.5 2 1200 180 120 -600 0
Own 0 0.0277777777 1000 0 100 0 1
Other 0.5 1.9666666667 1190 180 120 -600 1
)";

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string fault_of_state_table(const std::string& text) {
  return test_support::error_of([&] { parse_state_table(text, "a.daa"); });
}

TEST(StateTable, UnitsAndAxesOfDaa) {
  const track::Encounter encounter = parse_state_table(kDaa, "a.daa");
  ASSERT_EQ(encounter.aircraft.size(), 2u);
  const track::Track& other = encounter.aircraft[1];
  EXPECT_EQ(encounter.aircraft[0].name, "Own");
  EXPECT_EQ(other.times_s, (std::vector<double>{0, 1}));
  // x is east, y north and z up; 120 kt are 222.24 km/h.
  EXPECT_LT((other.positions_ned_m[0] - Vector3(3704, 926, -365.76)).norm(), 1e-9);
  EXPECT_LT((other.velocities_ned_mps[0] - Vector3(-222.24 / 3.6, 0, 3.048)).norm(), 1e-9);
}

TEST(StateTable, CommasVelocitiesByAxisOtherUnitsAndMoreColumns) {
  const track::Encounter encounter = parse_state_table(
      "filetype = state\n"
      "Time, mass, Name, vz, vy, vx, alt, sy, sx\n"
      "[min], [kg], unitless, [m/s], [m/s], [km/h], [m], [km], [m]\n"
      "0, 5, own ship, 1, 2, 3.6, 100, 1, 10   # a comment\n"
      "0, 5, b, 0, 0, 0, 0, 0, 0\n"
      "0.5, 5, own ship, 1, 2, 3.6, 130, 1.06, 40,\n",
      "a.daa");
  const track::Track& own = encounter.aircraft[0];
  EXPECT_EQ(own.name, "own_ship");
  EXPECT_EQ(own.times_s[1], 30);
  EXPECT_LT((own.positions_ned_m[0] - Vector3(1000, 10, -100)).norm(), 1e-9);
  EXPECT_LT((own.velocities_ned_mps[0] - Vector3(2, 1, -1)).norm(), 1e-12);
}

TEST(StateTable, AClockCountsHoursMinutesAndSeconds) {
  const std::string text = changed(
      changed(changed(changed(changed(kDaa, "time", "clock"), "0 0\nOther", "0 01:02:03.5\nOther"),
                      "-600 0\n",
                      "-600 01:02:03.5\n"),
              "0 1\nOther",
              "0 62:04.5\nOther"),
      "-600 1\n",
      "-600 3725\n");
  const track::Encounter encounter = parse_state_table(text, "a.daa");
  EXPECT_EQ(encounter.aircraft[0].times_s, (std::vector<double>{3723.5, 3724.5}));
  EXPECT_EQ(encounter.aircraft[1].times_s, (std::vector<double>{3723.5, 3725}));
}

TEST(StateTable, AnAirspeedIsAlongTheClimbingPath) {
  const track::Encounter encounter = parse_state_table(
      "NAME, east, north, alt, hdg, speed, dh, time\n"
      "unitless, [ft], [ft], [ft], [rad], [ftps], [ftps], [s]\n"
      "OWNSHIP, 0, 0, 1000, 1.5707963267948966, 50, 30, 0.0\n"
      "INTRUDER, 0, 1000, 1000, 0, 50, 0, 0.0\n",
      "1.txt");
  EXPECT_LT(
      (encounter.aircraft[0].velocities_ned_mps[0] / kMetresOfFoot - Vector3(0, 40, -30)).norm(),
      1e-9);
}

TEST(StateTable, LatitudesAndLongitudesAreProjected) {
  const track::Encounter encounter = parse_state_table(
      "name lat lon alt trk gs vs time\n"
      "[none] [deg] [deg] [ft] [deg] [knot] [fpm] [s]\n"
      "own 60 10 0 0 0 0 0\n"
      "north 60.1 10 0 0 0 0 0\n"
      "east 60 10.1 0 0 0 0 0\n",
      "a.daa");
  // A tenth of a degree is 6 nmi, and half of that along the parallel of 60 degrees. The projection
  // shortens it by x^3 / 6, 6 mm; the parallel bends north of the tangent by
  // (3 nmi)^2 tan(60) / (2 R) = 4.2 m.
  EXPECT_EQ(encounter.aircraft[0].positions_ned_m[0].norm(), 0);
  EXPECT_NEAR(encounter.aircraft[1].positions_ned_m[0].x(), 6 * 1852, 0.01);
  EXPECT_NEAR(encounter.aircraft[1].positions_ned_m[0].y(), 0, 1e-9);
  EXPECT_NEAR(encounter.aircraft[2].positions_ned_m[0].y(), 3 * 1852, 0.01);
  EXPECT_NEAR(encounter.aircraft[2].positions_ned_m[0].x(), 4.2, 0.01);
}

TEST(StateTable, EachFaultNamesTheLineAndWhatWasExpected) {
  EXPECT_THAT(fault_of_state_table(""), StartsWith("a.daa: is empty; expected headings"));
  EXPECT_THAT(fault_of_state_table("# only a comment\n"), HasSubstr("is empty"));
  EXPECT_THAT(fault_of_state_table("NAME sx sy sz trk gs vs time\n"),
              StartsWith("a.daa:1: ends after the"));
  EXPECT_THAT(
      fault_of_state_table(changed(kDaa, "[none] [nmi] [nmi] [ft] [deg] [knot] [fpm] [s]\n", "")),
      StartsWith("a.daa:3: has no units; expected a row of them"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "[none] [nmi] [nmi]", "[none] [nmi]")),
              StartsWith("a.daa:3: has 7 units for 8 headings"));
  EXPECT_THAT(fault_of_state_table("NAME,sx,sy,sz,trk,gs,vs,time\n"
                                   "[none],[nmi],[nmi],,[deg],[knot],[fpm],[s]\n"),
              StartsWith("a.daa:2: the unit of 'sz' is missing; expected one of m, km, ft, nmi"));
  EXPECT_THAT(
      fault_of_state_table(changed(kDaa, "[knot]", "[furlong]")),
      StartsWith("a.daa:3: the unit of 'gs' is [furlong]; expected one of m/s, km/h, knot"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "[deg]", "[ft]")),
              HasSubstr("expected one of deg, rad"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "[s]", "unitless")),
              HasSubstr("the unit of 'time'"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "NAME", "WHO")), HasSubstr("lack the aircraft"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "time", "when")), HasSubstr("lack the time"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "sx", "x")), HasSubstr("lack the position"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "gs", "vx")), HasSubstr("lack the velocity"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "sz", "sx")),
              HasSubstr("hold 'sx' and 'sx' for the same"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "100 0 0", "100 0")),
              StartsWith("a.daa:4: has 7 cells for 8 headings"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "0.5 2", "inf 2")),
              StartsWith("a.daa:5: sx is 'inf'"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "0.5 2", "nan 2")), HasSubstr("sx is 'nan'"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "0.5 2", "1e10 2")), HasSubstr("up to 1e9"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "120 -600", "-120 -600")),
              HasSubstr("the speed is -61"));
  EXPECT_THAT(fault_of_state_table(changed(kDaa, "100 0 1\n", "100 0 0\n")),
              StartsWith("a.daa:6: the time of 'Own' is 0 s after 0 s; expected times that"));
  EXPECT_THAT(
      fault_of_state_table("name sx sy sz vx vy vz time\n[none] [m] [m] [m] [m/s] [m/s] [m/s] [s]\n"
                           "own 0 0 0 0 0 0 0\nown 0 0 0 0 0 0 1\n"),
      StartsWith("a.daa: holds one aircraft only, 'own'; expected the own one and another"));
  EXPECT_THAT(fault_of_state_table(
                  "name sx sy sz vx vy vz time\n[none] [m] [m] [m] [m/s] [m/s] [m/s] [s]\n"),
              HasSubstr("has no rows"));
}

TEST(StateTable, LatitudesOutOfRangeAreErrors) {
  const auto with = [](const char* place) {
    return fault_of_state_table(std::string("name lat lon alt vx vy vz time\n"
                                            "[none] [deg] [deg] [m] [m/s] [m/s] [m/s] [s]\n"
                                            "own 10 20 0 0 0 0 0\nb ") +
                                place + " 0 0 0 0 0\n");
  };
  EXPECT_THAT(with("91 20"), HasSubstr("outside of 90 degrees"));
  EXPECT_THAT(with("10 400"), HasSubstr("360 of longitude"));
  EXPECT_THAT(with("-70 20"), HasSubstr("more than 60 degrees from the first"));
}

TEST(StateTable, WhatIsWrittenReadsTheSame) {
  const track::Encounter first = parse_state_table(kDaa, "a.daa");
  for (const bool is_daa : {true, false}) {
    const std::string written = is_daa ? daa_of(first) : state_table_of(first);
    const track::Encounter again = parse_state_table(written, "b");
    for (std::size_t a = 0; a < 2; ++a) {
      EXPECT_EQ(again.aircraft[a].name, first.aircraft[a].name);
      EXPECT_EQ(again.aircraft[a].times_s, first.aircraft[a].times_s);
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_LT(
            (again.aircraft[a].positions_ned_m[i] - first.aircraft[a].positions_ned_m[i]).norm(),
            1e-9);
        EXPECT_LT(
            (again.aircraft[a].velocities_ned_mps[i] - first.aircraft[a].velocities_ned_mps[i])
                .norm(),
            1e-9);
      }
    }
  }
  EXPECT_EQ(daa_of(parse_state_table(daa_of(first), "b")), daa_of(first));
  EXPECT_THROW(daa_of({{first.aircraft[0]}, 1}), Error);
}

// The first row of DAIDALUS' own output for its H1.daa: 44.554796 nmi and 799.951467 kt.
TEST(StateTable, DistancesAreThoseOfDaidalus) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is unset";
  const auto encounters = read_encounters(fs::path(shared) / "encounters/daidalus/H1.daa");
  ASSERT_EQ(encounters.size(), 1u);
  ASSERT_EQ(encounters[0].aircraft.size(), 2u);
  const track::Track &own = encounters[0].aircraft[0], &other = encounters[0].aircraft[1];
  EXPECT_EQ(own.size(), 230u);
  const Vector3 apart = own.positions_ned_m[0] - other.positions_ned_m[0];
  EXPECT_NEAR(apart.head<2>().norm() / kMetresOfNauticalMile, 44.554796, 1e-6);
  // DAIDALUS projects the mean velocity over 10 s, here the velocity itself is projected.
  const Vector3 closing = own.velocities_ned_mps[0] - other.velocities_ned_mps[0];
  EXPECT_NEAR(-apart.head<2>().normalized().dot(closing.head<2>()) / kMpsOfKnot, 799.951467, 0.01);
}

TEST(StateTable, TheExamplesOfThePairingToolAreRead) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is unset";
  for (const char* name : {"1.txt", "2.txt"}) {
    const auto encounters = read_encounters(fs::path(shared) / "encounters/examples" / name);
    for (const track::Track& track : encounters[0].aircraft) {
      ASSERT_EQ(track.size(), 1800u);
      EXPECT_EQ(track.times_s.back(), 179.9);
      // Courses have two decimals of radians, so that half a metre a second is lost across.
      const Vector3 flown_m = track.positions_ned_m[1] - track.positions_ned_m[0];
      EXPECT_LT((flown_m / 0.1 - track.velocities_ned_mps[0]).norm(), 0.5);
    }
  }
}

}  // namespace
}  // namespace airtruth::tracks_file
