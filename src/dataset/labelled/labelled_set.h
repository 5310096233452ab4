// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <airtruth/labels.h>

#include "dataset/sequences/labels_of_truth.h"
#include "dataset/sequences/layout.h"
#include "foundation/base/files.h"

namespace airtruth::labelled {

// Facts about a sequence that are available before its labels are read.
struct ClipFacts {
  std::string name;
  // The background video; for an imported clip, its own video.
  std::string background;
  // What the scene or catalogue calls it, or the name of its file; for an imported clip of
  // pictures, the clip's own name.
  std::string background_name;
  // The categories of the objects that may appear in the sequence.
  std::set<std::string> categories;
  // Those of them that are no aircraft.
  std::set<std::string> distractors;
  std::int64_t frames = 0;
  // scene::weather_facts() of its scene; empty for an imported clip.
  std::map<std::string, double> weather;
};

// The labelled clips of a folder: of a data set that `dataset build` made, complete or not; of the
// output of `dataset import`; or of one or more sequences that `render` made
// (sequences::SequenceFolders).
class LabelledSet {
 public:
  // Throws Error where the folder holds no sequence.
  explicit LabelledSet(const fs::path& root);

  const std::vector<std::string>& names() const { return folders_.names; }  // sorted
  ClipFacts facts(const std::string& name) const;
  // Returns one clip; its `media` is the path of its video. Labels exist for the frames in which an
  // object is visible and has the requested box. Each label holds its object's pixels where
  // `with_masks` is true and the sequence has masks. An imported clip has a single kind of box,
  // which is returned for every value of `boxes`.
  exchange::Clip clip(const std::string& name,
                      dataset::Boxes boxes = dataset::Boxes::kCovered,
                      bool with_masks = false) const;
  fs::path folder(const std::string& name) const;
  // True where the clip was labelled elsewhere; nothing is known about its camera.
  bool is_imported(const std::string& name) const;
  // SHA-256 of the file that names a sequence's content: its labels where it was labelled
  // elsewhere, else its record, which holds the checksums of its files.
  std::string sha256_of(const std::string& name) const;
  // The number of sequences of the catalogue that the folder does not hold.
  std::int64_t missing() const { return missing_; }

 private:
  sequences::SequenceFolders folders_;
  std::int64_t missing_ = 0;
};

}  // namespace airtruth::labelled
