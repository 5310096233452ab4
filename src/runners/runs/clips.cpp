// SPDX-License-Identifier: Apache-2.0
#include "runners/runs/clips.h"

#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/json/json_object.h"
#include "labels/annotation/lens_facts.h"
#include "scene/scene/scene.h"
#include "sequence/replay/finished.h"

namespace airtruth::runs {
namespace {

std::string name_of(fs::path video) {
  if (!video.has_filename()) video = video.parent_path();
  std::string name = video.stem().string();
  if (name.find('%') != std::string::npos) name = video.parent_path().filename().string();
  return name.empty() ? "video" : name;
}

}  // namespace

DetectionClip clip_of(const labelled::LabelledSet& set, const std::string& name) {
  DetectionClip clip;
  clip.name = name;
  if (set.is_imported(name)) {
    const exchange::Clip labelled = set.clip(name);
    if (labelled.media.empty()) throw Error("'" + name + "' has no video");
    clip.media = labelled.media;
    for (const exchange::LabelledFrame& frame : labelled.frames) clip.frames.push_back(frame.frame);
    return clip;
  }
  const replay::Finished finished = replay::open_finished(set.folder(name));
  clip.media = finished.video;
  clip.lens = annotation::lens_of(finished.truth.lens);
  if (finished.scene) clip.own_aircraft = finished.scene->background.mask;
  return clip;
}

DetectionClip clip_of(const fs::path& video) {
  DetectionClip clip;
  clip.name = name_of(video);
  clip.media = video;
  return clip;
}

std::vector<DetectionClip> backgrounds_of(const labelled::LabelledSet& set,
                                          const std::vector<std::string>& names,
                                          const Warn& warn) {
  using Part = std::tuple<fs::path, std::int64_t, std::int64_t>;
  std::set<Part> seen;
  std::map<std::string, int> count_of_name;
  std::vector<DetectionClip> clips;
  for (const std::string& name : names) {
    if (set.is_imported(name)) continue;
    const fs::path file = set.folder(name) / "sequence.json";
    const scene::Background background =
        scene::parse_scene(JsonDocument(file).text("scene_toml"), file).background;
    const Part part{background.video, background.first_frame, background.frame_count.value_or(-1)};
    if (!seen.insert(part).second) continue;
    if (!fs::exists(background.video) && background.video.string().find('%') == std::string::npos) {
      airtruth::warn(warn,
                     background.video.string() + ": the background of '" + name +
                         "' is not there; it is left out");
      continue;
    }
    DetectionClip clip = clip_of(background.video);
    if (const int count = ++count_of_name[clip.name]; count > 1)
      clip.name += fmt::format("-{}", count);
    clip.own_aircraft = background.mask;
    clip.first_frame = background.first_frame;
    clip.frame_count = background.frame_count;
    clip.lens = annotation::lens_of(annotation::read_truth(set.folder(name) / "truth.jsonl").lens);
    clips.push_back(std::move(clip));
  }
  return clips;
}

std::vector<results::ExpectedSequence> sequences_of(const labelled::LabelledSet& set) {
  std::vector<results::ExpectedSequence> sequences;
  for (const std::string& name : set.names())
    sequences.push_back({name, 0, 0, set.facts(name).frames});
  return sequences;
}

lens::Lens guessed_lens(int width, int height) {
  const double half_across = std::tan(radians(30.0));
  const double vertical_deg = degrees(2 * std::atan(half_across * height / width));
  return lens::pinhole_from_vertical_fov(vertical_deg, {width, height});
}

}  // namespace airtruth::runs
