// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "aircraft/shapes/mesh_builder.h"
#include "aircraft/shapes/shapes.h"
#include "foundation/base/error.h"

namespace airtruth::aircraft {
namespace {

using Colour = std::array<float, 3>;
using V = Eigen::Vector3f;

// Linear RGB of the parts of a plumage.
struct Feathers {
  Colour back, belly, wing_above, wing_below, tip, tail, beak;
};

Feathers feathers_of(Plumage plumage) {
  switch (plumage) {
    case Plumage::kGull:
      return {{0.55f, 0.56f, 0.58f},
              {0.72f, 0.72f, 0.70f},
              {0.30f, 0.32f, 0.35f},
              {0.62f, 0.62f, 0.61f},
              {0.05f, 0.05f, 0.05f},
              {0.70f, 0.70f, 0.68f},
              {0.60f, 0.38f, 0.05f}};
    case Plumage::kDark:
      return {{0.016f, 0.016f, 0.018f},
              {0.018f, 0.018f, 0.019f},
              {0.016f, 0.016f, 0.018f},
              {0.026f, 0.026f, 0.028f},
              {0.014f, 0.014f, 0.015f},
              {0.015f, 0.015f, 0.016f},
              {0.02f, 0.02f, 0.02f}};
    case Plumage::kBrown:
      return {{0.075f, 0.050f, 0.032f},
              {0.16f, 0.115f, 0.075f},
              {0.070f, 0.047f, 0.030f},
              {0.19f, 0.15f, 0.11f},
              {0.025f, 0.020f, 0.016f},
              {0.11f, 0.075f, 0.050f},
              {0.08f, 0.07f, 0.03f}};
    case Plumage::kGrey:
      break;
  }
  return {{0.15f, 0.17f, 0.20f},
          {0.18f, 0.19f, 0.21f},
          {0.22f, 0.24f, 0.26f},
          {0.35f, 0.36f, 0.37f},
          {0.08f, 0.09f, 0.10f},
          {0.14f, 0.15f, 0.17f},
          {0.05f, 0.05f, 0.05f}};
}

// How stout a bird of a plumage is: factors on the trunk's length and thickness, which below are a
// herring gull's.
struct Build {
  float length, thickness;
};

// The trunk's radius is that of its frontal area: 0.00813 m^0.666 (Pennycuick et al. 1988), of
// passerines 0.0129 m^0.614 (Hedenstroem and Rosen 2003, "Body frontal area in passerine birds"),
// in m^2 for a mass in kg. As shares of the span: herring gull of 1 kg and 1.34 m 0.038, carrion
// crow of 0.55 kg and 0.93 m 0.057, common buzzard of 0.9 kg and 1.25 m 0.039, rock dove of 0.33 kg
// and 0.65 m 0.054. Lengths over spans: 0.44, 0.50, 0.44 and 0.50 (Svensson et al. 2009).
Build build_of(Plumage plumage) {
  switch (plumage) {
    case Plumage::kDark:
      return {1.15f, 1.50f};
    case Plumage::kGrey:
      return {1.14f, 1.42f};
    case Plumage::kGull:
    case Plumage::kBrown:
      break;
  }
  return {1, 1};
}

// Lengths below are shares of the span. Shoulder and wrist, out from the middle and forward.
constexpr float kShoulderOut = 0.030f;
constexpr float kWristOut = 0.205f;
constexpr float kTipOut = 0.5f;
constexpr float kShoulderAhead = 0.035f;
constexpr float kHingesAbove = 0.012f;  // of the body's axis
// Angles of the wings, in radians: raised in a glide, and the stroke about it.
constexpr float kGlideRaised = 0.12f;
constexpr float kGlideWrist = -0.10f;
constexpr float kStroke = 0.62f;
constexpr float kWristStroke = 0.40f;
// The hand follows the arm.
constexpr float kWristLag = 0.18f;

// A section of the wing in shares of the span; chords in shares of the mean chord.
struct Section {
  float out, leading_ahead, chord, thickness;
};
constexpr std::array<Section, 4> kArm = {{{kShoulderOut, 0.036f, 1.30f, 0.16f},
                                          {0.09f, 0.050f, 1.32f, 0.13f},
                                          {0.15f, 0.066f, 1.27f, 0.10f},
                                          {kWristOut, 0.072f, 1.18f, 0.07f}}};
constexpr std::array<Section, 5> kHand = {{{kWristOut, 0.072f, 1.18f, 0.07f},
                                           {0.29f, 0.058f, 1.02f, 0.06f},
                                           {0.38f, 0.030f, 0.80f, 0.05f},
                                           {0.45f, 0.000f, 0.50f, 0.05f},
                                           {kTipOut, -0.030f, 0.12f, 0.05f}}};

std::vector<Rib> ribs_of(std::span<const Section> sections, float span, float chord, float side) {
  std::vector<Rib> ribs;
  for (const Section& section : sections) {
    const float of_rib = section.chord * chord;
    const V leading(section.leading_ahead * span, side * section.out * span, -kHingesAbove * span);
    ribs.push_back({leading, leading - V(of_rib, 0, 0), section.thickness * of_rib});
  }
  return ribs;
}

// A positive turn about x lowers the right wing and raises the left one.
Hinge hinge_at(const V& centre, float side, float rest_rad, float amplitude_rad, float lag) {
  return {V(1, 0, 0), centre, -side * rest_rad, -side * amplitude_rad, lag};
}

struct WingMaterials {
  std::uint32_t above, below, tip_above, tip_below;
};

void add_wing(MeshBuilder& builder,
              const BirdShape& shape,
              float side,
              const WingMaterials& material) {
  const auto span = static_cast<float>(shape.span_m);
  const float chord = span / static_cast<float>(shape.aspect_ratio);
  const Hinge shoulder =
      hinge_at(V(kShoulderAhead * span, side * kShoulderOut * span, -kHingesAbove * span),
               side,
               kGlideRaised,
               kStroke,
               0);
  const Hinge wrist =
      hinge_at(V(kShoulderAhead * span, side * kWristOut * span, -kHingesAbove * span),
               side,
               kGlideWrist,
               kWristStroke,
               kWristLag);
  Part part;
  part.name = side > 0 ? "right arm" : "left arm";
  part.centre_in_body = shoulder.centre_in_body;
  part.beat = {shape.strokes_per_s, shape.phase_strokes, shape.glide};
  part.hinges = {shoulder};
  builder.begin_part(part);
  builder.add_wing(ribs_of(kArm, span, chord, side), material.above, material.below);
  part.name = side > 0 ? "right hand" : "left hand";
  part.hinges = {shoulder, wrist};
  builder.begin_part(part);
  const std::vector<Rib> hand = ribs_of(kHand, span, chord, side);
  builder.add_wing({hand.begin(), hand.begin() + 3}, material.above, material.below);
  builder.add_wing({hand.begin() + 2, hand.end()}, material.tip_above, material.tip_below);
}

// The body from beak to tail, and the tail's fan.
void add_trunk(MeshBuilder& builder, float span, const Build& build, const Feathers& feathers) {
  const auto at = [&](float ahead, float out, float below) -> V {
    return V(build.length * ahead, build.thickness * out, build.thickness * below) * span;
  };
  const auto ring = [&](float ahead, float half_width, float half_height, float below) {
    return Ring{at(ahead, 0, below),
                build.thickness * half_width * span,
                build.thickness * half_height * span};
  };
  const std::uint32_t belly = builder.add_material(feathers.belly);
  const std::uint32_t back = builder.add_material(feathers.back);
  const std::uint32_t beak = builder.add_material(feathers.beak);
  const std::uint32_t tail = builder.add_material(feathers.tail);
  constexpr int kSides = 12;
  builder.begin_part({"body", {}});
  const std::array<Ring, 9> rings = {ring(0.175f, 0.008f, 0.008f, -0.004f),
                                     ring(0.160f, 0.020f, 0.020f, -0.006f),
                                     ring(0.138f, 0.024f, 0.024f, -0.006f),
                                     ring(0.110f, 0.025f, 0.026f, -0.003f),
                                     ring(0.060f, 0.035f, 0.035f, 0.002f),
                                     ring(0.010f, 0.038f, 0.038f, 0.005f),
                                     ring(-0.060f, 0.034f, 0.031f, 0.004f),
                                     ring(-0.120f, 0.022f, 0.019f, 0.001f),
                                     ring(-0.160f, 0.012f, 0.007f, 0)};
  builder.add_body(rings, V(0, 1, 0), V(0, 0, 1), kSides, belly);
  // The mantle: a slightly larger half shell above the wings' roots.
  const std::array<Rib, 5> mantle = {
      Rib{at(0.100f, -0.030f, -0.014f), at(-0.115f, -0.012f, -0.012f), 0.01f * span},
      Rib{at(0.112f, -0.016f, -0.027f), at(-0.125f, -0.008f, -0.018f), 0.02f * span},
      Rib{at(0.114f, 0, -0.031f), at(-0.130f, 0, -0.020f), 0.022f * span},
      Rib{at(0.112f, 0.016f, -0.027f), at(-0.125f, 0.008f, -0.018f), 0.02f * span},
      Rib{at(0.100f, 0.030f, -0.014f), at(-0.115f, 0.012f, -0.012f), 0.01f * span}};
  builder.add_wing(mantle, back, back);
  const std::array<Ring, 2> bill = {ring(0.170f, 0.008f, 0.009f, -0.004f),
                                    ring(0.208f, 0.001f, 0.002f, 0.001f)};
  builder.add_body(bill, V(0, 1, 0), V(0, 0, 1), 8, beak);
  const std::array<Rib, 5> fan = {
      Rib{at(-0.125f, -0.016f, 0), at(-0.215f, -0.052f, 0), 0.004f * span},
      Rib{at(-0.125f, -0.008f, 0), at(-0.226f, -0.026f, 0), 0.005f * span},
      Rib{at(-0.125f, 0, 0), at(-0.230f, 0, 0), 0.006f * span},
      Rib{at(-0.125f, 0.008f, 0), at(-0.226f, 0.026f, 0), 0.005f * span},
      Rib{at(-0.125f, 0.016f, 0), at(-0.215f, 0.052f, 0), 0.004f * span}};
  builder.add_wing(fan, tail, tail);
}

}  // namespace

double usual_strokes_per_s(double span_m) {
  constexpr double kGullHz = 3.05;
  constexpr double kGullSpanM = 1.34;
  return kGullHz * std::sqrt(kGullSpanM / span_m);
}

Mesh bird(const BirdShape& shape) {
  check(shape.span_m > 0 && shape.aspect_ratio > 0, "a bird has a span and wings");
  const Feathers feathers = feathers_of(shape.plumage);
  MeshBuilder builder;
  add_trunk(builder, static_cast<float>(shape.span_m), build_of(shape.plumage), feathers);
  const WingMaterials materials{builder.add_material(feathers.wing_above),
                                builder.add_material(feathers.wing_below),
                                builder.add_material(feathers.tip),
                                builder.add_material(feathers.tip)};
  for (const float side : {1.0f, -1.0f}) add_wing(builder, shape, side, materials);
  return builder.take();
}

}  // namespace airtruth::aircraft
