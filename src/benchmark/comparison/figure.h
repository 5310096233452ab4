// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

// Pictures of pairs: a real aircraft and the one beside it, cut out of the same frame.
namespace airtruth::comparison {

// A square crop about a box, as the frame has it.
struct Crop {
  image::Rgb8 picture;
  Box box;  // in the crop
};

struct FigureRow {
  std::int64_t frame = 0;
  Crop real, made;
};

// Both crops of a pair have one size: the boxes with as much again around the larger one.
FigureRow figure_row(const image::Picture& picture,
                     std::int64_t frame,
                     const Box& real,
                     const Box& made);

// Real at 1x and enlarged with its box, the inserted one the same; a row a frame, in two columns.
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
