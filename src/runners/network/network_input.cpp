// SPDX-License-Identifier: Apache-2.0
#include "runners/network/network_input.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "foundation/image/colour.h"
#include "foundation/image/mats.h"

namespace airtruth::network {
namespace {

constexpr std::uint8_t kLetterboxGrey = 114;  // YOLOv5's

// The part of the frame from (x, y), with the last column and row repeated beyond the frame.
cv::Mat part_of(const cv::Mat& frame, int x, int y, int width, int height) {
  const cv::Rect inside(x, y, std::min(width, frame.cols - x), std::min(height, frame.rows - y));
  cv::Mat part;
  cv::copyMakeBorder(frame(inside),
                     part,
                     0,
                     height - inside.height,
                     0,
                     width - inside.width,
                     cv::BORDER_REPLICATE);
  return part;
}

int rounded_up(int length, int multiple) { return (length + multiple - 1) / multiple * multiple; }

std::vector<Piece> whole(const cv::Mat& frame, const NetworkInput& input) {
  const cv::Size size(rounded_up(frame.cols, input.multiple_px),
                      rounded_up(frame.rows, input.multiple_px));
  return {{size == frame.size() ? frame : part_of(frame, 0, 0, size.width, size.height), {}}};
}

std::vector<Piece> tiles(const cv::Mat& frame, const NetworkInput& input) {
  std::vector<Piece> pieces;
  for (const int y : tile_starts(frame.rows, input.height, input.overlap_px)) {
    for (const int x : tile_starts(frame.cols, input.width, input.overlap_px)) {
      pieces.push_back({part_of(frame, x, y, input.width, input.height), {double(x), double(y)}});
    }
  }
  return pieces;
}

std::vector<Piece> letterbox(const cv::Mat& frame, const NetworkInput& input) {
  const double scale = std::min(static_cast<double>(input.width) / frame.cols,
                                static_cast<double>(input.height) / frame.rows);
  const int width = std::clamp(static_cast<int>(std::lround(frame.cols * scale)), 1, input.width);
  const int height = std::clamp(static_cast<int>(std::lround(frame.rows * scale)), 1, input.height);
  const int left = (input.width - width) / 2;
  const int top = (input.height - height) / 2;
  const cv::Mat samples(input.height, input.width, frame.type(), cv::Scalar::all(kLetterboxGrey));
  cv::Mat inside = samples(cv::Rect(left, top, width, height));
  const bool is_area = scale < 1 && input.resize == NetworkInput::Resize::kArea;
  cv::resize(frame, inside, inside.size(), 0, 0, is_area ? cv::INTER_AREA : cv::INTER_LINEAR);
  return {{samples, {-left / scale, -top / scale, scale}}};
}

}  // namespace

cv::Mat samples_of(const image::Picture& picture, NetworkInput::Layout layout) {
  cv::Mat samples;
  if (layout == NetworkInput::Layout::kGrey) {
    const bool is_full = picture.colour.range == image::Range::kFull;
    const double scale = is_full ? 1 : 255.0 / 219;  // from 16..235
    image::luma_of(picture).convertTo(samples, CV_8U, scale, is_full ? 0 : -16 * scale);
    return samples;
  }
  const image::Rgb8 rgb = image::rgb8_from_picture(picture);
  const cv::Mat shared = image::mat_of(rgb);
  if (layout == NetworkInput::Layout::kRgb) return shared.clone();
  cv::cvtColor(shared, samples, cv::COLOR_RGB2BGR);
  return samples;
}

std::vector<Piece> pieces_of(const image::Picture& picture, const NetworkInput& input) {
  const cv::Mat frame = samples_of(picture, input.layout);
  if (input.fit == NetworkInput::Fit::kTiles) return tiles(frame, input);
  if (input.fit == NetworkInput::Fit::kLetterbox) return letterbox(frame, input);
  return whole(frame, input);
}

std::vector<int> tile_starts(int length, int tile, int overlap) {
  if (length <= tile) return {0};
  const int step = tile - overlap;
  const int gaps = (length - tile + step - 1) / step;
  std::vector<int> starts;
  for (int i = 0; i <= gaps; ++i) {
    starts.push_back(static_cast<int>(static_cast<std::int64_t>(length - tile) * i / gaps));
  }
  return starts;
}

Box in_frame(const Box& box, const Placement& placement) {
  return {box.x / placement.scale + placement.x_px,
          box.y / placement.scale + placement.y_px,
          box.width / placement.scale,
          box.height / placement.scale};
}

}  // namespace airtruth::network
