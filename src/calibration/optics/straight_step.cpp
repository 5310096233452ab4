// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/straight_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "foundation/geometry/transform.h"

namespace airtruth::optics {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// camera_slow_test.cpp, whose figures are in docs/realism.md.

// Half the width of the profile of an edge, px.
constexpr double kStepHalfWidthPx = 6;
// Distance from the edge at which its two levels begin, px.
constexpr double kStepLevelFromPx = 3.5;
// Least height of a step, code values.
constexpr double kMinStepHeightCodes = 24;
// Least gradient of the 3 x 3 Sobel filter, which is 4 per code value and pixel for a step that
// rises by half of kMinStepHeightCodes in a pixel.
constexpr int kMinGradient = static_cast<int>(4 * kMinStepHeightCodes / 2);
// Largest rms deviation of the places along an edge from a straight line, px.
constexpr double kMaxBendPx = 0.2;
// Largest standard deviation of a level, as a share of the height of the step.
constexpr double kMaxStepDeviation = 0.08;
// Least number of samples of a level.
constexpr int kMinLevelSamples = 10;
// Distances from black and from white, code values, within which a level is clipped.
constexpr double kAboveBlack = 4, kBelowWhite = 3;
// Largest distance between the middle of the step and the line of its steepest places, px.
constexpr double kMaxOffLinePx = 1.5;
// Width of the border of the picture in which no edge is sought, px.
constexpr int kBorderPx = 12;

// The centroid of the derivative along the row (or column) through (x, y).
std::optional<double> middle_of(const cv::Mat& grey, int x, int y, bool along_x) {
  double sum = 0, weighted = 0;
  for (int i = -4; i <= 4; ++i) {
    const int a =
        along_x ? grey.at<unsigned char>(y, x + i + 1) : grey.at<unsigned char>(y + i + 1, x);
    const int b = along_x ? grey.at<unsigned char>(y, x + i) : grey.at<unsigned char>(y + i, x);
    const double d = std::abs(double(a - b));
    sum += d * d;
    weighted += d * d * (i + 0.5);
  }
  if (!(sum > 0)) return std::nullopt;
  return weighted / sum;
}

// Least squares of a straight line: place = at_0 + slope * t.
class LineFit {
 public:
  void add(double t, double place) {
    n_ += 1, sum_t_ += t, sum_p_ += place, sum_tt_ += t * t, sum_tp_ += t * place;
    sum_pp_ += place * place;
  }
  double slope() const {
    return (n_ * sum_tp_ - sum_t_ * sum_p_) / (n_ * sum_tt_ - sum_t_ * sum_t_);
  }
  double at_0() const { return (sum_p_ - slope() * sum_t_) / n_; }
  // Root mean square of the residuals.
  double rms() const {
    const double a = at_0(), b = slope();
    const double rest = sum_pp_ - 2 * a * sum_p_ - 2 * b * sum_tp_ + n_ * a * a +
                        2 * a * b * sum_t_ + b * b * sum_tt_;
    return std::sqrt(std::max(0.0, rest / n_));
  }

