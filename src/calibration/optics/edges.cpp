// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "calibration/optics/edge_fit.h"
#include "foundation/image/colour.h"
#include "foundation/image/mats.h"

namespace airtruth::optics {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// camera_slow_test.cpp, whose figures are in docs/realism.md.

// Number of long edges from which on only long ones are used.
constexpr std::size_t kMinLong = 60;
// Number of edges that are kept: of one frame, of the clip, and the least number for a result.
constexpr int kMaxPerFrame = 60;
constexpr std::size_t kMaxEdges = 6000;
constexpr std::size_t kMinEdges = 12;
// Least distance between two edges of a frame, px.
constexpr int kMinDistancePx = 8;
// Largest width of an edge, as a multiple of that of the sharpest one. Only the most symmetric of
// these are used, since a line along one side of an edge looks like half an unsharp mask.
constexpr double kMaxWidthRatio = 1.4;
// Share of the edges that count as most symmetric, the least number of them, and the largest number
// that is fitted, which bounds the time.
constexpr double kSymmetricShare = 0.25;
constexpr std::size_t kMinSymmetric = 60;
constexpr std::size_t kMaxFitted = 150;
// Least height of an edge, in steps of the codec's quantiser, at which quantisation does not change
// its sharpness. In a transform of 8 x 8 samples a step of height h through a spread of 0.7 px has
// a coefficient of 0.55 h at a quarter of a cycle a pixel (closed form of the DCT-II); half a
// quantiser's step is a sixth of that.
constexpr double kMinHeightInCodecSteps = 6;
// Largest motion across an edge between frames, px. Faster edges are blurred by motion.
constexpr double kMaxMotionPx = 10;
// Edges within this distance, px, and this cosine of their directions (2 degrees) are one edge.
constexpr double kMaxOffsetOfSamePx = 1;
constexpr double kMinCosineOfSame = 0.9994;
// Cosine of the angle to an axis of the picture up to which an edge lies along it, 30 degrees.
constexpr double kMinCosineToAxis = 0.866;
// Mean relative excess of the spread of edges in the world over the sharpest. The sharpest of n
// different edges exceeds the camera's spread by 1 / n of it: the expected minimum of n exponential
// values.
constexpr double kMeanExcessInWorld = 0.7;
// Largest width of an edge that the camera limits, as a multiple of that of the sharpest one.
// Softer edges are soft in the world. Of clips that were blurred on purpose 0.2 to 0.7 of the edges
// are that narrow, of other real clips 0.04 to 0.13 but for one.
constexpr double kLimitedWidthRatio = 1.2;

// Adds to the error of a spread the chance that the sharpest edges are soft in the world, by the
// number of different edges that the camera limits.
void add_chance(Estimate& spread, double limited) {
  spread.sigma = std::hypot(spread.sigma, spread.value * kMeanExcessInWorld / limited);
}

double moved_across(const EdgeLine& line, const Homography& frame_from_before) {
  const Pixel here(line.x + 0.5, line.y + 0.5);
  const Pixel before = apply(frame_from_before.inverse(), here);
  return std::abs((here.x() - before.x()) * line.nx + (here.y() - before.y()) * line.ny);
}

// Distance from the edge up to which chroma samples are used, px.
constexpr double kReachPx = 10;
// Distance from the edge at which the two levels begin, px.
constexpr double kLevelFromPx = 6.5;
// Least height of a step, code values. A codec does not preserve the shape of smaller steps.
constexpr double kMinHeightCodes = 6;
// Largest standard deviation of a level, as a share of the height of the step.
constexpr double kMaxLevelDeviation = 0.2;
// Least number of chroma samples across an edge, for four unknowns.
constexpr std::size_t kMinSamples = 24;
// Largest standard deviation of a step, px. The levels of a wider step would begin beyond
// kLevelFromPx.
constexpr double kMaxStepWidthPx = 6;
// Largest spread of luma across an edge, as a multiple of the camera's. The spread of a softer edge
// is mostly that of the world.
constexpr double kMaxLumaSpreadRatio = 2;
// Least number of steps of Cb and Cr for a median with a useful error.
constexpr std::size_t kMinSteps = 12;
// Variance of a box of one pixel, px^2.
constexpr double kPixelVariance = 1.0 / 12;

struct Sample {
  double place = 0, value = 0;
};

// The mean of one level and the standard deviation about it.
struct Level {
  double mean = 0, deviation = 0;
};

std::optional<Level> level_of(const std::vector<Sample>& samples, bool high) {
  double sum = 0, squares = 0, count = 0;
  for (const Sample& s : samples)
    if ((high ? s.place : -s.place) > kLevelFromPx)
      sum += s.value, squares += s.value * s.value, count += 1;
  if (count < 4) return std::nullopt;
  return Level{sum / count, std::sqrt(std::max(0.0, squares / count - sum / count * sum / count))};
}

// The chroma grid along one axis. A chroma sample is a weighted mean of pixels
// (picture/composite/matte.h). `variance_px2` is the variance of that mean plus that of the box of
// one sample, over which the fitted Gaussian is integrated.
struct Grid {
  int log2_size = 0;
  // Place of the first sample.
  double first_px = 0;
  double variance_px2 = 0;
};

Grid grid_of(int log2_size, bool on_a_pixel) {
  if (log2_size == 0) return {0, 0, kPixelVariance};
  return on_a_pixel ? Grid{1, 0, 0.5 + 4 * kPixelVariance}
                    : Grid{1, 0.5, 0.25 + 4 * kPixelVariance};
}

std::vector<Sample> samples_across(const image::Plane& plane,
                                   const Grid& across,
                                   const Grid& down,
                                   const EdgeLine& line) {
  std::vector<Sample> samples;
  const double reach = std::hypot(kReachPx, line.half_length_px);
  const auto range = [&](double middle, const Grid& grid, int count) {
    const double size = 1 << grid.log2_size;
    return std::pair(std::max(0, static_cast<int>((middle - reach) / size)),
                     std::min(count - 1, static_cast<int>((middle + reach) / size)));
  };
  const auto [left, right] = range(line.x, across, plane.width);
  const auto [top, bottom] = range(line.y, down, plane.height);
  for (int cy = top; cy <= bottom; ++cy)
    for (int cx = left; cx <= right; ++cx) {
      const double x = across.first_px + (cx << across.log2_size) - line.x;
      const double y = down.first_px + (cy << down.log2_size) - line.y;
      const double place = x * line.nx + y * line.ny;
      if (std::abs(place) < kReachPx && std::abs(y * line.nx - x * line.ny) <= line.half_length_px)
        samples.push_back({place, double(plane.row(cy)[cx])});
    }
  return samples;
}

// Fits the two levels, the place and the width of a Gaussian step by Gauss-Newton; the levels are
// eliminated by variable projection (Golub and Pereyra 1973). Returns the variance.
std::optional<double> fitted(const std::vector<Sample>& samples) {
  // Bounds of the iteration: rounds; the change of place, px, and of the logarithm of the width in
  // one round, and the change that ends it; the distance of the step from the edge of luma, px.
  constexpr int kMaxRounds = 20;
  constexpr double kMaxChange = 0.4, kMinChange = 1e-3, kMaxPlacePx = 4;
  const auto count = static_cast<Eigen::Index>(samples.size());
  double place = 0, log_width = std::log(2.0);
  Eigen::MatrixXd slopes(count, 4);
  Eigen::VectorXd values(count);
  for (int round = 0; round < kMaxRounds; ++round) {
    const double width = std::exp(log_width);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Sample& s = samples[static_cast<std::size_t>(i)];
      const double z = (s.place - place) / width;
      const double bell = std::exp(-0.5 * z * z) / std::sqrt(2 * kPi);
      slopes.row(i) << 1, 0.5 * (1 + std::erf(z / std::sqrt(2.0))), -bell / width, -bell * z;
      values[i] = s.value;
    }
    Eigen::Matrix4d square = slopes.transpose() * slopes;
    square.diagonal().array() += 1e-9 * square.trace();
    const Eigen::Vector4d x = square.inverse() * (slopes.transpose() * values);
    if (std::abs(x[1]) < kMinHeightCodes / 2) return std::nullopt;
    const double shift = std::clamp(x[2] / x[1], -kMaxChange, kMaxChange);
    const double wider = std::clamp(x[3] / x[1], -kMaxChange, kMaxChange);
    place += shift, log_width += wider;
    if (std::abs(place) > kMaxPlacePx || log_width > std::log(kMaxStepWidthPx)) return std::nullopt;
    if (std::abs(shift) + std::abs(wider) <= kMinChange) return std::exp(2 * log_width);
  }
  return std::nullopt;
}

