// SPDX-License-Identifier: Apache-2.0
#include "runners/network/network_input.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "foundation/image/colour.h"
#include "foundation/image/mats.h"

namespace airtruth::network {
namespace {

constexpr std::uint8_t kLetterboxGrey = 114;  // YOLOv5's

// Shares the samples.
cv::Mat mat_of(const Samples& samples) {
  return {samples.height,
          samples.width,
          CV_8UC(samples.channels),
          const_cast<std::uint8_t*>(samples.values.data())};
}

Samples grey_of_luma(const image::Picture& picture) {
  const bool is_full = picture.colour.range == image::Range::kFull;
  const double scale = is_full ? 1 : 255.0 / 219;  // from 16..235
  Samples grey = make_samples(picture.width, picture.height, 1);
  image::mat_of(picture.luma()).convertTo(mat_of(grey), CV_8U, scale, is_full ? 0 : -16 * scale);
  return grey;
}

Samples rgb_of(const image::Picture& picture) {
  const image::Rgb8 rgb = image::rgb8_from_picture(picture);
  Samples samples = make_samples(rgb.width, rgb.height, 3);
  std::memcpy(samples.values.data(), rgb.samples.get(), samples.values.size());
  return samples;
}

// The part of the frame from (x, y), with the last column and row repeated beyond the frame.
Samples part_of(const Samples& frame, int x, int y, int width, int height) {
  const cv::Rect inside(x, y, std::min(width, frame.width - x), std::min(height, frame.height - y));
  Samples part = make_samples(width, height, frame.channels);
  cv::copyMakeBorder(mat_of(frame)(inside),
                     mat_of(part),
                     0,
                     height - inside.height,
                     0,
                     width - inside.width,
                     cv::BORDER_REPLICATE);
  return part;
}

int rounded_up(int length, int multiple) { return (length + multiple - 1) / multiple * multiple; }

std::vector<Piece> whole(Samples frame, const NetworkInput& input) {
  const int width = rounded_up(frame.width, input.multiple_px);
  const int height = rounded_up(frame.height, input.multiple_px);
  std::vector<Piece> pieces(1);
  pieces[0].samples = width == frame.width && height == frame.height
                          ? std::move(frame)
                          : part_of(frame, 0, 0, width, height);
  return pieces;
}

std::vector<Piece> tiles(const Samples& frame, const NetworkInput& input) {
  std::vector<Piece> pieces;
  for (const int y : tile_starts(frame.height, input.height, input.overlap_px)) {
    for (const int x : tile_starts(frame.width, input.width, input.overlap_px)) {
      pieces.push_back({part_of(frame, x, y, input.width, input.height), {double(x), double(y)}});
    }
  }
  return pieces;
}

std::vector<Piece> letterbox(Samples frame, const NetworkInput& input) {
  const double scale = std::min(static_cast<double>(input.width) / frame.width,
                                static_cast<double>(input.height) / frame.height);
  const int width = std::clamp(static_cast<int>(std::lround(frame.width * scale)), 1, input.width);
  const int height =
      std::clamp(static_cast<int>(std::lround(frame.height * scale)), 1, input.height);
  const int left = (input.width - width) / 2;
  const int top = (input.height - height) / 2;
  Samples samples = make_samples(input.width, input.height, frame.channels);
  std::ranges::fill(samples.values, kLetterboxGrey);
  cv::Mat inside = mat_of(samples)(cv::Rect(left, top, width, height));
  const bool is_area = scale < 1 && input.resize == NetworkInput::Resize::kArea;
  cv::resize(
      mat_of(frame), inside, inside.size(), 0, 0, is_area ? cv::INTER_AREA : cv::INTER_LINEAR);
  std::vector<Piece> pieces;
  pieces.push_back({std::move(samples), {-left / scale, -top / scale, scale}});
  return pieces;
}

}  // namespace

Samples samples_of(const image::Picture& picture, NetworkInput::Layout layout) {
  if (layout == NetworkInput::Layout::kGrey && picture.colour.matrix != image::Matrix::kRgb) {
    return grey_of_luma(picture);
  }
  Samples rgb = rgb_of(picture);
  if (layout == NetworkInput::Layout::kRgb) return rgb;
  const bool is_grey = layout == NetworkInput::Layout::kGrey;
  Samples samples = make_samples(picture.width, picture.height, is_grey ? 1 : 3);
  cv::cvtColor(mat_of(rgb), mat_of(samples), is_grey ? cv::COLOR_RGB2GRAY : cv::COLOR_RGB2BGR);
  return samples;
}

std::vector<Piece> pieces_of(const image::Picture& picture, const NetworkInput& input) {
  Samples frame = samples_of(picture, input.layout);
  switch (input.fit) {
    case NetworkInput::Fit::kTiles:
      return tiles(frame, input);
    case NetworkInput::Fit::kLetterbox:
      return letterbox(std::move(frame), input);
    case NetworkInput::Fit::kFrame:
      break;
  }
  return whole(std::move(frame), input);
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
