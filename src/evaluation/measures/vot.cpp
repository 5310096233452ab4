// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include <airtruth/vot.h>

#include "evaluation/measures/outcome.h"
#include "foundation/base/error.h"
#include "foundation/geometry/box.h"

namespace airtruth::evaluation {
namespace {

constexpr std::size_t kBurnIn = 10;  // frames after a start without accuracy (VOT2013)
constexpr double kSensitivity =
    30;  // frames of the reliability exp(-S failures / frames) (VOT2014)

// A range of whole pixels from first to last, both included.
struct Pixels {
  double left = 0, top = 0, right = 0, bottom = 0;
};

Pixels pixels(const Box& box) {
  const double x = std::nearbyint(box.x);
  const double y = std::nearbyint(box.y);
  return {x, y, x + std::nearbyint(box.width) - 1, y + std::nearbyint(box.height) - 1};
}

Pixels cut(const Pixels& a, const Pixels& b) {
  return {std::max(a.left, b.left),
          std::max(a.top, b.top),
          std::min(a.right, b.right),
          std::min(a.bottom, b.bottom)};
}

double count(const Pixels& p) {
  return std::max(0.0, p.right - p.left + 1) * std::max(0.0, p.bottom - p.top + 1);
}

// The toolkit's empty region lies at the origin.
double region_overlap(const std::optional<Box>& stated_a,
                      const std::optional<Box>& stated_b,
                      int width,
                      int height) {
  const auto a = if_finite(stated_a);
  const auto b = if_finite(stated_b);
  const Pixels of_a = a ? pixels(*a) : Pixels{};
  const Pixels of_b = b ? pixels(*b) : Pixels{};
  const Pixels both{std::min(of_a.left, of_b.left),
                    std::min(of_a.top, of_b.top),
                    std::max(of_a.right, of_b.right),
                    std::max(of_a.bottom, of_b.bottom)};
  if (both.left >= both.right || both.top >= both.bottom) return 1;
  const Pixels part = width > 0 && height > 0 ? cut(both, {0, 0, width - 1.0, height - 1.0}) : both;
  if (part.left >= part.right || part.top >= part.bottom) return 0;
  if (!a || !b) return 0;
  const Pixels a_cut = cut(of_a, part);
  const Pixels b_cut = cut(of_b, part);
  const double shared = count(cut(a_cut, b_cut));
  const double all = count(a_cut) + count(b_cut) - shared;
  return all > 0 ? shared / all : 0;
}

std::vector<double> overlaps_of(const Trajectory& frames,
                                std::span<const std::optional<Box>> truth,
                                const VotTruth& about) {
  std::vector<double> result;
  for (std::size_t i = 0; i < frames.size(); ++i)
    result.push_back(frame_overlap(frames[i], truth[i], about.width, about.height));
  return result;
}

// Sums over runs. Point j of a curve covers the runs that are active there.
struct Curve {
  std::vector<double> sum;
  std::vector<double> active;

