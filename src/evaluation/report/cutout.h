// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include <airtruth/box.h>

#include "foundation/image/picture.h"
#include "show/html/page.h"

// Small pictures of a data set's frames for a page.
namespace airtruth::report {

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
  int side = 160;   // of the JPEG, px
  int quality = 7;  // of libav's mjpeg encoder
};

// The surroundings of a box. A box may lie anywhere; a square far from the picture is black.
Cutout cutout_of(const image::Picture& picture, const Box& box, const CutoutOptions& options);

// The whole picture, at most `width` pixels wide.
std::string small_jpeg(const image::Picture& picture, int width, int quality);

// Indices of `count` of `frames` frames, spread evenly from the first to the last.
std::set<std::size_t> spread_over(std::size_t frames, std::size_t count);

// Adds a picture under the name by which the page finds it; one without content is left out.
void add_picture(std::vector<html::PageBlob>& pictures,
                 const std::string& name,
                 const std::string& jpeg);

}  // namespace airtruth::report
