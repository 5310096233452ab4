// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "labels/annotation/object_class.h"
#include "labels/annotation/truth.h"
#include "labels/annotation/truth_rules.h"

namespace airtruth::annotation {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson json(double value) { return value; }
OrderedJson json(const Vector3& v) { return OrderedJson::array({v.x(), v.y(), v.z()}); }
OrderedJson json(const YawPitchRoll& a) {
  return OrderedJson::array({a.yaw_deg, a.pitch_deg, a.roll_deg});
}
OrderedJson json(const Box& b) { return OrderedJson::array({b.x, b.y, b.width, b.height}); }
OrderedJson json(const PixelBox& b) { return OrderedJson::array({b.x, b.y, b.width, b.height}); }

OrderedJson json(const Homography& h) {
  OrderedJson rows = OrderedJson::array();
  for (int i = 0; i < 3; ++i) rows.push_back(OrderedJson::array({h(i, 0), h(i, 1), h(i, 2)}));
  return rows;
}

template <typename T>
void add(OrderedJson& object, const char* key, const std::optional<T>& value) {
  if (value) object[key] = json(*value);
}

OrderedJson json(const EncounterTruth& truth) {
  const encounter::Measures& m = truth.measures;
  OrderedJson object;
  object["horizontal_m"] = m.horizontal_m;
  object["above_m"] = m.above_m;
  add(object, "closing_speed_mps", m.closing_speed_mps);
  add(object, "bearing_deg", m.bearing_deg);
  add(object, "bearing_rate_dps", m.bearing_rate_dps);
  add(object, "relative_bearing_deg", m.relative_bearing_deg);
  add(object, "line_of_sight_rate_dps", m.line_of_sight_rate_dps);
  add(object, "tcpa_s", m.tcpa_s);
  add(object, "dcpa_m", m.dcpa_m);
  object["hmd_m"] = m.hmd_m;
  object["vmd_m"] = m.vmd_m;
  add(object, "tau_mod_s", m.tau_mod_s);
  add(object, "tcoa_s", m.tcoa_s);
  OrderedJson volumes = OrderedJson::array();
  for (const VolumeTruth& volume : truth.volumes) {
    OrderedJson one = {{"name", volume.name}, {"inside", volume.inside}};
    add(one, "to_violation_s", volume.to_violation_s);
    volumes.push_back(std::move(one));
  }
  object["volumes"] = std::move(volumes);
  return object;
}

OrderedJson json(const Intruder& intruder) {
  OrderedJson object;
  object["id"] = intruder.id;
  object["aircraft"] = intruder.aircraft;
  if (!is_aircraft(intruder.object_class)) object["class"] = intruder.object_class;
  object["state"] = name(intruder.state);
  add(object, "position_ned_m", intruder.position_ned_m);
  add(object, "velocity_ned_mps", intruder.velocity_ned_mps);
  add(object, "attitude_yaw_pitch_roll_deg", intruder.attitude_yaw_pitch_roll_deg);
  add(object, "position_in_cam_m", intruder.position_in_cam_m);
  add(object, "range_m", intruder.range_m);
  add(object, "range_rate_mps", intruder.range_rate_mps);
  add(object, "azimuth_deg", intruder.azimuth_deg);
  add(object, "elevation_deg", intruder.elevation_deg);
  add(object, "nominal_azimuth_deg", intruder.nominal_azimuth_deg);
  add(object, "nominal_elevation_deg", intruder.nominal_elevation_deg);
  if (intruder.encounter) object["encounter"] = json(*intruder.encounter);
  add(object, "exact_box_px", intruder.exact_box_px);
  add(object, "covered_box_px", intruder.covered_box_px);
  add(object, "visible_box_px", intruder.visible_box_px);
  object["visible_area_px"] = intruder.visible_area_px;
  object["alpha_sum_px"] = intruder.alpha_sum_px;
  if (intruder.centroid_px)
    object["centroid_px"] = {intruder.centroid_px->x(), intruder.centroid_px->y()};
  object["hidden_by_own_aircraft"] = intruder.hidden_by_own_aircraft;
  object["hidden_by_intruder"] = intruder.hidden_by_intruder;
  object["cut_by_frame"] = intruder.cut_by_frame;
  return object;
}

OrderedJson json(const LensFacts& lens) {
  return {{"model", lens.model},
          {"width", lens.width},
          {"height", lens.height},
          {"focal_px", lens.focal_px},
          {"principal_point_px", lens.principal_point_px},
          {"distortion", lens.distortion}};
}

}  // namespace

const char* name(State state) {
  switch (state) {
    case State::kVisible:
      return "visible";
    case State::kHidden:
      return "hidden";
    case State::kOutside:
      return "outside";
    case State::kBehind:
      return "behind";
    case State::kEnded:
      return "ended";
  }
  return "";
}

std::string jsonl_line(const Frame& frame, const LensFacts& lens) {
  if (const auto found = fault(frame))
    check(false, "truth of frame " + std::to_string(frame.frame) + ": " + *found);
  if (const auto found = fault(lens)) check(false, *found);
  OrderedJson object;
  object["frame"] = frame.frame;
  object["time_s"] = frame.time_s;
  object["damaged"] = frame.damaged;
  object["lens"] = json(lens);
  object["camera"] = {
      {"position_ned_m", json(frame.camera_position_ned_m)},
      {"attitude_yaw_pitch_roll_deg", json(frame.camera_attitude_yaw_pitch_roll_deg)}};
  object["motion"] = {{"state", frame.motion_state},
                      {"frame_from_reference", json(frame.shake.frame_from_reference)}};
  if (frame.shake.rotation) {
    const Quaternion& q = *frame.shake.rotation;
    object["motion"]["rotation"] = {q.w(), q.x(), q.y(), q.z()};
  }
  if (!frame.shake.rate_radps.isZero(0))
    object["motion"]["rate_radps"] = json(frame.shake.rate_radps);
  if (!frame.shake.frame_from_reference_per_s.isZero(0))
    object["motion"]["frame_from_reference_per_s"] = json(frame.shake.frame_from_reference_per_s);
  OrderedJson intruders = OrderedJson::array();
  for (const Intruder& intruder : frame.intruders) intruders.push_back(json(intruder));
  object["intruders"] = std::move(intruders);
  return object.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

}  // namespace airtruth::annotation
