// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/rotation_fit.h"

#include <utility>

#include <Eigen/SVD>

#include "foundation/base/median.h"
#include "foundation/base/seed.h"

namespace airtruth::motion {
namespace {

// At most: enough for kConfidence where 17 % of the points are inliers (trials_for()).
constexpr int kMaxTrials = 300;
// The probability that a pair of inliers is among the trials. Chosen: a failure in 10,000 frames.
constexpr double kConfidence = 0.9999;
// At most. The scale of the weights shrinks to its end in four of them, and the rest settle.
constexpr int kRefinements = 12;
// A refinement that turns by less than this share of the limit is the last: the next would be
// smaller.
constexpr double kSettledShare = 1e-4;
// The least share of all points that turns as one. Chosen by judgement: half of a scene may be near
// ground, and clouds take more. Doubled, frames with much near ground are not measured.
constexpr double kMinTurnShare = 0.15;
// The least rms distance of the inliers from their mean direction, rad: 1.1 degrees. The rotation
// about that direction has the error of a bearing over this distance, so 50 times that of a
// bearing.
constexpr double kMinSpreadRad = 0.02;
// The least angle between the two directions of a pair, rad (its sine): the error about their
// middle is that of a bearing over half of it, so up to 40 times that of a bearing.
constexpr double kShortestBaseRad = 0.05;
constexpr int kFarSteps = 4;  // of kRefinements: the steps that use far points alone

// The rotation from two directions, by the axes of their common plane before and after (Black 1964,
// "TRIAD").
std::optional<Quaternion> from_pair(const Bearings& p, const Bearings& q) {
  const auto axes = [](const Vector3& a, const Vector3& b) -> std::optional<Matrix3> {
    const Vector3 normal = a.cross(b);
    const double length = normal.norm();
    if (length < kShortestBaseRad) return std::nullopt;
    const Vector3 middle = (a + b).normalized();
    Matrix3 m;
    m << middle, normal / length, middle.cross(normal / length);
    return m;
  };
  const auto before = axes(p.in_reference, q.in_reference);
  const auto after = axes(p.in_cam, q.in_cam);
  if (!before || !after) return std::nullopt;
  return Quaternion(Matrix3(*after * before->transpose()));
}

double miss(const Matrix3& r, const Bearings& b) {
  return (b.in_cam - r * b.in_reference).squaredNorm();
}

// How well a rotation agrees with bearings. The score counts an inlier the more, the smaller its
// residual is (Torr and Zisserman 2000, "MLESAC", equation 15), so that many points which agree
// loosely do not outvote those that agree.
struct Agreement {
  double score = 0;
  int inliers = 0;
};

Agreement agreement(const std::vector<Bearings>& bearings, const Matrix3& r, double limit_rad) {
  Agreement all;
  for (const Bearings& b : bearings) {
    const double share = miss(r, b) / (limit_rad * limit_rad);
    if (share > 1) continue;
    all.score += 1 - share;
    ++all.inliers;
  }
  return all;
}

// The number of pairs after which one of two inliers was among them with a probability of
// kConfidence, where this share of the points are inliers (Fischler and Bolles 1981, equation 4).
int trials_for(double inlier_share) {
  const double pair_share = inlier_share * inlier_share;
  if (pair_share >= 1) return 1;
  const double trials = std::log(1 - kConfidence) / std::log1p(-pair_share);
  return static_cast<int>(std::min<double>(kMaxTrials, std::ceil(trials)));
}

// The best rotation of as many pairs as the share of inliers requires. It is empty where fewer than
// min_inliers points or fewer than kMinTurnShare of all points agree with it.
std::optional<Matrix3> consensus(const std::vector<Bearings>& bearings,
                                 double limit_rad,
                                 int min_inliers,
                                 std::uint64_t seed) {
  const std::size_t n = bearings.size();
  if (n < 2 || static_cast<int>(n) < min_inliers) return std::nullopt;
  Random random(seed);
  Agreement most;
  Matrix3 best = Matrix3::Identity();
  int enough = kMaxTrials;
  for (int trial = 0; trial < enough; ++trial) {
    const auto one = static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
    const auto other = static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
    const auto rotation = from_pair(bearings[one], bearings[other]);
    if (!rotation) continue;
    const Matrix3 r = rotation->toRotationMatrix();
    const Agreement found = agreement(bearings, r, limit_rad);
    if (found.score <= most.score) continue;
    most = found, best = r;
    enough = trials_for(static_cast<double>(most.inliers) / static_cast<double>(n));
  }
  if (most.inliers < min_inliers || most.inliers < kMinTurnShare * static_cast<double>(n))
    return std::nullopt;
  return best;
}

double spread_of(const std::vector<Bearings>& bearings, const std::vector<bool>& chosen) {
  Vector3 middle = Vector3::Zero();
  int count = 0;
  for (std::size_t i = 0; i < bearings.size(); ++i)
    if (chosen[i]) middle += bearings[i].in_cam, ++count;
  if (count == 0) return 0;
  middle.normalize();
  double squares = 0;
  for (std::size_t i = 0; i < bearings.size(); ++i)
    if (chosen[i]) squares += (bearings[i].in_cam - middle).squaredNorm();
  return std::sqrt(squares / count);
}

}  // namespace

Quaternion best_rotation(const std::vector<Bearings>& bearings,
                         const std::vector<double>& weights) {
  Matrix3 sum = Matrix3::Zero();
  for (std::size_t i = 0; i < bearings.size(); ++i)
    sum += weights[i] * bearings[i].in_cam * bearings[i].in_reference.transpose();
  const Eigen::JacobiSVD<Matrix3> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3 sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return Quaternion(Matrix3(svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose()))
      .normalized();
}

namespace {

// A rotation from which a fit starts, and whether it is that of the far points alone.
struct Start {
  Matrix3 cam_from_reference;
  bool is_by_far = false;
};

std::optional<Start> start_of(const std::vector<Bearings>& bearings,
                              double limit_rad,
                              int min_inliers,
                              std::uint64_t seed) {
  std::vector<Bearings> far;
  for (const Bearings& b : bearings)
    if (b.near.is_far) far.push_back(b);
  const bool some_near = far.size() < bearings.size();
  if (some_near && spread_of(far, std::vector<bool>(far.size(), true)) >= kMinSpreadRad)
    if (const auto found = consensus(far, limit_rad, 2 * min_inliers, seed))
      return Start{*found, true};
  if (const auto found = consensus(bearings, limit_rad, min_inliers, seed))
    return Start{*found, false};
  return std::nullopt;
}

// The variance that parallax adds to the squared residual of two coordinates, per squared nearness:
// the median over the near points of their squared residual beyond noise. It is 0 where there are
// no near points.
double parallax_variance(const std::vector<Bearings>& bearings,
                         const Matrix3& r,
                         double noise_rad) {
  // Mean over median of chi squared with two degrees of freedom.
  constexpr double kMeanOverMedian = 2 / 1.386;
  std::vector<double> ratios;
  for (const Bearings& b : bearings)
    if (!b.near.is_far)
      ratios.push_back(std::max(0.0, miss(r, b) - 2 * noise_rad * noise_rad) /
                       (b.near.value * b.near.value));
  return kMeanOverMedian * median_or_0(std::move(ratios));
}

// The weight of a point: (noise / (noise + parallax))^2, both as variances, times the weight of
// Geman and McClure (1987) against outliers. The ratio is squared because the parallax of
// neighbours is correlated and does not average out. Ground without parallax has full weight, as
// below a camera at great height or at rest.
double weight_of(
    double squared_miss, double noise, double scale, double limit, double of_parallax) {
  if (squared_miss > limit * limit + 4 * of_parallax) return 0;
  const double share = noise * noise / (noise * noise + of_parallax);
  const double e = squared_miss / (scale * scale + of_parallax);
  return share * share / ((1 + e) * (1 + e));
}

// Iteratively reweighted least squares from the start.
Quaternion refined(const Start& start, const std::vector<Bearings>& bearings, double limit_rad) {
  Quaternion cam_from_reference(start.cam_from_reference);
  std::vector<double> weights(bearings.size());
  double scale = limit_rad;  // shrinks to the measured noise of the points
  const double noise_rad = limit_rad / 4;
  for (int step = 0; step < kRefinements; ++step) {
    const Matrix3 r = cam_from_reference.toRotationMatrix();
    const double variance = start.is_by_far ? parallax_variance(bearings, r, noise_rad) : 0;
    for (std::size_t i = 0; i < bearings.size(); ++i) {
      const Nearness& near = bearings[i].near;
      weights[i] = start.is_by_far && step < kFarSteps && !near.is_far
                       ? 0
                       : weight_of(miss(r, bearings[i]),
                                   noise_rad,
                                   scale,
                                   limit_rad,
                                   variance * near.value * near.value);
    }
    const Quaternion before = std::exchange(cam_from_reference, best_rotation(bearings, weights));
    const bool is_narrowest = scale == limit_rad / 4;
    if (step > kFarSteps && is_narrowest &&
        before.angularDistance(cam_from_reference) < kSettledShare * limit_rad)
      break;
    scale = std::max(0.7 * scale, limit_rad / 4);
  }
  return cam_from_reference;
}

}  // namespace

std::optional<RotationFit> fit_rotation(const std::vector<Bearings>& bearings,
                                        double limit_rad,
                                        int min_inliers,
                                        std::uint64_t seed) {
  const auto start = start_of(bearings, limit_rad, min_inliers, seed);
  if (!start) return std::nullopt;
  RotationFit fit;
  fit.cam_from_reference = refined(*start, bearings, limit_rad);
  const Matrix3 r = fit.cam_from_reference.toRotationMatrix();
  fit.is_inlier.assign(bearings.size(), false);
  double squares = 0;
  for (std::size_t i = 0; i < bearings.size(); ++i) {
    if (miss(r, bearings[i]) > limit_rad * limit_rad) continue;
    fit.is_inlier[i] = true;
    ++fit.inliers;
    squares += miss(r, bearings[i]);
  }
  if (fit.inliers < min_inliers || spread_of(bearings, fit.is_inlier) < kMinSpreadRad)
    return std::nullopt;
  fit.rms_rad = std::sqrt(squares / fit.inliers);
  return fit;
}

}  // namespace airtruth::motion
