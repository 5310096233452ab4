// SPDX-License-Identifier: Apache-2.0
#include "runners/association/direction_filter.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace airtruth::association {
namespace {

Sighting sighting_at(const Vector3& ray, double error_rad, double log_size, double size_error) {
  return {ray.normalized(),
          error_rad * error_rad * Matrix3::Identity(),
          log_size,
          size_error * size_error};
}

Quaternion yaw(double radians) { return Quaternion(Eigen::AngleAxisd(radians, Vector3::UnitY())); }

double azimuth(const Vector3& ray) { return std::atan2(ray.x(), ray.z()); }

// The camera turns left by 0.02 rad, so a fixed direction moves right by as much.
TEST(DirectionFilter, ATurnOfTheCameraMovesTheDirectionAndNotTheRate) {
  DirectionFilter filter(sighting_at({0, 0, 1}, 1e-3, std::log(0.01), 0.1));
  filter.predict(0.1, yaw(0.02), 0);
  EXPECT_NEAR(azimuth(filter.ray_in_cam()), 0.02, 1e-12);
  EXPECT_NEAR(filter.rate_in_cam().norm(), 0, 1e-12);
}

// 0.3 rad/s to the right for 4 s: 1.2 rad, far beyond where a plane would do.
TEST(DirectionFilter, AConstantRateIsLearnedOnTheSphere) {
  const double rate = 0.3;
  DirectionFilter filter(sighting_at({0, 0, 1}, 1e-4, std::log(0.01), 0.1));
  for (int frame = 1; frame <= 40; ++frame) {
    const double angle = rate * frame * 0.1;
    filter.predict(0.1, Quaternion::Identity(), 0);
    filter.update(sighting_at({std::sin(angle), 0, std::cos(angle)}, 1e-4, std::log(0.01), 0.1));
  }
  EXPECT_NEAR(filter.rate_in_cam().norm(), rate, 2e-3);
  const double before = azimuth(filter.ray_in_cam());
  filter.predict(1, Quaternion::Identity(), 0);
  EXPECT_NEAR(azimuth(filter.ray_in_cam()) - before, rate, 2e-3);
}

// One step by hand, along one axis: P = diag(s^2, w^2) becomes s^2 + w^2 dt^2 + q dt^3 / 3 + e^2.
TEST(DirectionFilter, TheCovarianceOfAPredictionByHand) {
  DirectionFilter filter(sighting_at({0, 0, 1}, 1e-3, 0, 0.3));
  const double dt = 0.2;
  const double e = 5e-4;
  filter.predict(dt, Quaternion::Identity(), e);
  const double w = kInitialRate;
  const double q = kAccelerationDensity;
  EXPECT_NEAR(
      filter.covariance()(0, 0), 1e-6 + w * w * dt * dt + q * dt * dt * dt / 3 + e * e, 1e-15);
  EXPECT_NEAR(filter.covariance()(0, 2), w * w * dt + q * dt * dt / 2, 1e-15);
  EXPECT_NEAR(filter.covariance()(3, 3), w * w + q * dt, 1e-15);
  EXPECT_NEAR(filter.covariance()(4, 4), 0.09 + kSizeDensity * dt, 1e-15);
  EXPECT_EQ(filter.covariance()(0, 1), 0);
}

TEST(DirectionFilter, NearIsNeverFalseWithinTheGate) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  DirectionFilter filter(sighting_at({0.1, 0.2, 1}, 2e-3, 0, 0.2));
  filter.predict(0.1, yaw(0.01), 1e-3);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 away = 0.03 * Vector3(normal(random), normal(random), normal(random));
    const Sighting sighting = sighting_at(filter.ray_in_cam() + away, 2e-3, 0, 0.2);
    EXPECT_TRUE(filter.compare(sighting).distance > 11.3 || filter.is_near(sighting, 11.3));
  }
}

// A world in which the filter's model is exactly true: white acceleration of the rate, a camera
// that turns at random, whose turn is measured with an error, and sightings with Gaussian errors.
class World {
 public:
  explicit World(unsigned seed) : random_(seed) {
    ray_ = Vector3(0.3 * normal(), 0.3 * normal(), 1).normalized();
    Vector3 rate = kInitialRate * Vector3(normal(), normal(), normal());
    rate_ = rate - ray_ * ray_.dot(rate);
  }

