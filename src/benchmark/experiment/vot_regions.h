// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "truth/evaluation/vot.h"
#include "truth/exchange/text.h"

// Regions as VOT's toolkit writes them in results: text, a region a line, and since version 0.5
// also binary (.bin). Rectangles; polygons and masks, which become the box that bounds them; and
// the marks 0, 1 and 2. As in the toolkit a text region with a NaN is the mark 0.
namespace airtruth::experiment {

// "x,y,w,h"; "x0,y0,x1,y1,x2,y2,..."; "mx,y,w,h,n0,n1,...", a mask by run lengths along its rows,
// the first of zeros; or a mark. `origin_px`: what the file calls the first pixel, 0 or 1. A box
// without an area is an answer without a box. Error at the line for anything
// else.
evaluation::VotFrame region_of(const exchange::Line& line,
                               const std::filesystem::path& file,
                               int origin_px);

// Little-endian: int16 version (1), uint32 count, then for each frame a byte of type and
//   0 mark: uint32;  1 rectangle: 4 float32;  2 polygon: uint16 n, 2 n float32;
//   3 mask: int16 x, y, uint16 w, h, n, n uint16 run lengths.
// Error with the byte's place for what does not follow it, and for what follows the last frame.
evaluation::Trajectory read_binary_trajectory(const std::filesystem::path& file, int origin_px);

}  // namespace airtruth::experiment
