// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "foundation/base/log.h"
#include "foundation/image/picture.h"
#include "truth/annotation/truth.h"
#include "world/scene/scene.h"

// A folder that `render` or `dataset import` has left, opened again.
namespace airtruth::sequence {

namespace fs = std::filesystem;

struct Finished {
  fs::path folder;
  std::string name;
  fs::path video;
  std::optional<scene::Scene> scene;  // empty: imported; then truth holds boxes and ranges alone
  annotation::Truth truth;
  // Covered boxes were looked for when it was made. In what is older there are none to be had.
  bool has_covered_boxes = false;
};

// Error where the folder is not whole: no sequence.json, or a file that it names is missing.
Finished open_finished(const fs::path& folder);

// Of every intruder that the truth names, in the order in which they come up.
std::vector<std::string> intruder_ids(const annotation::Truth& truth);

// Burns boxes, range and id into a copy of the video. mp4, mkv or avi by the extension of `out`.
struct OverlayOptions {
  bool overwrite = false;
  std::stop_token stop;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};
void write_overlay(const Finished& sequence, const fs::path& out, const OverlayOptions& options);

// Background, alpha and result of a frame around its intruder at `zoom`. `intruder_id` empty: the
// first that is in view. Error where the frame does not exist, no intruder is in view in it, or the
// clip was imported.
image::Rgb8 inspect(const Finished& sequence,
                    std::int64_t frame,
                    const std::string& intruder_id,
                    int zoom);

}  // namespace airtruth::sequence