  // Advances the truth and returns the measured turn.
  Quaternion advance(double dt, double turn_error) {
    // The exact discrete white acceleration: its contributions to direction and rate correlate.
    const double q = kAccelerationDensity;
    const Vector3 helper = std::abs(ray_.y()) < 0.9 ? Vector3::UnitY() : Vector3::UnitX();
    const Vector3 first = helper.cross(ray_).normalized();
    const Vector3 second = ray_.cross(first);
    Vector3 step = rate_ * dt;
    Vector3 change = Vector3::Zero();
    for (const Vector3& axis : {first, second}) {
      const double of_rate = std::sqrt(q * dt) * normal();
      const double alone = std::sqrt(q * dt * dt * dt / 12) * normal();
      change += axis * of_rate;
      step += axis * (of_rate * dt / 2 + alone);
    }
    rate_ += change;
    const double angle = step.norm();
    if (angle > 0) {
      const Eigen::AngleAxisd along(angle, ray_.cross(step).normalized());
      ray_ = (along * ray_).normalized();
      rate_ = along * rate_;
      rate_ -= ray_ * ray_.dot(rate_);
    }
    const Quaternion turn = turned(0.01);
    ray_ = turn * ray_;
    rate_ = turn * rate_;
    log_size_ += std::sqrt(kSizeDensity * dt) * normal();
    return turned(turn_error) * turn;
  }

  Sighting seen(double error_rad, double size_error) {
    const Vector3 error = error_rad * Vector3(normal(), normal(), normal());
    return sighting_at(ray_ + error - ray_ * ray_.dot(error),
                       error_rad,
                       log_size_ + size_error * normal(),
                       size_error);
  }

  const Vector3& ray() const { return ray_; }
  const Vector3& rate() const { return rate_; }
  double log_size() const { return log_size_; }

 private:
  double normal() { return normal_(random_); }
  Quaternion turned(double each_axis_rad) {
    const Vector3 turn = each_axis_rad * Vector3(normal(), normal(), normal());
    return turn.norm() > 0 ? Quaternion(Eigen::AngleAxisd(turn.norm(), turn.normalized()))
                           : Quaternion::Identity();
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  Vector3 ray_;
  Vector3 rate_;
  double log_size_ = std::log(0.01);
};

// Normalised estimation error squared (Bar-Shalom, Li and Kirubarajan 2001, section 5.4): its sum
// over n independent runs is chi-square with 5 n degrees of freedom, so that the mean over 200 runs
// lies within 5 +- 2.6 * sqrt(2 * 5 / 200) = 5 +- 0.58 with 99 % probability.
TEST(DirectionFilter, ErrorsAreAsLargeAsTheFilterSays) {
  constexpr int kRuns = 200;
  constexpr int kFrames = 40;
  constexpr double kDt = 1.0 / 15;
  constexpr double kError = 8e-4;
  constexpr double kTurnError = 4e-4;
  double after_few = 0;
  double after_many = 0;
  double innovation = 0;
  for (unsigned run = 0; run < kRuns; ++run) {
    World world(run + 1);
    DirectionFilter filter(world.seen(kError, 0.2));
    for (int frame = 1; frame <= kFrames; ++frame) {
      filter.predict(kDt, world.advance(kDt, kTurnError), kTurnError);
      const Sighting seen = world.seen(kError, 0.2);
      innovation += filter.compare(seen).distance;
      if (frame % 5 != 0) filter.update(seen);  // every fifth is missed
      if (frame != 4 && frame != kFrames) continue;
      Eigen::Matrix<double, 5, 1> error;
      error << filter.axes_in_cam().transpose() * (world.ray() - filter.ray_in_cam()),
          filter.axes_in_cam().transpose() * (world.rate() - filter.rate_in_cam()),
          world.log_size() - filter.log_size();
      const double nees = error.dot(filter.covariance().llt().solve(error));
      (frame == 4 ? after_few : after_many) += nees / kRuns;
    }
  }
  EXPECT_NEAR(after_few, 5, 0.58);
  EXPECT_NEAR(after_many, 5, 0.58);
  // The innovation is chi-square with 3 degrees of freedom, and those of one run are independent:
  // the mean over 8,000 lies within 3 +- 2.6 * sqrt(2 * 3 / 8000) = 3 +- 0.07 at 99 %, were all
  // independent. After a missed frame they are not.
  EXPECT_NEAR(innovation / (kRuns * kFrames), 3, 0.1);
}

}  // namespace
}  // namespace airtruth::association
