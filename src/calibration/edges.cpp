// SPDX-License-Identifier: Apache-2.0
#include "calibration/edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "geometry/transform.h"
#include "image/colour.h"
#include "motion/corners.h"

namespace airtruth::calibration {
namespace {

constexpr int kAlong = 5;          // half the length of an edge, px
constexpr double kAcross = 6;      // half the width of its profile, px
constexpr double kLeastStep = 24;  // code values
constexpr double kStraight = 0.2;  // px that the edge's places along it may stray
constexpr int kMostPerFrame = 60;
constexpr std::size_t kMostEdges = 6000;
constexpr std::size_t kFewestEdges = 12;
constexpr double kSharpestShare = 0.015;
constexpr double kBin = 0.2;  // px

struct Found {
  double x, y;    // on the edge
  double nx, ny;  // across it, towards the bright side
};

// Where the derivative along the row (or column) through (x, y) has its middle.
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

// A straight line through the edge's places on the rows (columns) beside it.
std::optional<Found> straight_edge(const cv::Mat& grey, int x, int y, double gx, double gy) {
  const bool along_x = std::abs(gx) >= std::abs(gy);  // the step goes along x: walk along y
  double n = 0, sum_t = 0, sum_p = 0, sum_tt = 0, sum_tp = 0, sum_pp = 0;
  const double slope = along_x ? -gy / gx : -gx / gy;  // of the edge, places over steps
  if (std::abs(slope) > 1) return std::nullopt;
  for (int t = -kAlong; t <= kAlong; ++t) {
    const int shift = static_cast<int>(std::lround(slope * t));
    const int px = along_x ? x + shift : x + t;
    const int py = along_x ? y + t : y + shift;
    if (px < 12 || py < 12 || px >= grey.cols - 12 || py >= grey.rows - 12) return std::nullopt;
    const auto middle = middle_of(grey, px, py, along_x);
    if (!middle) return std::nullopt;
    const double p = shift + *middle;
    n += 1, sum_t += t, sum_p += p, sum_tt += double(t) * t, sum_tp += t * p, sum_pp += p * p;
  }
  const double b = (n * sum_tp - sum_t * sum_p) / (n * sum_tt - sum_t * sum_t);
  const double a = (sum_p - b * sum_t) / n;
  const double rest =
      sum_pp - 2 * a * sum_p - 2 * b * sum_tp + n * a * a + 2 * a * b * sum_t + b * b * sum_tt;
  if (std::sqrt(std::max(0.0, rest / n)) > kStraight) return std::nullopt;
  const double norm = std::hypot(1, b);
  Found found = along_x ? Found{x + a, double(y), 1 / norm, -b / norm}
                        : Found{double(x), y + a, -b / norm, 1 / norm};
  if (found.nx * gx + found.ny * gy < 0) found.nx = -found.nx, found.ny = -found.ny;
  return found;
}

double phi(double x, double sigma) { return 0.5 * (1 + std::erf(x / (sigma * std::sqrt(2.0)))); }

// A step of light from `low` to `high` (0..1, coded) through a Gaussian, coded, then an unsharp
// mask; scaled to 0..1 and sampled finely.
class StepModel {
 public:
  StepModel(double sigma, double amount, double radius, double low, double high) {
    const double dark = double(image::linear_from_srgb(static_cast<float>(low)));
    const double bright = double(image::linear_from_srgb(static_cast<float>(high)));
    for (int i = 0; i < kCount; ++i) {
      const double light = dark + (bright - dark) * phi(place(i), sigma);
      coded_.at(static_cast<std::size_t>(i)) =
          (double(image::srgb_from_linear(static_cast<float>(light))) - low) / (high - low);
    }
    if (amount <= 0) return;
    const int reach = static_cast<int>(std::ceil(3 * radius / kFine));
    std::vector<double> kernel;
    double total = 0;
    for (int j = -reach; j <= reach; ++j) {
      kernel.push_back(std::exp(-0.5 * (j * kFine / radius) * (j * kFine / radius)));
      total += kernel.back();
    }
    const auto sharp = coded_;
    for (int i = 0; i < kCount; ++i) {
      double soft = 0;
      for (int j = -reach; j <= reach; ++j)
        soft += kernel[static_cast<std::size_t>(j + reach)] *
                sharp[static_cast<std::size_t>(std::clamp(i + j, 0, kCount - 1))];
      const auto k = static_cast<std::size_t>(i);
      coded_[k] += amount * (sharp[k] - soft / total);
    }
  }

