// SPDX-License-Identifier: Apache-2.0
#include "comparison/cuts.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "comparison/segment.h"
#include "video/reader.h"

namespace airtruth::comparison {
namespace {

constexpr int kCellColumns = 32;
constexpr int kCellRows = 24;
constexpr double kLeastOfCut = 6;        // code values, mean over the picture
constexpr double kOverNeighbours = 3;    // times what the frames around a cut differ by
constexpr int kHalving = 2;              // the shift is found at half the size
constexpr double kLeastTexture = 0.7;    // code values of fine detail that a shift can be told by
constexpr double kLeastResponse = 0.15;  // of the correlation's peak, 1: all power in one place

}  // namespace

std::optional<double> Differences::add(const image::Picture& picture) {
  std::vector<double> cells(kCellColumns * kCellRows, 0), counts(kCellColumns * kCellRows, 0);
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* row = picture.luma().row(y);
    const int line = y * kCellRows / picture.height * kCellColumns;
    for (int x = 0; x < picture.width; ++x) {
      const auto cell = static_cast<std::size_t>(line + x * kCellColumns / picture.width);
      cells[cell] += row[x];
      counts[cell] += 1;
    }
  }
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] /= std::max(1.0, counts[i]);
  std::optional<double> difference;
  if (!before_.empty()) {
    difference = 0;
    for (std::size_t i = 0; i < cells.size(); ++i)
      *difference += std::abs(cells[i] - before_[i]) / double(cells.size());
  }
  before_ = std::move(cells);
  return difference;
}

std::vector<std::int64_t> cuts_of(const std::vector<double>& differences) {
  std::vector<std::int64_t> cuts;
  const auto count = static_cast<std::int64_t>(differences.size());
  for (std::int64_t i = 0; i < count; ++i) {
    double around = 0;
    for (std::int64_t j = std::max<std::int64_t>(0, i - 2); j <= std::min(count - 1, i + 2); ++j)
      if (j != i) around = std::max(around, differences[static_cast<std::size_t>(j)]);
    const double here = differences[static_cast<std::size_t>(i)];
    if (here >= kLeastOfCut && here > kOverNeighbours * around) cuts.push_back(i + 1);
  }
  return cuts;
}

std::vector<std::int64_t> cuts_of(const std::filesystem::path& video, const std::stop_token& stop) {
  video::Reader reader(video);
  Differences differences;
  std::vector<double> all;
  while (const auto frame = reader.next()) {
    if (stop.stop_requested()) throw Interrupted();
    if (const auto difference = differences.add(frame->picture)) all.push_back(*difference);
  }
  return cuts_of(all);
}

std::optional<Pixel> BackgroundShift::add(const image::Picture& picture,
                                          const std::vector<Box>& aircraft) {
  cv::Mat small, coarse;
  cv::resize(luma_of(picture, {0, 0, picture.width, picture.height}),
             small,
             {picture.width / kHalving, picture.height / kHalving},
             0,
             0,
             cv::INTER_AREA);
  cv::GaussianBlur(small, coarse, {}, 4);
  cv::Mat fine = small - coarse;
  for (const Box& box : aircraft) {
    const double margin = 16;
    const PixelBox wide = pixels_of({(box.x - margin) / kHalving,
                                     (box.y - margin) / kHalving,
                                     (box.width + 2 * margin) / kHalving,
                                     (box.height + 2 * margin) / kHalving});
    if (const auto part = intersection(wide, {0, 0, fine.cols, fine.rows}))
      fine(cv::Rect(part->x, part->y, part->width, part->height)).setTo(0);
  }
  cv::Mat before = fine;
  std::swap(before, before_);
  if (before.empty() || before.size() != fine.size()) return std::nullopt;
  cv::Scalar mean, deviation;
  cv::meanStdDev(fine, mean, deviation);
  if (deviation[0] < kLeastTexture) return std::nullopt;
  cv::Mat window;
  cv::createHanningWindow(window, fine.size(), CV_32F);
  double response = 0;
  const cv::Point2d shift = cv::phaseCorrelate(before, fine, window, &response);
  if (response < kLeastResponse) return std::nullopt;
  return Pixel(kHalving * shift.x, kHalving * shift.y);
}

}  // namespace airtruth::comparison