 private:
  double n_ = 0, sum_t_ = 0, sum_p_ = 0, sum_tt_ = 0, sum_tp_ = 0, sum_pp_ = 0;
};

// A straight line through the places of the edge on the neighbouring rows (or columns); empty if
// the edge is not straight.
std::optional<EdgeLine> straight_edge(const cv::Mat& grey,
                                      const SteepPlace& steep,
                                      int half_length) {
  const auto [x, y] = steep.at;
  const auto [gx, gy] = steep.slope;
  // If the step is along x, the walk along the edge is along y.
  const bool along_x = std::abs(gx) >= std::abs(gy);
  // Change of place per row (or column).
  const double slope = along_x ? -gy / gx : -gx / gy;
  if (std::abs(slope) > 1) return std::nullopt;
  LineFit line;
  for (int t = -half_length; t <= half_length; ++t) {
    const int shift = static_cast<int>(std::lround(slope * t));
    const int px = along_x ? x + shift : x + t;
    const int py = along_x ? y + t : y + shift;
    if (px < kBorderPx || py < kBorderPx || px >= grey.cols - kBorderPx ||
        py >= grey.rows - kBorderPx)
      return std::nullopt;
    const auto middle = middle_of(grey, px, py, along_x);
    if (!middle) return std::nullopt;
    line.add(t, shift + *middle);
  }
  if (line.rms() > kMaxBendPx) return std::nullopt;
  const double a = line.at_0(), b = line.slope();
  const double norm = std::hypot(1, b), half = half_length;
  EdgeLine found = along_x ? EdgeLine{x + a, double(y), 1 / norm, -b / norm, half}
                           : EdgeLine{double(x), y + a, -b / norm, 1 / norm, half};
  if (found.nx * gx + found.ny * gy < 0) found.nx = -found.nx, found.ny = -found.ny;
  return found;
}

// Sums of one side of an edge.
struct Side {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double v) { sum += v, squares += v * v, ++count; }
  double mean() const { return sum / count; }
  double variance() const { return std::max(0.0, squares / count - mean() * mean()); }
};

// Heights averaged in bins of their place, from -kHalf to kHalf.
class Profile {
 public:
  void add(double place, double height) {
    const int bin = static_cast<int>(std::floor((place + kHalf) / kWide));
    if (bin < 0 || bin >= kBins) return;
    sums_[static_cast<std::size_t>(bin)] += height;
    ++counts_[static_cast<std::size_t>(bin)];
  }
  bool whole() const {
    return std::none_of(counts_.begin(), counts_.end(), [](int n) { return n == 0; });
  }
  // The middle of the step; the profile must be complete.
  double middle() const {
    double below = 0;
    for (std::size_t b = 0; b < kBins; ++b) below += kWide * (1 - sums_[b] / counts_[b]);
    return below - kHalf;
  }
  // The rms difference between the profile and itself rotated by half a turn about its middle. It
  // is 0 for a step through any symmetric spread and mask, but not for a step with a line along one
  // side.
  double asymmetry() const {
    constexpr std::size_t kPairs = kBins / 2;
    double squares = 0;
    for (std::size_t b = 0; b < kPairs; ++b) {
      const std::size_t o = kBins - 1 - b;
      const double off = sums_[b] / counts_[b] + sums_[o] / counts_[o] - 1;
      squares += off * off;
    }
    return std::sqrt(squares / kPairs);
  }
  // The width from the integral of |height - step|, which is sigma * sqrt(2 / pi) for a Gaussian.
  double width_px() const {
    double area = 0;
    for (std::size_t b = 0; b < kBins; ++b)
      area += kWide * std::abs(sums_[b] / counts_[b] - (b >= kBins / 2 ? 1 : 0));
    return area * std::sqrt(kPi / 2);
  }

 private:
  // Half the width of the profile and the width of its bins, px.
  static constexpr double kHalf = 4, kWide = 0.25;
  static constexpr int kBins = static_cast<int>(2 * kHalf / kWide);
  std::array<double, kBins> sums_{};
  std::array<int, kBins> counts_{};
};

// The samples across an edge, with heights as code values, and the levels on its two sides.
struct Sampled {
  std::vector<std::pair<double, double>> samples;
  Side low, high;
};

