// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "aircraft/shapes/shapes.h"
#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/geometry/transform.h"

// [[distractor]]: what a detector may take for an aircraft. Birds, multirotors and balloons fly in
// the world and are intruders of another class; glints, dirt and insects are on the lens.
namespace airtruth::scene {

enum class DistractorKind { kBird, kMultirotor, kBalloon, kGlint, kDirt, kInsect };

// The words are also the classes of the truth (labels/annotation/object_class.h).
constexpr auto enum_names(DistractorKind) {
  return std::to_array<EnumName<DistractorKind>>({{DistractorKind::kBird, "bird"},
                                                  {DistractorKind::kMultirotor, "multirotor"},
                                                  {DistractorKind::kBalloon, "balloon"},
                                                  {DistractorKind::kGlint, "glint"},
                                                  {DistractorKind::kDirt, "dirt"},
                                                  {DistractorKind::kInsect, "insect"}});
}

constexpr bool is_on_lens(DistractorKind kind) {
  return kind == DistractorKind::kGlint || kind == DistractorKind::kDirt ||
         kind == DistractorKind::kInsect;
}

// What a distractor in the air is. Each field is a key of the table.
struct Distractor {
  DistractorKind kind = DistractorKind::kBird;
  // A bird's span, the distance between opposite rotors, a balloon's diameter.
  double size_m = 1;
  // Birds (shapes::BirdShape).
  shapes::Plumage plumage = shapes::Plumage::kGull;
  double aspect_ratio = 8;
  double flap_hz = 3;
  double flap_phase = 0;
  double glide = 0.3;
  // Multirotors.
  int rotors = 4;
  std::array<double, 3> arm_colour = {0.05, 0.05, 0.055};
  // Multirotors and balloons; linear RGB.
  std::array<double, 3> colour = {0.05, 0.05, 0.055};

  bool operator==(const Distractor&) const = default;
};

// A distractor of this kind and size with the usual values of all else.
Distractor usual_distractor(DistractorKind kind, double size_m);
// A gull, a camera drone, a party balloon.
double usual_size_m(DistractorKind kind);

// A spot on the lens or in it. Each field is a key of the table.
struct LensMark {
  std::string id;
  DistractorKind kind = DistractorKind::kDirt;
  // The spot's middle at begin_s. Empty for a glint that follows the sun.
  std::optional<Pixel> pixel;
  // Of a glint that follows the sun: its place on the line from the image's centre (0) to the sun
  // (1). Reflections within a lens lie beyond the centre, at negative values.
  double along = -0.6;
  Pixel velocity_px_s = Pixel::Zero();
  // Diameter, and the length along the velocity; a round spot has both equal.
  double size_px = 60;
  double length_px = 60;
  // Share of the radius over which it fades: 0 has a sharp rim, 1 fades from its middle on.
  double softness = 0.6;
  // Alpha in the middle. A glint's is the share of white light that it adds.
  double opacity = 0.4;
  std::array<double, 3> colour = {0.02, 0.02, 0.02};  // linear RGB
  // In seconds of the clip; it is there from begin_s to end_s.
  double begin_s = 0;
  std::optional<double> end_s;
  Where where;
};

// A mark of this kind with the usual values.
LensMark usual_mark(DistractorKind kind);

}  // namespace airtruth::scene
