// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "exchange/labels.h"

namespace airtruth::dataset {

namespace fs = std::filesystem;

// What is known of a sequence before its labels are read.
struct ClipFacts {
  std::string name;
  std::string background;               // the video that it was made over; of an import, its own
  std::vector<std::string> categories;  // of what may be seen in it
  std::int64_t frames = 0;
};

// The labelled clips of a folder: a data set that `dataset build` made, whole or not; what
// `dataset import` made; or one or more sequences that `render` made.
class LabelledSet {
 public:
  // Error where the folder holds no sequence.
  explicit LabelledSet(const fs::path& root);

  const std::vector<std::string>& names() const { return names_; }  // sorted
  ClipFacts facts(const std::string& name) const;
  // With `media` as the path of its video.
  exchange::Clip clip(const std::string& name) const;
  fs::path folder(const std::string& name) const;
  // It was labelled elsewhere: of its camera nothing is known.
  bool is_imported(const std::string& name) const;
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
