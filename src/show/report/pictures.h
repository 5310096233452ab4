// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "truth/annotation/truth.h"

// Pictures for people: the contact sheet, the burnt-in overlay, the close look at one frame.
namespace airtruth::report {

// preview.jpg: up to twelve frames, each with its visible intruders enlarged in a corner, with
// range and frame number. Feed frames as they come, in order; keeps small copies of chosen ones
// alone, so memory does not grow. With an unknown number of frames the spacing doubles whenever the
// sheet is full.
class ContactSheet {
 public:
  ContactSheet(std::string title, std::int64_t frame_count_estimate, std::size_t tiles = 12);
  void add(const image::Picture& picture, const annotation::Frame& truth);
  // At most 3 columns, no place empty: up to two tiles are left out where they would fill no row. A
  // note where there was no frame.
  image::Rgb8 sheet() const;

 private:
  struct Tile {
    std::int64_t frame = 0;
    image::Rgb8 picture;
  };
  std::string title_;
  std::size_t tiles_;
  std::int64_t every_ = 1;
  std::vector<Tile> chosen_;
};

// Burns boxes, id and range into a copy of a picture (the look of the paper's Figure 12): the
// covered box (else the visible one), one pixel outside the labelled pixels; where the intruder is
// in view but hidden, the exact box, dashed. Each intruder has its own colour, by its place in
// `ids`, by that in the frame where `ids` do not name it. No label overprints another or leaves the
// picture; one overprints a box where no other place is left.
image::Rgb8 overlay(const image::Picture& picture,
                    const annotation::Frame& truth,
                    const std::vector<std::string>& ids = {});

// What a closer look needs of one intruder in one frame.
struct Closeup {
  const image::Picture* background = nullptr;
  const image::Picture* result = nullptr;
  const image::Layer* layer =
      nullptr;  // its alpha; nullptr: |result - background| is shown instead
};

// Background, alpha and result side by side, each pixel enlarged `zoom` times without smoothing,
// exact box (amber), covered box (green) and visible box (white) drawn on the result. `area`: the
// pixels shown, which may stick out of the frame.
image::Rgb8 closeup(const Closeup& what,
                    const annotation::Frame& truth,
                    const PixelBox& area,
                    int zoom);

}  // namespace airtruth::report
