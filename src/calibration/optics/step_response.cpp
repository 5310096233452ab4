// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/step_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "calibration/optics/edge_fit.h"
#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "foundation/geometry/transform.h"

namespace airtruth::optics {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// camera_slow_test.cpp, whose figures are in docs/realism.md.

// Radii of the unsharp mask that are tried, px.
constexpr std::array kTriedRadiiPx = {0.6, 0.75, 0.9, 1.05, 1.25, 1.5, 1.8, 2.2, 2.7};
// Prior of the radius: its median, px, and the standard deviation of its logarithm.
constexpr double kMedianRadiusPx = 1.1, kRadiusLogSigma = 0.3;
// An amount of sharpening is significant above this multiple of its standard error.
constexpr double kMinAmountInErrors = 2;
// Lower bound of the rms residual of an edge, in heights 0 to 1. A smaller residual is accidental.
constexpr double kMinRms = 0.0005;
// Scatter of the amounts of edges beyond their fitted errors.
constexpr double kAmountScatter = 0.15;
// Excess of the logarithm of an edge's spread over the camera's at which the edge has half weight.
constexpr double kHalfWeightExcess = 0.5;
// Effective number of independent residuals of an edge in the likelihood of its rms. It is much
// smaller than the number of samples, since neighbouring samples and edges of one scene have
// correlated errors.
constexpr double kIndependentResiduals = 6;

using measured::Likely;

Estimate from_logarithm(const Estimate& e) {
  return {std::exp(e.value), std::exp(e.value) * e.sigma};
}

struct Weighted {
  double value = 0, weight = 0;
};

// The weighted median: the least value at which the weights up to it reach half of their sum.
double median_of(std::vector<Weighted> values) {
  std::ranges::sort(values, {}, &Weighted::value);
  double total = 0, below = 0;
  for (const Weighted& v : values) total += v.weight;
  for (const Weighted& v : values)
    if ((below += v.weight) >= 0.5 * total) return v.value;
  return values.back().value;
}

// Likelihood of `sum`, the sum of the excess spread that an edge has in the world and of a normally
// distributed error. The excess of one half of the edges is exponentially distributed with the mean
// `world` (Meeusen and van den Broeck 1977); the excess of the other half is arbitrary.
double sum_likelihood(double sum, double world, double error) {
  // Range of an arbitrary excess, in logarithms: an edge up to 4.5 times as soft as the camera.
  constexpr double kMaxExcess = 1.5;
  const auto above = [](double deviations) {
    return 0.5 * std::erfc(-deviations / std::sqrt(2.0));
  };
  const double ratio = error / world;
  const double near = std::exp(std::min(0.5 * ratio * ratio - sum / world, 600.0)) / world *
                      above(sum / error - ratio);
  return 0.5 * near + 0.5 * above(sum / error) / kMaxExcess;
}

// Likelihood of the logarithm of an edge's spread relative to the camera's. Lines along an edge and
// other effects outside the model change the spread by a random amount, which is occasionally
// larger.
double likelihood(double over_camera, double world, double error) {
  // Standard deviations of the logarithm of the spread: of most edges, and of outliers.
  constexpr double kScatter = 0.05, kOutlierScatter = 0.2;
  // Share of the outliers.
  constexpr double kOutlierShare = 0.1;
  // Likelihood of an edge that neither describes.
  constexpr double kMinLikelihood = 1e-4;
  return (1 - kOutlierShare) * sum_likelihood(over_camera, world, std::hypot(error, kScatter)) +
         kOutlierShare * sum_likelihood(over_camera, world, std::hypot(error, kOutlierScatter)) +
         kMinLikelihood;
}

// The posterior mean of the camera's spread, marginalised over the mean excess in the world.
Estimate camera_spread(const std::vector<EdgeFit>& fits) {
  std::vector<double> spreads;
  for (const EdgeFit& fit : fits) spreads.push_back(std::log(fit.spread_px));
  const auto [least, most] = std::minmax_element(spreads.begin(), spreads.end());
  // Number of spreads that are tried, between the least and the greatest of an edge.
  constexpr int kTriedSpreads = 200;
  const double first = *least, step = (*most - *least) / (kTriedSpreads - 1);
  std::vector<Likely> all;
  for (const double world : {0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64})
    for (int i = 0; i < kTriedSpreads; ++i) {
      Likely camera{first + i * step, 0};
      for (std::size_t e = 0; e < fits.size(); ++e)
        camera.log_likelihood +=
            std::log(likelihood(spreads[e] - camera.value, world, fits[e].spread_error));
      all.push_back(camera);
    }
  return from_logarithm(mean_of(all));
}

// Reduces the weight of soft edges. The effect of the camera shows on sharp edges; softer ones do
// not have a Gaussian profile and imply a negative amount of sharpening. Returns the fits of the
// edges without a mask.
std::vector<EdgeFit> weigh(std::vector<GatheredEdge>& edges, const image::ToneCurve& tone) {
  std::vector<EdgeFit> fits = fit_edges(edges, kMedianRadiusPx, 0, tone);
  const double camera_px = camera_spread(fits).value;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const double softer =
        std::max(0.0, std::log(fits[e].spread_px / camera_px)) / kHalfWeightExcess;
    edges[e].weight = 1 / (1 + softer * softer);
  }
  return fits;
}

