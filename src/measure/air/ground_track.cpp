// SPDX-License-Identifier: Apache-2.0
#include "measure/air/ground_track.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <opencv2/imgproc.hpp>

#include "camera/motion/corners.h"
#include "foundation/base/error.h"

namespace airtruth::calibration {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// surroundings_slow_test.cpp, whose figures are in docs/realism.md.

// Lengths in heights: multiples of the camera's height above the ground.
// Range of the ground that is used, measured from the camera.
constexpr double kMinRange = 0.8, kMaxRange = 14;
// Size of a cell of the rectified view.
constexpr double kCell = 0.1;
// Largest distance between one view and the next.
constexpr double kMaxBetweenViews = 3;
// Size of the window in which the contrast is equalised.
constexpr double kContrastWindow = 1.1;
// Distance between the views whose agreement determines the horizon.
constexpr double kFarViewDistance = 2.5;
// Least correlation of such views, 0 to 1, with which the path counts as followed.
constexpr double kMinAgreement = 0.25;
// Spacing of the tilts that are tried, degrees, and of the first, coarse search in such steps.
constexpr double kTiltStepDeg = 0.25;
constexpr int kCoarse = 4, kMaxTiltSteps = static_cast<int>(kMaxTiltDeg / kTiltStepDeg);
static_assert(kMaxTiltSteps % kCoarse == 0);
// Least number of views for a path.
constexpr std::size_t kMinViews = 4;
// Side of the rectified view, and largest displacement from one view to the next, cells.
constexpr int kSide = 2 * static_cast<int>(kMaxRange / kCell) + 1;
constexpr int kReach = static_cast<int>(kMaxBetweenViews / kCell);
// Search radius, in cells, about the expected displacement of views that are farther apart.
constexpr int kAround = 4;
// Size of the padded view: the cyclic correlation must not wrap around.
constexpr int kPadded = kSide + static_cast<int>(2 * kFarViewDistance / kCell) + kAround + 1;
static_assert(2 * kFarViewDistance > kMaxBetweenViews);

// Spectra of a view that is rectified to the ground plane (rows north, columns east): of its
// contrast, which is 0 where nothing is seen, and of the mask of what is seen.
struct Straightened {
  cv::Mat spectrum, seen_spectrum;
};

// The light with its local mean subtracted and its local contrast equalised. Cells that are not
// seen have the value 0.
cv::Mat evened(const cv::Mat& light, const cv::Mat& seen) {
  const int window = static_cast<int>(kContrastWindow / kCell) | 1;
  const cv::Size size(window, window);
  cv::Mat count, sum, squares;
  cv::boxFilter(seen, count, CV_32F, size, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::boxFilter(light, sum, CV_32F, size, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::boxFilter(light.mul(light), squares, CV_32F, size, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::Mat result(light.size(), CV_32F, cv::Scalar(0));
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x) {
      if (seen.at<float>(y, x) == 0) continue;
      const float n = count.at<float>(y, x);
      const float mean = sum.at<float>(y, x) / n;
      const float variance = squares.at<float>(y, x) / n - mean * mean;
      // Squared code values.
      constexpr float kMinVariance = 0.25F;
      result.at<float>(y, x) = std::clamp(
          (light.at<float>(y, x) - mean) / std::sqrt(variance + kMinVariance), -3.0F, 3.0F);
    }
  return result;
}

cv::Mat spectrum_of(const cv::Mat& image) {
  const int side = cv::getOptimalDFTSize(kPadded);
  cv::Mat padded(side, side, CV_32F, cv::Scalar(0)), spectrum;
  image.copyTo(padded(cv::Rect(0, 0, image.cols, image.rows)));
  cv::dft(padded, spectrum);
  return spectrum;
}

Straightened straightened(const GroundView& view,
                          const lens::Lens& lens,
                          const image::Mask* own_aircraft,
                          const Quaternion& level_from_world) {
  const cv::Mat grey = motion::luma_of(*view.picture);
  const Quaternion cam_from_level = view.cam_from_world * level_from_world.conjugate();
  cv::Mat light(kSide, kSide, CV_32F, cv::Scalar(0)), seen(kSide, kSide, CV_32F, cv::Scalar(0));
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      const Eigen::Vector2d place(row * kCell - kMaxRange, column * kCell - kMaxRange);
      const double far = place.norm();
      if (far < kMinRange || far > kMaxRange) continue;
      const auto pixel = lens.pixel_from_cam(cam_from_level * Vector3(place.x(), place.y(), 1));
      if (!pixel) continue;
      const double x = pixel->x() - 0.5, y = pixel->y() - 0.5;
      const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
      if (ix < 0 || iy < 0 || ix + 1 >= grey.cols || iy + 1 >= grey.rows) continue;
      if (own_aircraft != nullptr && !own_aircraft->is_free(ix, iy)) continue;
      const double fx = x - ix, fy = y - iy;
      const auto at = [&](int i, int j) { return double(grey.at<unsigned char>(iy + j, ix + i)); };
      light.at<float>(row, column) =
          static_cast<float>((1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) +
                             fy * ((1 - fx) * at(0, 1) + fx * at(1, 1)));
      seen.at<float>(row, column) = 1;
    }
  return {spectrum_of(evened(light, seen)), spectrum_of(seen)};
}

cv::Mat correlated(const cv::Mat& from, const cv::Mat& to) {
  cv::Mat product, result;
  cv::mulSpectrums(from, to, product, 0, true);
  cv::dft(product, result, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  return result;
}

// The position, from -1/2 to 1/2, of the maximum of a parabola through three neighbouring values.
double peak(double before, double middle, double after) {
  const double bend = 2 * middle - before - after;
  return bend > 0 ? std::clamp(0.5 * (after - before) / bend, -0.5, 0.5) : 0;
}

struct Laid {
  // Motion of the camera, heights.
  Eigen::Vector2d moved;
  double agreement = 0;
};

// Registers the ground of `from` in `to`. The search covers the given number of cells about
// `expected` (heights).
std::optional<Laid> laid_over(const Straightened& from,
                              const Straightened& to,
                              const Eigen::Vector2d& expected,
                              int reach) {
  const cv::Mat products = correlated(from.spectrum, to.spectrum);
  const cv::Mat counts = correlated(from.seen_spectrum, to.seen_spectrum);
  const auto wrapped = [&](int i) { return (i % products.rows + products.rows) % products.rows; };
  const float enough = 0.02F * kSide * kSide;
  const auto at = [&](int row, int column) {
    const float n = counts.at<float>(wrapped(row), wrapped(column));
    return n < enough ? -1.0 : double(products.at<float>(wrapped(row), wrapped(column)) / n);
  };
  // Ground that the camera approaches is farther away in the earlier view.
  const int row0 = static_cast<int>(std::lround(expected.x() / kCell));
  const int column0 = static_cast<int>(std::lround(expected.y() / kCell));
  int row = 0, column = 0;
  double best = -1;
  for (int i = row0 - reach; i <= row0 + reach; ++i)
    for (int j = column0 - reach; j <= column0 + reach; ++j)
      if (const double a = at(i, j); a > best) best = a, row = i, column = j;
  if (best <= 0) return std::nullopt;
  return Laid{
      kCell * Eigen::Vector2d(row + peak(at(row - 1, column), best, at(row + 1, column)),
                              column + peak(at(row, column - 1), best, at(row, column + 1))),
      best};
}

// The level axis to the right of the mean direction of view.
Vector3 right_of(const std::vector<GroundView>& views) {
  Vector3 ahead = Vector3::Zero();
  for (const GroundView& view : views) ahead += view.cam_from_world.conjugate() * Vector3(0, 0, 1);
  const Vector3 right(-ahead.y(), ahead.x(), 0);
  return right.norm() > 0 ? right.normalized() : Vector3(0, 1, 0);
}

// The rectified views under an assumed horizon.
std::vector<Straightened> straightened_views(const std::vector<GroundView>& views,
                                             const lens::Lens& lens,
                                             const image::Mask* own_aircraft,
                                             const Quaternion& level_from_world) {
  std::vector<Straightened> flat(views.size());
  cv::parallel_for_({0, static_cast<int>(views.size())}, [&](const cv::Range& range) {
    for (auto k = static_cast<std::size_t>(range.start); k < static_cast<std::size_t>(range.end);
         ++k)
      flat[k] = straightened(views[k], lens, own_aircraft, level_from_world);
  });
  return flat;
}

// The registration of each view with the one before it.
std::vector<std::optional<Laid>> registrations(const std::vector<Straightened>& flat) {
  std::vector<std::optional<Laid>> next(flat.size());
  cv::parallel_for_({1, static_cast<int>(flat.size())}, [&](const cv::Range& range) {
    for (auto k = static_cast<std::size_t>(range.start); k < static_cast<std::size_t>(range.end);
         ++k)
      next[k] = laid_over(flat[k - 1], flat[k], Eigen::Vector2d::Zero(), kReach);
  });
  return next;
}

// The longest run of views that agree with the one before.
GroundTrack longest_run(const std::vector<std::optional<Laid>>& next, const GroundTrack& empty) {
  GroundTrack best, run = empty;
  const auto end_run = [&](std::size_t first) {
    if (run.places.size() > best.places.size()) best = run;
    run = empty;
    run.first = first;
  };
  for (std::size_t k = 1; k < next.size(); ++k) {
    if (next[k] && next[k]->agreement >= kMinAgreement)
      run.places.push_back(run.places.back() + next[k]->moved);
    else
      end_run(k);
  }
  end_run(next.size());
  return best;
}

// The mean agreement of views of the track that are kFarViewDistance apart; 0 without any.
double far_agreement(const GroundTrack& track, const std::vector<Straightened>& flat) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0, j = 0; i < track.places.size(); ++i) {
    while (j < track.places.size() && (track.places[j] - track.places[i]).norm() < kFarViewDistance)
      ++j;
    if (j == track.places.size()) break;
    const Eigen::Vector2d moved = track.places[j] - track.places[i];
    if (moved.norm() > 2 * kFarViewDistance) continue;
    const auto laid = laid_over(flat[track.first + i], flat[track.first + j], moved, kAround);
    sum += laid ? laid->agreement : 0;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

GroundTrack track_at(const std::vector<GroundView>& views,
                     const lens::Lens& lens,
                     const image::Mask* own_aircraft,
                     double horizon_rad) {
  // The assumed horizon is higher, so the direction that was level lies below it.
  const Quaternion level_from_world(Eigen::AngleAxisd(-horizon_rad, right_of(views)));
  const std::vector<Straightened> flat =
      straightened_views(views, lens, own_aircraft, level_from_world);
  GroundTrack best = longest_run(registrations(flat),
                                 {0, {Eigen::Vector2d::Zero()}, horizon_rad, level_from_world, 0});
  best.agreement = far_agreement(best, flat);
  return best;
}

}  // namespace

std::optional<Eigen::Vector2d> place_on_ground(const Vector3& direction) {
  // The sine of 0.06 degrees below the horizon: ground beyond has no useful range.
  constexpr double kMinDown = 1e-3;
  if (direction.z() < kMinDown) return std::nullopt;
  return Eigen::Vector2d(direction.x(), direction.y()) / direction.z();
}

std::optional<GroundTrack> track_ground(const std::vector<GroundView>& views,
                                        const lens::Lens& lens,
                                        const image::Mask* own_aircraft,
                                        const std::stop_token& stop) {
  if (views.size() < kMinViews) return std::nullopt;
  const auto at = [&](double steps) {
    if (stop.stop_requested()) throw Interrupted();
    return track_at(views, lens, own_aircraft, radians(kTiltStepDeg) * steps);
  };
  // The agreement by the number of tilt steps.
  std::map<int, double> known;
  const auto agreement = [&](int steps) {
    const auto [found, is_new] = known.try_emplace(steps, 0.0);
    if (is_new) found->second = at(steps).agreement;
    return found->second;
  };
  int best = -kMaxTiltSteps;
  for (int steps = -kMaxTiltSteps; steps <= kMaxTiltSteps; steps += kCoarse)
    if (agreement(steps) > agreement(best)) best = steps;
  if (std::abs(best) == kMaxTiltSteps) return std::nullopt;
  for (int step = kCoarse / 2; step > 0; step /= 2) {
    const int middle = best;
    for (const int steps : {middle - step, middle + step})
      if (agreement(steps) > agreement(best)) best = steps;
  }
  const double before = agreement(best - 1), after = agreement(best + 1);
  GroundTrack track = at(best + peak(before, agreement(best), after));
  if (track.agreement < kMinAgreement) return std::nullopt;
  return track;
}

}  // namespace airtruth::calibration
