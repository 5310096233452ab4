// SPDX-License-Identifier: Apache-2.0
#include "show/motion_plot/motion_plot.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "foundation/geometry/within_frame.h"

namespace airtruth::motion_plot {
namespace {

using motion::FrameMotion;
using motion::State;
using plot::Plot;
using plot::Series;

constexpr plot::Colour kCutColour = {250, 190, 190}, kUnmeasuredColour = {255, 228, 190};

// A quantity with one value for each frame.
struct Quantity {
  std::string name;
  std::vector<double> values;
};

// Consecutive frames of one colour are one band.
std::vector<plot::Band> unmeasured_bands(const std::vector<FrameMotion>& motion) {
  std::vector<plot::Band> bands;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (is_known(motion[i].state)) continue;
    const plot::Colour colour = motion[i].state == State::kCut ? kCutColour : kUnmeasuredColour;
    const double from = static_cast<double>(i) - 0.5;
    if (!bands.empty() && bands.back().to == from && bands.back().colour == colour)
      bands.back().to = from + 1;
    else
      bands.push_back({from, from + 1, colour});
  }
  return bands;
}

struct Limits {
  double low = 0;
  double high = 1;
};

// The axis holds 0 and what the middle 98 % of the values span. It is widened by up to the same
// span on either side where values lie there.
Limits limits_of(const std::vector<Quantity>& quantities) {
  constexpr double kTailShare = 0.01;  // on each side
  // Room beyond the values, as a share of the axis.
  constexpr double kMarginShare = 0.06;
  std::vector<double> values;
  for (const Quantity& q : quantities)
    for (const double v : q.values)
      if (std::isfinite(v)) values.push_back(v);
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto tail = static_cast<std::size_t>(kTailShare * static_cast<double>(values.size()));
  const double low = std::min(0.0, values[tail]);
  const double high = std::max(0.0, values[values.size() - 1 - tail]);
  const double span = high - low;
  Limits limits{std::min(low, std::max(values.front(), low - span)),
                std::max(high, std::min(values.back(), high + span))};
  if (limits.high - limits.low < 1e-6) limits.high = limits.low + 1;
  const double margin = kMarginShare * (limits.high - limits.low);
  if (limits.low < 0) limits.low -= margin;
  limits.high += margin;
  return limits;
}

// Adds the line of a quantity, and the triangles of its values beyond the axis. Returns the number
// of these.
std::size_t add_series(const Quantity& q, std::size_t index, const Limits& limits, Plot& plot) {
  Series line{.name = q.name, .style = plot::style_of(index)};
  Series above{.mark = plot::Mark::kAbove, .style = line.style};
  Series below{.mark = plot::Mark::kBelow, .style = line.style};
  for (std::size_t i = 0; i < q.values.size(); ++i) {
    const double v = q.values[i];
    const bool is_above = v > limits.high, is_below = !is_above && !(v >= limits.low);
    line.add(static_cast<double>(i), is_above ? limits.high : is_below ? limits.low : v);
    if (is_above || is_below) (is_above ? above : below).add(line.x.back(), line.y.back());
  }
  const std::size_t beyond = above.x.size() + below.x.size();
  for (Series* series : {&line, &above, &below})
    if (!series->x.empty()) plot.series.push_back(std::move(*series));
  return beyond;
}

Plot plot_of(const std::vector<Quantity>& quantities,
             const std::string& unit,
             const std::vector<plot::Band>& bands) {
  const Limits limits = limits_of(quantities);
  const double last =
      static_cast<double>(std::max<std::size_t>(2, quantities[0].values.size())) - 1;
  Plot plot{.x = {.min = 0, .max = last},
            .y = {.label = unit, .min = limits.low, .max = limits.high},
            .bands = bands};
  std::size_t beyond = 0;
  for (std::size_t k = 0; k < quantities.size(); ++k)
    beyond += add_series(quantities[k], k, limits, plot);
  if (beyond > 0) plot.title = std::to_string(beyond) + " off the scale";
  return plot;
}

struct Moved {
  Quantity x, y, turn;
};

// Yaw to the right, pitch upwards and roll clockwise of the camera, degrees.
Moved moved_by_rotation(const std::vector<FrameMotion>& motion) {
  Moved moved{{"yaw", {}}, {"pitch", {}}, {"roll", {}}};
  for (const FrameMotion& m : motion) {
    const Vector3 turned = vector_from_rotation(m.rotation->conjugate());
    moved.x.values.push_back(degrees(turned.y()));
    moved.y.values.push_back(degrees(turned.x()));
    moved.turn.values.push_back(degrees(turned.z()));
  }
  return moved;
}

Moved moved_by_homography(const std::vector<FrameMotion>& motion, const Pixel& centre) {
  Moved result{{"centre, x", {}}, {"centre, y", {}}, {"rotation", {}}};
  for (const FrameMotion& m : motion) {
    const Pixel moved = apply(m.frame_from_reference, centre);
    const Pixel right = apply(m.frame_from_reference, centre + Pixel(1, 0)) - moved;
    result.x.values.push_back(moved.x() - centre.x());
    result.y.values.push_back(moved.y() - centre.y());
    result.turn.values.push_back(degrees(std::atan2(right.y(), right.x())));
  }
  return result;
}

}  // namespace

std::vector<Plot> plots_of(const std::vector<FrameMotion>& motion, int width, int height) {
  const bool is_rotation = !motion.empty() && motion.front().rotation;
  const Moved moved = is_rotation ? moved_by_rotation(motion)
                                  : moved_by_homography(motion, {width / 2.0, height / 2.0});
  Quantity rms{"rms of the inliers", {}}, inliers{"inliers", {}};
  for (const FrameMotion& m : motion) {
    rms.values.push_back(m.rms_px);
    inliers.values.push_back(m.inliers);
  }
  const std::vector<plot::Band> bands = unmeasured_bands(motion);
  std::vector<Plot> plots = {plot_of({moved.x, moved.y}, is_rotation ? "degrees" : "px", bands),
                             plot_of({moved.turn}, "degrees", bands),
                             plot_of({rms}, "px", bands),
                             plot_of({inliers}, "corners", bands)};
  plots.back().x.label = "frame (shaded: not measured; red: cut)";
  return plots;
}

}  // namespace airtruth::motion_plot
