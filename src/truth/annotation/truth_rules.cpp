// SPDX-License-Identifier: Apache-2.0
#include "truth/annotation/truth_rules.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

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

bool all_finite(const Intruder& i) {
  return finite(i.position_ned_m) && finite(i.velocity_ned_mps) &&
         finite(i.attitude_yaw_pitch_roll_deg) && finite(i.position_in_cam_m) &&
         finite(i.range_m) && finite(i.range_rate_mps) && finite(i.azimuth_deg) &&
         finite(i.elevation_deg) && finite(i.nominal_azimuth_deg) &&
         finite(i.nominal_elevation_deg) && finite(i.exact_box_px) && finite(i.alpha_sum_px) &&
         (!i.centroid_px || i.centroid_px->allFinite()) && finite(i.hidden_by_own_aircraft) &&
         finite(i.hidden_by_intruder) && finite(i.cut_by_frame);
}

bool is_fraction(double value) { return value >= 0 && value <= 1; }

std::optional<std::string> fault(const Intruder& i) {
  if (!all_finite(i)) return "holds a number that is not finite";
  if (i.visible_box_px.has_value() != (i.state == State::kVisible))
    return fmt::format(
        "is {} and has {} visible_box_px", name(i.state), i.visible_box_px ? "a" : "no");
  const bool placed = i.position_ned_m && i.velocity_ned_mps && i.attitude_yaw_pitch_roll_deg &&
                      i.position_in_cam_m && i.range_m;
  const bool any_place = i.position_ned_m || i.velocity_ned_mps || i.attitude_yaw_pitch_roll_deg ||
                         i.position_in_cam_m || i.range_m || i.range_rate_mps || i.azimuth_deg ||
                         i.elevation_deg || i.nominal_azimuth_deg || i.nominal_elevation_deg ||
                         i.exact_box_px;
  if (i.state == State::kEnded && any_place) return "is ended and has a place";
  if (i.state != State::kEnded && !placed)
    return fmt::format("is {} and lacks its place", name(i.state));
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
  return std::nullopt;
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
