// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <airtruth/aircraft.h>
#include <airtruth/encounters.h>
#include <gtest/gtest.h>
#include <support/source_folder.h>

namespace airtruth {
namespace {

TEST(PublicAircraft, AreNamedWithTheirTypesAndSizes) {
  const std::vector<AircraftEntry> cessnas = list_aircraft("c172/*");
  ASSERT_GE(cessnas.size(), 10u);
  for (const AircraftEntry& one : cessnas) {
    EXPECT_EQ(one.type, "Cessna 172P");
    EXPECT_EQ(one.span_m, 11.0);
  }
  EXPECT_EQ(list_aircraft("C172").size(), cessnas.size());
  EXPECT_THROW(list_aircraft("no such aircraft"), Error);
  EXPECT_THROW(left_out_aircraft("no such aircraft"), Error);
}

TEST(PublicAircraft, AreShownAtTheirPublishedSpan) {
  const AircraftModel shown = show_aircraft("c172/news");
  EXPECT_NEAR(shown.span_m, 11.0, 0.001);
  EXPECT_GT(shown.triangles, 1000);
  EXPECT_EQ(std::count(shown.liveries.begin(), shown.liveries.end(), "c172/csna"), 1);
  EXPECT_THROW(show_aircraft("c172/new"), Error);
}

TEST(PublicEncounters, MeetAsTheyAreAskedFor) {
  const std::filesystem::path examples = test_support::source_folder() / "examples" / "encounters";
  EncounterOptions options;
  options.own = (examples / "own.csv").string();
  options.count = 5;
  options.vmd_m = {30};
  options.hmd_m = {0};
  options.course_deg = {180};
  std::int64_t drawn = 0;
  options.progress = [&](std::int64_t done, std::int64_t) { drawn = done; };
  const SampledEncounters met = sample_encounters("geometric", options);
  EXPECT_EQ(drawn, 5);
  EXPECT_EQ(met.aircraft_names, (std::vector<std::string>{"own", "intruder"}));
  EXPECT_EQ(met.weights, std::vector<double>(5, 1));
  EXPECT_EQ(met.effective_count, 5);
  // Both are there at the same times; at the closest approach the intruder is 30 m above.
  const std::size_t rows = met.time_s.size() / 10;
  double least_m = 1e9;
  for (std::size_t i = 0; i < rows; ++i) {
    EXPECT_EQ(met.time_s[i], met.time_s[rows + i]);
    const auto& own = met.position_ned_m[i];
    const auto& other = met.position_ned_m[rows + i];
    least_m =
        std::min(least_m, std::hypot(own[0] - other[0], own[1] - other[1], own[2] - other[2]));
  }
  EXPECT_NEAR(least_m, 30, 1);
  options.duration_s = 20;
  EXPECT_THROW(sample_encounters("geometric", options), Error);
  EXPECT_THROW(sample_encounters((examples / "none.txt").string()), Error);
}

}  // namespace
}  // namespace airtruth
