// SPDX-License-Identifier: Apache-2.0
#include "detection/run/clips.h"

#include <cmath>

#include "foundation/base/error.h"
#include "sequence/replay/finished.h"
#include "truth/annotation/lens_facts.h"

namespace airtruth::detection {

DetectionClip clip_of(const dataset::LabelledSet& set, const std::string& name) {
  DetectionClip clip;
  clip.name = name;
  if (set.is_imported(name)) {
    const exchange::Clip labelled = set.clip(name);
    if (labelled.media.empty()) throw Error("'" + name + "' has no video");
    clip.media = labelled.media;
    for (const exchange::LabelledFrame& frame : labelled.frames) clip.frames.push_back(frame.frame);
    return clip;
  }
  const sequence::Finished finished = sequence::open_finished(set.folder(name));
  clip.media = finished.video;
  clip.lens = annotation::lens_of(finished.truth.lens);
  return clip;
}

DetectionClip clip_of(const fs::path& video) {
  DetectionClip clip;
  fs::path path = video;
  if (!path.has_filename()) path = path.parent_path();
  clip.name = path.stem().string();
  if (clip.name.find('%') != std::string::npos) clip.name = path.parent_path().filename().string();
  if (clip.name.empty()) clip.name = "video";
  clip.media = video;
  return clip;
}

std::vector<ExpectedSequence> sequences_of(const dataset::LabelledSet& set) {
  std::vector<ExpectedSequence> sequences;
  for (const std::string& name : set.names())
    sequences.push_back({name, 0, 0, set.facts(name).frames});
  return sequences;
}

lens::Lens guessed_lens(int width, int height) {
  const double half_across = std::tan(radians(30.0));
  const double vertical_deg = degrees(2 * std::atan(half_across * height / width));
  return lens::pinhole_from_vertical_fov(vertical_deg, {width, height});
}

}  // namespace airtruth::detection
