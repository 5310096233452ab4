// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"

// Labelled video in the terms that annotation formats share: boxes, tracks and classes by frame. A
// field without information is empty and never holds a placeholder number.
namespace airtruth::exchange {

namespace fs = std::filesystem;

// The pixels of an object in a picture, as COCO's compressed run lengths (pixel_mask.h).
struct PixelMask {
  int width = 0;  // of the picture
  int height = 0;
  std::string counts;
  std::int64_t area_px = 0;
  bool operator==(const PixelMask&) const = default;
};

// One object in one frame.
struct Label {
  // Number of the object's track, the same throughout a clip; from 1.
  std::int64_t track = 1;
  std::string category;
  // The first pixel covers [0, 1); docs/conventions.md.
  Box box_px;
  // Visible share of the object, 0..1.
  std::optional<double> visible;
  // True where something else hides a part.
  std::optional<bool> occluded;
  // True where the frame's edge cuts a part off.
  std::optional<bool> truncated;
  std::optional<double> range_m;
  std::optional<bool> above_horizon;
  // The file labels.jsonl does not store it.
  std::optional<PixelMask> mask;
  bool operator==(const Label&) const = default;
};

// All labels of one frame.
struct LabelledFrame {
  // Number of the frame in the video.
  std::int64_t frame = 0;
  std::optional<double> time_s;
  std::vector<Label> labels;
  bool operator==(const LabelledFrame&) const = default;
};

// All labels of one video.
struct Clip {
  // A plain file name (scene::is_plain_file_name).
  std::string name;
  // A video, a folder or a pattern of numbered images; empty: none.
  fs::path media;
  // 0: unknown.
  int width = 0;
  int height = 0;
  std::optional<double> frame_rate_hz;
  // In order, including the frames without an object.
  std::vector<LabelledFrame> frames;
};

// The text of labels.jsonl (docs/formats/labels.md): one line for the clip, then one for each
// frame.
std::string labels_jsonl(const Clip& clip);
// Reads labels.jsonl. Errors carry file and line.
Clip read_labels(const fs::path& file);

// The track numbers of a clip, ascending.
std::vector<std::int64_t> tracks_of(const Clip& clip);

}  // namespace airtruth::exchange
