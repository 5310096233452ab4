// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/truth_rules.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "labels/annotation/object_class.h"

namespace airtruth::annotation {
namespace {

bool finite(double value) { return std::isfinite(value); }
bool finite(const Vector3& v) { return v.allFinite(); }
bool finite(const YawPitchRoll& a) {
  return finite(a.yaw_deg) && finite(a.pitch_deg) && finite(a.roll_deg);
}
bool finite(const Box& b) {
  return finite(b.x) && finite(b.y) && finite(b.width) && finite(b.height);
}

template <typename T>
bool finite(const std::optional<T>& value) {
  return !value || finite(*value);
}

bool finite(const EncounterTruth& truth) {
  const encounter::Measures& m = truth.measures;
  return finite(m.horizontal_m) && finite(m.above_m) && finite(m.closing_speed_mps) &&
         finite(m.bearing_deg) && finite(m.bearing_rate_dps) && finite(m.relative_bearing_deg) &&
         finite(m.line_of_sight_rate_dps) && finite(m.tcpa_s) && finite(m.dcpa_m) &&
         finite(m.hmd_m) && finite(m.vmd_m) && finite(m.tau_mod_s) && finite(m.tcoa_s) &&
         std::all_of(truth.volumes.begin(), truth.volumes.end(), [](const VolumeTruth& volume) {
           return finite(volume.to_violation_s);
         });
}

bool all_finite(const Intruder& i) {
  return finite(i.position_ned_m) && finite(i.velocity_ned_mps) &&
         finite(i.attitude_yaw_pitch_roll_deg) && finite(i.position_in_cam_m) &&
         finite(i.range_m) && finite(i.range_rate_mps) && finite(i.azimuth_deg) &&
         finite(i.elevation_deg) && finite(i.nominal_azimuth_deg) &&
         finite(i.nominal_elevation_deg) && (!i.encounter || finite(*i.encounter)) &&
         finite(i.exact_box_px) && finite(i.alpha_sum_px) &&
         (!i.centroid_px || i.centroid_px->allFinite()) && finite(i.hidden_by_own_aircraft) &&
         finite(i.hidden_by_intruder) && finite(i.cut_by_frame);
}

bool is_fraction(double value) { return value >= 0 && value <= 1; }

bool is_below_0(const std::optional<double>& value) { return value && *value < 0; }

std::optional<std::string> fault(const EncounterTruth& truth) {
  const encounter::Measures& m = truth.measures;
  if (m.horizontal_m < 0 || m.hmd_m < 0 || m.vmd_m < 0 || is_below_0(m.dcpa_m) ||
      is_below_0(m.line_of_sight_rate_dps))
    return "has an encounter with a distance or a rate of sight below 0";
  if (is_below_0(m.tcpa_s) || is_below_0(m.tau_mod_s) || is_below_0(m.tcoa_s))
    return "has an encounter with a time below 0";
  if (m.tcpa_s.has_value() != m.dcpa_m.has_value()) return "has half a closest approach";
  constexpr double kRounding = 1 + 1e-9;
  if (m.hmd_m > m.horizontal_m * kRounding || m.vmd_m > std::abs(m.above_m) * kRounding)
    return "has a miss distance above the distance of now";
  for (const VolumeTruth& volume : truth.volumes)
    if (is_below_0(volume.to_violation_s) || (volume.inside && volume.to_violation_s != 0.0))
      return fmt::format("is {} the volume '{}' with another time to its violation",
                         volume.inside ? "inside" : "outside",
                         volume.name);
  return std::nullopt;
}

// What is on the lens has no place in the world; everything else has one unless it is ended.
std::optional<std::string> fault_of_place(const Intruder& i) {
  const bool placed = i.position_ned_m && i.velocity_ned_mps && i.attitude_yaw_pitch_roll_deg &&
                      i.position_in_cam_m && i.range_m;
  const bool any_place = i.position_ned_m || i.velocity_ned_mps || i.attitude_yaw_pitch_roll_deg ||
                         i.position_in_cam_m || i.range_m || i.range_rate_mps || i.azimuth_deg ||
                         i.elevation_deg || i.nominal_azimuth_deg || i.nominal_elevation_deg ||
                         i.encounter;
  if (i.state == State::kEnded && (any_place || i.exact_box_px)) return "is ended and has a place";
  if (is_on_lens(i.object_class)) {
    if (any_place) return fmt::format("is a {} and has a place in the world", i.object_class);
    if (i.state == State::kBehind) return fmt::format("is a {} and behind", i.object_class);
    return std::nullopt;
  }
  if (i.state != State::kEnded && !placed)
    return fmt::format("is {} and lacks its place", name(i.state));
  return std::nullopt;
}

std::optional<std::string> fault(const Intruder& i) {
  if (!all_finite(i)) return "holds a number that is not finite";
  if (!is_object_class(i.object_class))
    return fmt::format(
        "is of the class '{}'; expected aircraft, bird, multirotor, balloon, glint, dirt or insect",
        i.object_class.substr(0, 40));
  if (i.visible_box_px.has_value() != (i.state == State::kVisible))
    return fmt::format(
        "is {} and has {} visible_box_px", name(i.state), i.visible_box_px ? "a" : "no");
  if (const auto found = fault_of_place(i)) return found;
  if (i.azimuth_deg.has_value() != i.elevation_deg.has_value() ||
      i.nominal_azimuth_deg.has_value() != i.nominal_elevation_deg.has_value())
    return "has half a bearing";
  if (i.covered_box_px && i.state != State::kVisible)
    return fmt::format("is {} and has a covered_box_px", name(i.state));
  if (i.covered_box_px && (i.covered_box_px->width <= 0 || i.covered_box_px->height <= 0))
    return "has an empty covered_box_px";
  if (i.visible_box_px && (i.visible_box_px->width <= 0 || i.visible_box_px->height <= 0))
    return "has an empty visible_box_px";
  if (i.exact_box_px && (i.exact_box_px->width < 0 || i.exact_box_px->height < 0))
    return "has an exact_box_px of negative size";
  if (i.visible_area_px < 0 || i.alpha_sum_px < 0 || (i.range_m && *i.range_m < 0))
    return "holds an area or a range below 0";
  if (!is_fraction(i.hidden_by_own_aircraft) || !is_fraction(i.hidden_by_intruder) ||
      !is_fraction(i.cut_by_frame))
    return "holds a fraction outside 0..1";
  return i.encounter ? fault(*i.encounter) : std::nullopt;
}

}  // namespace

std::optional<std::string> fault(const Frame& frame) {
  if (frame.frame < 0) return "frame is below 0";
  if (!finite(frame.time_s) || !finite(frame.camera_position_ned_m) ||
      !finite(frame.camera_attitude_yaw_pitch_roll_deg) ||
      !frame.shake.frame_from_reference.allFinite() ||
      !frame.shake.frame_from_reference_per_s.allFinite() || !finite(frame.shake.rate_radps))
    return "holds a number that is not finite";
  if (frame.shake.rotation && !(std::abs(frame.shake.rotation->norm() - 1) < 1e-6))
    return "has a rotation that is no unit quaternion";
  for (const Intruder& intruder : frame.intruders)
    if (const auto found = fault(intruder))
      return fmt::format("intruder '{}' {}", intruder.id, *found);
  return std::nullopt;
}

std::optional<std::string> fault(const LensFacts& lens) {
  const auto all = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  };
  if (!all(lens.focal_px) || !all(lens.principal_point_px) || !all(lens.distortion))
    return "lens holds a number that is not finite";
  return std::nullopt;
}

}  // namespace airtruth::annotation
