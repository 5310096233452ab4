// SPDX-License-Identifier: Apache-2.0
#include "show/plot/style.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace airtruth::plot {

namespace {
constexpr std::size_t kSeriesPerDash = 6;  // as many colours as are distinguishable by themselves
}  // namespace

Colour colour_of(std::size_t series) { return kColours[series % kColours.size()]; }

std::size_t dash_of(std::size_t series) {
  return std::min(kDashes.size() - 1, series / kSeriesPerDash);
}

std::string hex(const Colour& c) { return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]); }

std::string styles_json() {
  nlohmann::ordered_json styles = {{"colours", nlohmann::ordered_json::array()},
                                   {"dashes", nlohmann::ordered_json::array()}};
  for (const Colour& colour : kColours) styles["colours"].push_back(hex(colour));
  for (const Dash& dash : kDashes)
    styles["dashes"].push_back(dash.on > 0 ? nlohmann::ordered_json{dash.on, dash.off}
                                           : nlohmann::ordered_json::array());
  return styles.dump();
}

}  // namespace airtruth::plot
