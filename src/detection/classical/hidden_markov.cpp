// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "detection/classical/bearing_grid.h"
#include "detection/classical/blobs.h"
#include "detection/classical/filter_bank.h"
#include "detection/classical/kinds.h"
#include "detection/classical/likelihood.h"

namespace airtruth::detection {
namespace {

// ln odds from which a cell is a detection.
constexpr double kLeastScore = 7;
// Side of the blocks of cells of which the strongest cell is looked at.
constexpr int kBlockCells = 8;
// Blocks on either side of a block that make its surroundings.
constexpr int kAround = 2;
// A blob belongs to a cell where it lies this near, in samples of its level.
constexpr int kBlobRadius = 2;
// A peak this near to a stronger one's box is of the same object.
constexpr double kApartPx = 6;
// Levels with a weaker response there do not bound it.
constexpr double kLeastResponse = 2.5;
constexpr std::size_t kMostPeaks = 150;

// From a target's cell its odds spread to the cells around, which a target may have entered, and
// lose at least ln(4 / kStays) for each cell where a measurement is neutral.
const double kSpreadLoss = std::log(4 / FilterBank::kStays);

struct Peak {
  cv::Point cell;
  double score = 0;
};

// The strongest response of a level near a pixel.
cv::Point strongest_near(const Level& level, const Pixel& pixel) {
  const cv::Point centre = level.sample_at(pixel);
  cv::Point best = centre;
  double most = -1;
  for (int dy = -kBlobRadius; dy <= kBlobRadius; ++dy)
    for (int dx = -kBlobRadius; dx <= kBlobRadius; ++dx) {
      const cv::Point sample = centre + cv::Point(dx, dy);
      const double response = level.relative_response(sample);
      if (response > most) {
        most = response;
        best = sample;
      }
    }
  return best;
}

bool holds(const Box& box, const Pixel& pixel, double margin_px) {
  return pixel.x() > box.x - margin_px && pixel.y() > box.y - margin_px &&
         pixel.x() < box.right() + margin_px && pixel.y() < box.bottom() + margin_px;
}

// The object at a pixel, as its strongest blob of any level has it; a square of the smallest size
// that the detector responds to where it is too faint to bound.
Box box_at(const std::vector<Level>& levels, const Pixel& pixel) {
  std::optional<Blob> best;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const cv::Point sample = strongest_near(levels[i], pixel);
    if (levels[i].relative_response(sample) < kLeastResponse) continue;
    const auto blob = blob_at(levels, i, sample);
    if (!blob || !holds(blob->box_px, pixel, BearingGrid::kCellPx + 1)) continue;
    if (!best || blob->contrast_to_noise > best->contrast_to_noise) best = blob;
  }
  if (best) return best->box_px;
  constexpr double kSide = kElement - 2;
  return {pixel.x() - kSide / 2, pixel.y() - kSide / 2, kSide, kSide};
}

class HiddenMarkov : public Detector {
 public:
  void begin(const SequenceInput& sequence) override {
    grid_.emplace(sequence.lens);
    bank_.emplace(grid_->size());
    ratio_ = LikelihoodRatio();
    picture_ = {0, 0, double(sequence.width), double(sequence.height)};
  }

  std::vector<Detection> detect(const FrameInput& frame) override {
    if (frame.turn) {
      const cv::Mat carried = grid_->turn(frame.turn->this_from_previous);
      if (!carried.empty()) bank_->carry(carried);
    }
    const std::vector<Level> levels = scale_space(*frame.picture);
    if (levels.empty()) return {};  // a picture smaller than the elements
    const Measurement measurement = measurement_of(levels, grid_->size());
    ratio_.learn(measurement);
    bank_->update(grid_->seen_by_cells(ratios_of(measurement)));
    return detections_at(peaks(), levels);
  }

  bool needs_motion() const override { return true; }

