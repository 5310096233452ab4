// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"
#include "show/html/page.h"

// Small pictures for HTML pages, and the pages' JPEGs with boxes.
namespace airtruth::drawing {

// Pictures of one size, side by side.
image::Rgb8 strip(const std::vector<image::Rgb8>& pictures);

// A square cut out of a frame, as a JPEG.
struct Cutout {
  std::string jpeg;
  // The square in the frame, px.
  double x = 0, y = 0, px = 0;
};

struct CutoutOptions {
  // Side of the square in the frame as a multiple of the box's longer side, and its least side.
  double surroundings = 4;
  double least_px = 48;
  // Its largest side as a multiple of the longer side of the picture.
  double most_of_picture = 2;
  int side = 160;         // of the JPEG, px
  int whole_width = 480;  // of a still's whole picture, px
  int quality = 7;        // of libav's mjpeg encoder
};

// The surroundings of a box. A box may lie anywhere; what lies outside of the picture is black.
Cutout cutout_of(const image::Picture& picture, const Box& box, const CutoutOptions& options);
image::Rgb8 enlarged(const image::Picture& picture, const Box& box, const CutoutOptions& options);

// A frame on a page, as JPEGs.
struct Still {
  std::size_t index = 0;  // of the frame in its sequence
  int width = 0;          // of the video's picture, px
  // The whole picture, at most CutoutOptions::whole_width pixels wide.
  std::string whole;
  // The surroundings of its subject; empty without one.
  Cutout close;
};

Still still_of(const image::Picture& picture,
               std::size_t index,
               const std::optional<Box>& subject,
               const CutoutOptions& options);

// Adds the still with this number of a sequence with its own, under the names by which a page finds
// them.
void add_still(std::vector<html::PagePicture>& pictures,
               std::size_t sequence,
               std::size_t number,
               const Still& still);

// Indices of at most `count` of `frames` frames, spread evenly from the first to the last.
std::set<std::size_t> spread_over(std::size_t frames, std::size_t count);

struct ColouredBox {
  Box box;
  std::array<std::uint8_t, 3> rgb{};
};

// The picture of a JPEG with boxes drawn on it. Each box has a dark rim, and later boxes are drawn
// over earlier ones. `scale`: pixels of the JPEG for each pixel of the boxes. Error where the bytes
// are not a JPEG.
image::Rgb8 boxed(const std::string& jpeg, double scale, const std::vector<ColouredBox>& boxes);

}  // namespace airtruth::drawing
