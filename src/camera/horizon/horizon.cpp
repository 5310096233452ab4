// SPDX-License-Identifier: Apache-2.0
#include "camera/horizon/horizon.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "foundation/geometry/within_frame.h"
#include "foundation/image/colour.h"

namespace airtruth::horizon {
namespace {

// Blocks along the longer side. Chosen by judgement. Twice as many take four times as long to look
// at every attitude, and a block holds too few pixels for its texture.
constexpr int kAcross = 56;
// Both limits are chosen by judgement; a line that passes them must also be sharp
// (HorizonEdge::kSharp).
// The least share of the blocks on either side of the plane.
constexpr double kMinSideShare = 0.06;
// The least distance between the mean features of the two sides, in standard deviations.
constexpr double kMinSeparationSigmas = 2.2;
// Least number of blocks for a covariance of four features. Chosen by judgement.
constexpr std::size_t kMinBlocks = 40;

// The least cosine of the pitch of a camera that has a horizon ahead: 0.6 degrees from straight
// down.
constexpr double kLeastAhead = 0.01;

using Feature = Eigen::Vector4d;  // luma, Cb, Cr, texture

// The features of the blocks of a picture, with the sums over all of them, which every plane has in
// common.
struct Samples {
  // The rays of the blocks: one column for each axis.
  Eigen::Array<float, Eigen::Dynamic, 3> rays;
  std::vector<Feature> features;
  Feature sum = Feature::Zero();
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();

