// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <airtruth/export.h>
#include <airtruth/labels.h>
#include <airtruth/lens.h>
#include <airtruth/truth.h>

namespace airtruth {

namespace dataset {

// Selects the box of truth.jsonl that becomes a label's box (docs/formats/truth.md).
enum class Boxes {
  // covered_box_px bounds the pixels that the aircraft itself covers. It is the box for training.
  kCovered,
  // exact_box_px, cut at the frame's edges, is the box that geometry gives, in fractions of a
  // pixel.
  kExact,
  // visible_box_px bounds the pixels that changed, with the codec's ripple.
  kVisible,
};

}  // namespace dataset

// One video of a data set with what is known about it.
struct Sequence {
  std::string name;
  std::filesystem::path folder;
  // Its own video (VideoReader of <airtruth/video.h> reads it); empty for an imported clip without
  // pictures.
  std::filesystem::path video;
  // True where the clip was labelled elsewhere and imported: `labels` is all that is known.
  bool is_imported = false;
  // The truth of every frame, and the lens; empty for an imported clip.
  std::optional<SequenceTruth> truth;
  // The boxes of the frames in which an intruder is visible. A rendered sequence has no
  // frame_rate_hz here; its frames have times.
  exchange::Clip labels;
};

// The sequences of a folder that `airtruth dataset build`, `dataset import` or `render` has made. A
// data set may be incomplete.
//
// Example: a set with the sequences "sky-b737" and "sky-c172".
//   const DataSet set("set");
//   for (const std::string& name : set.names())
//     std::cout << name << ": " << set.sequence(name).labels.frames.size() << " frames\n";
class AIRTRUTH_API DataSet {
 public:
  // Throws Error where the folder holds no sequence.
  explicit DataSet(const std::filesystem::path& folder);

  // Sorted.
  const std::vector<std::string>& names() const;

  // Reads a sequence, which may take a second for many thousand frames. Throws Error for a name
  // that the set lacks, and for a file that is missing or broken.
  Sequence sequence(const std::string& name, dataset::Boxes boxes = dataset::Boxes::kCovered) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace airtruth
