// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/edge_profile.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "foundation/base/median.h"

namespace airtruth::optics {
namespace {

// Half the width of the profile, as straight_step.cpp samples it, and the width of its bins, px.
constexpr double kProfileHalfWidthPx = 6, kProfileBinPx = 0.2;
// Least number of samples of a bin that is shown: a median of fewer is noise.
constexpr std::size_t kMinSamplesInBin = 5;
// Largest spread of an edge that is shown, as a multiple of the camera's.
constexpr double kMaxSpreadRatio = 1.1;
// Least number of edges that are shown.
constexpr std::size_t kMinEdgesShown = 8;

// The edges whose spread is mostly the camera's; at least the sharpest kMinEdgesShown ones.
std::vector<const StepEdge*> nearest_to_camera(const std::vector<const StepEdge*>& edges,
                                               const StepResponse& response) {
  std::vector<double> sorted = response.edge_spreads_px;
  std::sort(sorted.begin(), sorted.end());
  const double fewest_px = sorted[std::min(kMinEdgesShown, sorted.size()) - 1];
  const double most_px = std::max(fewest_px, kMaxSpreadRatio * response.point_spread_px.value);
  std::vector<const StepEdge*> nearest;
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (response.edge_spreads_px[e] <= most_px) nearest.push_back(edges[e]);
  return nearest;
}

}  // namespace

EdgeProfile edge_profile(const std::vector<const StepEdge*>& edges,
                         const StepResponse& response,
                         const image::ToneCurve& tone) {
  constexpr int kBins = static_cast<int>(2 * kProfileHalfWidthPx / kProfileBinPx);
  std::array<std::vector<double>, kBins> bins;
  std::vector<double> lows, highs;
  for (const StepEdge* edge : nearest_to_camera(edges, response)) {
    lows.push_back(edge->low), highs.push_back(edge->high);
    for (const auto& [place, height] : edge->samples) {
      const int bin = static_cast<int>(std::floor((place + kProfileHalfWidthPx) / kProfileBinPx));
      if (bin >= 0 && bin < kBins) bins[static_cast<std::size_t>(bin)].push_back(height);
    }
  }
  EdgeProfile profile;
  for (int b = 0; b < kBins; ++b) {
    auto& heights = bins[static_cast<std::size_t>(b)];
    if (heights.size() < kMinSamplesInBin) continue;
    profile.place_px.push_back((b + 0.5) * kProfileBinPx - kProfileHalfWidthPx);
    profile.height.push_back(median(std::move(heights)));
  }
  const double low = median(std::move(lows)), high = median(std::move(highs));
  profile.fitted = step_heights(response, low, high, profile.place_px, tone);
  profile.spread_px = edge_spread_px(response, low, high, tone);
  profile.edges = static_cast<int>(edges.size());
  return profile;
}

}  // namespace airtruth::optics
