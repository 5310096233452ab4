// SPDX-License-Identifier: Apache-2.0
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

constexpr const char* kCsv =
    "encounter,aircraft,time_s,north_m,east_m,down_m,weight\n"
    "1,own,0,0,0,-300,2.5\n"
    "1,own,1,50,0,-300,2.5\n"
    "1,other,0.5,800,10,-310,2.5\n"
    "4,own,0,1,2,3,1\n";

std::string fault_of_encounter_csv(const std::string& text) {
  return test_support::error_of([&] { parse_encounter_csv(text, "a.csv"); });
}

std::string changed(const std::string& from, const std::string& to) {
  std::string text = kCsv;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(EncounterCsv, RowsBecomeEncounters) {
  const auto encounters = parse_encounter_csv(kCsv, "a.csv");
  ASSERT_EQ(encounters.size(), 2u);
  ASSERT_EQ(encounters[0].aircraft.size(), 2u);
  EXPECT_EQ(encounters[0].weight, 2.5);
  EXPECT_EQ(encounters[0].aircraft[1].name, "other");
  EXPECT_EQ(encounters[0].aircraft[0].positions_ned_m[1], Vector3(50, 0, -300));
  EXPECT_TRUE(encounters[0].aircraft[0].velocities_ned_mps.empty());
  EXPECT_EQ(encounters[1].aircraft[0].positions_ned_m[0], Vector3(1, 2, 3));
}

TEST(EncounterCsv, WhatIsWrittenReadsTheSame) {
  track::Encounter encounter{
      {{"a", {0, 0.1}, {{0.1, 1e-7, -1.0 / 3}, {1, 2, 3}}, {{4, 5, 6}, {7, 8, 9.1}}}}, 1.0 / 7};
  const auto again =
      parse_encounter_csv(encounter_csv_head() + encounter_csv_rows(encounter, 12), "a.csv");
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0].weight, encounter.weight);
  EXPECT_EQ(again[0].aircraft[0].times_s, encounter.aircraft[0].times_s);
  EXPECT_EQ(again[0].aircraft[0].positions_ned_m, encounter.aircraft[0].positions_ned_m);
  EXPECT_EQ(again[0].aircraft[0].velocities_ned_mps, encounter.aircraft[0].velocities_ned_mps);
}

TEST(EncounterCsv, EachFaultNamesTheLineAndWhatWasExpected) {
  EXPECT_THAT(fault_of_encounter_csv(""), StartsWith("a.csv: is empty"));
  EXPECT_THAT(fault_of_encounter_csv("encounter,aircraft,time_s,north_m,east_m,down_m\n"),
              StartsWith("a.csv:1: has no rows"));
  EXPECT_THAT(fault_of_encounter_csv(changed("north_m", "norht_m")),
              StartsWith("a.csv:1: unknown column 'norht_m'; did you mean 'north_m'?"));
  EXPECT_THAT(fault_of_encounter_csv(changed("weight", "north_m")),
              HasSubstr("'north_m' is twice there"));
  EXPECT_THAT(fault_of_encounter_csv(changed("weight", "east_mps")),
              HasSubstr("has no column 'north_mps'"));
  EXPECT_THAT(fault_of_encounter_csv(changed("1,own,0,0,0,-300,2.5", "1,own,0,0,0,-300")),
              StartsWith("a.csv:2: has 6 cells for 7 columns"));
  EXPECT_THAT(fault_of_encounter_csv(changed("1,own,1,", "1,own,0,")),
              StartsWith("a.csv:3: the time of 'own' is 0 s after 0 s"));
  EXPECT_THAT(fault_of_encounter_csv(changed("1,own,1,50", "1,own,1,nan")),
              StartsWith("a.csv:3: north_m is 'nan'; expected a number"));
  EXPECT_THAT(fault_of_encounter_csv(changed("-310,2.5", "-310,2")),
              StartsWith("a.csv:4: weight is 2 after 2.5"));
  EXPECT_THAT(fault_of_encounter_csv(changed("3,1\n", "3,-1\n")),
              HasSubstr("expected a positive number"));
  EXPECT_THAT(fault_of_encounter_csv(changed("4,own", "4.5,own")),
              HasSubstr("expected a whole number from 0"));
  EXPECT_THAT(fault_of_encounter_csv(changed("4,own", "4,")),
              HasSubstr("the aircraft is named ''"));
  EXPECT_THAT(fault_of_encounter_csv(std::string(kCsv) + "1,own,2,0,0,0,2.5\n"),
              StartsWith("a.csv:6: encounter 1 goes on after another"));
}

}  // namespace
}  // namespace airtruth::tracks_file