  double at(double x) const {
    const double p = std::clamp((x + kHalf) / kFine, 0.0, kCount - 1.001);
    const auto i = static_cast<std::size_t>(p);
    const double t = p - double(i);
    return (1 - t) * coded_[i] + t * coded_[i + 1];
  }

 private:
  static constexpr double kHalf = 9;
  static constexpr double kFine = 0.1;
  static constexpr int kCount = static_cast<int>(2 * kHalf / kFine) + 1;
  static double place(int i) { return i * kFine - kHalf; }
  std::array<double, kCount> coded_{};
};

}  // namespace

void EdgeMeter::add(const image::Picture& frame,
                    const std::optional<Homography>& frame_from_before) {
  if (edges_.size() >= kMostEdges) return;
  const cv::Mat grey = motion::luma_of(frame);
  cv::Mat gx, gy, size;
  cv::Sobel(grey, gx, CV_32F, 1, 0);
  cv::Sobel(grey, gy, CV_32F, 0, 1);
  cv::magnitude(gx, gy, size);
  std::vector<std::pair<float, cv::Point>> strong;
  for (int y = 16; y < grey.rows - 16; y += 2)
    for (int x = 16; x < grey.cols - 16; x += 2)
      if (const float g = size.at<float>(y, x); g > 4 * kLeastStep / 2)
        strong.push_back({g, {x, y}});
  std::sort(strong.begin(), strong.end(), [](const auto& a, const auto& b) {
    return a.first != b.first
               ? a.first > b.first
               : std::pair(a.second.y, a.second.x) < std::pair(b.second.y, b.second.x);
  });
  cv::Mat taken(grey.size(), CV_8UC1, cv::Scalar(0));
  int count = 0;
  for (const auto& [strength, at] : strong) {
    if (count >= kMostPerFrame) break;
    if (taken.at<unsigned char>(at) != 0) continue;
    cv::circle(taken, at, 8, cv::Scalar(255), cv::FILLED);
    // The own aircraft's edges are as good as others for sharpness; its mask says that they do not
    // move.
    const auto found =
        straight_edge(grey, at.x, at.y, double(gx.at<float>(at)), double(gy.at<float>(at)));
    if (!found) continue;
    Edge edge;
    double low = 0, high = 0, low2 = 0, high2 = 0;
    int low_count = 0, high_count = 0;
    bool outside = false;
    std::vector<std::pair<double, double>> samples;
    for (int t = -kAlong; t <= kAlong && !outside; ++t)
      for (double p = -kAcross; p <= kAcross; p += 0.5) {
        const double x = found->x - t * found->ny + p * found->nx;
        const double y = found->y + t * found->nx + p * found->ny;
        if (x < 1 || y < 1 || x >= grey.cols - 2 || y >= grey.rows - 2) {
          outside = true;
          break;
        }
        // Whole pixels alone, so that nothing is interpolated: the place is the pixel's own.
        const int ix = static_cast<int>(std::lround(x));
        const int iy = static_cast<int>(std::lround(y));
        const double v = grey.at<unsigned char>(iy, ix);
        const double place = (ix - found->x) * found->nx + (iy - found->y) * found->ny;
        samples.push_back({place, v});
        if (place < -3.5) low += v, low2 += v * v, ++low_count;
        if (place > 3.5) high += v, high2 += v * v, ++high_count;
      }
    if (outside || low_count < 10 || high_count < 10) continue;
    low /= low_count, high /= high_count;
    const double step = high - low;
    const double uneven =
        std::sqrt(std::max({0.0, low2 / low_count - low * low, high2 / high_count - high * high}));
    if (step < kLeastStep || uneven > 0.08 * step || high > 248 || low < 4) continue;
    std::array<double, 64> sums{};
    std::array<int, 64> counts{};
    for (auto& [place, v] : samples) {
      v = (v - low) / step;
      edge.samples.push_back({place, v});
      const int bin = static_cast<int>(std::floor((place + 8) / 0.25));
      if (bin >= 0 && bin < 64)
        sums[static_cast<std::size_t>(bin)] += v, ++counts[static_cast<std::size_t>(bin)];
    }
    // Width by the integral of |height - step|: for a Gaussian sigma * sqrt(2 / pi).
    double area = 0;
    for (std::size_t b = 16; b < 48; ++b) {
      const double place = (double(b) + 0.5) * 0.25 - 8;
      if (counts[b] > 0) area += 0.25 * std::abs(sums[b] / counts[b] - (place > 0 ? 1 : 0));
    }
    edge.low = low, edge.high = high;
    // The middle of the step as its own samples have it, to a twentieth of a pixel.
    double below = 0;
    bool whole = true;
    for (std::size_t b = 16; b < 48; ++b) {
      if (counts[b] == 0) whole = false;
      below += counts[b] > 0 ? 0.25 * (1 - sums[b] / counts[b]) : 0;
    }
    if (!whole) continue;
    const double middle = below - 4;
    if (std::abs(middle) > 1.5) continue;
    for (auto& [place, v] : edge.samples) place -= middle;
    edge.width_px = area * std::sqrt(kPi / 2);
    edge.moved_px = std::numeric_limits<double>::quiet_NaN();
    const bool own = own_aircraft_ != nullptr && !own_aircraft_->is_free(at.x, at.y);
    if (own) {
      edge.moved_px = 0;
    } else if (frame_from_before) {
      const Pixel here(found->x + 0.5, found->y + 0.5);
      const Pixel before = apply(frame_from_before->inverse(), here);
      edge.moved_px =
          std::abs((here.x() - before.x()) * found->nx + (here.y() - before.y()) * found->ny);
    }
    edges_.push_back(std::move(edge));
    ++count;
  }
}

std::optional<EdgeMeter::Result> EdgeMeter::result(std::string& why) {
  if (edges_.size() < kFewestEdges) {
    why = "the clip shows " + std::to_string(edges_.size()) + " clean straight edges; it takes " +
          std::to_string(kFewestEdges);
    return std::nullopt;
  }
  std::vector<const Edge*> still;
  for (const Edge& edge : edges_)
    if (!(edge.moved_px > 1.5)) still.push_back(&edge);
  if (still.size() < kFewestEdges)
    for (const Edge& edge : edges_) still.push_back(&edge);
  std::sort(still.begin(), still.end(), [](const Edge* a, const Edge* b) {
    return a->width_px < b->width_px;
  });
  const std::size_t skip = still.size() / 100;  // narrower than the camera: luck
  const std::size_t count =
      std::max(kFewestEdges / 2, static_cast<std::size_t>(kSharpestShare * double(still.size())));
  constexpr int kBins = static_cast<int>(2 * 6 / kBin);
  std::array<std::vector<double>, kBins> bins;
  profile_ = {};
  for (std::size_t i = skip; i < std::min(still.size(), skip + count); ++i) {
    ++profile_.edges;
    for (const auto& [place, v] : still[i]->samples) {
      const int bin = static_cast<int>(std::floor((place + 6) / kBin));
      if (bin >= 0 && bin < kBins) bins[static_cast<std::size_t>(bin)].push_back(v);
    }
  }
  for (int b = 0; b < kBins; ++b) {
    auto& values = bins[static_cast<std::size_t>(b)];
    if (values.size() < 5) continue;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    profile_.place_px.push_back((b + 0.5) * kBin - 6);
    profile_.height.push_back(*middle);
  }
  std::vector<double> lows, highs;
  for (std::size_t i = skip; i < std::min(still.size(), skip + count); ++i)
    lows.push_back(still[i]->low), highs.push_back(still[i]->high);
  std::nth_element(
      lows.begin(), lows.begin() + static_cast<std::ptrdiff_t>(lows.size() / 2), lows.end());
  std::nth_element(
      highs.begin(), highs.begin() + static_cast<std::ptrdiff_t>(highs.size() / 2), highs.end());
  const double low = lows[lows.size() / 2] / 255, high = highs[highs.size() / 2] / 255;
  double best = 1e300, sigma = 1, amount = 0, radius = 1, shift = 0, scale = 1, level = 0;
  const auto misfit = [&](double s, double a, double r, double d) {
    // The plateaus that heights are told from may lie in the halo: level and scale are free.
    const StepModel model(s, a, r, low, high);
    double n = 0, sm = 0, sh = 0, smm = 0, smh = 0, shh = 0;
    for (std::size_t i = 0; i < profile_.place_px.size(); ++i) {
      const double m = model.at(profile_.place_px[i] - d);
      const double h = profile_.height[i];
      n += 1, sm += m, sh += h, smm += m * m, smh += m * h, shh += h * h;
    }
    scale = (n * smh - sm * sh) / (n * smm - sm * sm);
    level = (sh - scale * sm) / n;
    if (!(scale > 0.8 && scale < 1.4)) return 1e300;
    return shh - level * sh - scale * smh;
  };
  for (double s = 0.35; s < 4; s *= 1.15)
    for (double a = 0; a <= 2.0; a += 0.25)
      for (double r = 0.6; r <= (a > 0 ? 2.61 : 0.6); r += 0.5)
        for (double d : {-0.3, 0.0, 0.3})
          if (const double m = misfit(s, a, r, d); m < best)
            best = m, sigma = s, amount = a, radius = r, shift = d;
  std::array<double*, 4> parameters = {&sigma, &amount, &radius, &shift};
  std::array<double, 4> steps = {0.05, 0.05, 0.12, 0.1};
  for (int round = 0; round < 200; ++round)  // coordinate descent
    for (std::size_t p = 0; p < 4; ++p) {
      bool better = false;
      for (const double sign : {1.0, -1.0}) {
        const double before = *parameters[p];
        *parameters[p] = before + sign * steps[p];
        const bool allowed = sigma > 0.2 && amount >= 0 && radius > 0.3 && radius < 4;
        const double m = allowed ? misfit(sigma, amount, radius, shift) : 1e300;
        if (m < best) {
          best = m, better = true;
          break;
        }
        *parameters[p] = before;
      }
      if (!better) steps[p] *= 0.7;
    }
  const StepModel fitted(sigma, amount, radius, low, high);
  misfit(sigma, amount, radius, shift);
  for (const double place : profile_.place_px)
    profile_.fitted.push_back(level + scale * fitted.at(place - shift));
  // A step drawn by the renderer is a pixel wide already, and the spread is of whole pixels: each
  // adds the variance of a pixel.
  constexpr double kTwoPixels = 2.0 / 12;
  const double spread = std::sqrt(std::max(0.0, sigma * sigma - kTwoPixels));
  const double rms = std::sqrt(best / double(profile_.place_px.size()));
  const double error = std::max(0.02, rms * 2.5 * sigma);
  Result result;
  result.point_spread_px = {spread, error};
  result.sharpening = {amount < 0.03 ? 0 : amount, std::max(0.02, 3 * rms)};
  result.sharpening_px = {radius, std::max(0.1, 6 * rms)};
  return result;
}

}  // namespace airtruth::calibration
