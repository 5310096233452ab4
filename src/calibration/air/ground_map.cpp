// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/ground_map.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <opencv2/imgproc.hpp>

#include "camera/motion/corners.h"
#include "foundation/image/layer.h"

namespace airtruth::air {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// surroundings_slow_test.cpp, whose figures are in docs/realism.md.

// Range of the ground that is used, measured from the point under the camera, heights.
constexpr double kMinRange = 0.8, kMaxRange = 14;
// Size of the window in which the contrast is equalised, heights.
constexpr double kContrastWindow = 1.1;
// Least share of the cells that two aligned maps have in common.
constexpr double kMinCommonShare = 0.02;

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
  const cv::Mat grey = motion::luma_of(*view.picture);
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

}  // namespace

GroundMaps::GroundMaps(const Scenery& scenery,
                       const Quaternion& level_from_world,
                       double cell,
                       double max_displacement)
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
  const int padding = static_cast<int>(std::ceil(max_displacement / cell_)) + 1;
  const cv::Size size(cv::getOptimalDFTSize(extent.width + padding),
                      cv::getOptimalDFTSize(extent.height + padding));
  for_each_view(flat.size(), [&](std::size_t k) {
    const cv::Mat seen = flat[k].seen(extent);
    spectra_[k] = {spectrum_of(evened(flat[k].light(extent), seen, cell_), size),
                   spectrum_of(seen, size)};
    flat[k] = {};
  });
}

std::optional<Laid> GroundMaps::laid_over(std::size_t from,
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

double peak_offset(double before, double middle, double after) {
  const double bend = 2 * middle - before - after;
  return bend > 0 ? std::clamp(0.5 * (after - before) / bend, -0.5, 0.5) : 0;
}

}  // namespace airtruth::air
