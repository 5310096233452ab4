// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "sequence/replay/finished.h"
#include "show/drawing/thumbnails.h"

namespace airtruth::set_report {

// Pictures of a sequence for the report page: frames spread over the sequence, and its aircraft
// enlarged; of a sequence that shows none, what else it shows.
struct Film {
  struct Marked {
    std::size_t intruder = 0;  // index in replay::intruder_ids()
    PixelBox box;
  };
  // Its subject is the largest of these boxes.
  struct Still : drawing::Still {
    std::int64_t frame = 0;
    std::vector<Marked> boxes;
  };

  std::vector<Still> stills;  // in frame order
  // Index in `stills` of the picture whose intruder is largest.
  std::size_t poster = 0;
  // Squares side by side; empty where no intruder is ever visible.
  std::string loop_jpeg;
  int loop_frames = 0;  // number of squares in loop_jpeg
  int loop_side = 0;    // side of one square, px
  // Contrast of the aircraft in each frame of the loop (foundation/image/contrast_to_noise.h).
  std::vector<double> contrasts;
};

// Reads the video once and keeps at most `most` stills. Throws Error where the video ends before
// the last frame that shows an intruder.
Film film_of(const replay::Finished& finished, std::size_t most, const std::stop_token& stop);

}  // namespace airtruth::set_report
