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

// The same for other pictures to be made of: real ones above inserted ones, kTilePx each.
constexpr int kTilePx = 176;
image::Rgb8 strip_of(const std::vector<FigureRow>& rows);

// Strips of several comparisons under each other, each beside its name.
struct NamedStrip {
  std::string name;
  image::Rgb8 picture;
};
image::Rgb8 figure_of_all(const std::vector<NamedStrip>& strips);

}  // namespace airtruth::comparison
