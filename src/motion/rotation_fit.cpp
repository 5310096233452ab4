// SPDX-License-Identifier: Apache-2.0
#include "motion/rotation_fit.h"

#include <cmath>

#include <Eigen/SVD>

#include "base/seed.h"

namespace airtruth::motion {
namespace {

constexpr int kTrials = 300;
constexpr int kRefinements = 12;
constexpr double kMinTurnShare = 0.15;
constexpr double kMinSpreadRad = 0.02;  // of the inliers about their own middle, rms
constexpr double kShortestBaseRad = 0.05;

// From two directions: the axes of their common plane, before and after (Black 1964, "TRIAD").
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

int count_within(const std::vector<Bearings>& bearings, const Matrix3& r, double limit_rad) {
  int count = 0;
  for (const Bearings& b : bearings) count += miss(r, b) <= limit_rad * limit_rad ? 1 : 0;
  return count;
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

std::optional<RotationFit> fit_rotation(const std::vector<Bearings>& bearings,
                                        double limit_rad,
                                        int min_inliers,
                                        std::uint64_t seed) {
  const std::size_t n = bearings.size();
  if (n < 2 || static_cast<int>(n) < min_inliers) return std::nullopt;
  Random random(seed);
  int most = 0;
  Matrix3 best = Matrix3::Identity();
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto one = static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
    const auto other = static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
    const auto rotation = from_pair(bearings[one], bearings[other]);
    if (!rotation) continue;
    const Matrix3 r = rotation->toRotationMatrix();
    const int count = count_within(bearings, r, limit_rad);
    if (count > most) most = count, best = r;
  }
  if (most < min_inliers || most < kMinTurnShare * static_cast<double>(n)) return std::nullopt;

  RotationFit fit;
  fit.cam_from_reference = Quaternion(best);
  std::vector<double> weights(n);
  double scale = limit_rad;  // narrows to what the points themselves are worth
  for (int step = 0; step < kRefinements; ++step) {
    const Matrix3 r = fit.cam_from_reference.toRotationMatrix();
    for (std::size_t i = 0; i < n; ++i) {
      const double e = miss(r, bearings[i]) / (scale * scale);
      weights[i] = miss(r, bearings[i]) <= limit_rad * limit_rad ? 1 / ((1 + e) * (1 + e)) : 0.0;
    }
    fit.cam_from_reference = best_rotation(bearings, weights);
    scale = std::max(0.7 * scale, limit_rad / 4);
  }
  const Matrix3 r = fit.cam_from_reference.toRotationMatrix();
  fit.is_inlier.assign(n, false);
  double squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
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
