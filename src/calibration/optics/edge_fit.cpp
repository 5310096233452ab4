// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/edge_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <tbb/parallel_for.h>

#include "foundation/geometry/transform.h"

namespace airtruth::optics {
namespace {

// The second integral of a Gaussian step (an error function).
double bend(double x, double sigma) {
  const double z = x / sigma;
  const double step = 0.5 * (1 + std::erf(z / std::sqrt(2.0)));
  const double bell = std::exp(-0.5 * z * z) / std::sqrt(2 * kPi);
  return 0.5 * ((x * x + sigma * sigma) * step + x * sigma * bell);
}

}  // namespace

std::vector<double> StepModel::blur_of(double radius_px) {
  const double sigma = std::hypot(radius_px, std::sqrt(1.0 / 12)) * kPerPixel;
  const int reach = static_cast<int>(std::ceil(4.5 * sigma));
  std::vector<double> kernel;
  double total = 0;
  for (int j = -reach; j <= reach; ++j) {
    kernel.push_back(std::exp(-0.5 * (j / sigma) * (j / sigma)));
    total += kernel.back();
  }
  for (double& weight : kernel) weight /= total;
  return kernel;
}

StepModel::StepModel(double spread_px,
                     double amount,
                     const std::vector<double>& blur,
                     double low,
                     double high,
                     const image::ToneCurve& tone) {
  const double dark = tone.linear_from_coded(low);
  const double bright = tone.linear_from_coded(high);
  std::array<double, kCount + 2 * kPerPixel> bends{};
  for (std::size_t i = 0; i < bends.size(); ++i)
    bends[i] = bend(double(i) / kPerPixel - kHalf - 1, spread_px);
  for (std::size_t i = 0; i < kCount; ++i) {
    // The second difference integrates over two boxes of a pixel: the light is that of whole
    // pixels, and so is the spread.
    const double risen = bends[i + 2 * kPerPixel] - 2 * bends[i + kPerPixel] + bends[i];
    heights_[i] = (tone.coded_from_linear(dark + (bright - dark) * risen) - low) / (high - low);
  }
  if (amount != 0) sharpen(amount, blur);
  for (const double height : heights_) middle_ += (1 - height) / kPerPixel;
  middle_ -= kHalf + 0.5 / kPerPixel;
}

void StepModel::sharpen(double amount, const std::vector<double>& blur) {
  const auto count = static_cast<Eigen::Index>(kCount);
  const auto reach = static_cast<Eigen::Index>(blur.size() / 2);
  Eigen::ArrayXd beyond(count + 2 * reach);
  beyond.head(reach) = heights_.front();
  beyond.tail(reach) = heights_.back();
  Eigen::Map<Eigen::ArrayXd> heights(heights_.data(), count);
  beyond.segment(reach, count) = heights;
  // The kernel is symmetric.
  Eigen::ArrayXd soft = blur[static_cast<std::size_t>(reach)] * heights;
  for (Eigen::Index j = 0; j < reach; ++j)
    soft += blur[static_cast<std::size_t>(j)] *
            (beyond.segment(j, count) + beyond.segment(2 * reach - j, count));
  heights += amount * (heights - soft);
}

double StepModel::slope(std::size_t i) const {
  const std::size_t before = i > 0 ? i - 1 : i, after = std::min(i + 1, kCount - 1);
  return (heights_[after] - heights_[before]) * kPerPixel / double(after - before);
}

std::pair<double, double> StepModel::at(double place_px) const {
  const double p =
      std::clamp((place_px + middle_ + kHalf) * kPerPixel, 0.0, double(kCount) - 1.001);
  const auto i = static_cast<std::size_t>(p);
  const double t = p - double(i);
  return {(1 - t) * heights_[i] + t * heights_[i + 1], (1 - t) * slope(i) + t * slope(i + 1)};
}

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

// The Jacobian under a mask of this blur. Its columns are plateau, height, place, spread
// and, if it is unknown, the amount.
Eigen::MatrixXd slopes_of(const GatheredEdge& edge,
                          const EdgeFit& fit,
                          const std::vector<double>& blur,
                          Eigen::Index unknowns,
                          const image::ToneCurve& tone) {
  const auto model = [&](double spread_px, double amount) {
    return StepModel(spread_px, amount, blur, edge.low, edge.high, tone);
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
               const std::vector<double>& blur,
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
        edge.roots.asDiagonal() * slopes_of(edge, fit, blur, unknowns, tone);
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
  const std::vector<double> blur = StepModel::blur_of(radius_px);
  tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t e) {
    const bool is_known = !start.empty() && is_within_bounds(start[e]);
    fits[e] = fitted(edges[e], blur, amount, tone, is_known ? start[e] : EdgeFit{});
  });
  return fits;
}

}  // namespace airtruth::optics
