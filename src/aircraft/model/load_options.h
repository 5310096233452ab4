// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <string>

// How a model is read: the state of the aircraft that its animations show, and the axes of a file
// that states none.
namespace airtruth::model {

// The axes of a model file without a wrapper, relative to those of the body, and its unit.
struct ModelAxes {
  std::string forward =
      "-x";  // one of x, y, z with an optional minus; as FlightGear's .ac files: nose at -x
  std::string up = "y";  // the same
  double scale = 1;      // metres per unit
};
// The axes with what is stated of them: "" and 0 state nothing. Empty where nothing is stated.
inline std::optional<ModelAxes> stated_axes(const std::string& forward,
                                            const std::string& up,
                                            double scale) {
  if (forward.empty() && up.empty() && scale == 0) return std::nullopt;
  ModelAxes axes;
  if (!forward.empty()) axes.forward = forward;
  if (!up.empty()) axes.up = up;
  if (scale != 0) axes.scale = scale;
  return axes;
}

struct LoadOptions {
  double airspeed_kt = 250;  // decides `select` conditions: gear is up above its speed
  double altitude_agl_ft = 3000;
  // For a catalogue name: the factor on the size of its model. Where it is empty, the model is
  // scaled to the published size of its type (scale.h). A value for a model file is an Error.
  std::optional<double> catalogue_scale;
  std::optional<ModelAxes> axes;  // for a bare model file; Error when given for a catalogue name
  std::stop_token stop;           // ends the reading of a model file
};

}  // namespace airtruth::model
