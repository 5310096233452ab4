// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <string>

// How a model is read: the state of the aircraft that its animations show, and the axes of a file
// that states none.
namespace airtruth::aircraft {

// The axes of a model file without a wrapper, relative to those of the body, and its unit.
struct ModelAxes {
  std::string forward =
      "-x";  // one of x, y, z with an optional minus; as FlightGear's .ac files: nose at -x
  std::string up = "y";  // the same
  double scale = 1;      // metres per unit
};

struct LoadOptions {
  double airspeed_kt = 250;  // decides `select` conditions: gear is up above its speed
  double altitude_agl_ft = 3000;
  // Of a catalogue name: the factor on its model's own size; empty: the one that brings it to the
  // published size of its type (scale.h). Error when given for a model file.
  std::optional<double> catalogue_scale;
  std::optional<ModelAxes> axes;  // for a bare model file; Error when given for a catalogue name
  std::stop_token stop;           // ends the reading of a model file
};

}  // namespace airtruth::aircraft
