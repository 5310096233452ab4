// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <airtruth/vot.h>

#include "labels/exchange/text.h"

// Regions in the formats of VOT's toolkit: text with one region per line and, since version 0.5,
// binary files (.bin). A region is a rectangle; a polygon or a mask, which becomes its bounding
// box; or one of the marks 0, 1 and 2. As in the toolkit, a text region with a NaN is the mark 0.
namespace airtruth::results {

// The bounds of x0, y0, x1, y1, ...; empty where a number is not finite. `origin_px` is the
// coordinate that the numbers give to the first pixel, 0 or 1.
std::optional<Box> bounds_of_polygon(const std::vector<double>& numbers, int origin_px = 0);

// Describes what is wrong with a mask (exchange::bounds_of_mask()); empty for a valid one.
std::optional<std::string> fault_of_mask(const std::vector<double>& numbers);

struct Region {
  evaluation::VotFrame frame;
  // Of a rectangle, which then is an answer without a box.
  bool has_negative_side = false;
};

// Reads one text region: "x,y,w,h"; "x0,y0,x1,y1,x2,y2,..."; "mx,y,w,h,n0,n1,...", a mask as run
// lengths along its rows of which the first counts zeros; or a mark. `origin_px` is the coordinate
// that the file gives to the first pixel, 0 or 1. A box without area is an answer without a box.
// Throws Error at the line for any other text.
Region region_of(const exchange::Line& line, const std::filesystem::path& file, int origin_px);

// Little-endian: int16 version (1), uint32 count, then for each frame a byte of type and
//   0 mark: uint32;  1 rectangle: 4 float32;  2 polygon: uint16 n, 2 n float32;
//   3 mask: int16 x, y, uint16 w, h, n, n uint16 run lengths.
// Error with the byte's place for what does not follow it, and for what follows the last frame.
std::vector<Region> read_binary_regions(const std::filesystem::path& file, int origin_px);

}  // namespace airtruth::results
