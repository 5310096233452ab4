// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "foundation/base/log.h"
#include "truth/exchange/labels.h"

namespace airtruth::dataset {

namespace fs = std::filesystem;

// What is known of a sequence before its labels are read.
struct ClipFacts {
  std::string name;
  std::string background;               // the video that it was made over; of an import, its own
  std::vector<std::string> categories;  // of what may be seen in it
  std::int64_t frames = 0;
};

// Which box of truth.jsonl becomes a label's (docs/formats/truth.md).
enum class Boxes {
  kCovered,  // covered_box_px: the pixels that the aircraft itself covers; to train on
  kExact,    // exact_box_px, cut by the frame: where geometry has it, floating
  kVisible,  // visible_box_px: the pixels that changed, the codec's ripple with them
};
const char* name(Boxes boxes);  // "covered", "exact", "visible"
// Throws Error for any other name.
Boxes boxes_from_name(const std::string& name);

// The labelled clips of a folder: a data set that `dataset build` made, whole or not; what
// `dataset import` made; or one or more sequences that `render` made.
class LabelledSet {
 public:
  // Error where the folder holds no sequence.
  explicit LabelledSet(const fs::path& root);

  const std::vector<std::string>& names() const { return names_; }  // sorted
  ClipFacts facts(const std::string& name) const;
  // With `media` as the path of its video, and with the pixels of each object where `with_masks` is
  // asked for and the sequence has masks. Labels are of the frames in which an object is visible
  // and has such a box; imported clips have one box alone, whichever is asked for. Error where
  // covered boxes are asked for and the sequence is older than they are.
  exchange::Clip clip(const std::string& name,
                      Boxes boxes = Boxes::kCovered,
                      bool with_masks = false) const;
  // Covered, or visible where a sequence of the set is older than covered boxes are; that is said.
  Boxes usual_boxes(const Warn& warn) const;
  // The sequence was made with [output] masks = true.
  bool has_masks(const std::string& name) const;
  fs::path folder(const std::string& name) const;
  // It was labelled elsewhere: of its camera nothing is known.
  bool is_imported(const std::string& name) const;
  bool has_covered_boxes(const std::string& name) const;
  // Error where it has not.
  void expect_covered_boxes(const std::string& name) const;
  // Some of the sequences that the catalogue asks for are not there.
  std::int64_t missing() const { return missing_; }

 private:
  fs::path root_;
  std::vector<std::string> names_;
  std::int64_t missing_ = 0;
};

// "738/738-Ryanair" -> "738"; a model file's name without its ending.
std::string category_of(const std::string& aircraft);

}  // namespace airtruth::dataset
