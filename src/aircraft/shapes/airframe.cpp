// SPDX-License-Identifier: Apache-2.0
#include "aircraft/shapes/airframe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "aircraft/shapes/mesh_builder.h"
#include "foundation/base/error.h"
#include "foundation/geometry/transform.h"

namespace airtruth::shapes {
namespace {

using V = Eigen::Vector3f;
using Plane = Eigen::Hyperplane<float, 3>;

// Corners of a hull's section, and rings from one station to the next: choices, beyond which no
// edge shows in an aircraft of 400 px.
constexpr int kHullSides = 32;
constexpr int kRingsOfStation = 4;

struct Fixed {
  std::array<float, 3> rgb;  // linear
  model::Finish finish;
};
// By Paint, from kWhite on: choices. Glass is a mirror above a dark cabin.
constexpr std::array<Fixed, 7> kFixed = {{{{0.72f, 0.72f, 0.70f}, model::Finish::kPaint},
                                          {{0.010f, 0.012f, 0.014f}, model::Finish::kGlass},
                                          {{0.018f, 0.018f, 0.019f}, model::Finish::kMat},
                                          {{0.25f, 0.24f, 0.23f}, model::Finish::kMetal},
                                          {{0.030f, 0.031f, 0.033f}, model::Finish::kMat},
                                          {{0.60f, 0.50f, 0.08f}, model::Finish::kMat},
                                          {{0.50f, 0.01f, 0.01f}, model::Finish::kPaint}}};

float f(double x) { return static_cast<float>(x); }
std::uint32_t of(Paint paint) { return static_cast<std::uint32_t>(paint); }

// The value between b (at 0) and c (at 1) on a Catmull-Rom curve, never beyond the two.
double between(double a, double b, double c, double d, double t) {
  const double curve =
      b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
  return std::clamp(curve, std::min(b, c), std::max(b, c));
}

std::vector<Station> smoothed(const std::vector<Station>& given) {
  std::vector<Station> result;
  for (std::size_t i = 0; i + 1 < given.size(); ++i) {
    const Station &b = given[i], &c = given[i + 1];
    const Station& a = given[i > 0 ? i - 1 : 0];
    const Station& d = given[std::min(i + 2, given.size() - 1)];
    for (int k = 0; k < kRingsOfStation; ++k) {
      const double t = static_cast<double>(k) / kRingsOfStation;
      result.push_back({between(a.forward, b.forward, c.forward, d.forward, t),
                        between(a.half_width, b.half_width, c.half_width, d.half_width, t),
                        between(a.bottom, b.bottom, c.bottom, d.bottom, t),
                        between(a.top, b.top, c.top, d.top, t)});
    }
  }
  result.push_back(given.back());
  return result;
}

class Assembly {
 public:
  Assembly(const Airframe& airframe, const Livery& livery) : origin_(airframe.origin) {
    builder_.add_material(livery.base, model::Finish::kPaint);
    builder_.add_material(livery.trim, model::Finish::kPaint);
    for (const Fixed& fixed : kFixed) builder_.add_material(fixed.rgb, fixed.finish);
    builder_.begin_part({"airframe", {}});
    for (const float side : {1.0f, -1.0f}) {
      for (const Hull& hull : airframe.hulls)
        if (side > 0 || hull.right != 0) add(hull, side);
      for (const Sheet& sheet : airframe.sheets)
        if (side > 0 || leaves_the_middle(sheet)) add(sheet, side);
      for (const Bar& bar : airframe.bars)
        if (side > 0 || bar.from.right != 0 || bar.to.right != 0)
          builder_.add_tube(at(bar.from, side), at(bar.to, side), f(bar.radius), 8, of(bar.paint));
    }
    for (const Rotor& rotor : airframe.rotors) add(rotor);
  }
  model::Mesh take() { return builder_.take(); }

 private:
  V at(const Place& place, float side = 1) const {
    return {f(place.forward - origin_.forward),
            side * f(place.right - origin_.right),
            f(origin_.up - place.up)};
  }

  static bool leaves_the_middle(const Sheet& sheet) {
    return std::any_of(sheet.ribs.begin(), sheet.ribs.end(), [](const SheetRib& rib) {
      return rib.leading.right != 0;
    });
  }

  void add(const Hull& hull, float side) {
    const std::size_t first = builder_.triangles();
    std::vector<Ring> rings;
    for (const Station& s : smoothed(hull.stations))
      rings.push_back({at({s.forward, hull.right, 0.5 * (s.bottom + s.top)}, side),
                       f(s.half_width),
                       f(0.5 * (s.top - s.bottom)),
                       f(hull.squareness)});
    builder_.add_body(rings, V(0, 1, 0), V(0, 0, -1), kHullSides, of(hull.paint));
    for (const Panel& panel : hull.panels) add(panel, first);
  }

