// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/plot.h"

#include <algorithm>

#include <fmt/format.h>

namespace airtruth::camera_file {
namespace {

using plot::Plot;
using plot::Series;

constexpr plot::Style kMeasured{plot::kColours[0]}, kFitted{plot::kColours[2]};

Plot or_not_measured(Plot plot, bool is_measured) {
  if (!is_measured) plot.title += ": not measured";
  return plot;
}

Plot noise_plot(const std::vector<sensor::NoisePoint>& points) {
  Plot plot{.title = "noise of luma",
            .x = {.label = "luma, 0 to 1", .min = 0, .max = 1},
            .y = {.label = "standard deviation, code values", .min = 0}};
  Series measured{.mark = plot::Mark::kPoints, .style = kMeasured};
  for (const sensor::NoisePoint& p : points) measured.add(p.luma, p.sigma_codes);
  if (!points.empty()) plot.series.push_back(std::move(measured));
  return or_not_measured(std::move(plot), !points.empty());
}

// Heights beyond the axis are drawn at its end.
Plot edge_plot(const optics::EdgeProfile& edge) {
  // Ends of the axis, in heights of the step: room for what sharpening adds below 0 and above 1.
  constexpr double kLowest = -0.3, kHighest = 1.3;
  Plot plot{.title = "step across sharp edges",
            .x = {.label = "px", .min = -6, .max = 6},
            .y = {.label = "height", .min = kLowest, .max = kHighest}};
  if (edge.edges == 0) return or_not_measured(std::move(plot), false);
  plot.title = fmt::format(
      "step across {} sharp edges: {:.2f} px from 10 to 90 %", edge.edges, edge.spread_px);
  Series measured{.name = "measured", .mark = plot::Mark::kPoints, .style = kMeasured};
  measured.x = edge.place_px;
  for (const double height : edge.height)
    measured.y.push_back(std::clamp(height, kLowest, kHighest));
  plot.series.push_back(std::move(measured));
  plot.series.push_back({.name = "fitted", .style = kFitted, .x = edge.place_px, .y = edge.fitted});
  return plot;
}

Plot horizon_plot(const Calibration& c) {
  Plot plot{.title = "horizon",
            .x = {.label = "frame", .min = 0, .max = std::max(1.0, double(c.frames))},
            .y = {.label = "degrees"}};
  Series pitch{.name = "pitch", .mark = plot::Mark::kPoints, .style = plot::style_of(0)};
  Series roll{.name = "roll", .mark = plot::Mark::kPoints, .style = plot::style_of(2)};
  for (const HorizonAttitude& h : c.horizons) {
    pitch.add(double(h.frame), h.pitch_deg);
    roll.add(double(h.frame), h.roll_deg);
  }
  if (!c.horizons.empty()) plot.series = {std::move(pitch), std::move(roll)};
  return or_not_measured(std::move(plot), !c.horizons.empty());
}

Plot sky_plot(const Calibration& c) {
  Plot plot{.title = c.sky_picture ? "sky, tinted red" : "sky: no horizon found"};
  plot.picture = c.sky_picture ? &*c.sky_picture : nullptr;
  return plot;
}

}  // namespace

std::vector<Plot> plots_of(const Calibration& c) {
  return {noise_plot(c.noise), edge_plot(c.edge), horizon_plot(c), sky_plot(c)};
}

}  // namespace airtruth::camera_file
