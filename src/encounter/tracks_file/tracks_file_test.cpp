// SPDX-License-Identifier: Apache-2.0
#include "encounter/tracks_file/tracks_file.h"

#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::tracks_file {
namespace {

class TracksFile : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("airtruth-tracks-") + test->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

track::Encounter encounter_of(std::size_t aircraft) {
  track::Encounter encounter;
  for (std::size_t a = 0; a < aircraft; ++a)
    encounter.aircraft.push_back({a == 0 ? "own" : "intruder",
                                  {0, 1, 2},
                                  {{static_cast<double>(a), 0, -100}, {30, 1, -100}, {60, 4, -100}},
                                  {}});
  return encounter;
}

TEST_F(TracksFile, EveryFormatReadsWhatItWrote) {
  for (const std::string& extension : all_enum_names<TracksFormat>()) {
    const fs::path file = folder_ / ("a." + extension);
    write_encounters(file, {encounter_of(2)});
    const auto again = read_encounters(file);
    ASSERT_EQ(again.size(), 1u) << extension;
    ASSERT_EQ(again[0].aircraft.size(), 2u) << extension;
    for (std::size_t a = 0; a < 2; ++a) {
      EXPECT_EQ(again[0].aircraft[a].name, a == 0 ? "own" : "intruder") << extension;
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_LT((again[0].aircraft[a].positions_ned_m[i] -
                   encounter_of(2).aircraft[a].positions_ned_m[i])
                      .norm(),
                  1e-9)
            << extension;
    }
  }
  EXPECT_EQ(files(), 4u);
}

TEST_F(TracksFile, AnExtensionOfAnotherKindIsAnError) {
  EXPECT_THROW(read_encounters(folder_ / "a.doc"), Error);
  EXPECT_THROW(tracks_format_of("encounters"), Error);
}

TEST_F(TracksFile, TracksOfOneAircraftEachFitInOneScenario) {
  const std::vector<track::Encounter> singles(3, encounter_of(1));
  const auto joined = fitted(singles, TracksFormat::kDaa, "a.daa");
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_EQ(joined[0].aircraft[2].name, "own-3");
  EXPECT_EQ(fitted(singles, TracksFormat::kWaypoints, "a.dat").size(), 3u);
  EXPECT_THROW(
      fitted(std::vector<track::Encounter>(2, encounter_of(2)), TracksFormat::kDaa, "a.daa"),
      Error);
  EXPECT_THROW(
      fitted(std::vector<track::Encounter>(1001, encounter_of(1)), TracksFormat::kTable, "a.txt"),
      Error);
}

TEST_F(TracksFile, WhatCannotBeWrittenLeavesNothing) {
  EXPECT_THROW(write_encounters(folder_ / "a.daa", {encounter_of(1)}), Error);
  EXPECT_THROW(write_encounters(folder_ / "none" / "a.csv", {encounter_of(2)}), Error);
  EXPECT_THROW(write_encounters(folder_ / "a.dat", {encounter_of(2), encounter_of(1)}), Error);
  EXPECT_EQ(files(), 0u);
  write_encounters(folder_ / "a.dat", {encounter_of(1)});
  const std::string before = read_file(folder_ / "a.dat");
  EXPECT_THROW(write_encounters(folder_ / "a.dat", {encounter_of(2), encounter_of(1)}), Error);
  EXPECT_EQ(read_file(folder_ / "a.dat"), before);
  EXPECT_EQ(files(), 1u);
}

}  // namespace
}  // namespace airtruth::tracks_file
