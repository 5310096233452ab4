// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <nlohmann/json.hpp>

#include "show/plot/plot.h"

namespace airtruth::plot {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(const auto& value) { return value ? Json(*value) : Json(); }

Json axis_json(const Axis& axis) {
  return {{"label", axis.label},
          {"low", or_null(axis.low)},
          {"high", or_null(axis.high)},
          {"names", axis.names}};
}

}  // namespace

Json to_json(const Plot& plot) {
  constexpr std::array<const char*, 4> kKinds = {"line", "line-with-points", "points", "bars"};
  Json series = Json::array();
  for (const Series& one : plot.series)
    series.push_back({{"name", one.name},
                      {"kind", kKinds[static_cast<std::size_t>(one.kind)]},
                      {"x", one.x},
                      {"y", one.y},
                      {"colour", or_null(one.colour)},
                      {"dash", one.dash},
                      {"width", one.width}});
  return {{"title", plot.title},
          {"x", axis_json(plot.x)},
          {"y", axis_json(plot.y)},
          {"series", series}};
}

}  // namespace airtruth::plot
