// SPDX-License-Identifier: Apache-2.0
#include "measure/optics/edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "camera/motion/corners.h"
#include "foundation/base/median.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"

namespace airtruth::calibration {
namespace {

// Half the length of an edge, px. The profile of a long edge is less affected by what happens to
// lie beside the edge, but not every clip has enough long edges.
constexpr int kLong = 15, kShort = 5;
constexpr std::size_t kEnoughLong = 60;
// Half the width of the profile of an edge, px.
constexpr double kAcross = 6;
// Distance from the edge at which its two levels begin, px.
constexpr double kPlateau = 3.5;
// Least height of a step, code values.
constexpr double kLeastStep = 24;
// Largest deviation of the places along an edge from a straight line, px.
constexpr double kStraight = 0.2;
constexpr int kMostPerFrame = 60;
// Least distance between two edges, px.
constexpr int kApart = 8;
constexpr std::size_t kMostEdges = 6000;
constexpr std::size_t kFewestEdges = 12;
// Sharp edges are those up to kSharp times as wide as the sharpest one. Only the most symmetric of
// them are used, since a line along one side of an edge looks like half an unsharp mask.
constexpr double kSharp = 1.4;
constexpr double kSymmetricShare = 0.25;
constexpr std::size_t kFewestSymmetric = 60;
constexpr std::size_t kMostFitted = 150;
// Least height of an edge, in steps of the codec's quantiser, at which quantisation does not change
// its sharpness. In a transform of 8 x 8 samples a step of height h through a spread of 0.7 px has
// a coefficient of 0.55 h at a quarter of a cycle a pixel (closed form of the DCT-II); half a
// quantiser's step is a sixth of that.
constexpr double kStepsForSharpness = 6;
// The profile for the plots shows edges with a spread up to kShown times the camera's.
constexpr double kShown = 1.1;
constexpr std::size_t kFewestShown = 8;
// Largest motion across an edge between frames, px. Faster edges are blurred by motion.
constexpr double kMostMoved = 10;
// Edges within this distance, px, and this cosine of their directions (2 degrees) are one edge.
constexpr double kSamePlace = 1;
constexpr double kSameDirection = 0.9994;
// Width of the bins of a profile, px.
constexpr double kBin = 0.2;
// Mean relative excess of the spread of edges in the world over the sharpest. The sharpest of n
// different edges exceeds the camera's spread by 1 / n of it: the expected minimum of n exponential
// values.
constexpr double kSofterInWorld = 0.7;

struct Found {
  double x, y;    // a point on the edge
  double nx, ny;  // unit vector across the edge, towards the bright side
};

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

// A straight line through the places of the edge on the neighbouring rows (or columns); empty if
// the edge is not straight.
std::optional<Found> straight_edge(
    const cv::Mat& grey, int x, int y, double gx, double gy, int half_length) {
  // If the step is along x, the walk along the edge is along y.
  const bool along_x = std::abs(gx) >= std::abs(gy);
  double n = 0, sum_t = 0, sum_p = 0, sum_tt = 0, sum_tp = 0, sum_pp = 0;
  // Slope of the edge: change of place per row (or column).
  const double slope = along_x ? -gy / gx : -gx / gy;
  if (std::abs(slope) > 1) return std::nullopt;
  for (int t = -half_length; t <= half_length; ++t) {
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

// The places with a steep gradient of luma, the steepest first.
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

// Sums of one side of an edge.
struct Side {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double v) { sum += v, squares += v * v, ++count; }
  double mean() const { return sum / count; }
  double variance() const { return std::max(0.0, squares / count - mean() * mean()); }
};

struct Step {
  double low = 0, high = 0;                        // code values
  double width_px = 0;                             // standard deviation of the derivative
  double asymmetry = 0;                            // rms difference of the two halves, heights
  std::vector<std::pair<double, double>> samples;  // place, px from the middle; height 0 to 1
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
    double squares = 0;
    for (std::size_t b = 0; b < kBins / 2; ++b) {
      const std::size_t o = kBins - 1 - b;
      const double off = sums_[b] / counts_[b] + sums_[o] / counts_[o] - 1;
      squares += off * off;
    }
    return std::sqrt(squares / (kBins / 2));
  }
  // The width from the integral of |height - step|, which is sigma * sqrt(2 / pi) for a Gaussian.
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

// The step across an edge; empty if it is not clean. The samples are whole pixels at their own
// places, so that nothing is interpolated.
std::optional<Step> step_across(const cv::Mat& grey, const Found& line, int half_length) {
  Step step;
  Side low, high;
  for (int t = -half_length; t <= half_length; ++t)
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
  Profile centred;
  for (auto& [place, v] : step.samples) {
    place -= middle;
    centred.add(place, v);
  }
  if (!centred.whole()) return std::nullopt;
  step.asymmetry = centred.asymmetry();
  return step;
}

struct FoundStep {
  Found line;
  Step step;
  int half_length = 0;
};

// The step over the longest usable length of the edge.
std::optional<FoundStep> step_at(const cv::Mat& grey, const Strong& place) {
  for (const int half_length : {kLong, kShort}) {
    const auto line =
        straight_edge(grey, place.at.x, place.at.y, place.slope.x, place.slope.y, half_length);
    if (!line) continue;
    if (auto step = step_across(grey, *line, half_length))
      return FoundStep{*line, std::move(*step), half_length};
  }
  return std::nullopt;
}

double moved_across(const Found& line, const Homography& frame_from_before) {
  const Pixel here(line.x + 0.5, line.y + 0.5);
  const Pixel before = apply(frame_from_before.inverse(), here);
  return std::abs((here.x() - before.x()) * line.nx + (here.y() - before.y()) * line.ny);
}

// The edges whose spread is mostly the camera's; at least the sharpest kFewestShown ones.
std::vector<const StepEdge*> nearest_to_camera(const std::vector<const StepEdge*>& edges,
                                               const StepResponse& response) {
  std::vector<double> sorted = response.edge_spreads_px;
  std::sort(sorted.begin(), sorted.end());
  const double fewest_px = sorted[std::min(kFewestShown, sorted.size()) - 1];
  const double most_px = std::max(fewest_px, kShown * response.point_spread_px.value);
  std::vector<const StepEdge*> nearest;
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (response.edge_spreads_px[e] <= most_px) nearest.push_back(edges[e]);
  return nearest;
}

// The mean profile of the edges, for the plots.
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
  for (int b = 0; b < kBins; ++b) {
    auto& heights = bins[static_cast<std::size_t>(b)];
    if (heights.size() < 5) continue;
    profile.place_px.push_back((b + 0.5) * kBin - kAcross);
    profile.height.push_back(median(std::move(heights)));
  }
  const double low = median(std::move(lows)), high = median(std::move(highs));
  profile.fitted = step_heights(response, low, high, profile.place_px, tone);
  profile.spread_px = edge_spread_px(response, low, high, tone);
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
  std::size_t with_chroma = 0;
  for (const Strong& place : strong_places(grey)) {
    if (count >= kMostPerFrame) break;
    const cv::Point at = place.at;
    if (taken.at<unsigned char>(at) != 0) continue;
    auto found = step_at(grey, place);
    const cv::Point along = found
                                ? cv::Point(static_cast<int>(found->half_length * found->line.ny),
                                            static_cast<int>(-found->half_length * found->line.nx))
                                : cv::Point(0, 0);
    cv::line(taken, at - along, at + along, cv::Scalar(255), 2 * kApart);
    if (!found) continue;
    Step& step = found->step;
    Edge edge;
    edge.width_px = step.width_px;
    edge.asymmetry = step.asymmetry;
    edge.height = step.high - step.low;
    edge.is_long = found->half_length == kLong;
    edge.step = {(step.low - dark) / unit, (step.high - dark) / unit, std::move(step.samples)};
    // Edges of the own aircraft are as useful for sharpness as others; the mask shows that they do
    // not move.
    const bool own = own_aircraft_ != nullptr && !own_aircraft_->is_free(at.x, at.y);
    edge.moved_px = own                 ? 0
                    : frame_from_before ? moved_across(found->line, *frame_from_before)
                                        : std::numeric_limits<double>::quiet_NaN();
    edge.x = found->line.x, edge.y = found->line.y;
    edge.nx = found->line.nx, edge.ny = found->line.ny;
    if (is_known(edge)) continue;
    edge.chroma =
        chroma_steps(frame, {edge.x, edge.y, edge.nx, edge.ny, double(found->half_length)});
    with_chroma += edge.chroma.empty() ? 0 : 1;
    edges_.push_back(std::move(edge));
    ++count;
  }
  most_at_once_ = std::max(most_at_once_, count);
  most_chroma_at_once_ = std::max(most_chroma_at_once_, with_chroma);
}

// Whether the edge was added before. An edge that stays at its place in the picture, such as one of
// the own aircraft, is the same edge in all frames.
bool EdgeMeter::is_known(const Edge& edge) const {
  return std::any_of(edges_.begin(), edges_.end(), [&](const Edge& known) {
    const double dx = edge.x - known.x, dy = edge.y - known.y;
    return std::abs(dx * known.nx + dy * known.ny) < kSamePlace && std::hypot(dx, dy) < 2 * kLong &&
           edge.nx * known.nx + edge.ny * known.ny > kSameDirection;
  });
}

std::vector<const EdgeMeter::Edge*> EdgeMeter::usable(double codec_step) const {
  std::vector<const Edge*> all, slow, clear, long_ones;
  for (const Edge& edge : edges_) {
    all.push_back(&edge);
    if (edge.moved_px > kMostMoved) continue;
    slow.push_back(&edge);
    if (edge.height >= kStepsForSharpness * codec_step) clear.push_back(&edge);
  }
  if (slow.size() < kFewestEdges) return all;
  const std::vector<const Edge*>& chosen = clear.size() >= kFewestSymmetric ? clear : slow;
  std::copy_if(chosen.begin(), chosen.end(), std::back_inserter(long_ones), [](const Edge* edge) {
    return edge->is_long;
  });
  return long_ones.size() >= kEnoughLong ? long_ones : chosen;
}

std::vector<const StepEdge*> EdgeMeter::sharp_ones(double codec_step) const {
  std::vector<const Edge*> edges = usable(codec_step);
  const auto keep = [&](std::size_t count, std::size_t fewest) {
    edges.resize(std::min(edges.size(), std::max(count, fewest)));
  };
  const auto narrower_than = [&](double width_px) {
    return static_cast<std::size_t>(std::count_if(
        edges.begin(), edges.end(), [&](const Edge* edge) { return edge->width_px < width_px; }));
  };
  const auto by_width = [](const Edge* a, const Edge* b) { return a->width_px < b->width_px; };
  const auto by_asymmetry = [](const Edge* a, const Edge* b) {
    return a->asymmetry < b->asymmetry;
  };
  std::sort(edges.begin(), edges.end(), by_width);
  // The sharpest hundredth is dropped: these edges are accidentally narrower than the camera's.
  edges.erase(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 100));
  keep(narrower_than(kSharp * edges[0]->width_px), kFewestSymmetric);
  std::sort(edges.begin(), edges.end(), by_asymmetry);
  keep(static_cast<std::size_t>(kSymmetricShare * double(edges.size())), kFewestSymmetric);
  edges.resize(std::min(edges.size(), kMostFitted));
  std::vector<const StepEdge*> sharp;
  for (const Edge* edge : edges) sharp.push_back(&edge->step);
  return sharp;
}

std::optional<StepResponse> EdgeMeter::result(std::string& why, double codec_step) {
  if (edges_.size() < kFewestEdges) {
    why = "the clip shows " + std::to_string(edges_.size()) + " clean straight edges; it takes " +
          std::to_string(kFewestEdges);
    return std::nullopt;
  }
  const auto edges = sharp_ones(codec_step);
  StepResponse response = fit_step_response(edges, tone_);
  Estimate& spread = response.point_spread_px;
  spread.sigma = std::hypot(spread.sigma, spread.value * kSofterInWorld / most_at_once_);
  profile_ = profile_of(nearest_to_camera(edges, response), response, tone_);
  profile_.edges = static_cast<int>(edges.size());
  return response;
}

std::optional<Estimate> EdgeMeter::chroma(const StepResponse& response,
                                          std::string& why,
                                          double codec_step) const {
  std::vector<LumaAndChroma> both;
  for (const Edge* edge : usable(codec_step))
    if (!edge->chroma.empty()) both.push_back({&edge->step, &edge->chroma});
  return chroma_spread(both, most_chroma_at_once_, response, tone_, why);
}

}  // namespace airtruth::calibration
