// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/ranking.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "detection/scoring/found.h"
#include "truth/evaluation/metrics.h"

namespace airtruth::detection {
namespace {

double recall_step(int i) { return i == kRecallSteps - 1 ? 1.0 : i * 0.01; }

// Resemblance of a detection and a truth; empty below the threshold. A larger one is more alike.
std::optional<double> likeness(const ScoredBox& detection,
                               const LabelledBox& truth,
                               const PrecisionOptions& options) {
  const Box& d = detection.box_px;
  const Box& t = truth.box_px;
  if (options.likeness == Likeness::kCentre) {
    const double distance = centre_distance_px(d, t);
    const bool is_near = distance <= found_radius_px(t, options.threshold);
    return is_near || (truth.is_region && centre_is_in(d, t)) ? std::optional(-distance)
                                                              : std::nullopt;
  }
  double overlap = evaluation::overlap(d, t);
  if (truth.is_region && overlap > 0) {
    const double width = std::min(d.right(), t.right()) - std::max(d.x, t.x);
    const double height = std::min(d.bottom(), t.bottom()) - std::max(d.y, t.y);
    overlap = width * height / d.area();
  }
  return overlap >= std::min(options.threshold, 1 - 1e-10) ? std::optional(overlap) : std::nullopt;
}

bool is_outside(const Box& box, const AreaRange& areas) {
  return box.area() < areas.low_px || box.area() > areas.high_px;
}

// The matching of cocoeval.py's evaluateImg.
class ImageMatcher {
 public:
  ImageMatcher(const ScoredImage& image, const PrecisionOptions& options)
      : image_(image), options_(options) {
    for (const LabelledBox& truth : image.truths)
      ignored_.push_back(truth.is_region || truth.is_ignored ||
                         is_outside(truth.box_px, options.areas));
    order_.resize(image.truths.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      return !ignored_[a] && ignored_[b];
    });
    is_taken_.resize(image.truths.size());
  }

  std::int64_t counting() const { return std::count(ignored_.begin(), ignored_.end(), false); }

  // Calls add(score, is_true) for each detection that counts, by falling score.
  template <typename Add>
  void match(Add add) {
    std::vector<std::size_t> by_score(image_.detections.size());
    std::iota(by_score.begin(), by_score.end(), std::size_t{0});
    std::stable_sort(by_score.begin(), by_score.end(), [&](std::size_t a, std::size_t b) {
      return image_.detections[a].score > image_.detections[b].score;
    });
    const auto most = static_cast<std::size_t>(std::max(0, options_.max_detections));
    if (by_score.size() > most) by_score.resize(most);
    for (const std::size_t d : by_score) {
      const ScoredBox& detection = image_.detections[d];
      const auto truth = best_of(detection);
      if (truth) is_taken_[*truth] = true;
      const bool is_ignored =
          truth ? ignored_[*truth] != 0 : is_outside(detection.box_px, options_.areas);
      if (!is_ignored) add(detection.score, truth.has_value());
    }
  }

 private:
  std::optional<std::size_t> best_of(const ScoredBox& detection) const {
    std::optional<std::size_t> best;
    double best_likeness = 0;
    for (const std::size_t t : order_) {
      if (is_taken_[t] && !image_.truths[t].is_region) continue;
      // Truths that count come first: once one is found, those to ignore are not looked at.
      if (best && !ignored_[*best] && ignored_[t]) break;
      const auto found = likeness(detection, image_.truths[t], options_);
      if (!found || (best && *found < best_likeness)) continue;
      best_likeness = *found;
      best = t;
    }
    return best;
  }

  const ScoredImage& image_;
  const PrecisionOptions& options_;
  std::vector<char> ignored_;
  std::vector<char> is_taken_;
  std::vector<std::size_t> order_;
};

}  // namespace

Ranking ranking_of(std::span<const ImageList> sequences, const PrecisionOptions& options) {
  Ranking ranking;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    std::int64_t& truths = ranking.truths.emplace_back();
    for (const ScoredImage& image : sequences[s]) {
      ImageMatcher matcher(image, options);
      truths += matcher.counting();
      matcher.match([&](double score, bool is_true) {
        ranking.detections.push_back({score, s, is_true});
      });
    }
  }
  std::stable_sort(ranking.detections.begin(),
                   ranking.detections.end(),
                   [](const Ranked& a, const Ranked& b) { return a.score > b.score; });
  return ranking;
}

// Precision is needed at true positives alone: between them it only falls, and recall stays.
PrecisionCurve curve_of(const Ranking& ranking, std::span<const double> weights) {
  PrecisionCurve curve;
  double truths = 0;
  for (std::size_t s = 0; s < weights.size(); ++s)
    truths += weights[s] * static_cast<double>(ranking.truths[s]);
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
    curve.score[k] = points[at].score;
    sum += points[at].precision;
  }
  curve.average_precision = sum / kRecallSteps;
  return curve;
}

std::optional<PrecisionCurve> curve_of(const Ranking& ranking) {
  const std::int64_t truths =
      std::accumulate(ranking.truths.begin(), ranking.truths.end(), std::int64_t{0});
  if (truths == 0) return std::nullopt;
  return curve_of(ranking, std::vector<double>(ranking.truths.size(), 1.0));
}

}  // namespace airtruth::detection
