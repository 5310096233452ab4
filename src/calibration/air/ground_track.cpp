// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/ground_track.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "foundation/image/mats.h"

namespace airtruth::air {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// surroundings_slow_test.cpp, whose figures are in docs/realism.md.

// Lengths in heights: multiples of the camera's height above the ground.
// Size of a cell of the rectified views, and of one in the first search for the horizon, which
// takes a quarter of the cells.
constexpr double kCell = 0.1, kCoarseCell = 0.2;
// Largest distance between one view and the next.
constexpr double kMaxBetweenViews = 3;
// Distance between the views whose agreement determines the horizon.
constexpr double kFarViewDistance = 2.5;
// Search radius about the expected displacement of views that are farther apart.
constexpr double kAround = 0.4;
static_assert(2 * kFarViewDistance > kMaxBetweenViews);
// Largest displacement, by row or by column, at which two views are compared; the rest is for
// rounding and for the neighbours of the maximum.
constexpr double kMaxDisplacement = 2 * kFarViewDistance + kAround + 2 * kCoarseCell;
// Least correlation of such views, 0 to 1, with which the path counts as followed. Below
// kMinCoarseAgreement in the coarse search the fine one is not made: over coarse and fine cells the
// correlations differed by at most 0.07 on two virtual and three real flights.
constexpr double kMinAgreement = 0.25, kMinCoarseAgreement = 0.12;
// Spacing of the tilts that are tried, degrees, and of the first, coarse search in such steps.
constexpr double kTrackTiltStepDeg = 0.25;
constexpr int kCoarse = 4, kMaxTiltSteps = static_cast<int>(kMaxTiltDeg / kTrackTiltStepDeg);
static_assert(kMaxTiltSteps % kCoarse == 0);
// Range of the ground that is used, measured from the point under the camera, heights.
constexpr double kMinRange = 0.8, kMaxRange = 14;
// Size of the window in which the contrast is equalised, heights.
constexpr double kContrastWindow = 1.1;
// Least share of the cells that two aligned maps have in common.
constexpr double kMinCommonShare = 0.02;
// Least number of views for a path.
constexpr std::size_t kMinViews = 4;

// A view that is rectified to the ground plane: the light, and 1 where it is seen. `extent` holds
// the cells that are seen.
struct Rectified {
  cv::Mat light, seen;
  cv::Rect extent;
};

// Number of cells along a side of a map that reaches kMaxRange in every direction.
int side_of(double cell) { return 2 * static_cast<int>(kMaxRange / cell) + 1; }

// The least cosine of the angle between the axis of the lens and the ray of a pixel. The angle
// grows away from the axis (camera/lens/lens.h), so it is greatest at the border of the picture.
double least_cosine(const lens::Lens& lens) {
  // Distance of the pixels of the border that are looked at, and a reserve for those between them.
  constexpr int kStepPx = 8;
  constexpr double kReserve = 0.01;
  const auto [width, height] = lens.size();
  double least = 1;
  const auto look = [&](int x, int y) {
    const auto ray = lens.ray_from_pixel({double(x), double(y)});
    least = std::min(least, ray ? ray->z() : std::cos(lens.max_angle_rad()));
  };
  for (int x = 0; x < width + kStepPx; x += kStepPx)
    look(std::min(x, width), 0), look(std::min(x, width), height);
  for (int y = 0; y < height + kStepPx; y += kStepPx)
    look(0, std::min(y, height)), look(width, std::min(y, height));
  return least - kReserve;
}

// Bilinear interpolation of luma; empty outside the picture and on the own aircraft.
std::optional<float> light_at(const cv::Mat& grey,
                              const image::Mask* own_aircraft,
                              const Pixel& p) {
  const double x = p.x() - 0.5, y = p.y() - 0.5;
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  if (ix < 0 || iy < 0 || ix + 1 >= grey.cols || iy + 1 >= grey.rows) return std::nullopt;
  if (own_aircraft != nullptr && !own_aircraft->is_free(ix, iy)) return std::nullopt;
  const double fx = x - ix, fy = y - iy;
  const unsigned char* upper = grey.ptr<unsigned char>(iy) + ix;
  const unsigned char* lower = grey.ptr<unsigned char>(iy + 1) + ix;
  return static_cast<float>((1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) +
                            fy * ((1 - fx) * lower[0] + fx * lower[1]));
}

Rectified rectified(const Scenery& scenery,
                    std::size_t k,
                    double lens_least_cosine,
                    const Quaternion& level_from_world,
                    double cell) {
  const GroundView& view = scenery.views[k];
  const cv::Mat grey = image::luma_of(*view.picture);
  const Matrix3 cam_from_level =
      (view.cam_from_world * level_from_world.conjugate()).toRotationMatrix();
  const int side = side_of(cell);
  Rectified result{
      cv::Mat(side, side, CV_32F, cv::Scalar(0)), cv::Mat(side, side, CV_32F, cv::Scalar(0)), {}};
  int top = side, bottom = -1, left = side, right = -1;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const Vector3 place(row * cell - kMaxRange, column * cell - kMaxRange, 1);
      const double squared_range = place.head<2>().squaredNorm();
      if (squared_range < kMinRange * kMinRange || squared_range > kMaxRange * kMaxRange) continue;
      const Vector3 in_cam = cam_from_level * place;
      if (in_cam.z() < lens_least_cosine * std::sqrt(squared_range + 1)) continue;
      const auto pixel = scenery.lens.pixel_from_cam(in_cam);
      const auto light = pixel ? light_at(grey, scenery.own_aircraft, *pixel) : std::nullopt;
      if (!light) continue;
      result.light.at<float>(row, column) = *light;
      result.seen.at<float>(row, column) = 1;
      top = std::min(top, row), bottom = std::max(bottom, row);
      left = std::min(left, column), right = std::max(right, column);
    }
  if (bottom >= 0) result.extent = {left, top, right - left + 1, bottom - top + 1};
  return result;
}

