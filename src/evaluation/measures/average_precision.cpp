// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include <airtruth/average_precision.h>
#include <airtruth/metrics.h>

#include "evaluation/matching/boxes.h"
#include "evaluation/statistics/bootstrap.h"

namespace airtruth::evaluation {
namespace {

// A detection after the matching of its image.
struct Ranked {
  double score = 0;
  std::size_t sequence = 0;
  bool is_true = false;
};

struct Ranking {
  // By falling score, equal ones in the order of the images; ignored detections are left out.
  std::vector<Ranked> detections;
  std::vector<std::int64_t> truths;  // that count, by sequence
};

using ImageList = std::span<const ScoredImage>;

double recall_step(int i) { return i == kRecallSteps - 1 ? 1.0 : i * 0.01; }

// Resemblance of a detection and a truth; empty below the threshold. A larger one is more alike.
std::optional<double> likeness(const ScoredBox& detection,
                               const LabelledBox& truth,
                               const PrecisionOptions& options) {
  const Box& d = detection.box_px;
  const Box& t = truth.box_px;
  if (options.likeness == Likeness::kCentre) {
    const double distance = matching::centre_distance_px(d, t);
    const bool is_near = distance <= matching::match_radius_px(t, options.threshold);
    return is_near || (truth.is_region && matching::centre_is_in(d, t)) ? std::optional(-distance)
                                                                        : std::nullopt;
  }
  double overlap = evaluation::overlap(d, t);
  if (truth.is_region && overlap > 0) overlap = intersection(d, t)->area() / d.area();
  return overlap >= std::min(options.threshold, 1 - 1e-10) ? std::optional(overlap) : std::nullopt;
}

bool is_outside(double area_px, const AreaRange& areas) {
  return area_px < areas.low_px || area_px > areas.high_px;
}

// The indices of that many, stably sorted by a key.
std::vector<std::size_t> sorted(std::size_t count, auto order, auto key) {
  std::vector<std::size_t> indices(count);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  std::ranges::stable_sort(indices, order, key);
  return indices;
}

// The matching of cocoeval.py's evaluateImg: adds what counts of an image to its sequence.
void add_image(const ScoredImage& image,
               const PrecisionOptions& options,
               std::size_t sequence,
               Ranking& ranking) {
  std::vector<char> is_ignored;
  for (const LabelledBox& truth : image.truths)
    is_ignored.push_back(truth.is_region || truth.is_ignored ||
                         is_outside(truth.area_px.value_or(truth.box_px.area()), options.areas));
  ranking.truths[sequence] += std::count(is_ignored.begin(), is_ignored.end(), false);
  const std::vector<std::size_t> order =
      sorted(image.truths.size(), std::less(), [&](std::size_t i) { return is_ignored[i] != 0; });
  std::vector<char> is_taken(image.truths.size());
  const auto best_of = [&](const ScoredBox& detection) {
    std::optional<std::size_t> best;
    double best_likeness = 0;
    for (const std::size_t t : order) {
      if (is_taken[t] && !image.truths[t].is_region) continue;
      // Truths that count come first: once one is found, those to ignore are not looked at.
      if (best && !is_ignored[*best] && is_ignored[t]) break;
      const auto found = likeness(detection, image.truths[t], options);
      if (!found || (best && *found < best_likeness)) continue;
      best_likeness = *found;
      best = t;
    }
    return best;
  };
  std::vector<std::size_t> by_score =
      sorted(image.detections.size(), std::greater(), [&](std::size_t i) {
        return image.detections[i].score;
      });
  const auto most = static_cast<std::size_t>(std::max(0, options.max_detections));
  if (by_score.size() > most) by_score.resize(most);
  for (const std::size_t d : by_score) {
    const ScoredBox& detection = image.detections[d];
    const auto truth = best_of(detection);
    if (truth) is_taken[*truth] = true;
    if (truth ? is_ignored[*truth] != 0 : is_outside(detection.box_px.area(), options.areas))
      continue;
    ranking.detections.push_back({detection.score, sequence, truth.has_value()});
  }
}

Ranking ranking_of(std::span<const ImageList> sequences, const PrecisionOptions& options) {
  Ranking ranking;
  ranking.truths.resize(sequences.size());
  std::vector<std::pair<const ScoredImage*, std::size_t>> images;
  for (std::size_t s = 0; s < sequences.size(); ++s)
    for (const ScoredImage& image : sequences[s]) images.emplace_back(&image, s);
  const auto id = [](const auto& image) { return image.first->image_id; };
  if (std::ranges::all_of(
          images, [](const auto& number) { return number.has_value(); }, id))
    std::ranges::stable_sort(images, {}, id);
  for (const auto& [image, s] : images) add_image(*image, options, s, ranking);
  std::ranges::stable_sort(ranking.detections, std::greater(), &Ranked::score);
  return ranking;
}

// The curve with each sequence counted as often as its weight says; empty without a truth.
// Precision is needed at true positives alone: between them it only falls, and recall stays.
std::optional<PrecisionCurve> curve_of(const Ranking& ranking, std::span<const double> weights) {
  double truths = 0;
  for (std::size_t s = 0; s < weights.size(); ++s)
    truths += weights[s] * static_cast<double>(ranking.truths[s]);
  if (!(truths > 0)) return std::nullopt;
  PrecisionCurve curve;
  curve.truths = static_cast<std::int64_t>(truths);
  struct Point {
    double recall, precision, score;
  };
  std::vector<Point> points;
  double hits = 0;
  double alarms = 0;
  for (const Ranked& one : ranking.detections) {
    const double weight = weights[one.sequence];
    if (weight == 0) continue;
    if (hits + alarms == 0) curve.score[0] = one.score;  // any detection reaches a recall of 0
    (one.is_true ? hits : alarms) += weight;
    if (one.is_true)
      points.push_back({hits / truths,
                        hits / (alarms + hits + std::numeric_limits<double>::epsilon()),
                        one.score});
  }
  if (points.empty()) return curve;
  curve.recall = points.back().recall;
  for (std::size_t i = points.size() - 1; i > 0; --i)
    points[i - 1].precision = std::max(points[i - 1].precision, points[i].precision);
  std::size_t at = 0;
  double sum = 0;
  for (int i = 0; i < kRecallSteps; ++i) {
    while (at < points.size() && points[at].recall < recall_step(i)) ++at;
    if (at == points.size()) break;
    const auto k = static_cast<std::size_t>(i);
    curve.precision[k] = points[at].precision;
    if (i > 0) curve.score[k] = points[at].score;
    sum += points[at].precision;
  }
  curve.average_precision = sum / kRecallSteps;
  return curve;
}

// The same with all weights 1.
std::optional<PrecisionCurve> curve_of(const Ranking& ranking) {
  return curve_of(ranking, std::vector<double>(ranking.truths.size(), 1.0));
}

constexpr int kOverlapSteps = 10;  // cocoeval.py: 0.50, 0.55 .. 0.95

// As numpy.linspace(0.5, 0.95, 10), which cocoeval.py uses.
double overlap_step(int i) {
  return i == kOverlapSteps - 1 ? 0.95 : i * ((0.95 - 0.5) / (kOverlapSteps - 1)) + 0.5;
}

struct MeanScores {
  std::optional<double> precision, recall;
  std::optional<double> precision_50, precision_75;
};

// Means over the overlaps.
MeanScores means_of(std::span<const ImageList> sequences, const AreaRange& areas, int most) {
  MeanScores means;
  double precision = 0;
  double recall = 0;
  for (int i = 0; i < kOverlapSteps; ++i) {
    const auto curve =
        curve_of(ranking_of(sequences, {Likeness::kOverlap, overlap_step(i), areas, most}));
    if (!curve) return means;
    precision += curve->average_precision;
    recall += curve->recall;
    if (i == 0) means.precision_50 = curve->average_precision;
    if (i == 5) means.precision_75 = curve->average_precision;
  }
  means.precision = precision / kOverlapSteps;
  means.recall = recall / kOverlapSteps;
  return means;
}

// Curves of sequences that are drawn with replacement.
std::vector<PrecisionCurve> drawn_curves(const Ranking& ranking) {
  std::vector<PrecisionCurve> curves;
  const std::size_t sequences = ranking.truths.size();
  if (sequences < 2) return curves;
  const std::size_t draws = statistics::draws_for(ranking.detections.size());
  statistics::ClusterDraws drawn(sequences, "average precision");
  for (std::size_t draw = 0; draw < draws; ++draw)
    if (const auto curve = curve_of(ranking, drawn.next())) curves.push_back(*curve);
  return curves;
}

// The curve, its band, and the interval of its mean.
std::tuple<std::optional<PrecisionCurve>, std::optional<PrecisionBand>, std::optional<Interval>>
curves_of(std::span<const ImageList> sequences, Likeness likeness, double threshold) {
  const Ranking ranking = ranking_of(sequences, {likeness, threshold, kAllAreas, 100});
  const std::optional<PrecisionCurve> curve = curve_of(ranking);
  const std::vector<PrecisionCurve> drawn =
      curve ? drawn_curves(ranking) : std::vector<PrecisionCurve>{};
  if (drawn.size() < 2) return {curve, {}, {}};
  std::vector<double> values(drawn.size());
  std::ranges::transform(
      drawn, values.begin(), std::identity(), &PrecisionCurve::average_precision);
  const Interval interval = statistics::percentile_interval(values);
  PrecisionBand band;
  for (std::size_t i = 0; i < kRecallSteps; ++i) {
    std::transform(drawn.begin(), drawn.end(), values.begin(), [i](const PrecisionCurve& curve) {
      return curve.precision[i];
    });
    const Interval limits = statistics::percentile_interval(values);
    band.low[i] = limits.low;
    band.high[i] = limits.high;
  }
  return {curve, band, interval};
}

}  // namespace

std::optional<PrecisionCurve> precision_curve(std::span<const ScoredImage> images,
                                              const PrecisionOptions& options) {
  return curve_of(ranking_of(std::vector<ImageList>{images}, options));
}

AveragePrecision average_precision(std::span<const std::vector<ScoredImage>> sequences,
                                   double centre_px) {
  const std::vector<ImageList> lists(sequences.begin(), sequences.end());
  AveragePrecision result;
  const MeanScores all = means_of(lists, kAllAreas, 100);
  result.ap = all.precision;
  result.ap_50 = all.precision_50;
  result.ap_75 = all.precision_75;
  result.ar_100 = all.recall;
  result.ar_1 = means_of(lists, kAllAreas, 1).recall;
  result.ar_10 = means_of(lists, kAllAreas, 10).recall;
  const MeanScores small = means_of(lists, kSmall, 100);
  result.ap_small = small.precision;
  result.ar_small = small.recall;
  const MeanScores medium = means_of(lists, kMedium, 100);
  result.ap_medium = medium.precision;
  result.ar_medium = medium.recall;
  const MeanScores large = means_of(lists, kLarge, 100);
  result.ap_large = large.precision;
  result.ar_large = large.recall;
  std::tie(result.curve_50, result.band_50, result.ap_50_interval) =
      curves_of(lists, Likeness::kOverlap, 0.5);
  std::tie(result.curve_centre, result.band_centre, result.ap_centre_interval) =
      curves_of(lists, Likeness::kCentre, centre_px);
  if (result.curve_centre) result.ap_centre = result.curve_centre->average_precision;
  return result;
}

}  // namespace airtruth::evaluation
