// SPDX-License-Identifier: Apache-2.0
#include "encounter/separation/violation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "foundation/geometry/units.h"

namespace airtruth::separation {
namespace {

using Vector2 = Eigen::Vector2d;
constexpr Interval kAlways{-std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::infinity()};

Volume with_rounding(Volume volume) {
  volume.horizontal_m += kRoundingM;
  volume.vertical_m += kRoundingM;
  return volume;
}

// Time is counted from the closest approach, where the quadratic of the header becomes
// v^2 t^2 + tau v^2 t + dcpa^2 - D^2 = 0.
std::optional<Interval> horizontal_violation(const Volume& volume, const Relative& between) {
  const Vector2 r = between.offset_ned_m.head<2>();
  const Vector2 v = between.velocity_ned_mps.head<2>();
  const double speed_mps = v.norm();
  if (!(speed_mps > kStillMps))
    return r.norm() <= volume.horizontal_m ? std::optional(kAlways) : std::nullopt;
  const double dcpa_m = std::abs(r.x() * v.y() - r.y() * v.x()) / speed_mps;
  if (dcpa_m > volume.horizontal_m) return std::nullopt;
  const double half_chord_s =
      std::sqrt((volume.horizontal_m - dcpa_m) * (volume.horizontal_m + dcpa_m)) / speed_mps;
  const double before_s = 0.5 * (volume.tau_s + std::hypot(volume.tau_s, 2 * half_chord_s));
  const double tcpa_s = -r.dot(v) / (speed_mps * speed_mps);
  return Interval{tcpa_s - before_s, tcpa_s + half_chord_s};
}

std::optional<Interval> vertical_violation(const Volume& volume, const Relative& between) {
  const double z = between.offset_ned_m.z();
  const double w = between.velocity_ned_mps.z();
  if (!(std::abs(w) > kStillMps))
    return std::abs(z) <= volume.vertical_m ? std::optional(kAlways) : std::nullopt;
  const double tcoa_s = -z / w;
  const double half_slab_s = volume.vertical_m / std::abs(w);
  return Interval{tcoa_s - std::max(volume.coaltitude_s, half_slab_s), tcoa_s + half_slab_s};
}

}  // namespace

bool is_inside(const Volume& stated, const Mover& own, const Mover& intruder) {
  const Volume volume = with_rounding(stated);
  const Measures now =
      measures(own, intruder, {.lookahead_s = 0, .tau_distance_m = volume.horizontal_m});
  const bool soon_near = now.dcpa_m && *now.dcpa_m <= volume.horizontal_m && now.tau_mod_s &&
                         *now.tau_mod_s <= volume.tau_s;
  const bool soon_level = now.tcoa_s && *now.tcoa_s <= volume.coaltitude_s;
  return (now.horizontal_m <= volume.horizontal_m || soon_near) &&
         (std::abs(now.above_m) <= volume.vertical_m || soon_level);
}

std::optional<Interval> violation(const Volume& stated,
                                  const Mover& own,
                                  const Mover& intruder,
                                  double lookahead_s) {
  const Volume volume = with_rounding(stated);
  const Relative between = relative(own, intruder);
  const auto horizontal = horizontal_violation(volume, between);
  const auto vertical = vertical_violation(volume, between);
  if (!horizontal || !vertical) return std::nullopt;
  const Interval both{std::max({0.0, horizontal->begin_s, vertical->begin_s}),
                      std::min({lookahead_s, horizontal->end_s, vertical->end_s})};
  return both.begin_s <= both.end_s ? std::optional(both) : std::nullopt;
}

namespace {

constexpr double kFt = kMetresOfFoot;
constexpr double kNmi = kMetresOfNauticalMile;

// The document's own units are kept in the numbers; docs/formats/scene.md says what each is for.
constexpr std::array kVolumes = {
    NamedVolume{"do365-phase1", {0.66 * kNmi, 450 * kFt, 35, 0}},         // RTCA DO-365B
    NamedVolume{"do365-preventive", {0.66 * kNmi, 700 * kFt, 35, 0}},     // RTCA DO-365B
    NamedVolume{"do365-terminal", {1500 * kFt, 450 * kFt, 0, 0}},         // RTCA DO-365B
    NamedVolume{"do365-non-cooperative", {2200 * kFt, 450 * kFt, 0, 0}},  // RTCA DO-365B
    NamedVolume{"do365-buffered", {1 * kNmi, 450 * kFt, 35, 20}},         // NASA DAIDALUS v2
    NamedVolume{"f3442", {2000 * kFt, 250 * kFt, 0, 0}},                  // ASTM F3442/F3442M-23
    NamedVolume{"nmac", {500 * kFt, 100 * kFt, 0, 0}},                    // RTCA DO-365B
};

}  // namespace

std::span<const NamedVolume> named_volumes() { return kVolumes; }

const NamedVolume* named_volume(std::string_view name) {
  const auto found = std::ranges::find(kVolumes, name, &NamedVolume::name);
  return found == kVolumes.end() ? nullptr : &*found;
}

std::vector<std::string> volume_names() {
  std::vector<std::string> names;
  for (const NamedVolume& volume : kVolumes) names.emplace_back(volume.name);
  return names;
}

}  // namespace airtruth::separation
