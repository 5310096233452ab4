// SPDX-License-Identifier: Apache-2.0
#include "aircraft/shapes/shapes.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

namespace airtruth::shapes {
namespace {

using model::Mesh;
using model::Part;

// Volume that the triangles of a part enclose (divergence theorem); positive where its corners turn
// counter-clockwise seen from outside.
double volume_m3(const Mesh& mesh, const Part& part) {
  double six = 0;
  for (const model::Triangle& t : part.triangles) {
    const auto at = [&](std::size_t k) -> Eigen::Vector3d {
      return mesh.positions[t.vertex[k]].cast<double>();
    };
    six += at(0).dot(at(1).cross(at(2)));
  }
  return six / 6;
}

// The vertices of a part at a time, in body.
template <typename Visit>
void each_point(const Mesh& mesh, const Part& part, double time_s, const Visit& visit) {
  const Eigen::Affine3f pose = model::body_from_part(part, time_s);
  for (const model::Triangle& t : part.triangles)
    for (const std::uint32_t v : t.vertex) visit(pose * mesh.positions[v]);
}

float span_at(const Mesh& mesh, double time_s) {
  float low = 0, high = 0;
  for (const Part& part : mesh.parts)
    each_point(mesh, part, time_s, [&](const Eigen::Vector3f& p) {
      low = std::min(low, p.y());
      high = std::max(high, p.y());
    });
  return high - low;
}

TEST(Shapes, ABirdHasItsSpanWithStretchedWings) {
  for (const double span_m : {0.6, 1.34, 2.2}) {
    const Mesh mesh = bird({.span_m = span_m, .strokes_per_s = 3, .glide = 1});
    const model::Extents size = model::extents(mesh);
    EXPECT_NEAR(size.span_m(), span_m, 1e-6 * span_m);
    // A herring gull is 0.55 to 0.67 m long at spans of 1.25 to 1.55 m (Cramp and Simmons 1983).
    EXPECT_NEAR(size.length_m() / span_m, 0.44, 0.01);
  }
}

// Half of the width of the trunk where it is widest, ahead of the tail.
float trunk_radius(const Mesh& mesh, double span_m) {
  float radius = 0;
  each_point(mesh, mesh.parts[0], 0, [&](const Eigen::Vector3f& p) {
    if (p.x() > -0.1f * static_cast<float>(span_m)) radius = std::max(radius, p.y());
  });
  return radius;
}

// Frontal areas of 0.00813 m^0.666 m^2 (Pennycuick et al. 1988), of a crow as a passerine 0.0129
// m^0.614 (Hedenstroem and Rosen 2003), at the masses and spans of their species.
TEST(Shapes, ABirdIsAsStoutAsItsFrontalAreaSays) {
  struct Species {
    Plumage plumage;
    double mass_kg, span_m, factor, exponent;
  };
  for (const Species& one : {Species{Plumage::kGull, 1.0, 1.34, 0.00813, 0.666},
                             Species{Plumage::kDark, 0.55, 0.93, 0.0129, 0.614},
                             Species{Plumage::kBrown, 0.9, 1.25, 0.00813, 0.666},
                             Species{Plumage::kGrey, 0.33, 0.65, 0.00813, 0.666}}) {
    const double area_m2 = one.factor * std::pow(one.mass_kg, one.exponent);
    const Mesh mesh = bird({.span_m = one.span_m, .plumage = one.plumage});
    EXPECT_NEAR(
        trunk_radius(mesh, one.span_m), std::sqrt(area_m2 / kPi), 0.05 * std::sqrt(area_m2 / kPi))
        << enum_names(one.plumage)[static_cast<std::size_t>(one.plumage)].name;
  }
}

TEST(Shapes, WingsOfABirdHaveTheStatedAspectRatio) {
  const Mesh mesh = bird({.span_m = 1, .aspect_ratio = 8});
  double area_m2 = 0;
  for (const Part& part : mesh.parts) {
    if (part.hinges.empty()) continue;
    for (const model::Triangle& t : part.triangles) {
      const Eigen::Vector3f n =
          (mesh.positions[t.vertex[1]] - mesh.positions[t.vertex[0]])
              .cross(mesh.positions[t.vertex[2]] - mesh.positions[t.vertex[0]]);
      area_m2 += 0.25 * std::abs(double(n.z()));  // the upper and the lower side: half of each
    }
  }
  // Pennycuick (1989) counts the part of the body between the wings.
  area_m2 += 2 * 0.03 * 0.1625;
  EXPECT_NEAR(1 / area_m2, 8, 0.8);
}

TEST(Shapes, WingsBeatAtTheirRateAndRestInAGlide) {
  const Mesh mesh = bird({.span_m = 1.34, .strokes_per_s = 4, .phase_strokes = 0, .glide = 0});
  const float up_or_down = span_at(mesh, 0.25 / 4);
  EXPECT_LT(up_or_down, 0.9f * span_at(mesh, 0));
  EXPECT_NEAR(span_at(mesh, 0.25 / 4), span_at(mesh, 3.25 / 4), 1e-4);
  const Mesh gliding = bird({.span_m = 1.34, .strokes_per_s = 4, .glide = 1});
  for (const double time_s : {0.1, 0.33, 1.7})
    EXPECT_EQ(model::body_from_part(gliding.parts[1], time_s).matrix(),
              model::body_from_part(gliding.parts[1], 0).matrix());
  // With glides of half the time, half of ten strokes are beaten.
  const Mesh both = bird({.span_m = 1.34, .strokes_per_s = 1, .glide = 0.5});
  int still = 0;
  for (int i = 0; i < 1000; ++i) {
    const double time_s = i * model::kStrokesOfBout / 1000;
    const float before = span_at(both, time_s), after = span_at(both, time_s + 1e-3);
    still += std::abs(after - before) < 1e-7f ? 1 : 0;
  }
  EXPECT_NEAR(still, 500, 60);
}

TEST(Shapes, WingsAreMirrorImages) {
  const Mesh mesh = bird({.span_m = 1.34, .phase_strokes = 0.2, .glide = 0});
  for (const double time_s : {0.0, 0.07, 0.2}) {
    std::map<std::size_t, std::vector<Eigen::Vector3f>> points;
    for (std::size_t p = 1; p < mesh.parts.size(); ++p)
      each_point(mesh, mesh.parts[p], time_s, [&](const auto& at) { points[p].push_back(at); });
    float lowest_right = 1, lowest_left = 1;
    for (const auto& at : points[2]) lowest_right = std::min(lowest_right, at.z());
    for (const auto& at : points[4]) lowest_left = std::min(lowest_left, at.z());
    EXPECT_NEAR(lowest_right, lowest_left, 1e-5);
  }
}

TEST(Shapes, AHandStaysAtItsWrist) {
  const Mesh mesh = bird({.span_m = 2, .glide = 0});
  const Part& arm = mesh.parts[1];
  const Part& hand = mesh.parts[2];
  ASSERT_EQ(hand.hinges.size(), 2U);
  const Eigen::Vector3f wrist = hand.hinges[1].centre_in_body;
  for (int i = 0; i < 20; ++i) {
    const double time_s = 0.05 * i;
    EXPECT_LT(
        (model::body_from_part(arm, time_s) * wrist - model::body_from_part(hand, time_s) * wrist)
            .norm(),
        1e-6f);
  }
}

TEST(Shapes, APartStaysWithinItsReachAndTurnsNoFasterThanItsBound) {
  for (const Mesh& mesh : {bird({.glide = 0.4}), multirotor({})})
    for (const Part& part : mesh.parts) {
      if (!part.moves()) continue;
      const float reach = model::reach_m(mesh, part) * 1.0001f;
      for (int i = 0; i < 200; ++i) {
        const double time_s = 0.017 * i;
        each_point(mesh, part, time_s, [&](const Eigen::Vector3f& p) {
          EXPECT_LE((p - part.centre_in_body).norm(), reach);
        });
        const double step_s = 1e-4;
        const Eigen::Matrix3f turn = model::body_from_part(part, time_s + step_s).linear() *
                                     model::body_from_part(part, time_s).linear().transpose();
        const double turned_rad = double(Eigen::AngleAxisf(turn).angle());
        EXPECT_LE(turned_rad / (2 * kPi) / step_s, model::fastest_turn_per_s(part) * 1.01 + 0.01);
      }
    }
}

TEST(Shapes, SkinsFaceOutwards) {
  EXPECT_NEAR(volume_m3(balloon({.size_m = 1}), balloon({.size_m = 1}).parts[0]), 0.62, 0.06);
  EXPECT_GT(volume_m3(multirotor({}), multirotor({}).parts[0]), 0);
  const Mesh gull = bird({});
  for (const Part& part : gull.parts) EXPECT_GT(volume_m3(gull, part), 0) << part.name;
}

TEST(Shapes, AMultirotorHasItsSizeAndItsRotors) {
  for (const int rotors : {4, 6, 8}) {
    const Mesh mesh = multirotor({.size_m = 0.8, .rotors = rotors});
    ASSERT_EQ(mesh.parts.size(), static_cast<std::size_t>(rotors) + 1);
    const auto& first = mesh.parts[1];
    const auto& opposite = mesh.parts[1 + static_cast<std::size_t>(rotors) / 2];
    EXPECT_NEAR((first.centre_in_body - opposite.centre_in_body).norm(), 0.8, 1e-5);
    const double tip_mps =
        2 * kPi * double(model::reach_m(mesh, first)) * std::abs(first.revolutions_per_s);
    EXPECT_NEAR(tip_mps, kRotorTipMps, 0.05 * kRotorTipMps);
    // Neighbours do not touch.
    EXPECT_GT((first.centre_in_body - mesh.parts[2].centre_in_body).norm(),
              model::reach_m(mesh, first) + model::reach_m(mesh, mesh.parts[2]));
  }
}

// Its lowest points: the feet of legs under the motors, or skids under the body.
TEST(Shapes, ASmallMultirotorStandsOnLegsAndALargeOneOnSkids) {
  for (const double size_m : {0.45, 0.9}) {
    const Mesh mesh = multirotor({.size_m = size_m});
    float lowest = 0;
    for (const Eigen::Vector3f& p : mesh.positions) lowest = std::max(lowest, p.z());
    for (const Eigen::Vector3f& p : mesh.positions) {
      if (p.z() < 0.95f * lowest) continue;
      const double out = double(p.head<2>().norm()) / size_m;
      if (size_m < 0.6)
        EXPECT_NEAR(out, 0.5, 0.04);
      else
        EXPECT_LT(out, 0.3);
    }
  }
}

TEST(Shapes, ABalloonHasItsDiameter) {
  const model::Extents size = model::extents(balloon({.size_m = 0.3}));
  EXPECT_NEAR(size.length_m(), 0.3, 1e-3);
  EXPECT_NEAR(size.span_m(), 0.3, 1e-3);
  EXPECT_NEAR(size.height_m(), 1.25 * 0.3, 1e-3);
}

TEST(Shapes, BirdsOfOneShapeBeatSlowerTheLargerTheyAre) {
  EXPECT_NEAR(usual_strokes_per_s(1.34), 3.05, 1e-12);
  // A bald eagle (2.0 m) beats 2.5 to 3 times a second, a pigeon (0.65 m) 5 to 6 (Pennycuick 1996).
  EXPECT_GT(usual_strokes_per_s(2.0), 2);
  EXPECT_LT(usual_strokes_per_s(2.0), 3);
  EXPECT_GT(usual_strokes_per_s(0.65), 4);
}

}  // namespace
}  // namespace airtruth::shapes