// Of the steps of Cb and Cr across the edge that are clean enough to fit, at most two: the variance
// of the Gaussian that fits the step best, minus the variance that the sampling grids add, in
// squared luma pixels. Empty for a picture without chroma.
std::vector<double> chroma_variances(const image::Picture& picture, const EdgeLine& line) {
  std::vector<double> variances;
  const image::Colour& colour = picture.colour;
  if (picture.plane_count == 1 || colour.matrix == image::Matrix::kRgb) return variances;
  const Grid across =
      grid_of(image::log2_chroma_width(colour.chroma), colour.siting != image::Siting::kCenter);
  const Grid down =
      grid_of(image::log2_chroma_height(colour.chroma), colour.siting == image::Siting::kTopLeft);
  for (const std::size_t p : {1U, 2U}) {
    const std::vector<Sample> samples = samples_across(picture.planes[p], across, down, line);
    const auto low = level_of(samples, false), high = level_of(samples, true);
    if (!low || !high || samples.size() < kMinSamples) continue;
    const double height = std::abs(high->mean - low->mean);
    if (height < kMinHeightCodes ||
        std::max(low->deviation, high->deviation) > kMaxLevelDeviation * height)
      continue;
    if (const auto variance = fitted(samples))
      variances.push_back(*variance - (line.nx * line.nx * across.variance_px2 +
                                       line.ny * line.ny * down.variance_px2 + 2 * kPixelVariance));
  }
  return variances;
}

}  // namespace

