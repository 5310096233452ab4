// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "sequence/sequence/finished.h"

namespace airtruth::dataset {

// Pictures of a sequence for the report page: frames spread over it, and its intruder enlarged.
struct Film {
  struct Marked {
    std::size_t intruder = 0;  // in sequence::intruder_ids()
    PixelBox box;
  };
  struct Still {
    std::int64_t frame = 0;
    std::string jpeg;  // at most kStillWidth wide
    std::vector<Marked> boxes;
  };
  static constexpr int kStillWidth = 400;

  std::vector<Still> stills;      // in the order of their frames
  std::size_t poster = 0;         // of the stills: the one whose intruder is largest
  std::string loop_jpeg;          // squares side by side; empty where nothing is ever seen
  int loop_frames = 0;            // squares in it
  int loop_side = 0;              // of a square, px
  std::vector<double> contrasts;  // of the loop's frames (show/report/thumbnails.h)
};

// Reads the video once. `most`: stills at most. Error where the video ends before the last frame
// that shows an intruder.
Film film_of(const sequence::Finished& finished, std::size_t most, const std::stop_token& stop);

// Indices of n things, thinned to at most `most`, the first and the last among them.
std::vector<std::size_t> thinned(std::size_t n, std::size_t most);

}  // namespace airtruth::dataset
