// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"
#include "runners/network/model_description.h"

// A frame as the pieces that a network sees, each with its place in the frame.
namespace airtruth::network {

// Where a piece lies: p_in_frame = p_in_piece / scale + (x_px, y_px).
struct Placement {
  double x_px = 0;
  double y_px = 0;
  double scale = 1;
};

struct Piece {
  cv::Mat samples;  // of 8 bits, without gaps between rows
  Placement placement;
};

// The frame in the network's layout. Grey is luma in the full range 0..255; for a picture of R, G
// and B it is Rec. 601's.
cv::Mat samples_of(const image::Picture& picture, NetworkInput::Layout layout);

// The pieces of a frame, by NetworkInput::fit. Beyond the frame's right and lower edge its last
// column and row are repeated; beside a letterbox the samples are 114, as YOLOv5 has them.
std::vector<Piece> pieces_of(const image::Picture& picture, const NetworkInput& input);

// The first pixels of tiles of `tile` px that cover `length` px and overlap by `overlap` px or
// more: as few as possible, evenly spaced.
//
//   tile_starts(1280, 640, 64) is {0, 320, 640}
std::vector<int> tile_starts(int length, int tile, int overlap);

Box in_frame(const Box& box_in_piece, const Placement& placement);

}  // namespace airtruth::network