void EdgeMeter::add(const image::Picture& frame,
                    const std::optional<Homography>& frame_from_before) {
  if (edges_.size() >= kMaxEdges) return;
  const cv::Mat grey = image::luma_of(frame);
  const image::ColourCode code(frame.colour);
  const double dark = double(code.ycc_from_rgb({0, 0, 0}).y);
  const double unit = double(code.ycc_from_rgb({1, 1, 1}).y) - dark;
  cv::Mat taken(grey.size(), CV_8UC1, cv::Scalar(0));
  int count = 0;
  std::size_t with_chroma = 0;
  for (const SteepPlace& place : steep_places(grey)) {
    if (count >= kMaxPerFrame) break;
    const cv::Point at = place.at;
    if (taken.at<unsigned char>(at) != 0) continue;
    auto found = straight_step_at(grey, place, dark, dark + unit);
    const double half_length = found ? found->line.half_length_px : 0;
    const cv::Point along = found ? cv::Point(static_cast<int>(half_length * found->line.ny),
                                              static_cast<int>(-half_length * found->line.nx))
                                  : cv::Point(0, 0);
    cv::line(taken, at - along, at + along, cv::Scalar(255), 2 * kMinDistancePx);
    if (!found) continue;
    // Edges of the own aircraft are as useful for sharpness as others; the mask shows that they do
    // not move.
    const bool own = own_aircraft_ != nullptr && !own_aircraft_->is_free(at.x, at.y);
    Edge edge{std::move(*found)};
    edge.height = edge.step.high - edge.step.low;
    for (double* level : {&edge.step.low, &edge.step.high}) *level = (*level - dark) / unit;
    edge.moved_px = own                 ? 0
                    : frame_from_before ? moved_across(edge.line, *frame_from_before)
                                        : std::numeric_limits<double>::quiet_NaN();
    if (is_known(edge)) continue;
    edge.chroma = chroma_variances(frame, edge.line);
    with_chroma += edge.chroma.empty() ? 0 : 1;
    edges_.push_back(std::move(edge));
    ++count;
  }
  most_at_once_ = std::max(most_at_once_, count);
  most_chroma_at_once_ = std::max(most_chroma_at_once_, with_chroma);
}