  void add(const Feature& feature) {
    features.push_back(feature);
    sum += feature;
    squares += feature * feature.transpose();
  }
};

// The sum over the samples above a plane, and their number.
struct Above {
  Feature sum = Feature::Zero();
  double count = 0;
};

Above above(const Samples& samples, const Vector3& up) {
  const Eigen::Vector3f n = up.cast<float>();
  const Eigen::ArrayXf heights =
      samples.rays.col(0) * n.x() + samples.rays.col(1) * n.y() + samples.rays.col(2) * n.z();
  Above result;
  for (Eigen::Index i = 0; i < heights.size(); ++i) {
    if (!(heights[i] > 0)) continue;
    result.sum += samples.features[static_cast<std::size_t>(i)];
    result.count += 1;
  }
  return result;
}

Vector3 up_of(double pitch_rad, double roll_rad) {
  const Quaternion body_from_world =
      world_from_body({0, degrees(pitch_rad), degrees(roll_rad)}).conjugate();
  return cam_from_body() * (body_from_world * Vector3(0, 0, -1));
}

// The squared distance between the mean features of the two sides, in their common covariance; 0
// where one side has too few blocks.
double parted(const Samples& samples, const Vector3& up) {
  const Above upper = above(samples, up);
  const double n = double(samples.features.size()), lower_count = n - upper.count;
  if (std::min(lower_count, upper.count) < kMinSideShare * n) return 0;
  const Feature low = (samples.sum - upper.sum) / lower_count;
  const Feature high = upper.sum / upper.count;
  Eigen::Matrix4d within = samples.squares / n - lower_count / n * low * low.transpose() -
                           upper.count / n * high * high.transpose();
  within.diagonal().array() += 1.0;  // a variance of one code value keeps it invertible
  const Feature apart = high - low;
  // Fisher's criterion (1936), weighted so that an even split has the weight 1.
  return apart.dot(within.ldlt().solve(apart)) * 4 * lower_count * upper.count / (n * n);
}

// Whether that side is the sky, which is smoother, and mostly brighter and bluer, than the ground.
bool is_sky(const Samples& samples, const Vector3& up) {
  const Above upper = above(samples, up);
  const double lower_count = double(samples.features.size()) - upper.count;
  const Feature d = upper.sum / std::max(1.0, upper.count) -
                    (samples.sum - upper.sum) / std::max(1.0, lower_count);
  return d[0] + 0.5 * d[1] - 3 * d[3] > 0;
}

// Mean and standard deviation of luma over the block of `side` pixels at (x0, y0), and the chroma
// at its middle: Cb and Cr, or blue and red less luma.
Feature feature_of(const image::Picture& picture, int x0, int y0, int side) {
  double sum = 0, squares = 0;
  for (int y = y0; y < y0 + side; y += 2)
    for (int x = x0; x < x0 + side; x += 2) {
      const double v = image::luma_at(picture, x, y);
      sum += v, squares += v * v;
    }
  const int samples_along = (side + 1) / 2;
  const double n = double(samples_along) * samples_along;
  const double mean = sum / n;
  Feature f(mean, 0, 0, std::sqrt(std::max(0.0, squares / n - mean * mean)));
  if (picture.plane_count == 3) {
    const int x = x0 + side / 2, y = y0 + side / 2;
    const int cx = x >> image::log2_chroma_width(picture.colour.chroma);
    const int cy = y >> image::log2_chroma_height(picture.colour.chroma);
    const bool is_rgb = picture.colour.matrix == image::Matrix::kRgb;
    const double grey = is_rgb ? image::luma_at(picture, x, y) : 128;
    f[1] = picture.planes[1].row(cy)[cx] - grey;
    f[2] = picture.planes[2].row(cy)[cx] - grey;
  }
  return f;
}

// A plane that parts the picture, in radians, with the value of parted().
struct Parting {
  double value = 0, pitch = 0, roll = 0;
};

// The plane that parts the picture best: a grid over all attitudes, and a refinement of its best
// point down to 0.02 degrees.
Parting best_parting(const Samples& samples) {
  Parting best;
  const auto look = [&](double pitch, double roll) {
    const double value = parted(samples, up_of(pitch, roll));
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

// The area of the unit square about the origin in which normal . q < t, for a unit normal: the
// trapezoid over t that two boxes of the widths |x| and |y| make of each other.
double area_before(const Pixel& normal, double t) {
  const double wide = std::max(std::abs(normal.x()), std::abs(normal.y()));
  const double narrow = std::min(std::abs(normal.x()), std::abs(normal.y()));
  if (t < 0) return 1 - area_before(normal, -t);
  if (2 * t <= wide - narrow) return 0.5 + t / wide;
  if (2 * t >= wide + narrow) return 1;  // also where narrow is 0, by which the rest divides
  const double left = (wide + narrow) / 2 - t;
  return 1 - left * left / (2 * wide * narrow);
}

}  // namespace

Vector3 up_from_seen(const Vector3& seen_up_in_cam, double dip_rad) {
  const Vector3 up = seen_up_in_cam.normalized();
  const Vector3 ahead = Vector3::UnitZ() - up.z() * up;
  if (ahead.norm() < kLeastAhead) return up;
  return std::cos(dip_rad) * up - std::sin(dip_rad) * ahead.normalized();
}

Vector3 seen_from_up(const Vector3& up_in_cam, double dip_rad) {
  return up_from_seen(up_in_cam, -dip_rad);
}

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

std::optional<HorizonEdge> HorizonFinder::find(const image::Picture& picture) const {
  Samples samples;
  samples.rays.resize(static_cast<Eigen::Index>(blocks_.size()), 3);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    samples.rays.row(static_cast<Eigen::Index>(i)) = blocks_[i].ray.cast<float>().transpose();
    samples.add(feature_of(picture, blocks_[i].x, blocks_[i].y, step_));
  }
  if (samples.features.size() < kMinBlocks) return std::nullopt;
  const Parting best = best_parting(samples);
  if (std::sqrt(best.value) < kMinSeparationSigmas) return std::nullopt;
  Vector3 up = up_of(best.pitch, best.roll);
  if (!is_sky(samples, up)) up = -up;
  HorizonEdge edge = horizon_edge({picture, lens_, mask()}, up);
  if (!edge.is_sharp()) edge.up_in_cam = up;
  return edge;
}

HorizonEdge HorizonFinder::follow(const image::Picture& picture,
                                  const Vector3& expected_up_in_cam) const {
  return horizon_edge_beside({picture, lens_, mask()}, expected_up_in_cam);
}

float share_below(const lens::Lens& lens,
                  const Vector3& up_in_cam,
                  const Homography& nominal_from_frame,
                  int x,
                  int y) {
  const auto height = [&](double px, double py) -> std::optional<double> {
    const auto ray = lens.ray_from_pixel(apply(nominal_from_frame, {px, py}));
    if (!ray) return std::nullopt;
    return ray->dot(up_in_cam);
  };
  const auto here = height(x + 0.5, y + 0.5);
  if (!here) return 0;
  const auto right = height(x + 1.0, y + 0.5), down = height(x + 0.5, y + 1.0);
  if (!right || !down) return *here < 0 ? 1.0F : 0.0F;
  const Pixel slope = 2 * Pixel(*right - *here, *down - *here);
  const double steepness = slope.norm();
  if (!(steepness > 0)) return *here < 0 ? 1.0F : 0.0F;
  return static_cast<float>(area_before(slope / steepness, -*here / steepness));
}

namespace {

// The variance of one sighting, rad^2. A detected horizon is off by 0.3 degrees (hills), and the
// error is nearly the same half a second later. The factor 10 counts ten correlated sightings as
// one independent sighting.
const double kSightingVariance = 10 * std::pow(radians(0.3), 2);
// Standard deviations beyond which a sighting is discarded: one in 3,000 right ones (a Rayleigh
// distribution).
constexpr double kGate = 4;

// The shortest rotation that maps one unit vector to another.
Quaternion turn_between(const Vector3& from, const Vector3& to) {
  const Vector3 axis = from.cross(to);
  const double sine = axis.norm();
  if (sine < 1e-15) return Quaternion::Identity();
  return rotation_from_vector(std::atan2(sine, from.dot(to)) / sine * axis);
}

// The angles about x and y of the shortest rotation that maps the z axis to v.
Eigen::Vector2d angles_of(const Vector3& v) {
  const double sine = std::hypot(v.x(), v.y());
  const double angle = std::atan2(sine, v.z());
  return sine < 1e-12 ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(angle / sine * v.head<2>());
}

}  // namespace

void HorizonHold::stray(double sigma_rad) { covariance_(1, 1) += sigma_rad * sigma_rad; }

double HorizonHold::uncertainty_rad() const { return std::sqrt(covariance_(1, 1)); }

Vector3 HorizonHold::up_in_reference(const Eigen::Vector2d& angles) const {
  const double angle = angles.norm();
  if (angle < 1e-15) return *reference_from_up_ * Vector3::UnitZ();
  const Eigen::Vector2d level = std::sin(angle) / angle * angles;
  return *reference_from_up_ * Vector3(level.x(), level.y(), std::cos(angle));
}

bool HorizonHold::see(const Quaternion& cam_from_reference, const Vector3& up_in_cam) {
  const Vector3 up = (cam_from_reference.conjugate() * up_in_cam).normalized();
  if (!reference_from_up_) {
    reference_from_up_ = turn_between(Vector3::UnitZ(), up);
    covariance_(0, 0) = 1;  // the first sighting may have any direction
  }
  const Eigen::Vector2d seen = angles_of(reference_from_up_->conjugate() * up);
  const Eigen::Vector2d expected = state_.colwise().sum();
  const Eigen::Vector2d both(1, 1);
  const double variance = both.dot(covariance_ * both) + kSightingVariance;
  if ((seen - expected).squaredNorm() > kGate * kGate * variance) return false;
  const Eigen::Vector2d gain = covariance_ * both / variance;
  state_ += gain * (seen - expected).transpose();
  covariance_ -= gain * both.transpose() * covariance_;
  return true;
}

std::optional<Vector3> HorizonHold::expected_up(const Quaternion& cam_from_reference) const {
  if (!reference_from_up_) return std::nullopt;
  return cam_from_reference * up_in_reference(state_.colwise().sum());
}

Quaternion HorizonHold::held(const Quaternion& cam_from_reference) const {
  if (!reference_from_up_) return cam_from_reference;
  const Eigen::Vector2d up = state_.row(0);
  const Eigen::Vector2d strayed = state_.colwise().sum();
  const Quaternion turn = turn_between(up_in_reference(up), up_in_reference(strayed));
  return (cam_from_reference * turn).normalized();
}

}  // namespace airtruth::horizon