  void add(std::size_t j, double value) {
    if (j >= sum.size()) {
      sum.resize(j + 1, 0);
      active.resize(j + 1, 0);
    }
    sum[j] += value;
    active[j] += 1;
  }
  std::vector<double> mean() const {
    std::vector<double> curve(sum.size(), 0);
    for (std::size_t j = 0; j < sum.size(); ++j)
      if (active[j] > 0) curve[j] = sum[j] / active[j];
    return curve;
  }
};

std::optional<double> mean_over(const std::vector<double>& curve, std::pair<int, int> range) {
  const std::ptrdiff_t first = std::max(0, range.first);
  const std::ptrdiff_t end = std::min(std::ptrdiff_t{range.second} + 1, std::ssize(curve));
  if (first >= end) return std::nullopt;
  const double sum = std::accumulate(curve.begin() + first, curve.begin() + end, 0.0);
  return sum / static_cast<double>(end - first);
}

// The frames from a start to the one before a failure, or to the end.
struct Fragment {
  std::vector<double> overlaps;
  bool failed = false;
};

void add_fragments(const Trajectory& run,
                   const std::vector<double>& overlaps,
                   std::vector<Fragment>& fragments) {
  std::optional<std::size_t> begun;
  for (std::size_t i = 0; i <= run.size(); ++i) {
    const bool ends = i == run.size();
    if (!ends && run[i].mark == Mark::kBegun) begun = i;
    if (begun && (ends || run[i].mark == Mark::kFailed)) {
      fragments.push_back({{overlaps.begin() + static_cast<std::ptrdiff_t>(*begun),
                            overlaps.begin() + static_cast<std::ptrdiff_t>(i)},
                           !ends});
      begun.reset();
    }
  }
}

std::vector<double> curve_of(const std::vector<Fragment>& fragments) {
  std::size_t longest = 0;
  for (const Fragment& fragment : fragments) longest = std::max(longest, fragment.overlaps.size());
  Curve curve;
  for (const Fragment& fragment : fragments) {
    double sum = 0;
    const std::size_t end = fragment.failed ? longest : fragment.overlaps.size();
    for (std::size_t j = 0; j < end; ++j) {
      const double here = j < fragment.overlaps.size() ? fragment.overlaps[j] : 0;
      if (j > 0) sum += here;
      curve.add(j, j > 0 ? sum / static_cast<double>(j) : here);
    }
  }
  return curve.mean();
}

std::pair<double, std::int64_t> accuracy_and_failures(const Trajectory& run,
                                                      const std::vector<double>& overlaps) {
  std::int64_t failures = 0;
  double sum = 0;
  std::int64_t n = 0;
  std::size_t counts_from = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const Mark mark = run[i].mark;
    failures += mark == Mark::kFailed ? 1 : 0;
    if (mark == Mark::kBegun) counts_from = i + kBurnIn;
    if (i < counts_from || mark == Mark::kUnknown || mark == Mark::kFailed) continue;
    sum += overlaps[i];
    ++n;
  }
  return {n > 0 ? sum / static_cast<double>(n) : 0, failures};
}

std::vector<std::optional<Box>> truth_of(const VotTruth& truth, const AnchorRun& run) {
  if (run.anchor < 0 || run.anchor >= std::ssize(truth.boxes))
    throw Error("an anchor is not in its sequence");
  const auto at = truth.boxes.begin() + run.anchor;
  if (!run.is_backward) return {at, truth.boxes.end()};
  std::vector<std::optional<Box>> boxes(truth.boxes.begin(), at + 1);
  std::reverse(boxes.begin(), boxes.end());
  return boxes;
}

// The number of frames before the failure; of all frames where there is no failure.
std::size_t progress_of(const std::vector<double>& overlaps,
                        std::span<const std::optional<Box>> truth) {
  int grace = kGrace;
  for (std::size_t j = 0; j < overlaps.size(); ++j) {
    if (overlaps[j] > kLostOverlap || !truth[j]) {
      grace = kGrace;
      continue;
    }
    if (--grace == 0) return j + 1 - kGrace;
  }
  return overlaps.size();
}

// Adds a run with this progress to the curve of expected overlap, up to the length `high`.
void add_run(const std::vector<double>& overlaps,
             std::size_t progress,
             std::size_t high,
             Curve& curve) {
  const bool failed = progress < overlaps.size();
  double sum = 0;
  for (std::size_t j = 1; j < high; ++j) {
    if (j < overlaps.size()) {
      if (j < progress) sum += overlaps[j];
      curve.add(j, sum / static_cast<double>(j));
    } else if (failed) {
      curve.add(j, sum / static_cast<double>(std::max<std::size_t>(1, j - 1)));
    }
  }
}

}  // namespace

double pixel_overlap(const Box& a, const Box& b, int width, int height) {
  return region_overlap(a, b, width, height);
}

double frame_overlap(const VotFrame& frame,
                     const std::optional<Box>& truth,
                     int width,
                     int height) {
  return region_overlap(
      frame.mark == Mark::kAnswer ? frame.box : std::nullopt, truth, width, height);
}

Restart restart_score(std::span<const RestartRuns> sequences, std::pair<int, int> eao_range) {
  Restart score;
  double length = 0;
  double count = 0;
  std::vector<Fragment> fragments;
  for (const RestartRuns& sequence : sequences) {
    if (sequence.runs.empty()) continue;
    double accuracy = 0;
    double failures = 0;
    for (const Trajectory& run : sequence.runs) {
      if (run.size() != sequence.truth.boxes.size())
        throw Error("a run is not as long as its truth");
      const auto overlaps = overlaps_of(run, sequence.truth.boxes, sequence.truth);
      const auto [mean, failed] = accuracy_and_failures(run, overlaps);
      accuracy += mean;
      failures += static_cast<double>(failed);
      add_fragments(run, overlaps, fragments);
    }
    const double runs = static_cast<double>(sequence.runs.size());
    const double frames = static_cast<double>(sequence.truth.boxes.size());
    score.accuracy += accuracy / runs * frames;
    score.failures += failures / runs * frames;
    length += frames;
    count += 1;
  }
  if (count == 0) return score;
  score.accuracy /= length;
  score.failures /= length;
  score.reliability = std::exp(-kSensitivity * score.failures / (length / count));
  score.eao_curve = curve_of(fragments);
  score.eao = mean_over(score.eao_curve, eao_range);
  return score;
}