bool EdgeMeter::is_known(const Edge& edge) const {
  return std::any_of(edges_.begin(), edges_.end(), [&](const Edge& known) {
    const EdgeLine &a = edge.line, &b = known.line;
    const double dx = a.x - b.x, dy = a.y - b.y;
    return std::abs(dx * b.nx + dy * b.ny) < kMaxOffsetOfSamePx &&
           std::hypot(dx, dy) < 2 * kLongEdgePx && a.nx * b.nx + a.ny * b.ny > kMinCosineOfSame;
  });
}

std::vector<const EdgeMeter::Edge*> EdgeMeter::usable(double codec_step) const {
  std::vector<const Edge*> all, slow, clear, long_ones;
  for (const Edge& edge : edges_) {
    all.push_back(&edge);
    if (edge.moved_px > kMaxMotionPx) continue;
    slow.push_back(&edge);
    if (edge.height >= kMinHeightInCodecSteps * codec_step) clear.push_back(&edge);
  }
  if (slow.size() < kMinEdges) return all;
  const std::vector<const Edge*>& chosen = clear.size() >= kMinSymmetric ? clear : slow;
  for (const Edge* edge : chosen)
    if (edge->line.half_length_px == kLongEdgePx) long_ones.push_back(edge);
  return long_ones.size() >= kMinLong ? long_ones : chosen;
}

std::vector<const EdgeMeter::Edge*> EdgeMeter::by_width(std::vector<const Edge*> edges) {
  std::ranges::sort(edges, {}, &Edge::width_px);
  // The sharpest hundredth is dropped: these edges are accidentally narrower than the camera's.
  edges.erase(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 100));
  return edges;
}

double EdgeMeter::share_limited(const std::vector<const Edge*>& by_width) {
  const double widest_px = kLimitedWidthRatio * by_width[0]->width_px;
  const auto end = std::ranges::upper_bound(by_width, widest_px, {}, &Edge::width_px);
  return double(end - by_width.begin()) / double(by_width.size());
}

std::vector<const StepEdge*> EdgeMeter::sharp_ones(std::vector<const Edge*> edges) {
  const auto keep = [&](std::size_t count, std::size_t fewest) {
    edges.resize(std::min(edges.size(), std::max(count, fewest)));
  };
  const double widest_px = kMaxWidthRatio * edges[0]->width_px;
  const auto wider = std::ranges::lower_bound(edges, widest_px, {}, &Edge::width_px);
  keep(static_cast<std::size_t>(wider - edges.begin()), kMinSymmetric);
  std::ranges::sort(edges, {}, &Edge::asymmetry);
  keep(static_cast<std::size_t>(kSymmetricShare * double(edges.size())), kMinSymmetric);
  edges.resize(std::min(edges.size(), kMaxFitted));
  std::vector<const StepEdge*> sharp;
  for (const Edge* edge : edges) sharp.push_back(&edge->step);
  return sharp;
}

