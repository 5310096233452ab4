// SPDX-License-Identifier: Apache-2.0
#include <airtruth/truth.h>

#include "labels/annotation/lens_facts.h"
#include "library/records/lens_state.h"
#include "library/records/truth_values.h"

namespace airtruth {
namespace {

using annotation::State;

static_assert(static_cast<int>(IntruderState::kVisible) == static_cast<int>(State::kVisible));
static_assert(static_cast<int>(IntruderState::kHidden) == static_cast<int>(State::kHidden));
static_assert(static_cast<int>(IntruderState::kOutside) == static_cast<int>(State::kOutside));
static_assert(static_cast<int>(IntruderState::kBehind) == static_cast<int>(State::kBehind));
static_assert(static_cast<int>(IntruderState::kEnded) == static_cast<int>(State::kEnded));

using Three = std::array<double, 3>;

Three array_of(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
Three array_of(const YawPitchRoll& a) { return {a.yaw_deg, a.pitch_deg, a.roll_deg}; }
std::array<double, 2> array_of(const Pixel& p) { return {p.x(), p.y()}; }

template <typename T>
auto arrays_of(const std::optional<T>& value) {
  return value ? std::optional(array_of(*value)) : std::nullopt;
}

std::array<double, 9> rows_of(const Homography& h) {
  return {h(0, 0), h(0, 1), h(0, 2), h(1, 0), h(1, 1), h(1, 2), h(2, 0), h(2, 1), h(2, 2)};
}

Vector3 vector_of(const Three& a) { return {a[0], a[1], a[2]}; }
YawPitchRoll attitude_of(const Three& a) { return {a[0], a[1], a[2]}; }

std::optional<Vector3> vectors_of(const std::optional<Three>& a) {
  return a ? std::optional(vector_of(*a)) : std::nullopt;
}

Homography homography_of(const std::array<double, 9>& rows) {
  Homography h;
  h << rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7], rows[8];
  return h;
}

// The measures that both forms hold under the same names.
template <typename From, typename To>
void copy_measures(const From& from, To& to) {
  to.horizontal_m = from.horizontal_m;
  to.above_m = from.above_m;
  to.closing_speed_mps = from.closing_speed_mps;
  to.bearing_deg = from.bearing_deg;
  to.bearing_rate_dps = from.bearing_rate_dps;
  to.relative_bearing_deg = from.relative_bearing_deg;
  to.line_of_sight_rate_dps = from.line_of_sight_rate_dps;
  to.tcpa_s = from.tcpa_s;
  to.dcpa_m = from.dcpa_m;
  to.hmd_m = from.hmd_m;
  to.vmd_m = from.vmd_m;
  to.tau_mod_s = from.tau_mod_s;
  to.tcoa_s = from.tcoa_s;
}

// The members that both forms name and type alike.
template <typename From, typename To>
void copy_scalars(const From& from, To& to) {
  to.id = from.id;
  to.aircraft = from.aircraft;
  to.range_m = from.range_m;
  to.range_rate_mps = from.range_rate_mps;
  to.azimuth_deg = from.azimuth_deg;
  to.elevation_deg = from.elevation_deg;
  to.nominal_azimuth_deg = from.nominal_azimuth_deg;
  to.nominal_elevation_deg = from.nominal_elevation_deg;
  to.exact_box_px = from.exact_box_px;
  to.covered_box_px = from.covered_box_px;
  to.visible_box_px = from.visible_box_px;
  to.visible_area_px = from.visible_area_px;
  to.alpha_sum_px = from.alpha_sum_px;
  to.hidden_by_own_aircraft = from.hidden_by_own_aircraft;
  to.hidden_by_intruder = from.hidden_by_intruder;
  to.cut_by_frame = from.cut_by_frame;
  to.object_class = from.object_class;
}

IntruderTruth public_intruder(const annotation::Intruder& intruder) {
  IntruderTruth truth;
  copy_scalars(intruder, truth);
  truth.state = static_cast<IntruderState>(intruder.state);
  if (intruder.encounter) {
    EncounterTruth& encounter = truth.encounter.emplace();
    copy_measures(intruder.encounter->measures, encounter);
    for (const annotation::VolumeTruth& volume : intruder.encounter->volumes)
      encounter.volumes.push_back({volume.name, volume.inside, volume.to_violation_s});
  }
  truth.position_ned_m = arrays_of(intruder.position_ned_m);
  truth.velocity_ned_mps = arrays_of(intruder.velocity_ned_mps);
  truth.attitude_yaw_pitch_roll_deg = arrays_of(intruder.attitude_yaw_pitch_roll_deg);
  truth.position_in_cam_m = arrays_of(intruder.position_in_cam_m);
  truth.centroid_px = arrays_of(intruder.centroid_px);
  return truth;
}

annotation::Intruder intruder_of(const IntruderTruth& truth) {
  annotation::Intruder intruder;
  copy_scalars(truth, intruder);
  if (truth.encounter) {
    annotation::EncounterTruth& encounter = intruder.encounter.emplace();
    copy_measures(*truth.encounter, encounter.measures);
    encounter.measures.range_m = truth.range_m.value_or(0);
    for (const VolumeTruth& volume : truth.encounter->volumes)
      encounter.volumes.push_back({volume.name, volume.inside, volume.to_violation_s});
  }
  intruder.state = static_cast<State>(truth.state);
  intruder.position_ned_m = vectors_of(truth.position_ned_m);
  intruder.velocity_ned_mps = vectors_of(truth.velocity_ned_mps);
  if (truth.attitude_yaw_pitch_roll_deg)
    intruder.attitude_yaw_pitch_roll_deg = attitude_of(*truth.attitude_yaw_pitch_roll_deg);
  intruder.position_in_cam_m = vectors_of(truth.position_in_cam_m);
  if (truth.centroid_px)
    intruder.centroid_px = Pixel((*truth.centroid_px)[0], (*truth.centroid_px)[1]);
  return intruder;
}

}  // namespace

FrameTruth public_truth(const annotation::Frame& frame) {
  FrameTruth truth;
  truth.frame = frame.frame;
  truth.time_s = frame.time_s;
  truth.damaged = frame.damaged;
  truth.camera_position_ned_m = array_of(frame.camera_position_ned_m);
  truth.camera_attitude_yaw_pitch_roll_deg = array_of(frame.camera_attitude_yaw_pitch_roll_deg);
  truth.motion_state = frame.motion_state;
  truth.frame_from_reference = rows_of(frame.shake.frame_from_reference);
  truth.frame_from_reference_per_s = rows_of(frame.shake.frame_from_reference_per_s);
  if (const auto& q = frame.shake.rotation) truth.rotation = {q->w(), q->x(), q->y(), q->z()};
  truth.rate_radps = array_of(frame.shake.rate_radps);
  for (const annotation::Intruder& intruder : frame.intruders)
    truth.intruders.push_back(public_intruder(intruder));
  return truth;
}

annotation::Frame annotation_of(const FrameTruth& truth) {
  annotation::Frame frame;
  frame.frame = truth.frame;
  frame.time_s = truth.time_s;
  frame.damaged = truth.damaged;
  frame.camera_position_ned_m = vector_of(truth.camera_position_ned_m);
  frame.camera_attitude_yaw_pitch_roll_deg = attitude_of(truth.camera_attitude_yaw_pitch_roll_deg);
  frame.motion_state = truth.motion_state;
  frame.shake.frame_from_reference = homography_of(truth.frame_from_reference);
  frame.shake.frame_from_reference_per_s = homography_of(truth.frame_from_reference_per_s);
  if (const auto& q = truth.rotation)
    frame.shake.rotation = Quaternion((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  frame.shake.rate_radps = vector_of(truth.rate_radps);
  for (const IntruderTruth& intruder : truth.intruders)
    frame.intruders.push_back(intruder_of(intruder));
  return frame;
}

SequenceTruth public_truth(const annotation::Truth& truth) {
  SequenceTruth result{public_lens(annotation::lens_of(truth.lens)), {}};
  for (const annotation::Frame& frame : truth.frames) result.frames.push_back(public_truth(frame));
  return result;
}

SequenceTruth read_truth(const std::filesystem::path& file) {
  return public_truth(annotation::read_truth(file));
}

std::string truth_line(const FrameTruth& truth, const Lens& lens) {
  return annotation::jsonl_line(annotation_of(truth), annotation::facts_of(lens.state().lens));
}

}  // namespace airtruth
