// SPDX-License-Identifier: Apache-2.0
#include "calibration/sensor/readout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calibration/sensor/blur.h"
#include "foundation/base/median.h"

namespace airtruth::sensor {
namespace {

// The shear that errors of the corners cause (0.2 px, 100 corners, at a mean distance of 200 px
// from the middle, averaged over some 5 frames). Frames that are copies of one another, and a
// camera on a tripod, have a smaller shear, and do not show that the readout time is small.
constexpr double kShearNoise = 5e-5;
// Least number of frames of known motion. That is two seconds of video at 30 frames/s.
constexpr std::size_t kMinFrames = 60;
// Residual at which a frame has a quarter of its weight, in median residuals.
constexpr double kScaleInMedians = 3;
// Largest standard error, and largest magnitude, of a share of the frame interval that is returned.
// A sensor cannot be read for longer than one interval; the rest allows for the error.
constexpr double kMaxShareError = 0.15;
constexpr double kMaxShare = 1.2;

// A low-pass filter with binomial weights. It removes what is faster than a third of the frame
// rate, where the differentiator is no longer exact. NaN if a neighbour is NaN.
double slow_part(const std::vector<double>& values, std::size_t k) {
  // Binomial weights, whose sum is 256.
  constexpr std::array<double, 9> kWeights = {1, 8, 28, 56, 70, 56, 28, 8, 1};
  double sum = 0;
  for (std::size_t i = 0; i < kWeights.size(); ++i)
    sum += k + i >= 4 && k + i - 4 < values.size() ? kWeights[i] * values[k + i - 4]
                                                   : std::numeric_limits<double>::quiet_NaN();
  return sum / 256;
}

struct Move {
  // Motion of the centre of the picture.
  Pixel moved;
  // The part of the shear that a rotation of the picture does not explain.
  double shear;
  // The part of the vertical stretch that a zoom does not explain.
  double stretch;
};

std::optional<Move> move_of(const std::optional<Homography>& h, const Pixel& centre) {
  if (!h) return std::nullopt;
  const double d = centre.norm() / 8;
  const Pixel middle = apply(*h, centre);
  const Pixel right = (apply(*h, centre + Pixel(d, 0)) - apply(*h, centre - Pixel(d, 0))) / (2 * d);
  const Pixel down = (apply(*h, centre + Pixel(0, d)) - apply(*h, centre - Pixel(0, d))) / (2 * d);
  return Move{middle - centre, down.x() + right.y(), down.y() - right.x()};
}

using Pairs = std::vector<std::pair<double, double>>;

// Appends, for the frames of one shot, the change of speed over the height of the picture together
// with the shear and the stretch.
void add_pairs(const Steps& steps, const Pixel& centre, Pairs& pairs) {
  // Shear (0) and stretch (1) of each frame; NaN if not known.
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  std::array<std::vector<double>, 2> changes, bends;
  // The summed motion of the centre; an unknown step counts as no motion.
  std::vector<Pixel> places;
  for (const auto& step : steps) {
    const auto here = move_of(step, centre);
    const Pixel moved = here ? here->moved : Pixel(0, 0);
    places.push_back(places.empty() ? moved : Pixel(places.back() + moved));
  }
  for (std::size_t k = 1; k < steps.size(); ++k) {
    const auto here = move_of(steps[k], centre);
    const auto before = rate_at(places, k - 1);
    const auto now = rate_at(places, k);
    const bool known = here && before && now;
    const Pixel change =
        known ? Pixel((*now - *before) / (2 * centre.y())) : Pixel(unknown, unknown);
    changes[0].push_back(change.x()), changes[1].push_back(change.y());
    bends[0].push_back(known ? here->shear : unknown);
    bends[1].push_back(known ? here->stretch : unknown);
  }
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (std::size_t k = 0; k < changes[axis].size(); ++k) {
      const double x = slow_part(changes[axis], k);
      const double y = slow_part(bends[axis], k);
      if (std::isfinite(x) && std::isfinite(y)) pairs.push_back({x, y});
    }
}

// A robust line through the origin: least squares with the weights of Geman and McClure (1985).
Estimate line_through_origin(const Pairs& pairs) {
  // Rounds of reweighting.
  constexpr int kRounds = 12;
  double slope = 0, error = 0, scale = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    double sxx = 0, sxy = 0, rest = 0, n = 0;
    std::vector<double> off;
    for (const auto& [x, y] : pairs) {
      const double e = (y - slope * x) / scale;
      const double w = 1 / ((1 + e * e) * (1 + e * e));
      sxx += w * x * x, sxy += w * x * y;
      rest += w * (y - slope * x) * (y - slope * x), n += w;
      off.push_back(std::abs(y - slope * x));
    }
    if (!(sxx > 0)) break;
    slope = sxy / sxx;
    error = std::sqrt(std::max(rest / n, kShearNoise * kShearNoise) / sxx);
    scale = kScaleInMedians * std::max(median(std::move(off)), kShearNoise);
  }
  return {slope, error};
}

}  // namespace

Measured<Estimate> readout_share(const std::vector<Steps>& shots, int width, int height) {
  Pairs pairs;
  for (const Steps& shot : shots) add_pairs(shot, {width / 2.0, height / 2.0}, pairs);
  if (pairs.size() < kMinFrames) return NotMeasured{"the motion of too few frames is known"};
  const Estimate share = line_through_origin(pairs);
  if (!(share.sigma > 0) || share.sigma > kMaxShareError)
    return NotMeasured{"the picture's speed changes too little from frame to frame"};
  if (std::abs(share.value) > kMaxShare)
    return NotMeasured{"the picture's shear follows its speed by more than a whole frame would"};
  return share;
}

}  // namespace airtruth::sensor
