// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/chroma.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "calibration/optics/edge_fit.h"
#include "foundation/base/median.h"
#include "foundation/geometry/transform.h"

namespace airtruth::optics {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// camera_slow_test.cpp, whose figures are in docs/realism.md.

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

}  // namespace

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

Measured<Estimate> chroma_spread(const std::vector<LumaAndChroma>& edges,
                                 std::size_t at_once,
                                 const StepResponse& response,
                                 const image::ToneCurve& tone) {
  std::vector<GatheredEdge> luma;
  for (const LumaAndChroma& edge : edges) luma.emplace_back(*edge.luma);
  const std::vector<EdgeFit> fits =
      fit_edges(luma, response.sharpening_px.value, response.sharpening.value, tone);
  std::vector<double> beyond;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const double luma_px = fits[e].spread_px;
    if (luma_px > kMaxLumaSpreadRatio * response.point_spread_px.value) continue;
    for (const double variance : *edges[e].chroma) beyond.push_back(variance - luma_px * luma_px);
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
  const double many = double(std::clamp<std::size_t>(at_once, 1, beyond.size()));
  // Error of the median of Gaussian values relative to the error of their mean.
  constexpr double kMedianErrorRatio = 1.25;
  return Estimate{root_at(50), kMedianErrorRatio * scatter / std::sqrt(many)};
}

}  // namespace airtruth::optics
