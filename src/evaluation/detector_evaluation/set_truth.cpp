// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/set_truth.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "camera/lens/lens.h"
#include "dataset/sequences/labels_of_truth.h"
#include "encounter/passage/passage.h"
#include "encounter/separation/violation.h"
#include "evaluation/scores/ignored_regions.h"
#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/image/contrast_to_noise.h"
#include "foundation/json/json_object.h"
#include "labels/annotation/truth.h"
#include "picture/video/numbered_frames.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/encounter_record.h"
#include "sequence/replay/finished.h"
#include "sequence/replay/recorded_inputs.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::detector_evaluation {
namespace {

constexpr const char* kIgnore = "ignore";
constexpr const char* kIgnoreFile = "ignore.csv";

scores::TruthObject object_of(const exchange::Label& label) {
  scores::TruthObject object;
  object.id = label.track;
  object.object_class = label.object_class;
  object.category = label.category;
  object.box_px = label.box_px;
  object.area_px = label.area_px.value_or(label.box_px.area());
  object.range_m = label.range_m;
  object.above_horizon = label.above_horizon;
  return object;
}

// The aircraft that any frame shows, with their categories.
std::map<std::int64_t, std::string> aircraft_in(const scores::TruthSequence& truth) {
  std::map<std::int64_t, std::string> aircraft;
  for (const scores::TruthFrame& frame : truth.frames)
    for (const scores::TruthObject& object : frame.objects)
      if (object.is_aircraft()) aircraft.try_emplace(object.id, object.category);
  return aircraft;
}

scores::TruthSequence imported_truth(const labelled::LabelledSet& set,
                                     const std::string& name,
                                     results::ExpectedSequence& expected) {
  exchange::Clip clip = set.clip(name);
  scores::TruthSequence truth;
  truth.name = name;
  truth.media = clip.media;
  truth.background_file = clip.media.filename().string();
  expected.category_ids = clip.category_ids;
  truth.width = clip.width;
  truth.height = clip.height;
  truth.frame_rate_hz = clip.frame_rate_hz.value_or(0);
  for (const exchange::LabelledFrame& labelled : clip.frames) {
    scores::TruthFrame& frame = truth.frames.emplace_back();
    frame.frame = labelled.frame;
    frame.image_id = labelled.image_id;
    expected.pictures.push_back(labelled.picture);
    expected.image_ids.push_back(labelled.image_id);
    const std::optional<double> time_s = clip.time_s_of(labelled);
    truth.has_times = truth.has_times && time_s;
    frame.time_s = time_s.value_or(0);
    for (const exchange::Label& label : labelled.labels)
      if (label.object_class == kIgnore)
        frame.ignored_px.push_back(label.box_px);
      else
        frame.objects.push_back(object_of(label));
  }
  for (const auto& [id, category] : aircraft_in(truth))
    truth.encounters.push_back({.id = id, .name = fmt::format("{} {}", category, id)});
  return truth;
}

// What is visible has a box: the covered one, or else, for what does not count, the visible one.
scores::TruthFrame frame_of(const annotation::Frame& truth, const lens::Facts& lens) {
  scores::TruthFrame frame;
  frame.frame = truth.frame;
  frame.time_s = truth.time_s;
  const auto covered =
      sequences::labels_of(truth, dataset::Boxes::kCovered, lens.width, lens.height);
  const auto visible =
      sequences::labels_of(truth, dataset::Boxes::kVisible, lens.width, lens.height);
  for (const exchange::Label& shown : visible.labels) {
    const auto label = std::ranges::find(covered.labels, shown.track, &exchange::Label::track);
    const bool is_covered = label != covered.labels.end();
    const annotation::Intruder& intruder =
        truth.intruders[static_cast<std::size_t>(shown.track) - 1];
    scores::TruthObject& object =
        frame.objects.emplace_back(object_of(is_covered ? *label : shown));
    object.counts = is_covered;
    object.range_m = intruder.range_m;
    object.azimuth_deg = intruder.azimuth_deg;
    object.elevation_deg = intruder.elevation_deg;
  }
  return frame;
}

// Whether the scene asked for this volume, so that the record has its violations.
bool was_asked(const std::vector<annotation::Frame>& frames,
               std::size_t actor,
               const std::string& volume) {
  for (const annotation::Frame& frame : frames) {
    if (actor >= frame.intruders.size() || !frame.intruders[actor].encounter) continue;
    const auto& volumes = frame.intruders[actor].encounter->volumes;
    return std::ranges::any_of(volumes, [&](const auto& one) { return one.name == volume; });
  }
  return false;
}

// The violation of a volume that the record does not have, of the same paths over the same time.
void ask_paths(const replay::Finished& finished,
               const separation::Volume& volume,
               setup::SharedInputs& inputs,
               scores::TruthEncounter& encounter) {
  const scene::Scene& scene = *finished.scene;
  const auto intruder = std::ranges::find(scene.intruders, encounter.name, &scene::Intruder::id);
  if (intruder == scene.intruders.end() || !intruder->seen.empty()) return;
  const double last_s = finished.truth.frames.back().time_s;
  const auto as_made = [&](const fs::path& file) {
    const auto found = replay::find_input(file, finished.folder, inputs);
    if (!found) throw Error("is another file now", {file.string()});
    return *found;
  };
  try {
    scene::Camera camera = scene.camera;
    for (const auto& file : {scene.camera.path_file, scene.camera.log, intruder->path_file})
      if (file) as_made(*file);
    setup::state_clip_start(camera,
                            camera.log ? as_made(scene.background.video) : scene.background.video,
                            scene.background.first_frame,
                            scene.background.frame_rate_hz);
    const trajectory::Path own = setup::camera_path(camera);
    const auto found =
        passage::violations(volume,
                            passage::beyond_clip(own, last_s),
                            passage::beyond_clip(setup::path_of(*intruder, own), last_s),
                            0,
                            last_s + scene.truth.lookahead_s);
    encounter.has_volume = true;
    if (!found.empty()) encounter.violation_s = found.front().begin_s;
  } catch (const Error&) {
    // The file of a path is not there any more, or is another one: whether they violate the volume
    // is unknown.
  }
}

scores::TruthEncounter encounter_of(const replay::Finished& finished,
                                    std::int64_t id,
                                    const std::string& volume,
                                    setup::SharedInputs& inputs) {
  const std::vector<annotation::Frame>& frames = finished.truth.frames;
  const auto actor = static_cast<std::size_t>(id) - 1;
  scores::TruthEncounter encounter{.id = id, .name = frames.front().intruders[actor].id};
  const auto record =
      std::ranges::find(finished.encounters, encounter.name, &pipeline::EncounterRecord::id);
  const bool is_recorded = record != finished.encounters.end();
  if (is_recorded && record->closest) {
    encounter.closest_approach_s = record->closest->time_s;
    encounter.closest_approach_m = record->closest->distance_m;
  }
  if (volume.empty()) return encounter;
  if (is_recorded && was_asked(frames, actor, volume)) {
    encounter.has_volume = true;
    std::optional<double>& first_s = encounter.violation_s;
    for (const pipeline::NamedInterval& one : record->violations)
      if (one.volume == volume)
        first_s = std::min(first_s.value_or(one.time.begin_s), one.time.begin_s);
  } else if (const auto* named = separation::named_volume(volume)) {
    ask_paths(finished, named->volume, inputs, encounter);
  }
  return encounter;
}

void add_times_to_approach(scores::TruthSequence& truth) {
  for (scores::TruthFrame& frame : truth.frames)
    for (scores::TruthObject& object : frame.objects) {
      const scores::TruthEncounter* encounter = truth.encounter(object.id);
      if (encounter != nullptr && encounter->closest_approach_s)
        object.to_closest_approach_s = *encounter->closest_approach_s - frame.time_s;
    }
}

// Without its duration.
scores::TruthSequence rendered_truth(const labelled::LabelledSet& set,
                                     const std::string& name,
                                     const std::string& volume,
                                     setup::SharedInputs& inputs) {
  const fs::path folder = set.folder(name);
  const replay::Finished finished = replay::open_finished(folder);
  const JsonDocument record(folder / "sequence.json");
  scores::TruthSequence truth;
  truth.first_background_frame = finished.scene->background.first_frame;
  truth.media = finished.video;
  truth.background_file = finished.scene->background.video.filename().string();
  truth.background_cut = fmt::format("{} from {}",
                                     finished.scene->background.video.string(),
                                     finished.scene->background.first_frame);
  truth.width = finished.truth.lens.width;
  truth.height = finished.truth.lens.height;
  truth.lens = lens::lens_of(finished.truth.lens);
  truth.weight = record.maybe_number("weight");
  if (truth.weight && *truth.weight < 0) record.fail("weight", "a number from 0 on");
  for (const annotation::Frame& frame : finished.truth.frames)
    truth.frames.push_back(frame_of(frame, finished.truth.lens));
  if (truth.frames.size() > 1 && truth.frames.back().time_s > 0)
    truth.frame_rate_hz = static_cast<double>(truth.frames.size() - 1) / truth.frames.back().time_s;
  else
    truth.frame_rate_hz = set.clip(name).frame_rate_hz.value_or(0);
  for (const auto& [id, category] : aircraft_in(truth))
    truth.encounters.push_back(encounter_of(finished, id, volume, inputs));
  if (!truth.frames.empty())
    truth.never_seen = std::ranges::count_if(
        finished.encounters, [](const auto& one) { return !one.first_seen.has_value(); });
  add_times_to_approach(truth);
  return truth;
}

// Frames over the rate. Clips may hold every n-th frame of a video, so the span of the times comes
// first where they are known.
double duration_s(const scores::TruthSequence& truth) {
  const std::size_t frames = truth.frames.size();
  if (frames == 0) return 0;
  const double span_s = truth.frames.back().time_s - truth.frames.front().time_s;
  if (frames > 1 && span_s > 0)
    return span_s * static_cast<double>(frames) / static_cast<double>(frames - 1);
  return truth.frame_rate_hz > 0 ? static_cast<double>(frames) / truth.frame_rate_hz : 0;
}

void start_at_0(scores::TruthSequence& truth) {
  if (truth.frames.empty()) return;
  const double first_s = truth.frames.front().time_s;
  for (scores::TruthFrame& frame : truth.frames) frame.time_s -= first_s;
}

// Whether a region is for this sequence; then the number that its background's frames have more
// than the sequence's.
std::optional<std::int64_t> offset_of(const scores::IgnoredRegion& region,
                                      const scores::TruthSequence& truth) {
  if (matches(region.sequence, truth.name)) return 0;
  if (!region.sequence.empty() &&
      (region.sequence == truth.background_file || region.sequence == truth.background))
    return truth.first_background_frame;
  return std::nullopt;
}

void ignore_regions(const fs::path& file, std::vector<scores::TruthSequence>& sequences) {
  for (const scores::IgnoredRegion& region : scores::read_ignored_regions(file)) {
    bool fits_any = false;
    for (scores::TruthSequence& sequence : sequences) {
      const auto offset = offset_of(region, sequence);
      if (!offset) continue;
      fits_any = true;
      for (scores::TruthFrame& frame : sequence.frames) {
        const std::int64_t number = frame.frame + *offset;
        if (number >= region.first_frame && number <= region.last_frame.value_or(number))
          frame.ignored_px.push_back(region.box_px);
      }
    }
    if (!fits_any)
      throw Error("'" + region.sequence +
                      "' is neither a sequence of the set nor the file name of "
                      "a background",
                  {file.string(), region.line});
  }
}

// `is_known`: of a sequence.
void leave_out(SetTruth& set,
               const auto& is_known,
               const std::string& what,
               const std::string& where) {
  std::size_t shown = 0;
  std::size_t unknown = 0;
  for (const scores::TruthSequence& truth : set.sequences) {
    if (truth.encounters.empty()) continue;
    ++shown;
    unknown += is_known(truth) ? 0 : 1;
  }
  if (unknown > 0)
    set.left_out.push_back(fmt::format(
        "{} unknown for {} of {} sequences with an aircraft; {}", what, unknown, shown, where));
}

bool has_range(const scores::TruthSequence& truth) {
  return std::ranges::any_of(truth.frames, [](const scores::TruthFrame& frame) {
    return std::ranges::any_of(frame.objects, [](const scores::TruthObject& object) {
      return object.is_aircraft() && object.range_m;
    });
  });
}

void say_what_is_missing(SetTruth& set, const std::string& volume) {
  std::int64_t never_seen = 0;
  for (const scores::TruthSequence& truth : set.sequences) never_seen += truth.never_seen;
  if (never_seen > 0)
    set.left_out.push_back(fmt::format(
        "{} intruders are never in view; shares of encounters leave them out", never_seen));
  const auto of_any_encounter = [](auto is_known) {
    return [is_known](const scores::TruthSequence& truth) {
      return std::ranges::any_of(truth.encounters, is_known);
    };
  };
  leave_out(set,
            has_range,
            "the range is",
            "detection by range, declaration ranges and AOT's measures leave them out");
  leave_out(
      set,
      [](const scores::TruthSequence& truth) { return truth.has_times; },
      "the frame rate is",
      "declarations leave them out");
  leave_out(
      set,
      [](const scores::TruthSequence& truth) { return truth.lens.has_value(); },
      "the lens is",
      "bearing errors and detection by azimuth leave them out");
  leave_out(set,
            of_any_encounter([](const scores::TruthEncounter& one) {
              return one.closest_approach_s.has_value();
            }),
            "the closest approach is",
            "times to it leave them out");
  if (!volume.empty())
    leave_out(set,
              of_any_encounter([](const scores::TruthEncounter& one) { return one.has_volume; }),
              "whether '" + volume + "' is violated is",
              "declarations in time leave them out");
}

// A category that has objects of several classes is an aircraft's where any of them is one.
void add_classes(std::vector<scores::TruthSequence>& sequences) {
  std::map<std::string, std::string> class_of;
  for (const scores::TruthSequence& truth : sequences)
    for (const scores::TruthFrame& frame : truth.frames)
      for (const scores::TruthObject& object : frame.objects)
        if (std::string& known = class_of[object.category]; known.empty() || object.is_aircraft())
          known = object.object_class;
  for (scores::TruthSequence& truth : sequences) truth.class_of = class_of;
}

void drop_hours_unless_all_known(SetTruth& set) {
  const auto unknown =
      std::ranges::count_if(set.sequences, [](const auto& t) { return !(t.duration_s > 0); });
  if (unknown == 0) return;
  for (scores::TruthSequence& truth : set.sequences) truth.duration_s = 0;
  set.left_out.push_back(
      fmt::format("the frame rate is unknown for {} of {} sequences; there are no durations, nor "
                  "false alarms and tracks an hour",
                  unknown,
                  set.sequences.size()));
}

void expect_volume(const SetTruth& set, const std::string& volume) {
  if (volume.empty() || separation::named_volume(volume) != nullptr) return;
  for (const scores::TruthSequence& truth : set.sequences)
    for (const scores::TruthEncounter& one : truth.encounters)
      if (one.has_volume) return;
  const std::vector<std::string> names = separation::volume_names();
  const auto nearest = nearest_spelling(volume, names);
  throw Error(fmt::format("--volume is '{}'{}; expected {}, or a volume of the scenes' own",
                          volume,
                          nearest ? " (did you mean '" + *nearest + "'?)" : "",
                          fmt::join(names, ", ")));
}

}  // namespace

