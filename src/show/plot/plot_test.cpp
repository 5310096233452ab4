// SPDX-License-Identifier: Apache-2.0
#include "show/plot/plot.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "show/plot/style.h"

namespace airtruth::plot {
namespace {

namespace fs = std::filesystem;

Plot line_with_gap() {
  Plot plot{.title = "Success", .x = {.label = "overlap"}, .y = {.label = "share", .low = 0}};
  plot.series.push_back(
      {.name = "am3", .x = {0, 1, 2}, .y = {1, NAN, 0.5}, .colour = 6, .dash = 1});
  return plot;
}

TEST(Plot, JsonHasNullForGapAndForFreeLimit) {
  EXPECT_EQ(
      to_json(line_with_gap()).dump(),
      R"({"title":"Success","x":{"label":"overlap","low":null,"high":null,"names":[]},)"
      R"("y":{"label":"share","low":0.0,"high":null,"names":[]},"series":[{"name":"am3",)"
      R"("kind":"line","x":[0.0,1.0,2.0],"y":[1.0,null,0.5],"colour":6,"dash":1,"width":1.0}]})");
}

TEST(Style, PageAndFigureHaveTheSameDashes) {
  EXPECT_NE(styles_json().find(R"("dashes":[[],[7,3],[2,3]])"), std::string::npos);
  const std::string script = gnuplot_script({line_with_gap()}, "p", "png", 9);
  EXPECT_NE(script.find("dt (7,3) lc rgb '#5d3a9b'"), std::string::npos) << script;
  EXPECT_EQ(dash_of(5), 0u);
  EXPECT_EQ(dash_of(6), 1u);
  EXPECT_EQ(dash_of(17), 2u);
}

TEST(Gnuplot, RejectsUnknownFormat) { EXPECT_THROW(check_gnuplot("bmp"), Error); }

// gnuplot's SVG states each line's colour and points: a horizontal line at half of the range lies
// halfway between the lines at the ends of the range.
TEST(Gnuplot, DrawsLinesInTheirColoursAtTheirPlaces) {
  if (std::system("command -v gnuplot > /dev/null 2>&1") != 0) GTEST_SKIP() << "no gnuplot";
  Plot plot{.y = {.label = "y", .low = 0, .high = 1}, .legend = false};
  for (const std::size_t k : {0u, 1u, 2u})
    plot.series.push_back({.name = "it's <" + std::to_string(k),
                           .x = {0, 1},
                           .y = {0.25 * (1.0 + double(k)), 0.25 * (1.0 + double(k))},
                           .colour = k});
  const fs::path folder = fs::path(testing::TempDir()) / "plot_test";
  fs::create_directories(folder);
  draw({plot, plot}, folder, "p", "svg", 9);
  std::ostringstream text;
  text << std::ifstream(folder / "p.svg").rdbuf();
  const std::string svg = text.str();
  // The heights of the lines of this colour, one for each panel from the top.
  const auto height_of = [&](std::size_t k) {
    const Colour c = colour_of(k);
    char rgb[64];
    std::snprintf(rgb, sizeof rgb, "<path stroke='rgb(%3d, %3d, %3d)'", c[0], c[1], c[2]);
    std::vector<double> heights;
    for (std::size_t at = svg.find(rgb); at != std::string::npos; at = svg.find(rgb, at + 1)) {
      const std::size_t path = svg.find("d='M", at);
      if (path == std::string::npos) break;
      const std::size_t comma = svg.find(',', path);
      heights.push_back(std::strtod(svg.c_str() + comma + 1, nullptr));
    }
    return heights;
  };
  const auto low = height_of(0);
  const auto middle = height_of(1);
  const auto high = height_of(2);
  ASSERT_EQ(low.size(), 2u);
  ASSERT_EQ(middle.size(), 2u);
  ASSERT_EQ(high.size(), 2u);
  for (const std::size_t panel : {0u, 1u}) {
    EXPECT_GT(low[panel], high[panel] + 20);
    EXPECT_NEAR(middle[panel], (low[panel] + high[panel]) / 2, 0.02);
  }
  EXPECT_GT(high[1], low[0]);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace airtruth::plot
