// SPDX-License-Identifier: Apache-2.0
#include "show/drawing/tiles.h"

#include "foundation/base/error.h"
#include "show/drawing/draw.h"

namespace airtruth::drawing {

image::Rgb8 tiled(const std::string& title, std::vector<NamedPicture> pictures, int columns) {
  // Gap between tiles, and height of the title above them: display choices.
  constexpr int kGapPx = 10;
  constexpr int kHeaderPx = 56;
  check(!pictures.empty() && columns > 0, "there is something to tile");
  const int width = pictures[0].picture.width;
  const int height = pictures[0].picture.height;
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  cv::Mat canvas(kHeaderPx + rows * (height + kGapPx),
                 kGapPx + columns * (width + kGapPx),
                 CV_8UC3,
                 kDarkPaper);
  text(canvas, fitted(title, 20, canvas.cols - 2 * kGapPx), kGapPx, 36, 20, kWhite);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int x = kGapPx + static_cast<int>(i) % columns * (width + kGapPx);
    const int y = kHeaderPx + static_cast<int>(i) / columns * (height + kGapPx);
    cv::Mat tile = view(pictures[i].picture);
    text(tile, fitted(pictures[i].name, 12, width - 20), 10, height - 12, 12, kWhite);
    tile.copyTo(canvas(cv::Rect(x, y, width, height)));
  }
  return from_mat(canvas);
}

}  // namespace airtruth::drawing
