// SPDX-License-Identifier: Apache-2.0
#include "show/plot/plot.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace airtruth::plot {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(Mark mark) {
  switch (mark) {
    case Mark::kLine:
      return "line";
    case Mark::kLineAndPoints:
      return "line and points";
    case Mark::kBars:
      return "bars";
    case Mark::kDots:
      return "dots";
    default:
      return "points";
  }
}

// In px, for a line of usual width.
Json dash_json(Dash dash) {
  if (dash == Dash::kLong) return {7, 3};
  if (dash == Dash::kShort) return {2, 3};
  return Json::array();
}

Json numbers(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(std::isfinite(value) ? Json(value) : Json());
  return json;
}

Json axis_json(const Axis& axis) {
  return {{"label", axis.label},
          {"min", axis.min ? Json(*axis.min) : Json()},
          {"max", axis.max ? Json(*axis.max) : Json()},
          {"names", axis.names},
          {"logarithmic", axis.is_logarithmic}};
}

Json series_json(const Series& series) {
  return {{"name", series.name},
          {"mark", name_of(series.mark)},
          {"style", json_of(series.style)},
          {"x", numbers(series.x)},
          {"y", numbers(series.y)},
          {"low", numbers(series.low)},
          {"high", numbers(series.high)},
          {"hollow", series.is_hollow}};
}

}  // namespace

Style style_of(std::size_t index) {
  // Number of the colours that everyone can distinguish (kColours).
  constexpr std::size_t kColoursOfOneDash = 6;
  const std::size_t dash = index / kColoursOfOneDash;
  return {kColours[index % kColours.size()],
          dash == 0   ? Dash::kSolid
          : dash == 1 ? Dash::kLong
                      : Dash::kShort};
}

std::string name_of_bin(double from, double to) {
  if (!std::isfinite(to)) return fmt::format("≥ {}", from);
  if (!std::isfinite(from)) return fmt::format("< {}", to);
  // A dash beside a minus sign is hard to read.
  return fmt::format(fmt::runtime(from < 0 ? "{} to {}" : "{}–{}"), from, to);
}

Json json_of(const Style& style) {
  const Colour& c = style.colour;
  return {{"colour", c == kInk ? "ink" : fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2])},
          {"dash", dash_json(style.dash)},
          {"width", style.width}};
}

Json json_of(const Plot& plot) {
  Json series = Json::array();
  for (const Series& one : plot.series) series.push_back(series_json(one));
  return {{"title", plot.title},
          {"x", axis_json(plot.x)},
          {"y", axis_json(plot.y)},
          {"series", series}};
}

}  // namespace airtruth::plot
