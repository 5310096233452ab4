// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include <airtruth/metrics.h>

#include "evaluation/measures/score_measures.h"
#include "foundation/base/median.h"
#include "foundation/geometry/box.h"

namespace airtruth::evaluation {
namespace {

// The box within the picture as GOT-10k's toolkit (0.1.3, rect_iou) bounds it: its coordinates
// count from 1 and are bounded to 0..width, and what a box loses on the left is not taken from its
// width.
Box bounded(const Box& box, int width, int height) {
  if (width <= 0 || height <= 0) return box;
  const double x = std::clamp(box.x + 1, 0.0, double(width));
  const double y = std::clamp(box.y + 1, 0.0, double(height));
  return {x, y, std::clamp(box.width, 0.0, width - x), std::clamp(box.height, 0.0, height - y)};
}

// OTB's curves and the normalised one.
void add_curves(const Box& truth, const std::optional<Box>& answer, Score& score) {
  const double shared = answer ? overlap(truth, *answer) : 0;
  double distance = std::numeric_limits<double>::infinity();
  double normalised = distance;
  if (answer) {
    const Pixel off = centre_of(*answer) - centre_of(truth);
    distance = std::hypot(off.x(), off.y());
    normalised = std::hypot(off.x() / truth.width, off.y() / truth.height);
  }
  for (int k = 0; k < kSuccessSteps; ++k)
    score.success[static_cast<std::size_t>(k)] += shared > 0.05 * k ? 1 : 0;
  for (int k = 0; k < kPrecisionSteps; ++k) {
    score.precision[static_cast<std::size_t>(k)] += distance <= k ? 1 : 0;
    score.normalised[static_cast<std::size_t>(k)] += normalised <= 0.01 * k ? 1 : 0;
  }
}

template <std::size_t n>
void divide(std::array<double, n>& curve, double count) {
  for (double& value : curve) value /= count;
}

template <std::size_t n>
double mean_of_curve(const std::array<double, n>& curve) {
  double sum = 0;
  for (const double value : curve) sum += value;
  return sum / n;
}

// Sums over the frames that have an error, for the measures of the E-Vision paper.
struct Offsets {
  double x = 0, y = 0, xx = 0, yy = 0, distance = 0;
  double x_most = 0, y_most = 0;
  std::int64_t count = 0;

  void add(const Pixel& off) {
    x += std::abs(off.x());
    y += std::abs(off.y());
    xx += off.x() * off.x();
    yy += off.y() * off.y();
    distance += std::hypot(off.x(), off.y());
    x_most = std::max(x_most, std::abs(off.x()));
    y_most = std::max(y_most, std::abs(off.y()));
    ++count;
  }
  void write(Score& score) const {
    if (count == 0) return;
    const double n = static_cast<double>(count);
    score.x_mean_px = x / n;
    score.y_mean_px = y / n;
    score.x_rmse_px = std::sqrt(xx / n);
    score.y_rmse_px = std::sqrt(yy / n);
    score.x_most_px = x_most;
    score.y_most_px = y_most;
    score.centre_mean_px = distance / n;
  }
};

// Sums over the frames after the first that show the target, for GOT-10k's measures.
struct Overlaps {
  double sum = 0;
  std::int64_t above_50 = 0;
  std::int64_t above_75 = 0;
  std::int64_t count = 0;

  void add(double overlap) {
    sum += overlap;
    above_50 += overlap > 0.5 ? 1 : 0;
    above_75 += overlap > 0.75 ? 1 : 0;
    ++count;
  }
  void write(Score& score) const {
    score.counted_after_first = count;
    if (count == 0) return;
    const double n = static_cast<double>(count);
    score.average_overlap = sum / n;
    score.success_50 = static_cast<double>(above_50) / n;
    score.success_75 = static_cast<double>(above_75) / n;
  }
};

void add_rates(std::span<const FramePair> frames, Score& score) {
  std::vector<double> rates;
  for (const FramePair& frame : frames.subspan(std::min<std::size_t>(1, frames.size())))
    if (frame.seconds > 0) rates.push_back(1 / frame.seconds);
  if (rates.empty()) return;
  score.frames_per_second_median = median_between(rates);
  double sum = 0;
  for (const double rate : rates) sum += rate / double(rates.size());
  score.frames_per_second = sum;
}

void end_curves(double count, Score& score) {
  if (count == 0) return;
  divide(score.success, count);
  divide(score.precision, count);
  divide(score.normalised, count);
}

// The mean over the sequences that have the measure.
std::optional<double> weighted_mean(std::span<const Score> scores,
                                    const measures::ScoreMeasure& measure) {
  double sum = 0;
  double weights = 0;
  for (const Score& score : scores) {
    if (!(score.*measure.value)) continue;
    sum += *(score.*measure.value) * measure.weight_of(score);
    weights += measure.weight_of(score);
  }
  return weights > 0 ? std::optional(sum / weights) : std::nullopt;
}

}  // namespace

Score score(std::span<const FramePair> frames, int width, int height) {
  Score score;
  score.frames = std::ssize(frames);
  Offsets offsets;
  Overlaps overlaps;
  add_rates(frames, score);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto truth = if_finite(frames[i].truth);
    if (!truth) continue;
    const auto answer = i == 0 ? truth : if_finite(frames[i].answer);
    ++score.counted;
    add_curves(*truth, answer, score);
    if (i == 0) continue;
    if (answer) offsets.add(centre_of(*answer) - centre_of(*truth));
    overlaps.add(answer ? overlap(bounded(*truth, width, height), bounded(*answer, width, height))
                        : 0);
  }
  offsets.write(score);
  overlaps.write(score);
  end_curves(static_cast<double>(score.counted), score);
  if (score.counted == 0) return score;
  score.auc = mean_of_curve(score.success);
  score.precision_20px = score.precision[20];
  score.normalised_auc = mean_of_curve(score.normalised);
  return score;
}

Score mean_of(std::span<const Score> scores) {
  Score mean;
  double n = 0;
  for (const Score& s : scores) {
    if (s.counted == 0) continue;
    mean.frames += s.frames;
    mean.counted += s.counted;
    mean.counted_after_first += s.counted_after_first;
    n += 1;
    for (std::size_t k = 0; k < mean.success.size(); ++k) mean.success[k] += s.success[k];
    for (std::size_t k = 0; k < mean.precision.size(); ++k) {
      mean.precision[k] += s.precision[k];
      mean.normalised[k] += s.normalised[k];
    }
  }
  end_curves(n, mean);
  for (const measures::ScoreMeasure& measure : measures::kScoreMeasures)
    mean.*measure.value = weighted_mean(scores, measure);
  return mean;
}

std::optional<std::size_t> first_loss(std::span<const FramePair> frames) {
  std::optional<std::size_t> first;
  int in_a_row = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const FramePair& frame = frames[i];
    if (!if_finite(frame.truth)) continue;
    if (frame.answer && overlap(*frame.truth, *frame.answer) > kLostOverlap) {
      in_a_row = 0;
      first.reset();
      continue;
    }
    if (in_a_row == 0) first = i;
    if (++in_a_row == kGrace) return first;
  }
  return first;
}

}  // namespace airtruth::evaluation
