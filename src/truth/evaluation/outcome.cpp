// SPDX-License-Identifier: Apache-2.0
#include "truth/evaluation/outcome.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace airtruth::evaluation {
std::vector<Outcome> outcomes(std::span<const FramePair> frames, const lens::Lens* lens) {
  std::vector<Outcome> result;
  std::optional<Box> last;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FramePair& frame = frames[i];
    if (frame.answer) last = frame.answer;
    if (i == 0 && !last) last = frame.truth;
    if (i == 0 || !frame.truth || !last) continue;
    const Box& truth = *frame.truth;
    Outcome outcome;
    outcome.frame = i;
    outcome.overlap = frame.answer ? overlap(truth, *frame.answer) : 0;
    outcome.x_px = centre_of(*last).x() - centre_of(truth).x();
    outcome.y_px = centre_of(*last).y() - centre_of(truth).y();
    outcome.centre_px = std::hypot(outcome.x_px, outcome.y_px);
    outcome.normalised = std::hypot(outcome.x_px / truth.width, outcome.y_px / truth.height);
    if (lens != nullptr) outcome.angle_mrad = angle_mrad(*lens, truth, *last);
    result.push_back(outcome);
  }
  return result;
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

Bin mean_of(std::span<const Outcome> outcomes) {
  Bin bin;
  bin.to = std::numeric_limits<double>::infinity();
  bin.frames = std::ssize(outcomes);
  if (outcomes.empty()) return bin;
  double angles = 0;
  std::int64_t with_angle = 0;
  for (const Outcome& o : outcomes) {
    bin.overlap += o.overlap;
    bin.success_50 += o.overlap > 0.5 ? 1 : 0;
    bin.precision_20px += o.centre_px <= 20 ? 1 : 0;
    bin.centre_px += o.centre_px;
    bin.normalised += o.normalised;
    angles += o.angle_mrad.value_or(0);
    with_angle += o.angle_mrad ? 1 : 0;
  }
  const double n = static_cast<double>(outcomes.size());
  for (double* value :
       {&bin.overlap, &bin.success_50, &bin.precision_20px, &bin.centre_px, &bin.normalised})
    *value /= n;
  if (with_angle > 0) bin.angle_mrad = angles / static_cast<double>(with_angle);
  return bin;
}

std::vector<Bin> breakdown(std::span<const Outcome> outcomes,
                           std::span<const std::optional<double>> values,
                           std::span<const double> edges) {
  std::vector<std::vector<Outcome>> sorted(edges.size());
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!values[i] || !std::isfinite(*values[i]) || *values[i] < edges.front()) continue;
    const auto above = std::upper_bound(edges.begin(), edges.end(), *values[i]);
    sorted[static_cast<std::size_t>(above - edges.begin()) - 1].push_back(outcomes[i]);
  }
  std::vector<Bin> bins;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    if (sorted[k].empty()) continue;
    Bin bin = mean_of(sorted[k]);
    bin.from = edges[k];
    if (k + 1 < edges.size()) bin.to = edges[k + 1];
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace airtruth::evaluation
