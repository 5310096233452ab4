// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <airtruth/box.h>
#include <airtruth/export.h>
#include <airtruth/statistics.h>

// Average precision by the rules of COCO (Lin et al. 2014; cocodataset/cocoapi,
// PythonAPI/pycocotools/cocoeval.py): in each image at most `max_detections` of the highest score
// are taken; in descending order of score each takes the truth that it resembles most among those
// not yet taken, if the resemblance reaches the threshold; truths to ignore are taken only where no
// other can be, and count neither way, as do detections outside of the range of areas without a
// truth. Precision is made monotone and read at 101 recalls, 0 to 1.
//
// Example: two truths in one image, and three detections with the scores 0.9 (hits the first), 0.8
// (hits nothing) and 0.7 (hits the second). Precision is 1 up to a recall of 0.5 and 2/3 beyond, so
// AP = (51 * 1 + 50 * 2/3) / 101 = 0.8350.
namespace airtruth::evaluation {

struct LabelledBox {
  Box box_px;
  // Counts neither way. Several detections may lie in it, as in COCO's crowds: resemblance is then
  // measured against the detection's area.
  bool is_region = false;
  // Counts neither way, and is taken by one detection.
  bool is_ignored = false;
  // By which an AreaRange selects it; empty: the area of its box. COCO's is that of the object's
  // pixels.
  std::optional<double> area_px;
};
struct ScoredBox {
  Box box_px;
  double score = 0;
};
struct ScoredImage {
  std::vector<LabelledBox> truths;
  std::vector<ScoredBox> detections;
  // COCO's. Detections of equal score are taken in the order of the images: of these numbers, where
  // all images have one.
  std::optional<std::int64_t> image_id;
};

// How a detection resembles a truth: overlap (intersection over union), or distance of the centres,
// which reaches a threshold in pixels where it is at most that or half of the truth's longer side.
enum class Likeness { kOverlap, kCentre };

struct AreaRange {
  double low_px = 0;
  double high_px = 1e10;
};
// COCO's: small below 32 x 32 px, medium, large above 96 x 96 px.
constexpr AreaRange kAllAreas{0, 1e10};
constexpr AreaRange kSmall{0, 32.0 * 32};
constexpr AreaRange kMedium{32.0 * 32, 96.0 * 96};
constexpr AreaRange kLarge{96.0 * 96, 1e10};

constexpr int kRecallSteps = 101;  // cocoeval.py: 0, 0.01 .. 1

struct PrecisionOptions {
  Likeness likeness = Likeness::kOverlap;
  // Least overlap; with kCentre largest distance, px.
  double threshold = 0.5;
  AreaRange areas = kAllAreas;
  int max_detections = 100;
};

struct PrecisionCurve {
  // Precision at the recalls 0, 0.01 .. 1, and the score of the detection that reaches that recall
  // (0 where none does).
  std::array<double, kRecallSteps> precision{};
  std::array<double, kRecallSteps> score{};
  // Mean of `precision`.
  double average_precision = 0;
  // The largest recall.
  double recall = 0;
  std::int64_t truths = 0;  // that count
};

// 95 % interval of the precision at each recall.
struct PrecisionBand {
  std::array<double, kRecallSteps> low{};
  std::array<double, kRecallSteps> high{};
};

// Empty where no truth counts: the measure is not defined.
AIRTRUTH_API std::optional<PrecisionCurve> precision_curve(std::span<const ScoredImage> images,
                                                           const PrecisionOptions& options);

// The numbers that COCO prints, and that at a centre distance. Empty: not defined.
struct AveragePrecision {
  std::optional<double> ap;  // mean over the overlaps 0.50, 0.55 .. 0.95
  std::optional<double> ap_50;
  std::optional<double> ap_75;
  std::optional<double> ap_small, ap_medium, ap_large;  // means as `ap`
  // Mean recall over the overlaps, with at most 1, 10 and 100 detections an image.
  std::optional<double> ar_1, ar_10, ar_100;
  std::optional<double> ar_small, ar_medium, ar_large;
  std::optional<double> ap_centre;
  // 95 % intervals: percentile bootstrap over sequences, 1000 draws.
  std::optional<Interval> ap_50_interval, ap_centre_interval;
  // For plots: at an overlap of 0.5, and at the centre distance, each with its 95 % band.
  std::optional<PrecisionCurve> curve_50, curve_centre;
  std::optional<PrecisionBand> band_50, band_centre;
};

// `sequences`: the images of each.
AIRTRUTH_API AveragePrecision average_precision(std::span<const std::vector<ScoredImage>> sequences,
                                                double centre_px);

}  // namespace airtruth::evaluation
