// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

// Pictures of pairs: a real aircraft and the inserted one beside it, cropped from the same frame.
namespace airtruth::comparison {

// A square crop of the frame around a box.
struct Crop {
  image::Rgb8 picture;
  Box box;  // in pixels of the crop
};

struct FigureRow {
  std::int64_t frame = 0;
  Crop real, made;
};

// Makes both crops of a pair with the same size: the larger box, with a margin of its own size
// around it.
FigureRow figure_row(const image::Picture& picture,
                     std::int64_t frame,
                     const Box& real,
                     const Box& made);

// Shows the real aircraft at 1x and enlarged with its box, and the inserted one likewise; one row
// per frame, in two columns.
image::Rgb8 figure_of(const std::vector<FigureRow>& rows);

// Both crops of a pair as they are: the real aircraft at the left, the inserted one at the right.
image::Rgb8 patches_of(const FigureRow& row);

}  // namespace airtruth::comparison
