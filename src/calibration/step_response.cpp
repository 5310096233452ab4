// SPDX-License-Identifier: Apache-2.0
#include "calibration/step_response.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "base/error.h"
#include "base/median.h"
#include "geometry/transform.h"
#include "image/tone_curve.h"

namespace airtruth::calibration {
namespace {

constexpr double kLeastSpread = 0.05, kMostSpread = 5;  // px
constexpr double kLeastRadius = 0.3, kMostRadius = 4;   // px
constexpr double kUnit = 0.05;                          // px: unknowns are logarithms of so much
constexpr double kStep = 1e-8;                          // of the unknowns, squared
constexpr double kSure = 2;                             // of its error an amount is a mask
// Cameras' masks, where edges are not clean enough to part a narrow strong one from a wide weak
// one.
constexpr double kUsualAmount = 0.0, kUsualAmountSpread = 0.6;
constexpr double kUsualRadius = 1, kUsualRadiusSpread = 0.25;  // px

// The second integral of a Gaussian's step.
double bend(double x, double sigma) {
  const double z = x / sigma;
  const double step = 0.5 * (1 + std::erf(z / std::sqrt(2.0)));
  const double bell = std::exp(-0.5 * z * z) / std::sqrt(2 * kPi);
  return 0.5 * ((x * x + sigma * sigma) * step + x * sigma * bell);
}

// A step through a Gaussian and two pixels: what is drawn is of whole pixels, and so is the spread.
double step_through(double x, double sigma) {
  return bend(x + 1, sigma) - 2 * bend(x, sigma) + bend(x - 1, sigma);
}

struct Parameters {
  double spread_px = 0, amount = 0, radius_px = 0;
};

// Sampled finely; heights 0..1 far from the step, places from the middle of what is coded.
class StepModel {
 public:
  StepModel(const Parameters& p, double low, double high, const image::ToneCurve& tone) {
    const double dark = tone.linear_from_coded(low);
    const double bright = tone.linear_from_coded(high);
    for (int i = 0; i < kCount; ++i) {
      const double light = dark + (bright - dark) * step_through(place(i), p.spread_px);
      heights_.at(static_cast<std::size_t>(i)) =
          (tone.coded_from_linear(light) - low) / (high - low);
    }
    if (p.amount != 0) sharpen(p.amount, std::hypot(p.radius_px, std::sqrt(1.0 / 12)));
    for (const double height : heights_) middle_ += kFine * (1 - height);
    middle_ -= kHalf + kFine / 2;
  }

  // The height and its slope.
  std::pair<double, double> at(double x) const {
    const double p = std::clamp((x + middle_ + kHalf) / kFine, 0.0, kCount - 1.001);
    const auto i = static_cast<std::size_t>(p);
    const double t = p - double(i);
    return {(1 - t) * heights_[i] + t * heights_[i + 1], (1 - t) * slope(i) + t * slope(i + 1)};
  }

 private:
  static constexpr double kHalf = 9;
  static constexpr double kFine = 0.1;
  static constexpr int kCount = static_cast<int>(2 * kHalf / kFine) + 1;
  static double place(int i) { return i * kFine - kHalf; }
  double slope(std::size_t i) const {
    const std::size_t before = i > 0 ? i - 1 : i, after = std::min<std::size_t>(i + 1, kCount - 1);
    return (heights_[after] - heights_[before]) / (double(after - before) * kFine);
  }

  void sharpen(double amount, double radius) {
    const int reach = static_cast<int>(std::ceil(4.5 * radius / kFine));
    std::vector<double> kernel;
    double total = 0;
    for (int j = -reach; j <= reach; ++j) {
      kernel.push_back(std::exp(-0.5 * (j * kFine / radius) * (j * kFine / radius)));
      total += kernel.back();
    }
    const auto sharp = heights_;
    for (int i = 0; i < kCount; ++i) {
      double soft = 0;
      for (int j = -reach; j <= reach; ++j)
        soft += kernel[static_cast<std::size_t>(j + reach)] *
                sharp[static_cast<std::size_t>(std::clamp(i + j, 0, kCount - 1))];
      const auto k = static_cast<std::size_t>(i);
      heights_[k] += amount * (sharp[k] - soft / total);
    }
  }

  std::array<double, kCount> heights_{};
  double middle_ = 0;
};

// What the edges' samples differ by from the model, each edge's place and plateaus solved for.
class Misfit {
 public:
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  Misfit(const std::vector<const StepEdge*>& edges, const image::ToneCurve& tone)
      : edges_(edges), tone_(tone) {
    for (const StepEdge* edge : edges) count_ += static_cast<int>(edge->samples.size());
  }
  // Beyond it a sample is an outlier, and counts as its distance alone (Huber 1964).
  void set_limit(double limit) { limit_ = limit; }
  // How much a usual mask weighs, in heights.
  void set_usual(double weight) { usual_ = weight; }

