// SPDX-License-Identifier: Apache-2.0
#include "evaluation/measures/outcome.h"

#include <cmath>
#include <limits>

#include "evaluation/matching/boxes.h"
#include "evaluation/statistics/bins.h"

namespace airtruth::measures {
std::vector<Outcome> outcomes(std::span<const evaluation::FramePair> frames,
                              const lens::Lens* lens) {
  std::vector<Outcome> result;
  std::optional<Box> last;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const evaluation::FramePair& frame = frames[i];
    if (frame.answer) last = frame.answer;
    if (i == 0 && !last) last = frame.truth;
    if (i == 0 || !frame.truth || !last) continue;
    const Box& truth = *frame.truth;
    Outcome outcome;
    outcome.frame = i;
    outcome.overlap = frame.answer ? evaluation::overlap(truth, *frame.answer) : 0;
    outcome.x_px = matching::centre_of(*last).x() - matching::centre_of(truth).x();
    outcome.y_px = matching::centre_of(*last).y() - matching::centre_of(truth).y();
    outcome.centre_px = std::hypot(outcome.x_px, outcome.y_px);
    outcome.normalised = std::hypot(outcome.x_px / truth.width, outcome.y_px / truth.height);
    if (lens != nullptr) outcome.angle_mrad = matching::angle_mrad(*lens, truth, *last);
    result.push_back(outcome);
  }
  return result;
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
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    if (const auto bin = statistics::bin_of(values[i], edges)) sorted[*bin].push_back(outcomes[i]);
  std::vector<Bin> bins;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    if (sorted[k].empty()) continue;
    Bin bin = mean_of(sorted[k]);
    bin.from = edges[k];
    bin.to = statistics::end_of_bin(k, edges);
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace airtruth::measures
