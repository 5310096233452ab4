// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/rendered_truth.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "encounter/separation/violation.h"
#include "foundation/json/json_object.h"
#include "labels/annotation/lens_facts.h"
#include "sequence/replay/finished.h"

namespace airtruth::detector_evaluation {
namespace {

namespace fs = std::filesystem;

const exchange::Label* label_of(const exchange::LabelledFrame& frame, std::int64_t track) {
  for (const exchange::Label& label : frame.labels)
    if (label.track == track) return &label;
  return nullptr;
}

scores::TruthObject object_of(const exchange::Label& label, const annotation::Intruder& intruder) {
  scores::TruthObject object;
  object.id = label.track;
  object.object_class = label.object_class;
  object.category = label.category;
  object.box_px = label.box_px;
  object.range_m = intruder.range_m;
  object.above_horizon = label.above_horizon;
  object.azimuth_deg = intruder.azimuth_deg;
  object.elevation_deg = intruder.elevation_deg;
  return object;
}

// What is visible has a box: the one that is asked for, or else, for what does not count, the
// visible one.
scores::TruthFrame frame_of(const annotation::Frame& truth,
                            dataset::Boxes boxes,
                            const annotation::LensFacts& lens) {
  scores::TruthFrame frame;
  frame.frame = truth.frame;
  frame.time_s = truth.time_s;
  const auto asked = sequences::labels_of(truth, boxes, lens.width, lens.height);
  const auto visible = sequences::labels_of(truth, dataset::Boxes::kVisible, lens.width, lens.height);
  for (const exchange::Label& shown : visible.labels) {
    const exchange::Label* label = label_of(asked, shown.track);
    const annotation::Intruder& intruder =
        truth.intruders[static_cast<std::size_t>(shown.track) - 1];
    frame.objects.push_back(object_of(label != nullptr ? *label : shown, intruder));
    frame.objects.back().counts = label != nullptr;
  }
  return frame;
}

// Velocity of the own aircraft at each frame, from its positions.
std::vector<Vector3> own_velocities(const std::vector<annotation::Frame>& frames) {
  std::vector<Vector3> velocities;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const annotation::Frame& before = frames[i == 0 ? 0 : i - 1];
    const annotation::Frame& after = frames[std::min(i + 1, frames.size() - 1)];
    const double seconds = after.time_s - before.time_s;
    velocities.push_back(
        seconds > 0
            ? Vector3((after.camera_position_ned_m - before.camera_position_ned_m) / seconds)
            : Vector3::Zero());
  }
  return velocities;
}

std::vector<PairState> states_of(const std::vector<annotation::Frame>& frames, std::size_t actor) {
  const std::vector<Vector3> velocities = own_velocities(frames);
  std::vector<PairState> states;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (actor >= frames[i].intruders.size()) continue;
    const annotation::Intruder& intruder = frames[i].intruders[actor];
    if (!intruder.position_ned_m || !intruder.velocity_ned_mps) continue;
    states.push_back({frames[i].time_s,
                      {frames[i].camera_position_ned_m, velocities[i]},
                      {*intruder.position_ned_m, *intruder.velocity_ned_mps}});
  }
  return states;
}

// Whether the scene asked for this volume, so that the record has its violations.
bool was_asked(const std::vector<annotation::Frame>& frames,
               std::size_t actor,
               const std::string& volume) {
  for (const annotation::Frame& frame : frames) {
    if (actor >= frame.intruders.size() || !frame.intruders[actor].encounter) continue;
    const auto& volumes = frame.intruders[actor].encounter->volumes;
    return std::any_of(
        volumes.begin(), volumes.end(), [&](const auto& one) { return one.name == volume; });
  }
  return false;
}

std::optional<double> recorded_violation_s(const JsonObject& record, const std::string& volume) {
  std::optional<double> first;
  for (const JsonObject& one : record.objects("violations"))
    if (one.text("volume") == volume)
      first = std::min(first.value_or(one.number("begin_s")), one.number("begin_s"));
  return first;
}

// The violation of a volume that the record does not have.
void ask_paths(const replay::Finished& finished,
               std::size_t actor,
               const encounter::Volume& volume,
               scores::TruthEncounter& encounter) {
  const std::vector<annotation::Frame>& frames = finished.truth.frames;
  const std::vector<PairState> states = states_of(frames, actor);
  // An aircraft whose path is over before the clip is does not fly on.
  const bool goes_on = !states.empty() && states.back().time_s == frames.back().time_s;
  const double lookahead_s = goes_on ? finished.scene->truth.lookahead_s : 0;
  encounter.has_volume = !states.empty();
  encounter.violation_s = first_violation_s(volume, states, lookahead_s);
}

