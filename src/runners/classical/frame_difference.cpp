// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "runners/classical/bearing_grid.h"
#include "runners/classical/classical.h"

namespace airtruth::classical {
namespace {

// Where a constant of this file states no origin, it is a choice; docs/detection.md has the result.

constexpr int kCellPx = 2;  // side of the cells that are compared
// Cells between the values of the noise map.
constexpr int kNoiseStep = 16;
// A difference of this many times the local noise is a change. Interpolation between pixels takes
// noise from the picture before, from none to half of it: the local noise is one of many pixels,
// and one of them may have kInterpolation times as much.
constexpr double kInterpolation = 1.2;
constexpr double kChange = 5 * kInterpolation;
// A mean of a smaller share than this of its cells is replaced by those around.
constexpr float kLeastSeen = 0.25F;
// Standard deviation of normal noise over its mean absolute value.
const double kSigmaOfMean = std::sqrt(kPi / 2);
// Cells in a row within which changes belong together.
constexpr int kGapCells = 3;
// Any share of it makes an interpolated sample negative: shares are multiples of 1/32.
constexpr int kUnseen = -30'000;
// Least side of a picture, which has one value of the noise map, and largest side of a change.
constexpr int kLeastSidePx = kCellPx * kNoiseStep;
constexpr int kLargestCells = kLargestPx / kCellPx;
// The rounding of both pictures to whole grey levels.
const double kLeastDifferenceNoise = std::sqrt(2.0 / 12);

class FrameDifference : public ClassicalDetector {
 public:
  void begin(const detector::SequenceInput& sequence) override {
    ClassicalDetector::begin(sequence);
    hidden_ = view_.hidden(1);
    before_.release();
    const double cells = double(sequence.width) * sequence.height / (kCellPx * kCellPx);
    confident_ = kInterpolation * confident_deviations(cells, sequence.frame_rate_hz);
  }

  std::vector<results::Detection> detect(const detector::FrameInput& frame) override {
    if (std::min(frame.picture->width, frame.picture->height) < kLeastSidePx) return {};
    cv::Mat now;
    cv::resize(view_.luma(*frame.picture),
               now,
               {frame.picture->width / kCellPx, frame.picture->height / kCellPx},
               0,
               0,
               cv::INTER_AREA);
    std::vector<results::Detection> detections;
    if (frame.turn && !before_.empty()) {
      cv::Mat before = registered(before_, *frame.turn);
      if (!hidden_.empty()) before.setTo(kUnseen, hidden_);
      detections = changes(now, before);
    }
    before_ = now;
    return detections;
  }

 private:
  // The picture before as this frame's camera would have seen it; negative where it did not.
  cv::Mat registered(const cv::Mat& before, const detector::CameraTurn& turn) const {
    const cv::Mat map =
        cells_after_turn(*lens_, before.size(), kCellPx, turn.this_from_previous.conjugate());
    cv::Mat samples, result;
    before.convertTo(samples, CV_16S);
    if (!hidden_.empty()) samples.setTo(kUnseen, hidden_);
    cv::remap(samples, result, map, {}, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(kUnseen));
    return result;
  }

  // The mean difference on a coarse grid, of the cells that were seen.
  static cv::Mat mean_of_seen(const cv::Mat& difference, const cv::Mat& is_seen) {
    const cv::Size size(std::max(1, difference.cols / kNoiseStep),
                        std::max(1, difference.rows / kNoiseStep));
    cv::Mat seen, share, mean;
    is_seen.convertTo(seen, CV_32F, 1 / 255.0);
    cv::resize(seen, share, size, 0, 0, cv::INTER_AREA);
    cv::resize(difference, mean, size, 0, 0, cv::INTER_AREA);
    cv::divide(mean, cv::max(share, kLeastSeen), mean);
    fill(mean, cv::max(share - kLeastSeen, 0));
    return mean;
  }

  static std::vector<results::Detection> changes(const cv::Mat& now, const cv::Mat& before) {
    cv::Mat difference;
    cv::subtract(now, before, difference, {}, CV_16S);
    difference = cv::abs(difference);
    difference.setTo(0, before < 0);
    cv::Mat samples;
    difference.convertTo(samples, CV_32F);
    cv::Mat noise = mean_of_seen(samples, before >= 0);
    cv::medianBlur(noise, noise, 3);
    noise = cv::max(noise * kSigmaOfMean, kLeastDifferenceNoise);
    cv::resize(noise, noise, now.size(), 0, 0, cv::INTER_LINEAR);
    cv::divide(samples, noise, samples);
    const cv::Mat is_changed = samples >= kChange;
    cv::Mat joined, labels, stats, centres;
    cv::dilate(is_changed, joined, cv::Mat::ones(kGapCells, kGapCells, CV_8U));
    const int count = cv::connectedComponentsWithStats(joined, labels, stats, centres);
    std::vector<results::Detection> detections;
    for (int i = 1; i < count; ++i) {
      cv::Rect cells(stats.at<int>(i, cv::CC_STAT_LEFT),
                     stats.at<int>(i, cv::CC_STAT_TOP),
                     stats.at<int>(i, cv::CC_STAT_WIDTH),
                     stats.at<int>(i, cv::CC_STAT_HEIGHT));
      double most = 0;
      cv::minMaxLoc(samples(cells), nullptr, &most, nullptr, nullptr, labels(cells) == i);
      cells = without_rim(cells, now.size());
      if (std::max(cells.width, cells.height) > kLargestCells) continue;
      detections.push_back(detection_of({double(kCellPx * cells.x),
                                         double(kCellPx * cells.y),
                                         double(kCellPx * cells.width),
                                         double(kCellPx * cells.height)},
                                        most));
    }
    results::sort_by_score(detections);
    return detections;
  }

  // What joining added, but at the picture's border.
  static cv::Rect without_rim(const cv::Rect& cells, const cv::Size& size) {
    // Number of cells that joining adds to each side.
    constexpr int kRim = kGapCells / 2;
    const int left = cells.x > 0 ? kRim : 0, top = cells.y > 0 ? kRim : 0;
    const int right = cells.br().x < size.width ? kRim : 0;
    const int bottom = cells.br().y < size.height ? kRim : 0;
    return {cells.x + left,
            cells.y + top,
            std::max(1, cells.width - left - right),
            std::max(1, cells.height - top - bottom)};
  }

  cv::Mat hidden_;  // cells that show the own aircraft
  cv::Mat before_;
};

}  // namespace

std::unique_ptr<detector::Detector> make_frame_difference() {
  return std::make_unique<FrameDifference>();
}

}  // namespace airtruth::classical
