// SPDX-License-Identifier: Apache-2.0
#include "calibration/edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "calibration/median.h"
#include "geometry/transform.h"
#include "image/colour.h"
#include "motion/corners.h"

namespace airtruth::calibration {
namespace {

constexpr int kAlong = 5;          // half the length of an edge, px
constexpr double kAcross = 6;      // half the width of its profile, px
constexpr double kPlateau = 3.5;   // px from the edge its two levels begin
constexpr double kLeastStep = 24;  // code values
constexpr double kStraight = 0.2;  // px that the edge's places along it may stray
constexpr int kMostPerFrame = 60;
constexpr std::size_t kMostEdges = 6000;
constexpr std::size_t kFewestEdges = 12;
constexpr double kSharpestShare = 0.015;
constexpr double kAsSharp = 1.1;  // times the sharpest: within luck
constexpr std::size_t kMostFitted = 150;
constexpr double kMostMoved = 1.5;  // px between frames, across the edge
constexpr double kBin = 0.2;        // px

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

struct Strong {
  cv::Point at;
  cv::Point2d slope;
};

// Where luma is steep, the steepest first.
std::vector<Strong> strong_places(const cv::Mat& grey) {
  cv::Mat gx, gy, size;
  cv::Sobel(grey, gx, CV_32F, 1, 0);
  cv::Sobel(grey, gy, CV_32F, 0, 1);
  cv::magnitude(gx, gy, size);
  std::vector<std::pair<float, cv::Point>> strong;
  for (int y = 16; y < grey.rows - 16; y += 2)
    for (int x = 16; x < grey.cols - 16; x += 2)
      if (const float g = size.at<float>(y, x); double(g) > 4 * kLeastStep / 2)
        strong.push_back({g, {x, y}});
  std::sort(strong.begin(), strong.end(), [](const auto& a, const auto& b) {
    return a.first != b.first
               ? a.first > b.first
               : std::pair(a.second.y, a.second.x) < std::pair(b.second.y, b.second.x);
  });
  std::vector<Strong> places;
  for (const auto& [strength, at] : strong)
    places.push_back({at, {double(gx.at<float>(at)), double(gy.at<float>(at))}});
  return places;
}

struct Side {  // of an edge
  double sum = 0, squares = 0;
  int count = 0;
  void add(double v) { sum += v, squares += v * v, ++count; }
  double mean() const { return sum / count; }
  double variance() const { return std::max(0.0, squares / count - mean() * mean()); }
};

struct Step {
  double low = 0, high = 0;                        // code values
  double width_px = 0;                             // standard deviation of its derivative
  std::vector<std::pair<double, double>> samples;  // place px from its middle, height 0..1
};

// Heights averaged by place, from -kHalf to kHalf.
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
  // Where the step has its middle; of a whole profile.
  double middle() const {
    double below = 0;
    for (std::size_t b = 0; b < kBins; ++b) below += kWide * (1 - sums_[b] / counts_[b]);
    return below - kHalf;
  }
  // By the integral of |height - step|: for a Gaussian sigma * sqrt(2 / pi).
  double width_px() const {
    double area = 0;
    for (std::size_t b = 0; b < kBins; ++b)
      area += kWide * std::abs(sums_[b] / counts_[b] - (b >= kBins / 2 ? 1 : 0));
    return area * std::sqrt(kPi / 2);
  }

