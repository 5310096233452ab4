// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"

// Flights as seen from above and from the side, for people who look for a good encounter.
namespace airtruth::drawing {

// One aircraft's path at equal steps of time, with marks at whole seconds.
struct FlightLine {
  std::string name;
  cv::Scalar colour;
  std::vector<double> times_s;           // increasing
  std::vector<Vector3> positions_ned_m;  // one for each time
};

// The paths from above: north is up and both axes have the same scale. A dot marks each whole
// second, and a thin line joins the first path with every other one at the same second. `cone_deg`:
// the horizontal view of the first aircraft's camera around `heading_deg`, drawn at its start.
image::Rgb8 plan_view(const std::vector<FlightLine>& lines,
                      double heading_deg,
                      double cone_deg,
                      int width,
                      int height);

// Height above the origin over time.
image::Rgb8 height_view(const std::vector<FlightLine>& lines, int width, int height);

// Rows of cells under a heading, each column as wide as its widest cell. The colour of a row is
// that of its aircraft.
struct TableRow {
  cv::Scalar colour;
  std::vector<std::string> cells;
};
image::Rgb8 table_picture(const std::vector<std::string>& heading,
                          const std::vector<TableRow>& rows,
                          int width);

}  // namespace airtruth::drawing