Measured<StepResponse> EdgeMeter::result(double codec_step) {
  if (edges_.size() < kMinEdges)
    return NotMeasured{"the clip shows " + std::to_string(edges_.size()) +
                       " clean straight edges; it takes " + std::to_string(kMinEdges)};
  const std::vector<const Edge*> all = usable(codec_step);
  const std::vector<const Edge*> sharpest_first = by_width(all);
  const auto edges = sharp_ones(sharpest_first);
  StepResponse response = fit_step_response(edges, tone_);
  add_chance(response.point_spread_px, share_limited(sharpest_first) * most_at_once_);
  part_by_axis(response, all);
  profile_ = edge_profile(edges, response, tone_);
  return response;
}

Estimate EdgeMeter::spread_by(const std::vector<const Edge*>& sharpest_first,
                              const StepResponse& mask) const {
  Estimate spread = camera_spread_px(sharp_ones(sharpest_first), mask, tone_);
  add_chance(spread,
             share_limited(sharpest_first) * most_at_once_ * double(sharpest_first.size()) /
                 double(edges_.size()));
  return spread;
}

void EdgeMeter::part_by_axis(StepResponse& response, const std::vector<const Edge*>& edges) const {
  std::vector<const Edge*> along_rows, along_columns;
  for (const Edge* edge : edges) {
    if (std::abs(edge->line.ny) > kMinCosineToAxis) along_rows.push_back(edge);
    if (std::abs(edge->line.nx) > kMinCosineToAxis) along_columns.push_back(edge);
  }
  if (std::min(along_rows.size(), along_columns.size()) < kMinEdges) {
    response.vertical_spread_px =
        NotMeasured{fmt::format("the clip shows {} clean edges along its rows and {} along its "
                                "columns; it takes {} of each",
                                along_rows.size(),
                                along_columns.size(),
                                kMinEdges)};
    return;
  }
  const Estimate down = spread_by(by_width(std::move(along_rows)), response);
  const Estimate across = spread_by(by_width(std::move(along_columns)), response);
  const double variance = down.value * down.value - across.value * across.value;
  const double error = 2 * std::hypot(down.value * down.sigma, across.value * across.sigma);
  if (variance < 2 * error) {
    response.vertical_spread_px = Estimate{0, std::sqrt(error)};
    return;
  }
  response.point_spread_px = across;
  response.vertical_spread_px = Estimate{std::sqrt(variance), error / (2 * std::sqrt(variance))};
}

Measured<Estimate> EdgeMeter::chroma(const StepResponse& response, double codec_step) const {
  std::vector<const Edge*> edges = usable(codec_step);
  std::erase_if(edges, [](const Edge* edge) { return edge->chroma.empty(); });
  std::vector<GatheredEdge> luma;
  for (const Edge* edge : edges) luma.emplace_back(edge->step);
  const std::vector<EdgeFit> fits =
      fit_edges(luma, response.sharpening_px.value, response.sharpening.value, tone_);
  std::vector<double> beyond;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const double luma_px = fits[e].spread_px;
    if (luma_px > kMaxLumaSpreadRatio * response.point_spread_px.value) continue;
    for (const double variance : edges[e]->chroma) beyond.push_back(variance - luma_px * luma_px);
  }
  if (beyond.size() < kMinSteps)
    return NotMeasured{
        fmt::format("the clip shows {} sharp edges with a clean step of colour; it takes {}",
                    beyond.size(),
                    kMinSteps)};
  std::sort(beyond.begin(), beyond.end());
  const auto root_at = [&](std::size_t percent) {
    return std::sqrt(std::max(0.0, beyond[beyond.size() * percent / 100]));
  };
  const double scatter = (root_at(84) - root_at(16)) / 2;
  const double many = double(std::clamp<std::size_t>(most_chroma_at_once_, 1, beyond.size()));
  // Error of the median of Gaussian values relative to the error of their mean.
  constexpr double kMedianErrorRatio = 1.25;
  return Estimate{root_at(50), kMedianErrorRatio * scatter / std::sqrt(many)};
}

}  // namespace airtruth::optics