// The samples are whole pixels at their own places, so that nothing is interpolated. Empty at the
// border of the picture.
std::optional<Sampled> samples_across(const cv::Mat& grey, const EdgeLine& line) {
  Sampled result;
  const int half_length = static_cast<int>(line.half_length_px);
  for (int t = -half_length; t <= half_length; ++t)
    for (double p = -kStepHalfWidthPx; p <= kStepHalfWidthPx; p += 0.5) {
      const double x = line.x - t * line.ny + p * line.nx;
      const double y = line.y + t * line.nx + p * line.ny;
      if (x < 1 || y < 1 || x >= grey.cols - 2 || y >= grey.rows - 2) return std::nullopt;
      const int ix = static_cast<int>(std::lround(x));
      const int iy = static_cast<int>(std::lround(y));
      const double v = grey.at<unsigned char>(iy, ix);
      const double place = (ix - line.x) * line.nx + (iy - line.y) * line.ny;
      result.samples.push_back({place, v});
      if (place < -kStepLevelFromPx) result.low.add(v);
      if (place > kStepLevelFromPx) result.high.add(v);
    }
  return result;
}

// Whether the two levels are even, apart enough, and not clipped.
bool has_clean_levels(const Side& low, const Side& high, double black, double white) {
  if (low.count < kMinLevelSamples || high.count < kMinLevelSamples) return false;
  const double height = high.mean() - low.mean();
  const double uneven = std::sqrt(std::max(low.variance(), high.variance()));
  return height >= kMinStepHeightCodes && uneven <= kMaxStepDeviation * height &&
         high.mean() <= white - kBelowWhite && low.mean() >= black + kAboveBlack;
}

// The step across an edge; empty if it is not clean.
std::optional<StraightStep> step_across(const cv::Mat& grey,
                                        const EdgeLine& line,
                                        double black,
                                        double white) {
  auto sampled = samples_across(grey, line);
  if (!sampled || !has_clean_levels(sampled->low, sampled->high, black, white)) return std::nullopt;
  StraightStep found{line};
  StepEdge& step = found.step;
  step = {sampled->low.mean(), sampled->high.mean(), std::move(sampled->samples)};
  const double height = step.high - step.low;
  Profile profile;
  for (auto& [place, v] : step.samples) {
    v = (v - step.low) / height;
    profile.add(place, v);
  }
  if (!profile.whole()) return std::nullopt;
  found.width_px = profile.width_px();
  const double middle = profile.middle();
  if (std::abs(middle) > kMaxOffLinePx) return std::nullopt;
  Profile centred;
  for (auto& [place, v] : step.samples) {
    place -= middle;
    centred.add(place, v);
  }
  if (!centred.whole()) return std::nullopt;
  found.asymmetry = centred.asymmetry();
  return found;
}

}  // namespace

std::vector<SteepPlace> steep_places(const cv::Mat& grey) {
  cv::Mat gx, gy;
  cv::Sobel(grey, gx, CV_16S, 1, 0);
  cv::Sobel(grey, gy, CV_16S, 0, 1);
  // Squares of gradients, with their places.
  std::vector<std::pair<int, cv::Point>> strong;
  for (int y = 16; y < grey.rows - 16; y += 2) {
    const auto* across = gx.ptr<short>(y);
    const auto* down = gy.ptr<short>(y);
    for (int x = 16; x < grey.cols - 16; x += 2)
      if (const int g = across[x] * across[x] + down[x] * down[x]; g > kMinGradient * kMinGradient)
        strong.push_back({g, {x, y}});
  }
  std::ranges::sort(strong, {}, [](const auto& one) {
    return std::tuple(-one.first, one.second.y, one.second.x);
  });
  std::vector<SteepPlace> places;
  places.reserve(strong.size());
  for (const auto& [strength, at] : strong)
    places.push_back({at, {double(gx.at<short>(at)), double(gy.at<short>(at))}});
  return places;
}

std::optional<StraightStep> straight_step_at(const cv::Mat& grey,
                                             const SteepPlace& place,
                                             double black,
                                             double white) {
  for (const int half_length : {kLongEdgePx, kShortEdgePx}) {
    const auto line = straight_edge(grey, place, half_length);
    if (!line) continue;
    if (auto step = step_across(grey, *line, black, white)) return step;
  }
  return std::nullopt;
}

}  // namespace airtruth::optics