 private:
  cv::Mat ratios_of(const Measurement& measurement) const {
    cv::Mat ratios(measurement.response.size(), CV_32F);
    for (int y = 0; y < ratios.rows; ++y) {
      const std::uint8_t* response = measurement.response.ptr<std::uint8_t>(y);
      const std::uint8_t* clutter = measurement.clutter.ptr<std::uint8_t>(y);
      float* out = ratios.ptr<float>(y);
      for (int x = 0; x < ratios.cols; ++x) out[x] = ratio_.of_class(clutter[x])[response[x]];
    }
    return ratios;
  }

  // The strongest cell of each block, by how much its ln odds exceed those of the strongest cells
  // of the blocks around it, on average: clutter that stays, as on the ground, lifts those as well.
  std::vector<Peak> peaks() const {
    const cv::Mat& odds = bank_->odds();
    const cv::Size blocks(odds.cols / kBlockCells, odds.rows / kBlockCells);
    cv::Mat strongest(blocks, CV_32F), around, inner;
    for (int by = 0; by < blocks.height; ++by)
      for (int bx = 0; bx < blocks.width; ++bx) {
        double most = 0;
        cv::minMaxLoc(odds(block(bx, by)), nullptr, &most);
        strongest.at<float>(by, bx) = static_cast<float>(std::log(std::max(1.0, most)));
      }
    // Without the block's neighbours, which a target may fill.
    const int side = 2 * kAround + 1;
    cv::boxFilter(strongest, around, -1, {side, side}, {-1, -1}, false);
    cv::boxFilter(strongest, inner, -1, {3, 3}, {-1, -1}, false);
    std::vector<Peak> found;
    for (int by = 0; by < blocks.height; ++by)
      for (int bx = 0; bx < blocks.width; ++bx) {
        const double outer = around.at<float>(by, bx) - inner.at<float>(by, bx);
        const double score = strongest.at<float>(by, bx) - outer / (side * side - 9);
        if (score < kLeastScore) continue;
        cv::Point at;
        cv::minMaxLoc(odds(block(bx, by)), nullptr, nullptr, nullptr, &at);
        found.push_back({at + block(bx, by).tl(), score});
      }
    std::stable_sort(
        found.begin(), found.end(), [](const Peak& a, const Peak& b) { return a.score > b.score; });
    std::vector<Peak> own;
    for (const Peak& peak : found)
      if (own.size() < kMostPeaks && std::none_of(own.begin(), own.end(), [&](const Peak& other) {
            const cv::Point way = peak.cell - other.cell;
            const double cells = std::max(std::abs(way.x), std::abs(way.y));
            return peak.score + kSpreadLoss * cells <= other.score;
          }))
        own.push_back(peak);
    return own;
  }

  static cv::Rect block(int bx, int by) {
    return {bx * kBlockCells, by * kBlockCells, kBlockCells, kBlockCells};
  }

  std::vector<Detection> detections_at(const std::vector<Peak>& peaks,
                                       const std::vector<Level>& levels) const {
    std::vector<Detection> detections;
    for (const Peak& peak : peaks) {
      const auto pixel = grid_->pixel_of(peak.cell);
      if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() >= picture_.width ||
          pixel->y() >= picture_.height)
        continue;
      const Box box = box_at(levels, *pixel);
      const bool is_taken =
          std::any_of(detections.begin(), detections.end(), [&](const Detection& stronger) {
            return is_same_object(stronger.box_px, box) || holds(stronger.box_px, *pixel, kApartPx);
          });
      if (is_taken) continue;
      Detection detection;
      detection.box_px = box;
      detection.score = std::round(peak.score * 1000) / 1000;
      detections.push_back(detection);
    }
    return detections;
  }

  std::optional<BearingGrid> grid_;
  std::optional<FilterBank> bank_;
  LikelihoodRatio ratio_;
  Box picture_;
};

}  // namespace

std::unique_ptr<Detector> make_hidden_markov() { return std::make_unique<HiddenMarkov>(); }

}  // namespace airtruth::detection
