// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/image/picture.h"
#include "labels/annotation/truth.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/encounter_record.h"

// Opens a folder that `render` or `dataset import` has made.
namespace airtruth::replay {

struct Finished {
  fs::path folder;
  std::string name;
  fs::path video;
  // Of numbered pictures, which state none: that of the truth's times, or of the labels of an
  // imported clip. Empty: it is not known.
  std::optional<double> picture_rate_hz;
  // Empty for an imported clip, whose truth holds only boxes and ranges.
  std::optional<scene::Scene> scene;
  annotation::Truth truth;
  // In the order of the scene; empty for an imported clip.
  std::vector<pipeline::EncounterRecord> encounters;
};

// Throws Error where the folder is not whole: sequence.json or a file that it names is missing.
Finished open_finished(const fs::path& folder);

// Returns the id of every intruder in the truth, in order of first appearance.
std::vector<std::string> intruder_ids(const annotation::Truth& truth);

// Draws boxes, range and id into a copy of the video. The extension of `out` selects mp4, mkv or
// avi.
struct OverlayOptions {
  bool overwrite = false;
  std::stop_token stop;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};
void write_overlay(const Finished& sequence, const fs::path& out, const OverlayOptions& options);

// Returns background, alpha and result of a frame around its intruder, enlarged by `zoom`. An empty
// `intruder_id` selects the first intruder in view. Throws Error where the frame does not exist, no
// intruder is in view in it, the clip was imported, or a file that it was made of is another now.
image::Rgb8 inspect(const Finished& sequence,
                    std::int64_t frame,
                    const std::string& intruder_id,
                    int zoom);

// Renders every n-th frame of a finished sequence again, from its record, its background and the
// motion in its truth, and compares the results. The truth line must be equal; a lossless video
// must be equal sample by sample; a lossy video may differ around the intruder no more than its
// codec's error elsewhere. Each fault is one line. `compared` counts the compared frames.
struct Recomposition {
  std::int64_t compared = 0;
  std::vector<std::string> faults;
};
Recomposition recompose(const Finished& sequence, std::int64_t every, const std::stop_token& stop);

}  // namespace airtruth::replay
