// SPDX-License-Identifier: Apache-2.0
#include "evaluation/measures/outcome.h"

#include <cmath>
#include <map>

#include "evaluation/matching/boxes.h"
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
                           std::span<const std::optional<statistics::Place>> places) {
  std::map<statistics::Place, std::vector<Outcome>> sorted;
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    if (places[i]) sorted[*places[i]].push_back(outcomes[i]);
  std::vector<Bin> bins;
  for (const auto& [place, of_bin] : sorted) {
    bins.push_back(mean_of(of_bin));
    bins.back().place = place;
  }
  return bins;
}

}  // namespace airtruth::measures