SetTruth set_truth(const fs::path& folder, const std::string& volume, fs::path ignore) {
  const labelled::LabelledSet set(folder);
  SetTruth result;
  setup::SharedInputs inputs;
  std::size_t weighted = 0;
  for (const std::string& name : set.names()) {
    results::ExpectedSequence& expected = result.expected.emplace_back();
    scores::TruthSequence& truth = result.sequences.emplace_back(
        set.is_imported(name) ? imported_truth(set, name, expected)
                              : rendered_truth(set, name, volume, inputs));
    labelled::ClipFacts facts = set.facts(name);
    expected.name = name;
    expected.width = truth.width;
    expected.height = truth.height;
    expected.frames = std::ssize(truth.frames);
    expected.categories = std::move(facts.categories);
    expected.distractors = std::move(facts.distractors);
    weighted += truth.weight ? 1 : 0;
    truth.name = name;
    truth.background = std::move(facts.background_name);
    truth.weather = std::move(facts.weather);
    truth.sha256 = set.sha256_of(name);
    start_at_0(truth);
    truth.duration_s = duration_s(truth);
  }
  result.is_weighted = weighted > 0;
  if (result.is_weighted && weighted < result.sequences.size())
    result.left_out.push_back(
        fmt::format("{} of {} sequences have no encounter weight; weighted shares count them with "
                    "a weight of 1",
                    result.sequences.size() - weighted,
                    result.sequences.size()));
  add_classes(result.sequences);
  expect_volume(result, volume);
  if (ignore.empty() && fs::exists(folder / kIgnoreFile)) ignore = folder / kIgnoreFile;
  if (!ignore.empty()) ignore_regions(ignore, result.sequences);
  drop_hours_unless_all_known(result);
  say_what_is_missing(result, volume);
  return result;
}

void measure_contrast(scores::TruthSequence& truth, const std::stop_token& stop) {
  if (truth.media.empty()) return;
  video::NumberedFrames pictures(truth.media, {});
  for (scores::TruthFrame& frame : truth.frames) {
    if (frame.objects.empty()) continue;
    const image::Picture& picture = pictures.labelled(frame.frame, truth.name, stop);
    for (scores::TruthObject& object : frame.objects)
      object.contrast_to_noise = image::contrast_to_noise(picture, pixels_of(object.box_px));
  }
}

}  // namespace airtruth::detector_evaluation
