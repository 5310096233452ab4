// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "dataset/catalogue.h"

namespace airtruth::dataset {

// Where a background of the catalogue lies on this machine.
struct BackgroundFiles {
  fs::path video;
  std::optional<fs::path> mask;
};

// One sequence of a catalogue.
struct Item {
  std::int64_t index = 0;
  std::string name;
  std::size_t background = 0;
  std::int64_t frame_count = 0;
  scene::Scene scene;  // its [background] is filled in by place()
};

// The sequences of a catalogue by number, in the order of the file. Nothing is held but the
// catalogue, so that a million sequences cost no more than one; item i depends on the catalogue and
// i alone.
class Expansion {
 public:
  explicit Expansion(const Catalogue& catalogue);
  std::int64_t size() const { return size_; }
  Item at(std::int64_t index) const;

 private:
  const Catalogue& catalogue_;
  std::vector<std::int64_t> first_;  // of each rule
  std::int64_t size_ = 0;
};

// Gives an item's scene the files of its background.
void place(Item& item, const Catalogue& catalogue, const BackgroundFiles& files);

// Does a name fit a pattern with * and ?
bool matches(std::string_view pattern, std::string_view name);

}  // namespace airtruth::dataset