// The light with its local mean subtracted and its local contrast equalised. Cells that are not
// seen have the value 0.
cv::Mat evened(const cv::Mat& light, const cv::Mat& seen, double cell) {
  const int window = static_cast<int>(kContrastWindow / cell) | 1;
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
      // Squared code values: even ground is raised to at most 2 standard deviations a code value.
      constexpr float kMinVariance = 0.25F;
      result.at<float>(y, x) = std::clamp(
          (light.at<float>(y, x) - mean) / std::sqrt(variance + kMinVariance), -3.0F, 3.0F);
    }
  return result;
}

cv::Mat spectrum_of(const cv::Mat& map, const cv::Size& padded_size) {
  cv::Mat padded(padded_size, CV_32F, cv::Scalar(0)), spectrum;
  map.copyTo(padded(cv::Rect(0, 0, map.cols, map.rows)));
  cv::dft(padded, spectrum, 0, map.rows);
  return spectrum;
}

cv::Mat correlated(const cv::Mat& from, const cv::Mat& to) {
  cv::Mat product, result;
  cv::mulSpectrums(from, to, product, 0, true);
  cv::dft(product, result, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  return result;
}

// Calls `make` for every index below `count`, on several threads.
void for_each_view(std::size_t count, const std::function<void(std::size_t)>& make) {
  cv::parallel_for_({0, static_cast<int>(count)}, [&](const cv::Range& range) {
    for (int k = range.start; k < range.end; ++k) make(static_cast<std::size_t>(k));
  });
}

// The position, from -1/2 to 1/2, of the maximum of a parabola through three neighbouring values.
double peak_offset(double before, double middle, double after) {
  const double bend = 2 * middle - before - after;
  return bend > 0 ? std::clamp(0.5 * (after - before) / bend, -0.5, 0.5) : 0;
}

// The registration of one view with another.
struct Laid {
  // Motion of the camera.
  Eigen::Vector2d moved;
  // Correlation of the aligned views, -1 to 1.
  double agreement = 0;
};

// Views that are rectified to the ground plane and registered with one another: rows north, columns
// east.
class GroundMaps {
 public:
  // The level frame, in which the ground is z = 1, is that of `level_from_world`. `cell`: the size
  // of a cell.
  GroundMaps(const Scenery& scenery, const Quaternion& level_from_world, double cell)
      : cell_(cell), spectra_(scenery.views.size()) {
    const double cosine = least_cosine(scenery.lens);
    std::vector<Rectified> flat(spectra_.size());
    for_each_view(flat.size(), [&](std::size_t k) {
      flat[k] = rectified(scenery, k, cosine, level_from_world, cell_);
    });
    // Nothing is seen outside the extent of all views together.
    cv::Rect extent(0, 0, 0, 0);
    for (const Rectified& view : flat) extent |= view.extent;
    if (extent.empty()) extent = {0, 0, 1, 1};
    // Padding: the cyclic correlation must not wrap around.
    const int padding = static_cast<int>(std::ceil(kMaxDisplacement / cell_)) + 1;
    const cv::Size size(cv::getOptimalDFTSize(extent.width + padding),
                        cv::getOptimalDFTSize(extent.height + padding));
    for_each_view(flat.size(), [&](std::size_t k) {
      const cv::Mat seen = flat[k].seen(extent);
      spectra_[k] = {spectrum_of(evened(flat[k].light(extent), seen, cell_), size),
                     spectrum_of(seen, size)};
      flat[k] = {};
    });
  }

  std::size_t size() const { return spectra_.size(); }
  // Registers the ground of view `from` in view `to` (ground_track.h). The search covers the
  // displacements within `reach` of `expected`, by row and by column. Empty where no displacement
  // gives a positive correlation.
  std::optional<Laid> laid_over(std::size_t from,
                                std::size_t to,
                                const Eigen::Vector2d& expected,
                                double reach) const {
    const cv::Mat products = correlated(spectra_[from].contrast, spectra_[to].contrast);
    const cv::Mat counts = correlated(spectra_[from].seen, spectra_[to].seen);
    const auto wrapped = [](int i, int count) { return (i % count + count) % count; };
    const double side = side_of(cell_);
    const double enough = kMinCommonShare * side * side;
    const auto at = [&](int row, int column) {
      const int r = wrapped(row, products.rows), c = wrapped(column, products.cols);
      const float n = counts.at<float>(r, c);
      return double(n) < enough ? -1.0 : double(products.at<float>(r, c) / n);
    };
    // Ground that the camera approaches is farther away in the earlier view.
    const int row0 = static_cast<int>(std::lround(expected.x() / cell_));
    const int column0 = static_cast<int>(std::lround(expected.y() / cell_));
    const int cells = static_cast<int>(std::lround(reach / cell_));
    int row = 0, column = 0;
    double best = -1;
    for (int i = row0 - cells; i <= row0 + cells; ++i)
      for (int j = column0 - cells; j <= column0 + cells; ++j)
        if (const double a = at(i, j); a > best) best = a, row = i, column = j;
    if (best <= 0) return std::nullopt;
    const double down = peak_offset(at(row - 1, column), best, at(row + 1, column));
    const double across = peak_offset(at(row, column - 1), best, at(row, column + 1));
    return Laid{cell_ * Eigen::Vector2d(row + down, column + across), best};
  }

 private:
  // Of the map's contrast, which is 0 where nothing is seen, and of the mask of what is seen.
  struct Spectra {
    cv::Mat contrast, seen;
  };
  double cell_;
  std::vector<Spectra> spectra_;
};

// The level axis to the right of the mean direction of view.
Vector3 right_of(const std::vector<GroundView>& views) {
  Vector3 ahead = Vector3::Zero();
  for (const GroundView& view : views) ahead += view.cam_from_world.conjugate() * Vector3(0, 0, 1);
  const Vector3 right(-ahead.y(), ahead.x(), 0);
  return right.norm() > 0 ? right.normalized() : Vector3(0, 1, 0);
}

// The registration of each view with the one before it.
std::vector<std::optional<Laid>> registrations(const GroundMaps& maps) {
  std::vector<std::optional<Laid>> next(maps.size());
  for_each_view(next.size(), [&](std::size_t k) {
    if (k > 0) next[k] = maps.laid_over(k - 1, k, Eigen::Vector2d::Zero(), kMaxBetweenViews);
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
double far_agreement(const GroundTrack& track, const GroundMaps& maps) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0, j = 0; i < track.places.size(); ++i) {
    while (j < track.places.size() && (track.places[j] - track.places[i]).norm() < kFarViewDistance)
      ++j;
    if (j == track.places.size()) break;
    const Eigen::Vector2d moved = track.places[j] - track.places[i];
    if (moved.norm() > 2 * kFarViewDistance) continue;
    const auto laid = maps.laid_over(track.first + i, track.first + j, moved, kAround);
    sum += laid ? laid->agreement : 0;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

// The track under an assumed horizon, by rectified views with cells of the given size.
GroundTrack track_at(const Scenery& scenery, double horizon_rad, double cell) {
  // The assumed horizon is higher, so the direction that was level lies below it.
  const Quaternion level_from_world(Eigen::AngleAxisd(-horizon_rad, right_of(scenery.views)));
  const GroundMaps maps(scenery, level_from_world, cell);
  GroundTrack best = longest_run(registrations(maps),
                                 {0, {Eigen::Vector2d::Zero()}, horizon_rad, level_from_world, 0});
  best.agreement = far_agreement(best, maps);
  return best;
}

// The tilt, in steps, from which the fine search begins: the best of a coarse one. Empty where that
// is at either end of the range, or where no tilt lets the views agree. `at` gives the track at a
// number of steps by cells of a size.
std::optional<int> coarse_tilt(const std::function<GroundTrack(double, double)>& at) {
  std::vector<double> agreements;
  for (int steps = -kMaxTiltSteps; steps <= kMaxTiltSteps; steps += kCoarse)
    agreements.push_back(at(steps, kCoarseCell).agreement);
  const auto best = std::max_element(agreements.begin(), agreements.end());
  if (best == agreements.begin() || best + 1 == agreements.end() || *best < kMinCoarseAgreement)
    return std::nullopt;
  const double place =
      double(best - agreements.begin()) + peak_offset(*(best - 1), *best, *(best + 1));
  return static_cast<int>(std::lround(kCoarse * place)) - kMaxTiltSteps;
}

}  // namespace

std::optional<Eigen::Vector2d> place_on_ground(const Vector3& direction) {
  // The sine of 0.06 degrees below the horizon: ground beyond has no useful range.
  constexpr double kMinDown = 1e-3;
  if (direction.z() < kMinDown) return std::nullopt;
  return Eigen::Vector2d(direction.x(), direction.y()) / direction.z();
}

std::optional<GroundTrack> track_ground(const Scenery& scenery, const std::stop_token& stop) {
  if (scenery.views.size() < kMinViews) return std::nullopt;
  const auto at = [&](double steps, double cell) {
    if (stop.stop_requested()) throw Interrupted();
    return track_at(scenery, radians(kTrackTiltStepDeg) * steps, cell);
  };
  const auto start = coarse_tilt(at);
  if (!start) return std::nullopt;
  // The agreement by the number of tilt steps.
  std::map<int, double> known;
  const auto agreement = [&](int steps) {
    const auto [found, is_new] = known.try_emplace(steps, 0.0);
    if (is_new) found->second = at(steps, kCell).agreement;
    return found->second;
  };
  int best = *start;
  for (int climbed = 0; climbed < kCoarse; ++climbed) {
    const int next = agreement(best + 1) > agreement(best - 1) ? best + 1 : best - 1;
    if (agreement(next) <= agreement(best)) break;
    best = next;
  }
  const double before = agreement(best - 1), after = agreement(best + 1);
  GroundTrack track = at(best + peak_offset(before, agreement(best), after), kCell);
  if (track.agreement < kMinAgreement) return std::nullopt;
  return track;
}

}  // namespace airtruth::air