MultiStart multistart_score(std::span<const MultiStartRuns> sequences,
                            std::pair<int, int> eao_range) {
  MultiStart score;
  double overlap = 0;
  double before = 0;
  double robustness = 0;
  double length = 0;
  Curve curve;
  const auto high = static_cast<std::size_t>(std::max(0, eao_range.second));
  for (const MultiStartRuns& sequence : sequences) {
    if (sequence.runs.empty()) continue;
    double progress_of_runs = 0;
    double frames = 0;
    for (const AnchorRun& run : sequence.runs) {
      const auto truth = truth_of(sequence.truth, run);
      if (run.frames.size() != truth.size())
        throw Error("a run is not as long as the sequence from its anchor");
      const auto overlaps = overlaps_of(run.frames, truth, sequence.truth);
      const std::size_t progress = progress_of(overlaps, truth);
      progress_of_runs += static_cast<double>(progress);
      frames += static_cast<double>(overlaps.size());
      for (std::size_t j = 0; j < progress; ++j) overlap += overlaps[j];
      add_run(overlaps, progress, high, curve);
    }
    before += progress_of_runs;
    const double weight = static_cast<double>(sequence.truth.boxes.size());
    robustness += progress_of_runs / frames * weight;
    length += weight;
  }
  if (length == 0) return score;
  score.accuracy = before > 0 ? overlap / before : 0;
  score.robustness = robustness / length;
  score.eao_curve = curve.mean();
  score.eao = mean_over(score.eao_curve, eao_range);
  return score;
}

std::vector<Anchor> anchors_of(const VotTruth& truth, int step) {
  if (step <= 0) throw Error("the step from anchor to anchor is not above 0");
  const std::int64_t length = std::ssize(truth.boxes);
  const auto shown = [&](std::int64_t frame) {
    return truth.boxes[static_cast<std::size_t>(frame)].has_value();
  };
  std::vector<Anchor> anchors;
  const auto add = [&](std::int64_t frame) {
    const bool is_backward = frame >= (length + 1) / 2;
    const std::int64_t way = is_backward ? -1 : 1;
    while (frame >= 0 && frame < length && !shown(frame)) frame += way;
    if (frame < 0 || frame >= length) return;
    if (std::ranges::find(anchors, frame, &Anchor::frame) == anchors.end())
      anchors.push_back({frame, is_backward});
  };
  for (std::int64_t frame = 0; frame < length; frame += step) {
    const bool is_last = frame + step >= length && frame >= (length + 1) / 2;
    add(is_last ? length - 1 : frame);
  }
  return anchors;
}

namespace {

// The density of lengths at 0, 1, ... frames up to the longest, not normalised: a sum of Gaussians
// whose width follows the rule of Silverman (1986), 1.06 sigma n^(-1/5), and is at least 1 frame.
std::vector<double> density_of(std::span<const std::int64_t> lengths) {
  const double n = static_cast<double>(lengths.size());
  const double mean = std::accumulate(lengths.begin(), lengths.end(), 0.0) / n;
  double variance = 0;
  std::int64_t longest = 0;
  for (const std::int64_t l : lengths) {
    variance += (static_cast<double>(l) - mean) * (static_cast<double>(l) - mean) / n;
    longest = std::max(longest, l);
  }
  const double width = std::max(1.0, 1.06 * std::sqrt(variance) * std::pow(n, -0.2));
  std::vector<double> density(static_cast<std::size_t>(longest) + 1, 0);
  for (std::size_t x = 1; x < density.size(); ++x)
    for (const std::int64_t l : lengths) {
      const double z = (static_cast<double>(x) - static_cast<double>(l)) / width;
      density[x] += std::exp(-z * z / 2);
    }
  return density;
}

}  // namespace

std::pair<int, int> eao_range(std::span<const std::int64_t> lengths) {
  if (lengths.empty()) return {0, 0};
  const std::vector<double> density = density_of(lengths);
  const auto longest = std::ssize(density) - 1;
  const double all = std::accumulate(density.begin(), density.end(), 0.0);
  // Extends the range from the mode towards the denser side until it holds half of the density.
  auto low = std::max_element(density.begin(), density.end()) - density.begin();
  auto high = low;
  double held = density[static_cast<std::size_t>(low)];
  while (held < all / 2) {
    const double below = low > 1 ? density[static_cast<std::size_t>(low - 1)] : -1;
    const double above = high < longest ? density[static_cast<std::size_t>(high + 1)] : -1;
    held += std::max(below, above);
    if (below >= above)
      --low;
    else
      ++high;
  }
  return {static_cast<int>(low), static_cast<int>(high)};
}

std::pair<int, int> within_curves(std::pair<int, int> range, std::int64_t longest) {
  const int last = static_cast<int>(std::max<std::int64_t>(1, longest - 1));
  const int high = std::min(range.second, last);
  return {std::min(range.first, std::max(1, high - 1)), high};
}

}  // namespace airtruth::evaluation
