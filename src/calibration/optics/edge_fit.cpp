// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/edge_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>
#include <tbb/parallel_for.h>

#include "calibration/optics/step_model.h"

namespace airtruth::optics {
namespace {

// Bounds of the spread, px, and of the amount of the mask, a ratio. They end fits that diverge.
constexpr double kMinSpreadPx = 0.05, kMaxSpreadPx = 5;
constexpr double kMinAmount = -0.9, kMaxAmount = 3;
// Half the width of the profile of an edge, px, as straight_step.cpp samples it.
constexpr double kHalfWidthPx = 6;
// Width of the bins in which samples are averaged, px.
constexpr double kBinPx = 0.25;
// Step of the numerical derivatives, in the logarithm of the spread and in the amount.
constexpr double kDerivativeStep = 0.01;
// Largest change of an unknown, in the units of kDerivativeStep, in one round: it damps the fit.
constexpr double kMaxChange = 0.3;
// The iteration ends when all changes are smaller than this.
constexpr double kMinChange = 0.001;
// Largest number of rounds: it ends a fit that oscillates.
constexpr int kMaxRounds = 12;

// The Jacobian under a mask of the radius of `mask`. Its columns are plateau, height, place, spread
// and, if it is unknown, the amount.
Eigen::MatrixXd slopes_of(const GatheredEdge& edge,
                          const EdgeFit& fit,
                          const UnsharpMask& mask,
                          Eigen::Index unknowns,
                          const image::ToneCurve& tone) {
  const auto model = [&](double spread_px, double amount) {
    return StepModel(spread_px, mask.with_amount(amount), edge.low, edge.high, tone);
  };
  const StepModel here = model(fit.spread_px, fit.amount);
  const StepModel wider = model(fit.spread_px * std::exp(kDerivativeStep), fit.amount);
  Eigen::MatrixXd slopes(edge.places.size(), unknowns);
  for (Eigen::Index i = 0; i < edge.places.size(); ++i) {
    const double place = edge.places[i];
    const auto [value, slope] = here.at(place);
    slopes.row(i).head<4>() << 1, value, slope, (wider.at(place).first - value) / kDerivativeStep;
  }
  if (unknowns == 4) return slopes;
  const StepModel sharper = model(fit.spread_px, fit.amount + kDerivativeStep);
  for (Eigen::Index i = 0; i < edge.places.size(); ++i)
    slopes(i, 4) = (sharper.at(edge.places[i]).first - slopes(i, 1)) / kDerivativeStep;
  return slopes;
}

// Whether a fit is a point from which another one may begin: one that has not run to a bound.
bool is_within_bounds(const EdgeFit& fit) {
  return fit.spread_px > 2 * kMinSpreadPx && fit.spread_px < kMaxSpreadPx / 2 &&
         fit.amount > kMinAmount / 2 && fit.amount < kMaxAmount / 2;
}

EdgeFit fitted(const GatheredEdge& edge,
               const UnsharpMask& mask,
               std::optional<double> amount,
               const image::ToneCurve& tone,
               const EdgeFit& start) {
  const Eigen::Index unknowns = amount ? 4 : 5;
  const Eigen::VectorXd heights = edge.roots.cwiseProduct(edge.heights);
  EdgeFit fit;
  fit.spread_px = start.spread_px;
  fit.amount = amount.value_or(start.amount);
  for (int round = 0; round < kMaxRounds; ++round) {
    const Eigen::MatrixXd slopes =
        edge.roots.asDiagonal() * slopes_of(edge, fit, mask, unknowns, tone);
    Eigen::MatrixXd square = slopes.transpose() * slopes;
    square.diagonal().array() += 1e-9 * square.trace();
    const Eigen::MatrixXd inverse = square.inverse();
    const Eigen::VectorXd x = inverse * (slopes.transpose() * heights);
    const double left = (heights - slopes * x).squaredNorm();
    const double height = std::max(std::abs(x[1]), 0.1);
    const double unit_error = std::sqrt(left / double(heights.size() - unknowns)) / height;
    const auto error = [&](Eigen::Index i) {
      return unit_error * std::sqrt(std::max(0.0, inverse(i, i)));
    };
    const auto change = [&](Eigen::Index i) {
      return std::clamp(x[i] / height, -kMaxChange, kMaxChange);
    };
    fit.rms = std::sqrt(left / edge.roots.squaredNorm());
    fit.spread_error = error(3);
    const double wider = change(3), sharper = amount ? 0 : change(4);
    fit.spread_px = std::clamp(fit.spread_px * std::exp(wider), kMinSpreadPx, kMaxSpreadPx);
    if (!amount) {
      fit.amount_error = error(4);
      fit.amount = std::clamp(fit.amount + sharper, kMinAmount, kMaxAmount);
    }
    if (std::abs(wider) < kMinChange && std::abs(sharper) < kMinChange) break;
  }
  return fit;
}

}  // namespace

GatheredEdge::GatheredEdge(const StepEdge& step) : low(step.low), high(step.high) {
  constexpr auto kBins = static_cast<std::size_t>(2 * kHalfWidthPx / kBinPx);
  struct Bin {
    double n = 0, place = 0, height = 0;
  };
  std::array<Bin, kBins> bins{};
  for (const auto& [place, height] : step.samples) {
    const double at = (place + kHalfWidthPx) / kBinPx;
    if (!(at >= 0 && at < double(kBins))) continue;
    Bin& bin = bins[static_cast<std::size_t>(at)];
    bin.n += 1, bin.place += place, bin.height += height;
  }
  const auto count = std::count_if(bins.begin(), bins.end(), [](const Bin& b) { return b.n > 0; });
  places.resize(count), heights.resize(count), roots.resize(count);
  Eigen::Index i = 0;
  for (const Bin& bin : bins) {
    if (bin.n == 0) continue;
    places[i] = bin.place / bin.n, heights[i] = bin.height / bin.n;
    roots[i++] = std::sqrt(bin.n);
  }
}

std::vector<EdgeFit> fit_edges(const std::vector<GatheredEdge>& edges,
                               double radius_px,
                               std::optional<double> amount,
                               const image::ToneCurve& tone,
                               const std::vector<EdgeFit>& start) {
  std::vector<EdgeFit> fits(edges.size());
  const UnsharpMask mask(0, radius_px);
  tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t e) {
    const bool is_known = !start.empty() && is_within_bounds(start[e]);
    fits[e] = fitted(edges[e], mask, amount, tone, is_known ? start[e] : EdgeFit{});
  });
  return fits;
}

}  // namespace airtruth::optics
