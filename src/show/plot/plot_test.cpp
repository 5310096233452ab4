// SPDX-License-Identifier: Apache-2.0
#include "show/plot/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/still.h"
#include "show/plot/gnuplot.h"
#include "support/environment_variable.h"
#include "support/temporary_folder.h"

namespace airtruth::plot {
namespace {

bool has_gnuplot() { return std::system("command -v gnuplot > /dev/null 2>&1") == 0; }

Plot two_levels() {
  Plot plot{.title = "levels", .x = {.label = "x", .min = 0, .max = 10}, .y = {.min = 0, .max = 1}};
  plot.series.push_back({.name = "low", .style = style_of(0), .x = {0, 10}, .y = {0.25, 0.25}});
  plot.series.push_back({.name = "high", .style = style_of(1), .x = {0, 10}, .y = {0.75, 0.75}});
  return plot;
}

bool is_near(const std::uint8_t* pixel, const Colour& colour) {
  for (std::size_t c = 0; c < 3; ++c)
    if (std::abs(int{pixel[c]} - int{colour[c]}) > 40) return false;
  return true;
}

// The rows in which at least `least` pixels have the colour.
std::vector<int> rows_of(const image::Rgb8& picture, const Colour& colour, int least) {
  std::vector<int> rows;
  for (int y = 0; y < picture.height; ++y) {
    int count = 0;
    for (int x = 0; x < picture.width; ++x) count += is_near(picture.at(x, y), colour) ? 1 : 0;
    if (count >= least) rows.push_back(y);
  }
  return rows;
}

double middle(const std::vector<int>& rows) {
  double sum = 0;
  for (const int y : rows) sum += y;
  return sum / static_cast<double>(rows.size());
}

TEST(Plot, StylesOfTheFirst18SeriesDiffer) {
  for (std::size_t a = 0; a < 18; ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_FALSE(style_of(a).colour == style_of(b).colour && style_of(a).dash == style_of(b).dash)
          << a << " and " << b;
}

TEST(Plot, JsonHoldsWhatIsDescribed) {
  Plot plot{.title = "t", .x = {.names = {"a", "b"}}, .y = {.label = "v", .min = 0}};
  plot.series.push_back({.name = "s",
                         .mark = Mark::kBars,
                         .style = {kInk, Dash::kLong, 2},
                         .x = {0, 1},
                         .y = {3, std::numeric_limits<double>::quiet_NaN()}});
  EXPECT_EQ(
      json_of(plot).dump(),
      R"({"title":"t","x":{"label":"","min":null,"max":null,"names":["a","b"],"logarithmic":false},)"
      R"("y":{"label":"v","min":0.0,"max":null,"names":[],"logarithmic":false},)"
      R"("series":[{"name":"s","mark":"bars","style":{"colour":"ink","dash":[7,3],)"
      R"("width":2.0},"x":[0.0,1.0],"y":[3.0,null],"low":[],"high":[],"hollow":false}]})");
}

// Two levels a half of the axis apart lie a half of its height apart in the picture.
TEST(Gnuplot, DrawsValuesWhereTheAxisSaysTheyAre) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const image::Rgb8 picture = picture_of({.plots = {two_levels()}, .legend = Legend::kNone});
  EXPECT_EQ(picture.width, 1600);
  EXPECT_EQ(picture.height, 900);
  const auto low = rows_of(picture, kColours[0], 500), high = rows_of(picture, kColours[1], 500);
  const auto border = rows_of(picture, {85, 85, 85}, 900);
  ASSERT_FALSE(low.empty() || high.empty());
  ASSERT_GE(border.size(), 2U);
  const double axis = border.back() - border.front();
  EXPECT_NEAR(middle(low) - middle(high), 0.5 * axis, 4);
  EXPECT_NEAR(border.back() - middle(low), 0.25 * axis, 4);
}

// A value stands where its logarithm is, and the band between its bounds is a lighter shade of it.
TEST(Gnuplot, ALogarithmicAxisAndABand) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  Plot plot{.x = {.min = 0, .max = 1}, .y = {.min = 0.01, .max = 100, .is_logarithmic = true}};
  plot.series.push_back(
      {.style = style_of(0), .x = {0, 1}, .y = {10, 10}, .low = {1, 1}, .high = {100, 100}});
  const image::Rgb8 picture = picture_of({.plots = {plot}, .legend = Legend::kNone});
  const auto line = rows_of(picture, kColours[0], 500);
  const auto border = rows_of(picture, {85, 85, 85}, 900);
  ASSERT_FALSE(line.empty() || border.size() < 2);
  const double axis = border.back() - border.front();
  EXPECT_NEAR(border.back() - middle(line), 0.75 * axis, 4);
  // 15 % of the colour on white, from the middle of the axis up.
  const Colour shade = {217, 234, 243};
  const int x = picture.width / 2;
  EXPECT_TRUE(is_near(picture.at(x, border.back() - static_cast<int>(0.6 * axis)), shade));
  EXPECT_GT(int{picture.at(x, border.back() - static_cast<int>(0.6 * axis))[2]},
            int{picture.at(x, border.back() - static_cast<int>(0.6 * axis))[0]} + 15);
  EXPECT_EQ(int{picture.at(x, border.back() - static_cast<int>(0.4 * axis))[0]}, 255);
}

// A bar is as high as its value, and its whisker reaches from bound to bound.
TEST(Gnuplot, ABarHasItsInterval) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  Plot plot{.x = {.names = {"one"}}, .y = {.min = 0, .max = 1}};
  plot.series.push_back({.mark = Mark::kBars,
                         .style = style_of(0),
                         .x = {0},
                         .y = {0.5},
                         .low = {0.25},
                         .high = {0.75}});
  const image::Rgb8 picture = picture_of({.plots = {plot}, .legend = Legend::kNone});
  const auto bar = rows_of(picture, kColours[0], 500);
  const auto border = rows_of(picture, {85, 85, 85}, 900);
  ASSERT_FALSE(bar.empty() || border.size() < 2);
  const double axis = border.back() - border.front();
  EXPECT_NEAR(border.back() - bar.front(), 0.5 * axis, 4);
  // Dark from 0.25 to 0.75 in the middle, and not beyond.
  const auto is_dark_at = [&](double value) {
    const int y = border.back() - static_cast<int>(value * axis);
    for (int x = 0; x < picture.width; ++x)
      if (is_near(picture.at(x, y), {51, 51, 51}) && picture.at(x, y)[0] < 70) return true;
    return false;
  };
  for (const double value : {0.28, 0.45, 0.5, 0.6, 0.73}) EXPECT_TRUE(is_dark_at(value)) << value;
  for (const double value : {0.2, 0.8}) EXPECT_FALSE(is_dark_at(value)) << value;
}

