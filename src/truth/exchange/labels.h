// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"

// Labelled video as the formats of others know it: boxes, tracks and classes by frame, and little
// else. What is unknown is empty, never a made-up number.
namespace airtruth::exchange {

namespace fs = std::filesystem;

// The pixels of an object in a picture: COCO's compressed run lengths (pixel_mask.h).
struct PixelMask {
  int width = 0;  // of the picture
  int height = 0;
  std::string counts;
  std::int64_t area_px = 0;
  bool operator==(const PixelMask&) const = default;
};

// One object in one frame.
struct Label {
  std::int64_t track = 1;  // the same object through a clip; from 1
  std::string category;
  Box box_px;                     // docs/conventions.md: the first pixel covers [0, 1)
  std::optional<double> visible;  // share of it that is seen, 0..1
  std::optional<bool> occluded;   // something else hides a part
  std::optional<bool> truncated;  // the frame's edge cuts a part off
  std::optional<double> range_m;
  std::optional<bool> above_horizon;
  std::optional<PixelMask> mask;  // not kept in labels.jsonl
  bool operator==(const Label&) const = default;
};

struct LabelledFrame {
  std::int64_t frame = 0;  // of the video
  std::optional<double> time_s;
  std::vector<Label> labels;
  bool operator==(const LabelledFrame&) const = default;
};

struct Clip {
  std::string name;  // a plain file name
  fs::path media;    // a video, a folder or a pattern of numbered images; empty: none
  int width = 0;     // 0: unknown
  int height = 0;
  std::optional<double> frame_rate_hz;
  std::vector<LabelledFrame> frames;  // in order; also those that show nothing
};

// labels.jsonl (docs/formats/labels.md): a line on the clip, then one a frame.
std::string labels_jsonl(const Clip& clip);
// Errors carry file and line.
Clip read_labels(const fs::path& file);

// Track numbers of a clip, ascending.
std::vector<std::int64_t> tracks_of(const Clip& clip);

}  // namespace airtruth::exchange
