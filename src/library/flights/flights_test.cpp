// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <airtruth/aircraft.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace airtruth
