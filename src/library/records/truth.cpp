// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/truth.h"

#include <type_traits>

#include <airtruth/truth.h>

#include "labels/annotation/lens_facts.h"
#include "labels/annotation/truth_fields.h"
#include "library/records/public_forms.h"

namespace airtruth {
namespace {

using Three = std::array<double, 3>;

void convert(const Vector3& from, Three& to) { to = {from.x(), from.y(), from.z()}; }
void convert(const Three& from, Vector3& to) { to = {from[0], from[1], from[2]}; }
void convert(const YawPitchRoll& from, Three& to) {
  to = {from.yaw_deg, from.pitch_deg, from.roll_deg};
}
void convert(const Three& from, YawPitchRoll& to) { to = {from[0], from[1], from[2]}; }
void convert(const Pixel& from, std::array<double, 2>& to) { to = {from.x(), from.y()}; }
void convert(const std::array<double, 2>& from, Pixel& to) { to = {from[0], from[1]}; }
void convert(const Quaternion& from, std::array<double, 4>& to) {
  to = {from.w(), from.x(), from.y(), from.z()};
}
void convert(const std::array<double, 4>& from, Quaternion& to) {
  to = Quaternion(from[0], from[1], from[2], from[3]);
}
void convert(const Homography& from, std::array<double, 9>& to) {
  for (int i = 0; i < 9; ++i) to[static_cast<std::size_t>(i)] = from(i / 3, i % 3);
}
void convert(const std::array<double, 9>& from, Homography& to) {
  for (int i = 0; i < 9; ++i) to(i / 3, i % 3) = from[static_cast<std::size_t>(i)];
}
void convert(const annotation::EncounterTruth& from, EncounterTruth& to);
void convert(const EncounterTruth& from, annotation::EncounterTruth& to);

template <typename From, typename To>
void copy(const From& from, To& to) {
  if constexpr (std::is_same_v<From, To>)
    to = from;
  else
    convert(from, to);
}

template <typename From, typename To>
void copy(const std::optional<From>& from, std::optional<To>& to) {
  to.reset();
  if (from) copy(*from, to.emplace());
}

// Visit of truth_fields.h.
struct Copying {
  template <typename From, typename To>
  void operator()(const char*, const From& from, To& to) const {
    copy(from, to);
  }
};

void convert(const annotation::EncounterTruth& from, EncounterTruth& to) {
  annotation::each_measure(Copying{}, from.measures, to);
  to.volumes = from.volumes;
}

void convert(const EncounterTruth& from, annotation::EncounterTruth& to) {
  annotation::each_measure(Copying{}, from, to.measures);
  to.volumes = from.volumes;
}

template <typename To, typename From>
To intruder_of(const From& from) {
  To to;
  to.id = from.id;
  to.aircraft = from.aircraft;
  to.object_class = from.object_class;
  annotation::each_field(Copying{}, from, to);
  return to;
}

// What the two forms of a frame have in common. The public form holds the shake's members itself.
template <typename From, typename FromShake, typename To, typename ToShake>
void copy_frame(const From& from, const FromShake& from_shake, To& to, ToShake& to_shake) {
  to.frame = from.frame;
  to.time_s = from.time_s;
  to.damaged = from.damaged;
  to.motion_state = from.motion_state;
  copy(from.camera_position_ned_m, to.camera_position_ned_m);
  copy(from.camera_attitude_yaw_pitch_roll_deg, to.camera_attitude_yaw_pitch_roll_deg);
  copy(from_shake.frame_from_reference, to_shake.frame_from_reference);
  copy(from_shake.frame_from_reference_per_s, to_shake.frame_from_reference_per_s);
  copy(from_shake.rotation, to_shake.rotation);
  copy(from_shake.rate_radps, to_shake.rate_radps);
}

annotation::Frame annotation_of(const FrameTruth& truth) {
  annotation::Frame frame;
  copy_frame(truth, truth, frame, frame.shake);
  for (const IntruderTruth& intruder : truth.intruders) {
    frame.intruders.push_back(intruder_of<annotation::Intruder>(intruder));
    if (auto& encounter = frame.intruders.back().encounter)
      encounter->measures.range_m = intruder.range_m.value_or(0);
  }
  return frame;
}

}  // namespace

FrameTruth public_truth(const annotation::Frame& frame) {
  FrameTruth truth;
  copy_frame(frame, frame.shake, truth, truth);
  for (const annotation::Intruder& intruder : frame.intruders)
    truth.intruders.push_back(intruder_of<IntruderTruth>(intruder));
  return truth;
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