  void add(const Panel& panel, std::size_t first) {
    const auto corner = [&](std::size_t k) {
      const auto& [forward, up] = panel.corners[k % panel.corners.size()];
      return at({forward, 0, up});
    };
    V middle(0, 0, 0);
    for (std::size_t k = 0; k < panel.corners.size(); ++k)
      middle += corner(k) / f(static_cast<double>(panel.corners.size()));
    std::vector<Plane> sides;
    for (std::size_t k = 0; k < panel.corners.size(); ++k) {
      Plane side(V(0, 1, 0).cross(corner(k + 1) - corner(k)).normalized(), corner(k));
      if (side.signedDistance(middle) < 0) side = Plane(-side.normal(), -side.offset());
      sides.push_back(side);
    }
    const float inner = f(panel.inner_m);
    for (const Plane& side : sides) builder_.cut(first, side);
    if (inner > 0)
      for (const float side : {1.0f, -1.0f}) builder_.cut(first, Plane(V(0, side, 0), -inner));
    builder_.paint(first, of(panel.paint), [&](const V& p) {
      return std::abs(p.y()) >= inner &&
             std::all_of(sides.begin(), sides.end(), [&](const Plane& side) {
               return side.signedDistance(p) > 0;
             });
    });
  }

  // Its ends are closed by ribs without thickness. A sheet that begins in the middle is one with
  // its mirror image.
  void add(const Sheet& sheet, float side) {
    const bool is_one = sheet.ribs.front().leading.right == 0 && leaves_the_middle(sheet);
    if (is_one && side < 0) return;
    std::vector<Rib> ribs;
    const auto add_rib = [&](const SheetRib& rib, float of_side, double thickness) {
      Place trailing = rib.leading;
      trailing.forward -= rib.chord;
      ribs.push_back({at(rib.leading, of_side), at(trailing, of_side), f(thickness)});
    };
    if (is_one) {
      add_rib(sheet.ribs.back(), -1, 0);
      for (std::size_t i = sheet.ribs.size(); --i > 0;)
        add_rib(sheet.ribs[i], -1, sheet.ribs[i].thickness);
    } else {
      add_rib(sheet.ribs.front(), side, 0);
    }
    for (const SheetRib& rib : sheet.ribs) add_rib(rib, is_one ? 1 : side, rib.thickness);
    add_rib(sheet.ribs.back(), is_one ? 1 : side, 0);
    const V above = (ribs.back().leading - ribs.front().leading)
                        .cross(ribs.front().leading - ribs.front().trailing)
                        .normalized();
    builder_.add_wing(ribs, of(sheet.paint), of(sheet.paint), above);
  }

  void add(const Rotor& rotor) {
    const V hub = at(rotor.hub);
    const V axis = V(f(rotor.axis.forward), f(rotor.axis.right), -f(rotor.axis.up)).normalized();
    const V mark = std::abs(axis.x()) < 0.7f ? V(1, 0, 0) : V(0, 0, -1);
    const V start = (mark - mark.dot(axis) * axis).normalized();
    model::Part part;
    part.name = rotor.name;
    part.spins = true;
    part.axis_in_body = axis;
    part.centre_in_body = hub;
    part.revolutions_per_s = rotor.tip_mps / (kPi * rotor.diameter);
    builder_.begin_part(part);
    const float radius = f(0.5 * rotor.diameter), chord = f(rotor.chord);
    builder_.add_tube(hub - 0.3f * chord * axis,
                      hub + 0.3f * chord * axis,
                      0.045f * radius,
                      10,
                      of(Paint::kMetal));
    for (int k = 0; k < rotor.blades; ++k) {
      const double angle = radians(rotor.phase_deg) + 2 * kPi * k / rotor.blades;
      add_blade(rotor, hub, axis, Eigen::AngleAxisf(f(angle), axis) * start, radius, chord);
    }
  }

  void add_blade(const Rotor& rotor,
                 const V& hub,
                 const V& axis,
                 const V& outward,
                 float radius,
                 float chord) {
    const float ahead = rotor.tip_mps < 0 ? -1 : 1;
    const auto middle = [&](float share) -> V {
      return hub + share * radius * (outward + f(std::tan(radians(rotor.cone_deg))) * axis);
    };
    const auto rib = [&](float share, float of_chord, float of_thickness) {
      const float pitch = f(radians(rotor.pitch_deg)) * (1 - 0.6f * share);
      const V along = std::cos(pitch) * ahead * axis.cross(outward) + std::sin(pitch) * axis;
      return Rib{middle(share) + 0.3f * of_chord * chord * along,
                 middle(share) - 0.7f * of_chord * chord * along,
                 0.12f * of_thickness * chord};
    };
    builder_.add_tube(middle(0.03f), middle(0.16f), 0.16f * chord, 6, of(Paint::kDark));
    // The share of the radius that is painted as the blade's tip.
    constexpr float kTip = 0.97f;
    const std::array<Rib, 4> blade = {
        rib(0.14f, 0.7f, 0), rib(0.15f, 0.8f, 1), rib(0.25f, 1, 1), rib(kTip, 1, 1)};
    builder_.add_wing(blade, of(Paint::kBlade), of(Paint::kBlade), axis);
    const std::array<Rib, 3> tip = {rib(kTip, 1, 1), rib(1, 0.9f, 1), rib(1, 0.9f, 0)};
    builder_.add_wing(tip, of(Paint::kTip), of(Paint::kTip), axis);
  }

  Place origin_;
  MeshBuilder builder_;
};

}  // namespace

model::Mesh airframe_mesh(const Airframe& airframe, const Livery& livery) {
  check(!airframe.hulls.empty(), "an airframe has a hull");
  return Assembly(airframe, livery).take();
}

}  // namespace airtruth::shapes