// The columns in which a pixel of a row has the colour.
std::vector<int> columns_of(const image::Rgb8& picture, const Colour& colour, int y) {
  std::vector<int> columns;
  for (int x = 0; x < picture.width; ++x)
    if (is_near(picture.at(x, y), colour)) columns.push_back(x);
  return columns;
}

// Four detectors at three places, each with a ring beside its dot: every one stands free, a dot is
// full and a ring is empty, and whiskers reach from bound to bound.
TEST(Gnuplot, DotsAndRingsOfManySeriesStandFree) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  Plot plot{.x = {.names = {"a", "b", "c"}}, .y = {.min = 0, .max = 1}};
  for (std::size_t k = 0; k < 8; ++k)
    plot.series.push_back({.mark = Mark::kDots,
                           .style = style_of(k / 2),
                           .x = {0, 1, 2},
                           .y = {0.5, 0.5, 0.5},
                           .low = {0.25, 0.25, 0.25},
                           .high = {0.75, 0.75, 0.75},
                           .is_hollow = k % 2 == 1});
  const image::Rgb8 picture = picture_of({.plots = {plot}, .legend = Legend::kNone});
  const auto border = rows_of(picture, {85, 85, 85}, 900);
  ASSERT_GE(border.size(), 2U);
  const double axis = border.back() - border.front();
  const auto row = [&](double value) { return border.back() - static_cast<int>(value * axis); };
  for (std::size_t k = 0; k < 4; ++k) {
    // At each place two whiskers, which do not touch.
    int whiskers = 0, last = -10;
    for (const int x : columns_of(picture, kColours[k], row(0.65))) {
      whiskers += x > last + 5 ? 1 : 0;
      last = x;
    }
    EXPECT_EQ(whiskers, 6) << k;
    for (const double beyond : {0.2, 0.8})
      EXPECT_TRUE(columns_of(picture, kColours[k], row(beyond)).empty()) << k;
    // In the middle of the first place's ring it is white, and its dot is full.
    const std::vector<int> first = columns_of(picture, kColours[k], row(0.65));
    const auto is_full = [&](int x) { return is_near(picture.at(x, row(0.5)), kColours[k]); };
    EXPECT_TRUE(is_full(first.front())) << k;
    const auto ring =
        std::find_if(first.begin(), first.end(), [&](int x) { return x > first.front() + 5; });
    ASSERT_NE(ring, first.end());
    EXPECT_FALSE(is_full(*ring)) << k;
  }
}

