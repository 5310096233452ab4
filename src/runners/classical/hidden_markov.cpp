// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <opencv2/imgproc.hpp>

#include "runners/classical/bearing_grid.h"
#include "runners/classical/blobs.h"
#include "runners/classical/classical.h"
#include "runners/classical/filter_bank.h"

namespace airtruth::classical {
namespace {

// Where a constant of this file states no origin, it is a choice; docs/detection.md has the result.

// Sides of the cells of the banks: a target moves by up to a cell a frame. Smaller cells find
// fainter targets, larger ones faster.
constexpr std::array<int, 2> kCellsPx = {2, 8};
// ln odds from which a cell is a detection.
constexpr double kLeastScore = 7;
// Blocks on either side of a block that make its surroundings.
constexpr int kAround = 2;
// A peak this near to a stronger one's box is of the same object.
constexpr double kApartPx = 6;
// Levels with a weaker response there, in typical responses, do not bound it.
constexpr double kLeastResponse = 2.5;
constexpr std::size_t kMostPeaks = 150;  // of a bank and frame: bounds the time in rich clutter

// From a target's cell its odds spread to the cells around, which a target may have entered, and
// lose at least ln(4 / kStays) for each cell where a measurement is neutral.
const double kSpreadLoss = std::log(4 / FilterBank::kStays);

struct Peak {
  cv::Point cell;
  double score = 0;
};

bool holds(const Box& box, const Pixel& pixel, double margin_px) {
  return pixel.x() > box.x - margin_px && pixel.y() > box.y - margin_px &&
         pixel.x() < box.right() + margin_px && pixel.y() < box.bottom() + margin_px;
}

// The object at a pixel, as its strongest blob of any level has it; empty where it is too faint to
// bound.
std::optional<Box> box_at(const std::vector<Level>& levels, const Pixel& pixel, double within_px) {
  std::optional<Blob> best;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Level& level = levels[i];
    const int radius = std::max(1, static_cast<int>(std::lround(within_px / level.step)));
    const cv::Point sample = level.strongest_near(level.sample_at(pixel), radius);
    if (level.relative_response(sample) < kLeastResponse) continue;
    const auto blob = blob_at(levels, i, sample);
    if (!blob || !holds(blob->box_px, pixel, within_px + 1)) continue;
    if (!best || blob->contrast_to_noise > best->contrast_to_noise) best = blob;
  }
  return best ? std::optional(best->box_px) : std::nullopt;
}

// A square of the smallest size that the detector responds to.
Box smallest_box(const Pixel& centre) {
  // Side of the box, px.
  constexpr double kSide = kElement - 2;
  return {centre.x() - kSide / 2, centre.y() - kSide / 2, kSide, kSide};
}

// Filters over cells of one size, with the odds of clutter in them.
struct Bank {
  Bank(const lens::Lens& lens, int side_px)
      : cell_px(side_px), grid(lens, side_px), filters(grid.size()) {}

  void update(const Measurement& measurement) {
    ratio.learn(measurement);
    cv::Mat ratios(measurement.response.size(), CV_32F);
    for (int y = 0; y < ratios.rows; ++y) {
      const std::uint8_t* response = measurement.response.ptr<std::uint8_t>(y);
      const std::uint8_t* clutter = measurement.clutter.ptr<std::uint8_t>(y);
      float* out = ratios.ptr<float>(y);
      for (int x = 0; x < ratios.cols; ++x) out[x] = ratio.of_class(clutter[x])[response[x]];
    }
    filters.update(grid.seen_by_cells(ratios));
  }

  void turn(const Quaternion& this_from_previous) {
    const cv::Mat carried = grid.turn(this_from_previous);
    if (!carried.empty()) filters.carry(carried);
  }

  int cell_px;
  BearingGrid grid;
  FilterBank filters;
  LikelihoodRatio ratio;
};

class HiddenMarkov : public ClassicalDetector {
 public:
  void begin(const detector::SequenceInput& sequence) override {
    ClassicalDetector::begin(sequence);
    picture_ = {0, 0, double(sequence.width), double(sequence.height)};
    double cells = 0;
    for (const int cell_px : kCellsPx) cells += picture_.area() / (cell_px * cell_px);
    confident_ = confident_log_ratio(cells, sequence.frame_rate_hz);
  }

  std::vector<results::Detection> detect(const detector::FrameInput& frame) override {
    const std::vector<Level> levels = scale_space(*frame.picture, view_);
    if (levels.empty()) return {};  // a picture smaller than the elements
    if (frame.begins_shot || frame.index == 0) {
      banks_.clear();
      for (const int cell_px : kCellsPx) banks_.emplace_back(*lens_, cell_px);
    }
    std::vector<results::Detection> detections;
    const Measurement fine = measurement_of(levels, banks_.front().grid.size());
    for (Bank& bank : banks_) {
      if (bank.grid.size().empty()) continue;
      if (frame.turn) bank.turn(frame.turn->this_from_previous);
      const int factor = bank.cell_px / kCellsPx[0];
      bank.update(factor == 1 ? fine : coarser(fine, factor, bank.grid.size()));
      add_detections(bank, levels, detections);
    }
    results::sort_by_score(detections);
    return detections;
  }

 private:
  // The strongest cell of each block, by how much its ln odds exceed those of the strongest cells
  // of the blocks around it, on average: clutter that stays, as on the ground, lifts those as well.
  static std::vector<Peak> peaks_of(const cv::Mat& odds) {
    if (std::min(odds.cols, odds.rows) < kBlock) return {};
    const cv::Size blocks = blocks_in(odds.size());
    cv::Mat strongest(blocks, CV_32F), around, inner;
    for (int by = 0; by < blocks.height; ++by)
      for (int bx = 0; bx < blocks.width; ++bx) {
        double most = 0;
        cv::minMaxLoc(odds(block_in(odds.size(), bx, by)), nullptr, &most);
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
        const cv::Rect block = block_in(odds.size(), bx, by);
        cv::Point at;
        cv::minMaxLoc(odds(block), nullptr, nullptr, nullptr, &at);
        found.push_back({at + block.tl(), score});
      }
    std::ranges::stable_sort(found, std::greater(), &Peak::score);
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

  // The bank's peaks that are of no object that is there already.
  void add_detections(const Bank& bank,
                      const std::vector<Level>& levels,
                      std::vector<results::Detection>& detections) const {
    for (const Peak& peak : peaks_of(bank.filters.odds())) {
      const auto pixel = bank.grid.pixel_of(peak.cell);
      if (!pixel || !holds(picture_, *pixel, 0) || view_.hides(*pixel)) continue;
      const auto bounds = box_at(levels, *pixel, bank.cell_px);
      // Large cells are for what moves fast and can be seen in a single frame.
      if (!bounds && bank.cell_px > kCellsPx[0]) continue;
      const results::Detection found =
          detection_of(bounds.value_or(smallest_box(*pixel)), peak.score);
      const auto same =
          std::find_if(detections.begin(), detections.end(), [&](const results::Detection& other) {
            return is_same_object(other.box_px, found.box_px) ||
                   holds(other.box_px, *pixel, kApartPx);
          });
      if (same != detections.end())
        same->score = std::max(same->score, found.score);
      else
        detections.push_back(found);
    }
  }

  std::vector<Bank> banks_;
  Box picture_;
};

}  // namespace

std::unique_ptr<detector::Detector> make_hidden_markov() {
  return std::make_unique<HiddenMarkov>();
}

}  // namespace airtruth::classical
