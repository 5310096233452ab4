// SPDX-License-Identifier: Apache-2.0
#include "evaluation/measures/outcome.h"

#include <cmath>
#include <limits>

#include "evaluation/matching/boxes.h"
#include "evaluation/statistics/bins.h"
#include "foundation/geometry/box.h"

namespace airtruth::measures {
namespace {

// The mean over the outcomes that have the value.
std::optional<double> mean(std::span<const Outcome> outcomes,
                           std::optional<double> Outcome::*member) {
  double sum = 0;
  std::int64_t count = 0;
  for (const Outcome& outcome : outcomes) {
    sum += (outcome.*member).value_or(0);
    count += outcome.*member ? 1 : 0;
  }
  return count > 0 ? std::optional(sum / static_cast<double>(count)) : std::nullopt;
}

}  // namespace

std::vector<Outcome> outcomes(std::span<const evaluation::FramePair> frames,
                              const lens::Lens* lens) {
  std::vector<Outcome> result;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (!frames[i].truth) continue;
    Outcome& outcome = result.emplace_back();
    outcome.frame = i;
    if (!frames[i].answer) continue;
    const Box& truth = *frames[i].truth;
    const Box& answer = *frames[i].answer;
    const Pixel off = centre_of(answer) - centre_of(truth);
    outcome.overlap = evaluation::overlap(truth, answer);
    outcome.centre_px = off.norm();
    outcome.normalised = std::hypot(off.x() / truth.width, off.y() / truth.height);
    if (lens != nullptr) outcome.angle_mrad = matching::angle_mrad(*lens, truth, answer);
  }
  return result;
}

Bin mean_of(std::span<const Outcome> outcomes) {
  Bin bin;
  bin.to = std::numeric_limits<double>::infinity();
  bin.frames = std::ssize(outcomes);
  if (outcomes.empty()) return bin;
  for (const Outcome& o : outcomes) {
    bin.overlap += o.overlap;
    bin.success_50 += o.overlap > 0.5 ? 1 : 0;
    bin.precision_20px += o.centre_px && *o.centre_px <= 20 ? 1 : 0;
  }
  const double n = static_cast<double>(outcomes.size());
  for (double* value : {&bin.overlap, &bin.success_50, &bin.precision_20px}) *value /= n;
  bin.centre_px = mean(outcomes, &Outcome::centre_px);
  bin.normalised = mean(outcomes, &Outcome::normalised);
  bin.angle_mrad = mean(outcomes, &Outcome::angle_mrad);
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
