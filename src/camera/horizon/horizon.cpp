// SPDX-License-Identifier: Apache-2.0
#include "camera/horizon/horizon.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "camera/horizon/horizon_edge.h"

namespace airtruth::motion {
namespace {

constexpr int kAcross = 56;  // blocks along the longer side
// Both limits are chosen by judgement; a line that passes them must also be sharp
// (HorizonFinder::kSharp).
// The least share of the blocks on either side of the plane.
constexpr double kMinSideShare = 0.06;
// The least distance between the mean features of the two sides, in standard deviations.
constexpr double kMinSeparationSigmas = 2.2;
// Least number of blocks for a covariance of four features. Chosen by judgement.
constexpr std::size_t kMinBlocks = 40;

using Feature = Eigen::Vector4d;  // luma, Cb, Cr, texture

struct Sample {
  Vector3 ray;
  Feature feature;
};

Vector3 up_of(double pitch_rad, double roll_rad) {
  const Quaternion body_from_world =
      world_from_body({0, degrees(pitch_rad), degrees(roll_rad)}).conjugate();
  return cam_from_body() * (body_from_world * Vector3(0, 0, -1));
}

// The sums over all samples, which are the same for every plane.
struct Totals {
  Feature sum = Feature::Zero();
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
};

Totals totals_of(const std::vector<Sample>& samples) {
  Totals totals;
  for (const Sample& s : samples) {
    totals.sum += s.feature;
    totals.squares += s.feature * s.feature.transpose();
  }
  return totals;
}

// The squared distance between the mean features of the two sides, in their common covariance; 0
// where one side has too few blocks.
double parted(const std::vector<Sample>& samples, const Totals& totals, const Vector3& up) {
  Feature above = Feature::Zero();
  double count[2] = {0, 0};
  for (const Sample& s : samples) {
    const double side = s.ray.dot(up) > 0 ? 1 : 0;
    above += side * s.feature;
    count[1] += side;
  }
  const auto n = static_cast<double>(samples.size());
  count[0] = n - count[1];
  if (std::min(count[0], count[1]) < kMinSideShare * n) return 0;
  const Feature low = (totals.sum - above) / count[0];
  const Feature high = above / count[1];
  Eigen::Matrix4d within = totals.squares / n - count[0] / n * low * low.transpose() -
                           count[1] / n * high * high.transpose();
  within.diagonal().array() += 1.0;  // a variance of one code value keeps it invertible
  const Feature apart = high - low;
  // Fisher's criterion (1936), weighted so that an even split has the weight 1.
  return apart.dot(within.ldlt().solve(apart)) * 4 * count[0] * count[1] / (n * n);
}

// Whether that side is the sky, which is smoother, and mostly brighter and bluer, than the ground.
bool is_sky(const std::vector<Sample>& samples, const Vector3& up) {
  Feature sum[2] = {Feature::Zero(), Feature::Zero()};
  double count[2] = {0, 0};
  for (const Sample& s : samples) {
    const int side = s.ray.dot(up) > 0 ? 1 : 0;
    sum[side] += s.feature;
    count[side] += 1;
  }
  const Feature d = sum[1] / std::max(1.0, count[1]) - sum[0] / std::max(1.0, count[0]);
  return d[0] + 0.5 * d[1] - 3 * d[3] > 0;
}

// Mean and standard deviation of luma over the block of `side` pixels at (x0, y0), and the chroma
// at its middle.
Feature feature_of(const image::Picture& picture, int x0, int y0, int side) {
  double sum = 0, squares = 0;
  for (int y = y0; y < y0 + side; y += 2)
    for (int x = x0; x < x0 + side; x += 2) {
      const double v = picture.planes[0].row(y)[x];
      sum += v, squares += v * v;
    }
  const int samples_along = (side + 1) / 2;
  const double n = double(samples_along) * samples_along;
  const double mean = sum / n;
  Feature f(mean, 0, 0, std::sqrt(std::max(0.0, squares / n - mean * mean)));
  if (picture.plane_count == 3) {
    const int cx = (x0 + side / 2) >> image::log2_chroma_width(picture.colour.chroma);
    const int cy = (y0 + side / 2) >> image::log2_chroma_height(picture.colour.chroma);
    f[1] = picture.planes[1].row(cy)[cx] - 128.0;
    f[2] = picture.planes[2].row(cy)[cx] - 128.0;
  }
  return f;
}

// A plane that parts the picture, in radians, with the value of parted().
struct Parting {
  double value = 0, pitch = 0, roll = 0;
};

// The plane that parts the picture best: a grid over all attitudes, and a refinement of its best
// point down to 0.02 degrees.
Parting best_parting(const std::vector<Sample>& samples) {
  const Totals totals = totals_of(samples);
  Parting best;
  const auto look = [&](double pitch, double roll) {
    const double value = parted(samples, totals, up_of(pitch, roll));
    if (value > best.value) best = {value, pitch, roll};
  };
  for (double p = -48; p <= 48; p += 4)
    for (double r = -88; r <= 92; r += 6) look(radians(p), radians(r));
  for (double step = 2; step > 0.02; step *= 0.6) {
    const double p0 = best.pitch, r0 = best.roll;
    for (int i = -2; i <= 2; ++i)
      for (int j = -2; j <= 2; ++j) look(p0 + radians(step) * i, r0 + radians(1.5 * step) * j);
  }
  return best;
}

}  // namespace

Quaternion cam_from_level(const Vector3& up_in_cam) {
  const YawPitchRoll attitude = attitude_from_up(up_in_cam);
  return cam_from_body() * world_from_body(attitude).conjugate();
}

YawPitchRoll attitude_from_up(const Vector3& up_in_cam) {
  // The up direction in body axes is (sin pitch, -sin roll cos pitch, -cos roll cos pitch).
  const Vector3 up = cam_from_body().conjugate() * up_in_cam.normalized();
  return {
      0, degrees(std::asin(std::clamp(up.x(), -1.0, 1.0))), degrees(std::atan2(-up.y(), -up.z()))};
}

HorizonFinder::HorizonFinder(const lens::Lens& lens, const image::Mask* own_aircraft)
    : lens_(lens), step_(std::max(4, std::max(lens.size().width, lens.size().height) / kAcross)) {
  if (own_aircraft != nullptr) own_aircraft_ = *own_aircraft;
  const auto [width, height] = lens.size();
  for (int y = 0; y + step_ <= height; y += step_)
    for (int x = 0; x + step_ <= width; x += step_) {
      const int cx = x + step_ / 2;
      const int cy = y + step_ / 2;
      if (own_aircraft != nullptr && !own_aircraft->is_free(cx, cy)) continue;
      if (const auto ray = lens.ray_from_pixel({double(cx), double(cy)}))
        blocks_.push_back({x, y, *ray});
    }
}

std::optional<HorizonFinder::Found> HorizonFinder::find(const image::Picture& picture) const {
  std::vector<Sample> samples;
  for (const Block& b : blocks_) samples.push_back({b.ray, feature_of(picture, b.x, b.y, step_)});
  if (samples.size() < kMinBlocks) return std::nullopt;
  const Parting best = best_parting(samples);
  if (std::sqrt(best.value) < kMinSeparationSigmas) return std::nullopt;
  Vector3 up = up_of(best.pitch, best.roll);
  if (!is_sky(samples, up)) up = -up;
  const HorizonEdge edge = horizon_edge(picture, lens_, mask(), up);
  return Found{
      edge.sharpness >= kSharp ? edge.up_in_cam : up, std::sqrt(best.value), edge.sharpness};
}

HorizonFinder::Found HorizonFinder::follow(const image::Picture& picture,
                                           const Vector3& expected_up_in_cam) const {
  const HorizonEdge edge = horizon_edge_beside(picture, lens_, mask(), expected_up_in_cam);
  return {edge.up_in_cam, 0, edge.sharpness};
}

}  // namespace airtruth::motion
