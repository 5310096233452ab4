// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "show/plot/plot.h"

namespace airtruth::plot {

// A plot as a page's script reads it (drawPlot in show/html/assets/common.js): title, x and y with
// label, min, max, names and logarithmic, and series with name, mark, style, x, y, low and high.
// Values that are not finite are null. Pages draw lines, points and bars with their bounds;
// horizontal intervals, triangles, bands of x and pictures are for files alone.
nlohmann::ordered_json json_of(const Plot& plot);

// A style as {"colour": "#0072b2", "dash": [7, 3], "width": 1}: dashes are in px for a line of
// usual width, and the colour of truth is "ink".
nlohmann::ordered_json json_of(const Style& style);

}  // namespace airtruth::plot