scores::TruthEncounter encounter_of(const replay::Finished& finished,
                                    const JsonObject* record,
                                    std::size_t actor,
                                    const std::string& volume) {
  scores::TruthEncounter encounter;
  encounter.id = static_cast<std::int64_t>(actor) + 1;
  encounter.name = finished.truth.frames.front().intruders[actor].id;
  if (record != nullptr && record->has("closest_approach")) {
    const JsonObject closest = record->object("closest_approach");
    encounter.closest_approach_s = closest.number("time_s");
    encounter.closest_approach_m = closest.number("distance_m");
  }
  if (volume.empty()) return encounter;
  if (record != nullptr && was_asked(finished.truth.frames, actor, volume)) {
    encounter.has_volume = true;
    encounter.violation_s = recorded_violation_s(*record, volume);
  } else if (const auto* named = encounter::named_volume(volume)) {
    ask_paths(finished, actor, named->volume, encounter);
  }
  return encounter;
}

void add_encounters(const replay::Finished& finished,
                    const JsonObject& record,
                    const std::string& volume,
                    scores::TruthSequence& truth) {
  std::set<std::int64_t> aircraft;
  for (const scores::TruthFrame& frame : truth.frames)
    for (const scores::TruthObject& object : frame.objects)
      if (object.is_aircraft()) aircraft.insert(object.id);
  const std::vector<JsonObject> records =
      record.has("encounters") ? record.objects("encounters") : std::vector<JsonObject>{};
  truth.never_seen = std::count_if(
      records.begin(), records.end(), [](const JsonObject& one) { return !one.has("first_seen"); });
  for (const std::int64_t id : aircraft) {
    const auto actor = static_cast<std::size_t>(id) - 1;
    const std::string& name = finished.truth.frames.front().intruders[actor].id;
    const auto found = std::find_if(records.begin(), records.end(), [&](const JsonObject& one) {
      return one.text("id") == name;
    });
    truth.encounters.push_back(
        encounter_of(finished, found == records.end() ? nullptr : &*found, actor, volume));
  }
}

void add_times_to_approach(scores::TruthSequence& truth) {
  for (scores::TruthFrame& frame : truth.frames)
    for (scores::TruthObject& object : frame.objects) {
      const scores::TruthEncounter* encounter = truth.encounter(object.id);
      if (encounter != nullptr && encounter->closest_approach_s)
        object.to_closest_approach_s = *encounter->closest_approach_s - frame.time_s;
    }
}

}  // namespace

RenderedTruth rendered_truth(const fs::path& folder,
                             dataset::Boxes boxes,
                             const std::string& volume) {
  const replay::Finished finished = replay::open_finished(folder);
  const JsonDocument record(folder / "sequence.json");
  RenderedTruth rendered;
  rendered.first_background_frame = finished.scene->background.first_frame;
  scores::TruthSequence& truth = rendered.truth;
  truth.media = finished.video;
  truth.background = finished.scene->background.video.filename().string();
  truth.background_cut = fmt::format("{} from {}",
                                     finished.scene->background.video.string(),
                                     finished.scene->background.first_frame);
  truth.width = finished.truth.lens.width;
  truth.height = finished.truth.lens.height;
  truth.lens = annotation::lens_of(finished.truth.lens);
  if (const auto weight = record.maybe_number("weight")) {
    if (*weight < 0) record.fail("weight", "a number from 0 on");
    rendered.has_weight = true;
    truth.weight = *weight;
  }
  for (const annotation::Frame& frame : finished.truth.frames)
    truth.frames.push_back(frame_of(frame, boxes, finished.truth.lens));
  if (truth.frames.size() > 1 && truth.frames.back().time_s > 0)
    truth.frame_rate_hz = static_cast<double>(truth.frames.size() - 1) / truth.frames.back().time_s;
  if (!finished.truth.frames.empty()) add_encounters(finished, record, volume, truth);
  add_times_to_approach(truth);
  return rendered;
}

namespace {

constexpr int kHalvings = 40;

encounter::Mover between(const encounter::Mover& a, const encounter::Mover& b, double share) {
  return {a.position_ned_m + share * (b.position_ned_m - a.position_ned_m),
          a.velocity_ned_mps + share * (b.velocity_ned_mps - a.velocity_ned_mps)};
}

// `before` does not violate the volume and `after` does.
double entry_s(const encounter::Volume& volume, const PairState& before, const PairState& after) {
  double low = 0;
  double high = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double share = (low + high) / 2;
    const bool is_in = is_inside(volume,
                                 between(before.own, after.own, share),
                                 between(before.intruder, after.intruder, share));
    (is_in ? high : low) = share;
  }
  return before.time_s + high * (after.time_s - before.time_s);
}

}  // namespace

std::optional<double> first_violation_s(const encounter::Volume& volume,
                                        std::span<const PairState> states,
                                        double lookahead_s) {
  for (std::size_t i = 0; i < states.size(); ++i)
    if (is_inside(volume, states[i].own, states[i].intruder))
      return i == 0 ? states[i].time_s : entry_s(volume, states[i - 1], states[i]);
  if (states.empty()) return std::nullopt;
  const PairState& last = states.back();
  const auto later = encounter::violation(volume, last.own, last.intruder, lookahead_s);
  return later ? std::optional(last.time_s + later->begin_s) : std::nullopt;
}

}  // namespace airtruth::detector_evaluation
