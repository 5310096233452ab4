// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include <airtruth/metrics.h>

#include "foundation/base/median.h"

namespace airtruth::evaluation {
namespace {

std::optional<Box> cut(const Box& box, int width, int height) {
  if (width <= 0 || height <= 0) return box;
  const double x0 = std::clamp(box.x, 0.0, double(width));
  const double y0 = std::clamp(box.y, 0.0, double(height));
  const double x1 = std::clamp(box.right(), 0.0, double(width));
  const double y1 = std::clamp(box.bottom(), 0.0, double(height));
  return Box{x0, y0, x1 - x0, y1 - y0};
}

struct Offset {
  double x = 0;
  double y = 0;
};

Offset offset(const Box& truth, const Box& answer) {
  // The centres are subtracted first, so that equal boxes are at a distance of exactly 0.
  return {(answer.x + answer.width / 2) - (truth.x + truth.width / 2),
          (answer.y + answer.height / 2) - (truth.y + truth.height / 2)};
}

// OTB's curves and the normalised one.
void add_curves(const Box& truth, const std::optional<Box>& answer, Score& score) {
  const double shared = answer ? overlap(truth, *answer) : 0;
  double distance = std::numeric_limits<double>::infinity();
  double normalised = distance;
  if (answer) {
    const Offset off = offset(truth, *answer);
    distance = std::hypot(off.x, off.y);
    normalised = std::hypot(off.x / truth.width, off.y / truth.height);
  }
  for (int k = 0; k < kSuccessSteps; ++k)
    score.success[static_cast<std::size_t>(k)] += shared > 0.05 * k ? 1 : 0;
  for (int k = 0; k < kPrecisionSteps; ++k) {
    score.precision[static_cast<std::size_t>(k)] += distance <= k ? 1 : 0;
    score.normalised[static_cast<std::size_t>(k)] += normalised <= 0.01 * k ? 1 : 0;
  }
}

template <std::size_t n>
double divided(std::array<double, n>& curve, double count) {
  double sum = 0;
  for (double& value : curve) sum += value /= count;
  return sum / n;
}

// Sums over the frames after the first, for the measures of the E-Vision paper.
struct Offsets {
  double x = 0, y = 0, xx = 0, yy = 0, distance = 0;
  double x_most = 0, y_most = 0;
  std::int64_t count = 0;

  void add(const Offset& off) {
    x += std::abs(off.x);
    y += std::abs(off.y);
    xx += off.x * off.x;
    yy += off.y * off.y;
    distance += std::hypot(off.x, off.y);
    x_most = std::max(x_most, std::abs(off.x));
    y_most = std::max(y_most, std::abs(off.y));
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

void add_rates(std::span<const FramePair> frames, Score& score) {
  std::vector<double> rates;
  for (const FramePair& frame : frames.subspan(std::min<std::size_t>(1, frames.size())))
    if (frame.seconds > 0) rates.push_back(1 / frame.seconds);
  if (rates.empty()) return;
  score.frames_per_second_median = median_between(rates);
  for (const double rate : rates) score.frames_per_second += rate / double(rates.size());
}

// Separates the measures that are averaged over sequences from those over the frames of all
// sequences.
constexpr double Score::*kOfSequences[] = {&Score::x_mean_px,
                                           &Score::x_rmse_px,
                                           &Score::x_most_px,
                                           &Score::y_mean_px,
                                           &Score::y_rmse_px,
                                           &Score::y_most_px,
                                           &Score::centre_mean_px,
                                           &Score::auc,
                                           &Score::precision_20px,
                                           &Score::normalised_auc};
constexpr double Score::*kOfFrames[] = {
    &Score::average_overlap, &Score::success_50, &Score::success_75};

// Turns the sums over frames into means. The first frame counts for the curves alone.
void divide_sums(std::int64_t after_first, Score& score) {
  if (score.counted > 0) {
    const double n = static_cast<double>(score.counted);
    score.auc = divided(score.success, n);
    divided(score.precision, n);
    score.precision_20px = score.precision[20];
    score.normalised_auc = divided(score.normalised, n);
  }
  if (after_first > 0) {
    const double n = static_cast<double>(after_first);
    score.average_overlap /= n;
    score.success_50 /= n;
    score.success_75 /= n;
  }
}

}  // namespace

Score score(std::span<const FramePair> frames, int width, int height) {
  Score score;
  score.frames = std::ssize(frames);
  Offsets offsets;
  std::int64_t after_first = 0;
  add_rates(frames, score);
  std::optional<Box> last;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FramePair& frame = frames[i];
    if (frame.answer) last = frame.answer;
    if (!frame.truth) continue;
    ++score.counted;
    add_curves(*frame.truth, i == 0 ? frame.truth : frame.answer, score);
    if (i == 0) continue;
    ++after_first;
    if (last) offsets.add(offset(*frame.truth, *last));
    const double shared = frame.answer ? overlap(*cut(*frame.truth, width, height),
                                                 *cut(*frame.answer, width, height))
                                       : 0;
    score.average_overlap += shared;
    score.success_50 += shared > 0.5 ? 1 : 0;
    score.success_75 += shared > 0.75 ? 1 : 0;
  }
  offsets.write(score);
  divide_sums(after_first, score);
  return score;
}

Score mean_of(std::span<const Score> scores) {
  Score mean;
  double n = 0;
  double frames = 0;
  double rates = 0;
  for (const Score& s : scores) {
    if (s.counted == 0) continue;
    mean.frames += s.frames;
    mean.counted += s.counted;
    n += 1;
    // The first frame, which GOT-10k omits, always shows the target.
    const double after_first = static_cast<double>(s.counted - 1);
    frames += after_first;
    for (const auto member : kOfSequences) mean.*member += s.*member;
    for (const auto member : kOfFrames) mean.*member += s.*member * after_first;
    for (std::size_t k = 0; k < mean.success.size(); ++k) mean.success[k] += s.success[k];
    for (std::size_t k = 0; k < mean.precision.size(); ++k) {
      mean.precision[k] += s.precision[k];
      mean.normalised[k] += s.normalised[k];
    }
    mean.frames_per_second += s.frames_per_second;
    mean.frames_per_second_median += s.frames_per_second_median;
    rates += s.frames_per_second > 0 ? 1 : 0;
  }
  if (n == 0) return mean;
  for (const auto member : kOfSequences) mean.*member /= n;
  if (frames > 0)
    for (const auto member : kOfFrames) mean.*member /= frames;
  divided(mean.success, n);
  divided(mean.precision, n);
  divided(mean.normalised, n);
  if (rates > 0) {
    mean.frames_per_second /= rates;
    mean.frames_per_second_median /= rates;
  }
  return mean;
}

std::optional<std::size_t> first_loss(std::span<const FramePair> frames) {
  std::optional<std::size_t> first;
  int in_a_row = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const FramePair& frame = frames[i];
    if (!frame.truth) continue;
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
