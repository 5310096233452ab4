// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "aircraft/model/mesh.h"
#include "foundation/base/names.h"

// Meshes of what a detector may take for an aircraft, made in code from a few numbers. Body
// coordinates: x forward, y right, z down; metres; the origin is the middle of the body.
//
// Example: bird({.span_m = 1.34}) is a herring gull: 0.58 m long, 3.05 strokes a second. Its wings
// are parts with hinges at the shoulder and at the wrist, so that any moment of a stroke has its
// own exact pose (body_from_part).
namespace airtruth::shapes {

enum class Plumage { kGull, kDark, kBrown, kGrey };

constexpr auto enum_names(Plumage) {
  return std::to_array<EnumName<Plumage>>({{Plumage::kGull, "gull"},
                                           {Plumage::kDark, "dark"},
                                           {Plumage::kBrown, "brown"},
                                           {Plumage::kGrey, "grey"}});
}

struct BirdShape {
  double span_m = 1.3;
  // Span squared over the wings' area: a gull has 9.6, a pigeon 7, an eagle 6.5.
  double aspect_ratio = 8;
  Plumage plumage = Plumage::kGull;
  double strokes_per_s = 3;
  // Strokes done at the time 0.
  double phase_strokes = 0;
  // Share of the time spent gliding; 1: it soars.
  double glide = 0.3;
  bool operator==(const BirdShape&) const = default;
};
model::Mesh bird(const BirdShape& shape);

// The stroke rate of a bird of this span: 3.05 Hz at 1.34 m, a herring gull in cruise, and with
// span^-1/2 for birds of one shape (Pennycuick 1996, "Wingbeat frequency of birds in steady
// cruising flight", equation 9, with mass as span^3 and area as span^2).
double usual_strokes_per_s(double span_m);

// Multirotors below this size stand on a leg under each motor (DJI F450, Hubsan H501), larger ones
// on skids (DJI S900: 0.9 m): their meshes have other triangles.
constexpr double kLeastWithSkidsM = 0.6;

struct MultirotorShape {
  // Between the axes of opposite rotors.
  double size_m = 0.4;
  int rotors = 4;  // 4, 6 or 8
  // Linear RGB of its shell, and of its arms.
  std::array<double, 3> colour = {0.05, 0.05, 0.055};
  std::array<double, 3> arm_colour = {0.05, 0.05, 0.055};
  bool operator==(const MultirotorShape&) const = default;
};
// Arms, motors, a shell with a camera below, legs or landing skids, lights that are red in front
// and green behind, and two-bladed rotors whose tips move at kRotorTipMps.
model::Mesh multirotor(const MultirotorShape& shape);
// The speed of a rotor's tips: a choice.
constexpr double kRotorTipMps = 60;

struct BalloonShape {
  // Largest diameter of its envelope; the height is 1.25 times that, with the knot.
  double size_m = 0.3;
  std::array<double, 3> colour = {0.5, 0.02, 0.02};  // linear RGB
  bool operator==(const BalloonShape&) const = default;
};
model::Mesh balloon(const BalloonShape& shape);

}  // namespace airtruth::shapes