  void leave_out_the_mask() { masked_ = false; }

  Parameters parameters(const Eigen::VectorXd& x) const {
    return {std::clamp(kUnit * std::exp(x[0]), kLeastSpread, kMostSpread),
            masked_ ? x[1] : 0,
            masked_ ? std::clamp(kUnit * std::exp(x[2]), kLeastRadius, kMostRadius) : kUsualRadius};
  }
  static Eigen::VectorXd unknowns(const Parameters& p) {
    return Eigen::Vector3d(std::log(p.spread_px / kUnit), p.amount, std::log(p.radius_px / kUnit));
  }

  int inputs() const { return 3; }
  int values() const { return count_ + 2; }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& residuals) const {
    const Parameters p = parameters(x);
    int first = 0;
    for (const StepEdge* edge : edges_) {
      const auto n = static_cast<int>(edge->samples.size());
      residuals.segment(first, n) = left_of(*edge, StepModel(p, edge->low, edge->high, tone_));
      first += n;
    }
    residuals[first] = usual_ * (x[1] - kUsualAmount) / kUsualAmountSpread;
    residuals[first + 1] = usual_ * (kUnit * std::exp(x[2]) - kUsualRadius) / kUsualRadiusSpread;
    for (double& r : residuals.head(first))
      if (std::abs(r) > limit_)
        r = std::copysign(std::sqrt(2 * limit_ * std::abs(r) - limit_ * limit_), r);
    return 0;
  }

 private:
  static Eigen::VectorXd left_of(const StepEdge& edge, const StepModel& model) {
    const auto n = static_cast<Eigen::Index>(edge.samples.size());
    Eigen::MatrixX3d basis(n, 3);
    Eigen::VectorXd heights(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& [place, height] = edge.samples[static_cast<std::size_t>(i)];
      const auto [value, slope] = model.at(place);
      basis.row(i) << 1, value, slope;
      heights[i] = height;
    }
    const Eigen::Matrix3d square = basis.transpose() * basis;
    return heights - basis * square.ldlt().solve(basis.transpose() * heights);
  }

  const std::vector<const StepEdge*>& edges_;
  image::ToneCurve tone_;
  int count_ = 0;
  double limit_ = 1e300;
  double usual_ = 0;
  bool masked_ = true;
};

Eigen::VectorXd fitted(Misfit& misfit, Eigen::VectorXd x) {
  Eigen::NumericalDiff<Misfit> with_slopes(misfit, kStep);
  Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Misfit>> solver(with_slopes);
  solver.parameters.maxfev = 200;
  solver.minimize(x);
  return x;
}

Eigen::VectorXd residuals_at(const Misfit& misfit, const Eigen::VectorXd& x) {
  Eigen::VectorXd residuals(misfit.values());
  misfit(x, residuals);
  return residuals;
}

double cost(const Misfit& misfit, const Eigen::VectorXd& x) {
  return residuals_at(misfit, x).squaredNorm();
}

// Of several beginnings' ends the best: a narrow strong mask looks much like a wide weak one.
Eigen::VectorXd best_fit(Misfit& misfit) {
  Eigen::VectorXd best;
  double least = 1e300;
  for (const double spread : {0.5, 1.0, 2.0})
    for (const double radius : {0.8, 2.0}) {
      const auto x = fitted(misfit, Misfit::unknowns({spread, 0.4, radius}));
      if (const double c = cost(misfit, x); c < least) least = c, best = x;
    }
  std::vector<double> sizes;
  for (const double r : residuals_at(misfit, best)) sizes.push_back(std::abs(r));
  constexpr double kSigmaFromMedian = 1.4826;
  misfit.set_limit(std::max(1e-4, 2.5 * kSigmaFromMedian * median(std::move(sizes))));
  return fitted(misfit, best);
}

// Of the unknowns: what the edges pull, each taken whole, and that they may be wrong alike.
Eigen::Matrix3d covariance_of(const std::vector<const StepEdge*>& edges,
                              const Misfit& misfit,
                              const Eigen::VectorXd& x,
                              double wrong) {
  const Eigen::VectorXd residuals = residuals_at(misfit, x);
  Eigen::MatrixXd slopes(misfit.values(), 3);
  Eigen::NumericalDiff<Misfit>(misfit, kStep).df(x, slopes);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Index first = 0;
  for (const StepEdge* edge : edges) {
    const auto n = static_cast<Eigen::Index>(edge->samples.size());
    const Eigen::Vector3d pull =
        slopes.middleRows(first, n).transpose() * residuals.segment(first, n);
    scatter += pull * pull.transpose();
    first += n;
  }
  Eigen::Matrix3d information = slopes.transpose() * slopes;
  information.diagonal().array() += 1e-9 * information.trace();  // without a mask two rows are 0
  const Eigen::Matrix3d inverse = information.inverse();
  return inverse * scatter * inverse + wrong * wrong * double(misfit.values()) * inverse;
}

// What all edges have alike and the model has not, in heights: edges that are no ideal steps.
double common_misfit(const std::vector<const StepEdge*>& edges,
                     const Misfit& misfit,
                     const Eigen::VectorXd& x) {
  constexpr double kBin = 0.25, kHalf = 6;  // px
  constexpr int kBins = static_cast<int>(2 * kHalf / kBin);
  struct Bin {
    double n = 0, sum = 0, squares = 0;
  };
  std::array<Bin, kBins> bins{};
  const Eigen::VectorXd residuals = residuals_at(misfit, x);
  Eigen::Index i = 0;
  for (const StepEdge* edge : edges)
    for (const auto& sample : edge->samples) {
      const double r = residuals[i++];
      const int b = static_cast<int>(std::floor((sample.first + kHalf) / kBin));
      if (b < 0 || b >= kBins) continue;
      Bin& bin = bins[static_cast<std::size_t>(b)];
      bin.n += 1, bin.sum += r, bin.squares += r * r;
    }
  double total = 0, count = 0;
  for (const Bin& bin : bins) {
    if (bin.n < 2) continue;
    const double mean = bin.sum / bin.n;
    total += mean * mean - (bin.squares / bin.n - mean * mean) / (bin.n - 1);
    count += 1;
  }
  return count > 0 ? std::sqrt(std::max(0.0, total)) / count
                   : 0;  // along one of so many directions
}

StepModel model_of(const StepResponse& response,
                   double low,
                   double high,
                   const image::ToneCurve& tone) {
  return {{response.point_spread_px.value, response.sharpening.value, response.sharpening_px.value},
          low,
          high,
          tone};
}

}  // namespace