TEST(Gnuplot, APlotWithoutDataHasAxes) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  Sheet sheet;
  sheet.plots.resize(2);
  sheet.plots[0].title = "no series";
  sheet.plots[1].series.push_back(
      {.name = "gaps", .x = {0, 1}, .y = std::vector(2, std::numeric_limits<double>::quiet_NaN())});
  const image::Rgb8 picture = picture_of(sheet);
  EXPECT_GE(rows_of(picture, {85, 85, 85}, 900).size(), 4U);  // two axes, top and bottom
}

// gnuplot leaves the name of an axis out where there is no room for it.
TEST(Gnuplot, AnAxisOfLongNumbersHasItsName) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const auto drawn = [](const std::string& name) {
    Plot plot{.y = {.label = name, .min = -0.0004, .max = 0.0003}};
    plot.series.push_back({.style = style_of(0), .x = {0, 1}, .y = {-0.0003, 0.0002}});
    return picture_of({.plots = {plot, plot}, .height = 8, .legend = Legend::kAbove});
  };
  EXPECT_NE(drawn("degrees").bytes(), drawn("").bytes());
}

TEST(Gnuplot, NamesOfAUserRunNothing) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const test_support::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  Plot plot = two_levels();
  const std::string command = "' ; system('touch " + (folder / "ran").string() + "') ; '\n`touch " +
                              (folder / "ran").string() + "`";
  plot.title = plot.x.label = plot.series[0].name = command;
  plot.y.names = {command, "%06d.png 5 %"};
  Sheet sheet;
  sheet.plots.push_back(plot);
  draw(sheet, folder, "p", Format::kSvg);
  EXPECT_TRUE(fs::exists(folder / "p.svg"));
  EXPECT_TRUE(fs::exists(folder / "p.gnuplot"));
  EXPECT_FALSE(fs::exists(folder / "ran"));
}

// gnuplot ends well where the disk is full, and leaves a part.
TEST(Gnuplot, AFileThatIsNotWholeIsAnError) {
  const test_support::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  write_file(folder / "gnuplot",
             "#!/bin/sh\ncat > /dev/null\nprintf '<svg>' > " + (folder / "p.svg").string() + "\n");
  fs::permissions(folder / "gnuplot", fs::perms::owner_all);
  const test_support::EnvironmentVariable path("PATH", folder.string() + ":" + std::getenv("PATH"));
  Sheet sheet;
  sheet.plots.push_back(two_levels());
  std::string message;
  try {
    draw(sheet, folder, "p", Format::kSvg);
  } catch (const Error& error) {
    message = error.what();
  }
  EXPECT_EQ(message, (folder / "p.svg").string() + ": cannot be written: is the disk full?");
}

}  // namespace
}  // namespace airtruth::plot
