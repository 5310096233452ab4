// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "labels/annotation/truth.h"

// Pictures for people: the contact sheet and other tiles, the overlay, and the enlarged view of a
// part of one frame.
namespace airtruth::drawing {

// The contact sheet preview.jpg: up to twelve frames, each with its visible intruders enlarged in a
// corner, with range and frame number. add() takes the frames in order. Only small copies of chosen
// frames are kept, so memory does not grow. With an unknown number of frames the spacing doubles
// whenever the sheet is full.
class ContactSheet {
 public:
  ContactSheet(std::string title, std::int64_t frame_count_estimate, std::size_t tiles = 12);
  void add(const image::Picture& picture, const annotation::Frame& truth);
  // The sheet has at most 3 columns and no empty place: up to two tiles are omitted where they do
  // not fill a row. Without any frame it shows a note.
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

struct NamedPicture {
  std::string name;
  image::Rgb8 picture;
};

// Arranges pictures of one size in `columns` columns under a title, each with its name in its lower
// left corner.
image::Rgb8 tiled(const std::string& title, const std::vector<NamedPicture>& pictures, int columns);

// Draws boxes, id and range into a copy of a picture, in the style of the E-Vision paper's Figure
// 12. An intruder's box is the covered one (else the visible one), drawn one pixel outside the
// labelled pixels. An intruder that is in view but hidden gets its exact box, dashed. Its colour
// depends on its index in `ids`, or on its index in the frame where `ids` lacks it. No label
// overlaps another or leaves the picture; a label overlaps a box only where no other place is left.
image::Rgb8 overlay(const image::Picture& picture,
                    const annotation::Frame& truth,
                    const std::vector<std::string>& ids = {});

// Where labels stand without overlaps between them.
struct Placing {
  // No label leaves it.
  PixelBox frame;
  // Places of other labels; no label overlaps them.
  std::vector<PixelBox> taken;
  // Boxes; a label overlaps them only where nothing else is left.
  std::vector<PixelBox> boxes;
};

// The place of a label of `width` by `height` pixels for the box `anchor`. The candidates are the
// eight places around the box, then rings of places at distances that grow by a label's height. The
// first one without an overlap is chosen, else the one that overlaps the fewest pixels of `boxes`.
// nullopt where every candidate overlaps a label or leaves the frame.
std::optional<PixelBox> place_label(const PixelBox& anchor,
                                    int width,
                                    int height,
                                    const Placing& placing);

// The input of closeup() for one frame.
struct Closeup {
  const image::Picture* background = nullptr;
  const image::Picture* result = nullptr;
  // The layer whose alpha is shown; nullptr: |result - background| is shown instead.
  const image::Layer* layer = nullptr;
};

// Shows background, alpha and result side by side, each pixel enlarged `largest_zoom` times
// without smoothing, or less where the picture would have more than some 4000 px a side. The exact
// box (amber), the covered box (green) and the visible box (white) are drawn on the result. `area`:
// the pixels that are shown; it may extend beyond the frame.
image::Rgb8 closeup(const Closeup& what,
                    const annotation::Frame& truth,
                    const PixelBox& area,
                    int largest_zoom);

}  // namespace airtruth::drawing