StepResponse fit_step_response(const std::vector<const StepEdge*>& edges,
                               const image::ToneCurve& tone) {
  check(!edges.empty(), "a step response needs an edge");
  Misfit misfit(edges, tone);
  Eigen::VectorXd x = best_fit(misfit);
  const double wrong = common_misfit(edges, misfit, x);
  misfit.set_usual(wrong * std::sqrt(double(misfit.values())));
  const Eigen::VectorXd usual =
      fitted(misfit, Misfit::unknowns({misfit.parameters(x).spread_px, 0.5, kUsualRadius}));
  x = fitted(misfit, x);
  if (cost(misfit, usual) < cost(misfit, x)) x = usual;
  Eigen::Matrix3d covariance = covariance_of(edges, misfit, x, wrong);
  StepResponse response;
  response.sharpening = {x[1], std::sqrt(covariance(1, 1))};
  const double radius_px = misfit.parameters(x).radius_px;
  response.sharpening_px = {radius_px, radius_px * std::sqrt(covariance(2, 2))};
  // No camera's mask softens; and a weak one looks much like none with a little less spread.
  if (x[1] <= kSure * response.sharpening.sigma) {
    misfit.leave_out_the_mask();
    x = fitted(misfit, Misfit::unknowns({misfit.parameters(x).spread_px, 0, kUsualRadius}));
    covariance = covariance_of(edges, misfit, x, wrong);
    response.sharpening.value = 0;
    response.sharpening_px = {kUsualRadius, kUsualRadiusSpread};
  }
  const double spread_px = misfit.parameters(x).spread_px;
  response.point_spread_px = {spread_px, spread_px * std::sqrt(covariance(0, 0))};
  return response;
}

std::vector<double> step_heights(const StepResponse& response,
                                 double low,
                                 double high,
                                 const std::vector<double>& places_px,
                                 const image::ToneCurve& tone) {
  const StepModel model = model_of(response, low, high, tone);
  std::vector<double> heights;
  for (const double place : places_px) heights.push_back(model.at(place).first);
  return heights;
}

double edge_spread_px(const StepResponse& response,
                      double low,
                      double high,
                      const image::ToneCurve& tone) {
  const StepModel model = model_of(response, low, high, tone);
  constexpr double kHalf = 6, kFine = 0.01;  // px
  double last_below = -kHalf, first_above = kHalf;
  for (double x = -kHalf; x < kHalf; x += kFine) {
    if (model.at(x).first < 0.1) last_below = x;
    if (model.at(-x).first > 0.9) first_above = -x;
  }
  return first_above - last_below;
}

}  // namespace airtruth::calibration