// The amount of an unsharp mask of the given radius: the median over the edges, since lines in the
// world imitate a mask on some edges and soft edges imitate the opposite. `fits` are the fits of
// the edges under that radius.
Estimate common_amount(const std::vector<GatheredEdge>& edges, const std::vector<EdgeFit>& fits) {
  std::vector<Weighted> amounts;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const double error = std::hypot(fits[e].amount_error, kAmountScatter);
    amounts.push_back({fits[e].amount, edges[e].weight / (error * error)});
  }
  const double middle = median_of(amounts);
  double total = 0, squares = 0;
  for (Weighted& a : amounts) {
    total += a.weight, squares += a.weight * a.weight;
    a.value = std::abs(a.value - middle);
  }
  // The median of Gaussian values has the error of a mean of 2 / pi as many values.
  const double many = total * total / squares * 2 / kPi;
  const double scatter = std::hypot(kSigmaOfMad * median_of(amounts), kAmountScatter);
  return {middle, scatter / std::sqrt(many)};
}

// The logarithm of the likelihood of a mask on all edges times the prior of its radius. `fits` are
// the fits of the edges under that mask.
double log_likelihood(const std::vector<GatheredEdge>& edges,
                      const std::vector<EdgeFit>& fits,
                      double radius_px) {
  const double off = std::log(radius_px / kMedianRadiusPx) / kRadiusLogSigma;
  double sum = -0.5 * off * off;
  for (std::size_t e = 0; e < edges.size(); ++e)
    sum -= kIndependentResiduals * edges[e].weight * std::log(std::max(fits[e].rms, kMinRms));
  return sum;
}

struct Mask {
  Estimate amount, radius_px;
};

Mask likely_mask(const std::vector<GatheredEdge>& edges, const image::ToneCurve& tone) {
  std::vector<Likely> log_radii, amounts;
  for (const double radius_px : kTriedRadiiPx) {
    const std::vector<EdgeFit> fits = fit_edges(edges, radius_px, std::nullopt, tone);
    const double amount = common_amount(edges, fits).value;
    const double likelihood =
        log_likelihood(edges, fit_edges(edges, radius_px, amount, tone, fits), radius_px);
    log_radii.push_back({std::log(radius_px), likelihood});
    amounts.push_back({amount, likelihood});
  }
  Mask mask{{}, from_logarithm(mean_of(log_radii))};
  mask.amount = common_amount(edges, fit_edges(edges, mask.radius_px.value, std::nullopt, tone));
  // A camera's mask does not soften. A weak mask is hardly distinguishable from no mask with a
  // slightly smaller spread.
  if (mask.amount.value <= kMinAmountInErrors * mask.amount.sigma)
    return {{0, mask.amount.sigma}, {kMedianRadiusPx, kMedianRadiusPx * kRadiusLogSigma}};
  mask.amount.sigma = std::hypot(mask.amount.sigma, mean_of(amounts).sigma);
  return mask;
}

StepModel model_of(const StepResponse& response,
                   double low,
                   double high,
                   const image::ToneCurve& tone) {
  return {response.point_spread_px.value,
          response.sharpening.value,
          StepModel::blur_of(response.sharpening_px.value),
          low,
          high,
          tone};
}

}  // namespace

StepResponse fit_step_response(const std::vector<const StepEdge*>& edges,
                               const image::ToneCurve& tone) {
  check(!edges.empty(), "a step response needs an edge");
  std::vector<GatheredEdge> all;
  for (const StepEdge* edge : edges) all.emplace_back(*edge);
  const std::vector<EdgeFit> unmasked = weigh(all, tone);
  const Mask mask = likely_mask(all, tone);
  const auto under = [&](double amount) {
    return fit_edges(all, mask.radius_px.value, amount, tone, unmasked);
  };
  const std::vector<EdgeFit> fits = under(mask.amount.value);
  StepResponse response{camera_spread(fits), mask.amount, mask.radius_px};
  // The errors are coupled: a stronger mask implies a larger spread.
  const Estimate other = camera_spread(under(mask.amount.value + mask.amount.sigma));
  Estimate& spread = response.point_spread_px;
  spread.sigma = std::hypot(spread.sigma, other.value - spread.value);
  for (const EdgeFit& fit : fits) response.edge_spreads_px.push_back(fit.spread_px);
  return response;
}

Estimate camera_spread_px(const std::vector<const StepEdge*>& edges,
                          const StepResponse& mask,
                          const image::ToneCurve& tone) {
  std::vector<GatheredEdge> all;
  for (const StepEdge* edge : edges) all.emplace_back(*edge);
  return camera_spread(fit_edges(all, mask.sharpening_px.value, mask.sharpening.value, tone));
}

double edge_spread_px(const StepResponse& response,
                      double low,
                      double high,
                      const image::ToneCurve& tone) {
  const StepModel model = model_of(response, low, high, tone);
  // Half the way that is searched, as far as edges are sampled, and the spacing of the places.
  constexpr double kHalf = 6, kFine = 0.01;  // px
  double last_below = -kHalf, first_above = kHalf;
  for (double x = -kHalf; x < kHalf; x += kFine) {
    if (model.at(x).first < 0.1) last_below = x;
    if (model.at(-x).first > 0.9) first_above = -x;
  }
  return first_above - last_below;
}

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
  const StepModel model = model_of(response, low, high, tone);
  for (const double place : profile.place_px) profile.fitted.push_back(model.at(place).first);
  profile.spread_px = edge_spread_px(response, low, high, tone);
  profile.edges = static_cast<int>(edges.size());
  return profile;
}

}  // namespace airtruth::optics
