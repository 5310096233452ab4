// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "aircraft/shapes/mesh_builder.h"
#include "aircraft/shapes/shapes.h"
#include "foundation/base/error.h"

namespace airtruth::aircraft {
namespace {

using V = Eigen::Vector3f;

std::array<float, 3> floats(const std::array<double, 3>& rgb) {
  return {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])};
}

// Lengths below are shares of the size, the distance between opposite rotors.
constexpr float kArmAbove = 0.02f;  // height of the arms above the middle
constexpr float kRotorAbove = 0.085f;
constexpr float kSkidBelow = 0.20f;
constexpr float kLegBelow = 0.17f;
// Multirotors below this size stand on a leg under each motor (DJI F450, Hubsan H501), larger ones
// on skids (DJI S900: 0.9 m).
constexpr float kLeastWithSkidsM = 0.6f;
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

Mesh multirotor(const MultirotorShape& shape) {
  check(shape.size_m > 0 && shape.rotors >= 3, "a multirotor has a size and rotors");
  const auto size = static_cast<float>(shape.size_m);
  MeshBuilder builder;
  const std::uint32_t shell = builder.add_material(floats(shape.colour), Finish::kPaint);
  const std::uint32_t dark = builder.add_material({0.02f, 0.02f, 0.022f});
  const std::uint32_t blade = builder.add_material({0.03f, 0.03f, 0.032f});
  builder.begin_part({"airframe", {}});
  add_shell(builder, size, shell, dark);
  const std::vector<V> rotors = directions(shape.rotors);
  const bool has_skids = size >= kLeastWithSkidsM;
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
                     shell);
    builder.add_tube(at + V(0, 0, 0.012f * size),
                     at - V(0, 0, 0.07f * size),
                     (has_skids ? 0.034f : kStoutArm) * size,
                     10,
                     dark);
  }
  for (std::size_t k = 0; k < rotors.size(); ++k) {
    const V hub = 0.5f * size * rotors[k] - V(0, 0, kRotorAbove * size);
    Part part;
    part.name = "rotor " + std::to_string(k + 1);
    part.spins = true;
    part.axis_in_body = V(0, 0, 1);
    part.centre_in_body = hub;
    // Neighbours turn in opposite directions.
    part.revolutions_per_s =
        (k % 2 == 0 ? 1 : -1) * kRotorTipMps / (2 * kPi * static_cast<double>(radius));
    builder.begin_part(part);
    add_rotor(builder, hub, radius, blade);
  }
  return builder.take();
}

}  // namespace airtruth::aircraft