 private:
  static constexpr double kHalf = 4, kWide = 0.25;
  static constexpr int kBins = static_cast<int>(2 * kHalf / kWide);
  std::array<double, kBins> sums_{};
  std::array<int, kBins> counts_{};
};

// What stands across an edge, if it is a clean step. Whole pixels alone, so that nothing is
// interpolated: the place is the pixel's own.
std::optional<Step> step_across(const cv::Mat& grey, const Found& line) {
  Step step;
  Side low, high;
  for (int t = -kAlong; t <= kAlong; ++t)
    for (double p = -kAcross; p <= kAcross; p += 0.5) {
      const double x = line.x - t * line.ny + p * line.nx;
      const double y = line.y + t * line.nx + p * line.ny;
      if (x < 1 || y < 1 || x >= grey.cols - 2 || y >= grey.rows - 2) return std::nullopt;
      const int ix = static_cast<int>(std::lround(x));
      const int iy = static_cast<int>(std::lround(y));
      const double v = grey.at<unsigned char>(iy, ix);
      const double place = (ix - line.x) * line.nx + (iy - line.y) * line.ny;
      step.samples.push_back({place, v});
      if (place < -kPlateau) low.add(v);
      if (place > kPlateau) high.add(v);
    }
  if (low.count < 10 || high.count < 10) return std::nullopt;
  step.low = low.mean(), step.high = high.mean();
  const double height = step.high - step.low;
  const double uneven = std::sqrt(std::max(low.variance(), high.variance()));
  if (height < kLeastStep || uneven > 0.08 * height || step.high > 248 || step.low < 4)
    return std::nullopt;
  Profile profile;
  for (auto& [place, v] : step.samples) {
    v = (v - step.low) / height;
    profile.add(place, v);
  }
  if (!profile.whole()) return std::nullopt;
  step.width_px = profile.width_px();
  const double middle = profile.middle();
  if (std::abs(middle) > 1.5) return std::nullopt;
  for (auto& [place, v] : step.samples) place -= middle;
  return step;
}

double moved_across(const Found& line, const Homography& frame_from_before) {
  const Pixel here(line.x + 0.5, line.y + 0.5);
  const Pixel before = apply(frame_from_before.inverse(), here);
  return std::abs((here.x() - before.x()) * line.nx + (here.y() - before.y()) * line.ny);
}

// Edges laid over one another, for the eye.
EdgeProfile profile_of(const std::vector<const StepEdge*>& edges,
                       const StepResponse& response,
                       const image::ToneCurve& tone) {
  constexpr int kBins = static_cast<int>(2 * kAcross / kBin);
  std::array<std::vector<double>, kBins> bins;
  std::vector<double> lows, highs;
  for (const StepEdge* edge : edges) {
    lows.push_back(edge->low), highs.push_back(edge->high);
    for (const auto& [place, height] : edge->samples) {
      const int bin = static_cast<int>(std::floor((place + kAcross) / kBin));
      if (bin >= 0 && bin < kBins) bins[static_cast<std::size_t>(bin)].push_back(height);
    }
  }
  EdgeProfile profile;
  profile.edges = static_cast<int>(edges.size());
  for (int b = 0; b < kBins; ++b) {
    auto& heights = bins[static_cast<std::size_t>(b)];
    if (heights.size() < 5) continue;
    profile.place_px.push_back((b + 0.5) * kBin - kAcross);
    profile.height.push_back(median(std::move(heights)));
  }
  profile.fitted = step_heights(response, median(lows), median(highs), profile.place_px, tone);
  return profile;
}

}  // namespace

void EdgeMeter::add(const image::Picture& frame,
                    const std::optional<Homography>& frame_from_before) {
  if (edges_.size() >= kMostEdges) return;
  const cv::Mat grey = motion::luma_of(frame);
  const image::ColourCode code(frame.colour);
  const double dark = double(code.ycc_from_rgb({0, 0, 0}).y);
  const double unit = double(code.ycc_from_rgb({1, 1, 1}).y) - dark;
  cv::Mat taken(grey.size(), CV_8UC1, cv::Scalar(0));
  int count = 0;
  for (const auto& [at, slope] : strong_places(grey)) {
    if (count >= kMostPerFrame) break;
    if (taken.at<unsigned char>(at) != 0) continue;
    cv::circle(taken, at, 8, cv::Scalar(255), cv::FILLED);
    const auto line = straight_edge(grey, at.x, at.y, slope.x, slope.y);
    if (!line) continue;
    auto step = step_across(grey, *line);
    if (!step) continue;
    Edge edge;
    edge.width_px = step->width_px;
    edge.step = {(step->low - dark) / unit, (step->high - dark) / unit, std::move(step->samples)};
    // The own aircraft's edges are as good as others for sharpness; its mask says that they do not
    // move.
    const bool own = own_aircraft_ != nullptr && !own_aircraft_->is_free(at.x, at.y);
    edge.moved_px = own                 ? 0
                    : frame_from_before ? moved_across(*line, *frame_from_before)
                                        : std::numeric_limits<double>::quiet_NaN();
    edges_.push_back(std::move(edge));
    ++count;
  }
}

std::vector<const StepEdge*> EdgeMeter::sharpest() const {
  std::vector<const Edge*> still;
  for (const Edge& edge : edges_)
    if (!(edge.moved_px > kMostMoved)) still.push_back(&edge);
  if (still.size() < kFewestEdges)
    for (const Edge& edge : edges_) still.push_back(&edge);
  std::sort(still.begin(), still.end(), [](const Edge* a, const Edge* b) {
    return a->width_px < b->width_px;
  });
  const std::size_t skip = still.size() / 100;  // narrower than the camera: luck
  const auto least =
      std::max(kFewestEdges / 2, static_cast<std::size_t>(kSharpestShare * double(still.size())));
  std::vector<const StepEdge*> sharpest;
  for (std::size_t i = skip; i < still.size() && sharpest.size() < kMostFitted; ++i) {
    if (sharpest.size() >= least && still[i]->width_px > kAsSharp * still[skip]->width_px) break;
    sharpest.push_back(&still[i]->step);
  }
  return sharpest;
}

std::optional<StepResponse> EdgeMeter::result(std::string& why) {
  if (edges_.size() < kFewestEdges) {
    why = "the clip shows " + std::to_string(edges_.size()) + " clean straight edges; it takes " +
          std::to_string(kFewestEdges);
    return std::nullopt;
  }
  const auto edges = sharpest();
  const StepResponse response = fit_step_response(edges, tone_);
  profile_ = profile_of(edges, response, tone_);
  return response;
}

}  // namespace airtruth::calibration
