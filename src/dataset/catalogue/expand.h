// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "dataset/catalogue/catalogue.h"
#include "dataset/catalogue/drawing.h"

namespace airtruth::dataset {

// Where a background of the catalogue lies on this machine, and what its video is.
struct BackgroundFiles {
  fs::path video;
  std::optional<fs::path> mask;
  int width = 0;
  int height = 0;
  double frame_rate_hz = 0;  // 0: not known
  std::int64_t frames = 0;   // from the video's first on; 0: not known
};

// One sequence of a catalogue.
struct Item {
  std::int64_t index = 0;
  std::string name;
  std::size_t background = 0;
  std::int64_t frame_count = 0;
  // Its [background] is filled in by place(); what [[random]] draws has provisional paths until
  // then.
  scene::Scene scene;
  const Drawn* rule = nullptr;  // of [[random]]; nullptr for what is listed
  DrawnSequence drawn;          // where there is a rule
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

// A scene over a background of the catalogue, by its place there: all but [background], intruders
// and name.
scene::Scene scene_over(const Catalogue& catalogue, std::size_t background);

// Gives an item's scene the files of its background, and what was drawn its place in time and
// space: the frame with which it begins, the meeting moment, and the range at which an aircraft has
// the size that was drawn. Error at the rule where no range gives that size (the direction is not
// in the lens's field), and where a random start meets a video that does not state its length.
void place(Item& item, const Catalogue& catalogue, const BackgroundFiles& files);

}  // namespace airtruth::dataset
