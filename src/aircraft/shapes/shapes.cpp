// SPDX-License-Identifier: Apache-2.0
#include "aircraft/shapes/shapes.h"

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "aircraft/shapes/mesh_builder.h"
#include "foundation/base/error.h"

namespace airtruth::shapes {
namespace {

using Colour = std::array<float, 3>;
using V = Eigen::Vector3f;

// What a plumage decides: linear RGB of its parts, and how stout the bird is, as factors on the
// trunk's length and thickness, which below are a herring gull's.
//
// The trunk's radius is that of its frontal area: 0.00813 m^0.666 (Pennycuick et al. 1988), of
// passerines 0.0129 m^0.614 (Hedenstroem and Rosen 2003, "Body frontal area in passerine birds"),
// in m^2 for a mass in kg. As shares of the span: herring gull of 1 kg and 1.34 m 0.038, carrion
// crow of 0.55 kg and 0.93 m 0.057, common buzzard of 0.9 kg and 1.25 m 0.039, rock dove of 0.33 kg
// and 0.65 m 0.054. Lengths over spans: 0.44, 0.50, 0.44 and 0.50 (Svensson et al. 2009).
struct Feathers {
  Colour back, belly, wing_above, wing_below, tip, tail, beak;
  float length = 1, thickness = 1;
};
// By Plumage: gull, dark, brown, grey.
constexpr std::array<Feathers, 4> kFeathers = {{{{0.55f, 0.56f, 0.58f},
                                                 {0.72f, 0.72f, 0.70f},
                                                 {0.30f, 0.32f, 0.35f},
                                                 {0.62f, 0.62f, 0.61f},
                                                 {0.05f, 0.05f, 0.05f},
                                                 {0.70f, 0.70f, 0.68f},
                                                 {0.60f, 0.38f, 0.05f}},
                                                {{0.016f, 0.016f, 0.018f},
                                                 {0.018f, 0.018f, 0.019f},
                                                 {0.016f, 0.016f, 0.018f},
                                                 {0.026f, 0.026f, 0.028f},
                                                 {0.014f, 0.014f, 0.015f},
                                                 {0.015f, 0.015f, 0.016f},
                                                 {0.02f, 0.02f, 0.02f},
                                                 1.15f,
                                                 1.50f},
                                                {{0.075f, 0.050f, 0.032f},
                                                 {0.16f, 0.115f, 0.075f},
                                                 {0.070f, 0.047f, 0.030f},
                                                 {0.19f, 0.15f, 0.11f},
                                                 {0.025f, 0.020f, 0.016f},
                                                 {0.11f, 0.075f, 0.050f},
                                                 {0.08f, 0.07f, 0.03f}},
                                                {{0.15f, 0.17f, 0.20f},
                                                 {0.18f, 0.19f, 0.21f},
                                                 {0.22f, 0.24f, 0.26f},
                                                 {0.35f, 0.36f, 0.37f},
                                                 {0.08f, 0.09f, 0.10f},
                                                 {0.14f, 0.15f, 0.17f},
                                                 {0.05f, 0.05f, 0.05f},
                                                 1.14f,
                                                 1.42f}}};

// Lengths below are shares of the span: choices. Shoulder and wrist, out from the middle and
// forward.
constexpr float kShoulderOut = 0.030f;
constexpr float kWristOut = 0.205f;
constexpr float kTipOut = 0.5f;
constexpr float kShoulderAhead = 0.035f;
constexpr float kHingesAbove = 0.012f;  // of the body's axis
// Angles of the wings, in radians: raised in a glide, and the stroke about it. They are choices.
constexpr float kGlideRaised = 0.12f;
constexpr float kGlideWrist = -0.10f;
constexpr float kStroke = 0.62f;
constexpr float kWristStroke = 0.40f;
// The hand follows the arm by this share of a stroke.
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

struct WingMaterials {
  std::uint32_t above, below, tip_above, tip_below;
};

void add_wing(MeshBuilder& builder,
              const BirdShape& shape,
              float side,
              const WingMaterials& material) {
  const auto span = static_cast<float>(shape.span_m);
  const float chord = span / static_cast<float>(shape.aspect_ratio);
  // A positive turn about x lowers the right wing and raises the left one.
  const auto hinge = [&](float out, float rest_rad, float amplitude_rad, float lag) {
    const V centre(kShoulderAhead * span, side * out * span, -kHingesAbove * span);
    return model::Hinge{V(1, 0, 0), centre, -side * rest_rad, -side * amplitude_rad, lag};
  };
  const model::Hinge shoulder = hinge(kShoulderOut, kGlideRaised, kStroke, 0);
  const model::Hinge wrist = hinge(kWristOut, kGlideWrist, kWristStroke, kWristLag);
  model::Part part;
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

void add_trunk(MeshBuilder& builder, float span, const Feathers& feathers) {
  const auto at = [&](float ahead, float out, float below) -> V {
    return V(feathers.length * ahead, feathers.thickness * out, feathers.thickness * below) * span;
  };
  const auto ring = [&](float ahead, float half_width, float half_height, float below) {
    return Ring{at(ahead, 0, below),
                feathers.thickness * half_width * span,
                feathers.thickness * half_height * span};
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
  // A herring gull in cruise (shapes.h).
  constexpr double kGullHz = 3.05;
  constexpr double kGullSpanM = 1.34;
  return kGullHz * std::sqrt(kGullSpanM / span_m);
}

model::Mesh bird(const BirdShape& shape) {
  check(shape.span_m > 0 && shape.aspect_ratio > 0, "a bird has a span and wings");
  const Feathers& feathers = kFeathers[static_cast<std::size_t>(shape.plumage)];
  MeshBuilder builder;
  add_trunk(builder, static_cast<float>(shape.span_m), feathers);
  const WingMaterials materials{builder.add_material(feathers.wing_above),
                                builder.add_material(feathers.wing_below),
                                builder.add_material(feathers.tip),
                                builder.add_material(feathers.tip)};
  for (const float side : {1.0f, -1.0f}) add_wing(builder, shape, side, materials);
  return builder.take();
}

namespace {

std::array<float, 3> floats(const std::array<double, 3>& rgb) {
  return {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])};
}

// Lengths below are shares of the size, the distance between opposite rotors: choices.
constexpr float kArmAbove = 0.02f;  // height of the arms above the middle
constexpr float kRotorAbove = 0.085f;
constexpr float kSkidBelow = 0.20f;
constexpr float kLegBelow = 0.17f;
// Radius of a small one's arms: those of an F450 are 4 cm deep for 45 cm between rotors.
constexpr float kStoutArm = 0.044f;

// Radius of a rotor as a share of the size: neighbours leave a tenth of their distance free.
float rotor_radius(int rotors) {
  const double between_neighbours = std::sin(kPi / rotors);
  return static_cast<float>(0.45 * between_neighbours);
}

// Unit vectors to the rotors; the nose is between the first and the last.
std::vector<V> directions(int rotors) {
  std::vector<V> result;
  for (int k = 0; k < rotors; ++k) {
    const double angle = 2 * kPi * (k + 0.5) / rotors;
    result.emplace_back(
        static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0.0f);
  }
  return result;
}

// The body, 0.52 long, 0.26 wide and 0.26 high with battery and camera. Folded, without rotors, a
// DJI Mavic Pro, Mavic 2, Mavic Air 2 and Mini 2 are 0.59 to 0.65 long, 0.25 to 0.38 wide with the
// arms at their sides and 0.24 to 0.28 high; the centre of a DJI F450 with its battery is about 0.3
// long and wide and as high.
void add_shell(MeshBuilder& builder, float size, std::uint32_t shell, std::uint32_t dark) {
  const auto ring = [&](float ahead, float half_width, float half_height) {
    return Ring{V(ahead, 0, 0) * size, half_width * size, half_height * size};
  };
  const std::array<Ring, 6> rings = {ring(0.260f, 0.060f, 0.035f),
                                     ring(0.235f, 0.095f, 0.060f),
                                     ring(0.120f, 0.130f, 0.080f),
                                     ring(-0.120f, 0.130f, 0.080f),
                                     ring(-0.225f, 0.100f, 0.065f),
                                     ring(-0.260f, 0.060f, 0.035f)};
  builder.add_body(rings, V(0, 1, 0), V(0, 0, 1), 12, shell);
  // The battery on top, and the camera with its gimbal below the nose.
  builder.add_box(V(-0.16f, -0.070f, -0.115f) * size, V(0.09f, 0.070f, -0.060f) * size, dark);
  builder.add_tube(V(0.17f, 0, 0.05f) * size, V(0.17f, 0, 0.095f) * size, 0.020f * size, 6, dark);
  builder.add_box(V(0.125f, -0.050f, 0.085f) * size, V(0.215f, 0.050f, 0.145f) * size, dark);
}

void add_skids(MeshBuilder& builder, float size, std::uint32_t dark) {
  for (const float side : {-1.0f, 1.0f}) {
    const float out = side * 0.17f;
    for (const float ahead : {-0.07f, 0.07f})
      builder.add_tube(V(ahead, side * 0.07f, 0.04f) * size,
                       V(ahead, out, kSkidBelow) * size,
                       0.010f * size,
                       6,
                       dark);
    builder.add_tube(V(-0.19f, out, kSkidBelow) * size,
                     V(0.19f, out, kSkidBelow) * size,
                     0.012f * size,
                     6,
                     dark);
  }
}

// Legs under the motors, in the line of their arms and wider at the top.
void add_legs(MeshBuilder& builder, float size, std::span<const V> rotors, std::uint32_t dark) {
  for (const V& rotor : rotors) {
    const V top = 0.47f * size * rotor;
    const V foot = 0.50f * size * rotor + V(0, 0, kLegBelow * size);
    builder.add_tube(top, 0.5f * (top + foot), 0.042f * size, 6, dark);
    builder.add_tube(0.5f * (top + foot), foot, 0.030f * size, 6, dark);
  }
}

// Two blades, twisted and tapered.
void add_rotor(MeshBuilder& builder, const V& hub, float radius, std::uint32_t dark) {
  for (const float side : {-1.0f, 1.0f}) {
    const auto rib = [&](float out, float chord, float twist) {
      const V middle = hub + V(0, side * out * radius, 0);
      const V half(side * 0.5f * chord * radius, 0, 0.5f * chord * radius * twist);
      return Rib{middle + half, middle - half, 0.012f * radius};
    };
    const std::array<Rib, 4> ribs = {rib(0.06f, 0.12f, 0.4f),
                                     rib(0.30f, 0.20f, 0.35f),
                                     rib(0.75f, 0.14f, 0.18f),
                                     rib(1, 0.07f, 0.1f)};
    builder.add_wing(ribs, dark, dark);
  }
}

}  // namespace

model::Mesh multirotor(const MultirotorShape& shape) {
  check(shape.size_m > 0 && shape.rotors >= 3, "a multirotor has a size and rotors");
  const auto size = static_cast<float>(shape.size_m);
  MeshBuilder builder;
  const std::uint32_t shell = builder.add_material(floats(shape.colour), model::Finish::kPaint);
  const std::uint32_t arm = builder.add_material(floats(shape.arm_colour), model::Finish::kPaint);
  const std::uint32_t red = builder.add_material({0.6f, 0.02f, 0.02f});
  const std::uint32_t green = builder.add_material({0.03f, 0.5f, 0.06f});
  const std::uint32_t dark = builder.add_material({0.02f, 0.02f, 0.022f});
  const std::uint32_t blade = builder.add_material({0.03f, 0.03f, 0.032f});
  builder.begin_part({"airframe", {}});
  add_shell(builder, size, shell, dark);
  const std::vector<V> rotors = directions(shape.rotors);
  const bool has_skids = shape.size_m >= kLeastWithSkidsM;
  if (has_skids) {
    add_skids(builder, size, dark);
  } else {
    add_legs(builder, size, rotors, dark);
  }
  const float radius = rotor_radius(shape.rotors) * size;
  for (const V& direction : rotors) {
    const V at = 0.5f * size * direction;
    builder.add_tube(V(0, 0, 0) + 0.08f * size * direction,
                     at - V(0, 0, kArmAbove * size),
                     (has_skids ? 0.020f : kStoutArm) * size,
                     8,
                     arm);
    builder.add_tube(0.88f * at - V(0, 0, 0.01f * size),
                     0.88f * at + V(0, 0, 0.05f * size),
                     0.016f * size,
                     6,
                     direction.x() > 0 ? red : green);
    builder.add_tube(at + V(0, 0, 0.012f * size),
                     at - V(0, 0, 0.07f * size),
                     (has_skids ? 0.034f : kStoutArm) * size,
                     10,
                     dark);
  }
  for (std::size_t k = 0; k < rotors.size(); ++k) {
    const V hub = 0.5f * size * rotors[k] - V(0, 0, kRotorAbove * size);
    // Neighbours turn in opposite directions.
    const double turns_hz =
        (k % 2 == 0 ? 1 : -1) * kRotorTipMps / (2 * kPi * static_cast<double>(radius));
    builder.begin_part({.name = "rotor " + std::to_string(k + 1),
                        .spins = true,
                        .axis_in_body = V(0, 0, 1),
                        .centre_in_body = hub,
                        .revolutions_per_s = turns_hz});
    add_rotor(builder, hub, radius, blade);
  }
  return builder.take();
}

namespace {

// The outline of a latex envelope in shares of its diameter: a sphere above, drawn out to the neck
// below.
struct Outline {
  float above, radius;  // above the sphere's middle
};

std::vector<Outline> outline() {
  constexpr int kSteps = 14;
  std::vector<Outline> result;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = kPi * i / kSteps;  // 0 at the top
    const double height = std::cos(angle) * (std::cos(angle) < 0 ? 0.68 : 0.5);
    result.push_back({static_cast<float>(height), static_cast<float>(0.5 * std::sin(angle))});
  }
  result.back().radius = 0.03f;
  // The knot.
  result.push_back({-0.70f, 0.022f});
  result.push_back({-0.75f, 0.045f});
  return result;
}

}  // namespace

model::Mesh balloon(const BalloonShape& shape) {
  check(shape.size_m > 0, "a balloon has a size");
  const auto size = static_cast<float>(shape.size_m);
  MeshBuilder builder;
  const std::uint32_t latex = builder.add_material(floats(shape.colour), model::Finish::kPaint);
  builder.begin_part({"envelope", {}});
  std::vector<Ring> rings;
  for (const auto& [above, radius] : outline())
    rings.push_back({V(0, 0, -above * size), radius * size, radius * size});
  builder.add_body(rings, V(1, 0, 0), V(0, -1, 0), 24, latex);
  return builder.take();
}

}  // namespace airtruth::shapes
