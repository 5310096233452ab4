// SPDX-License-Identifier: Apache-2.0
#include "calibration/sensor/shutter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "camera/motion/shake.h"
#include "foundation/base/median.h"
#include "foundation/image/mats.h"

namespace airtruth::sensor {
namespace {

// Where a constant of the exposure states no origin, it was chosen on the virtual flights of
// camera_slow_test.cpp, whose figures are in docs/realism.md.

// Frames whose crops are kept, and the size of a crop, px: they bound memory to 300 x 448 x 336
// bytes.
constexpr std::size_t kMaxFrames = 300;
constexpr int kCropWidth = 448;
constexpr int kCropHeight = 336;
// Least speed of a frame in motion, px per frame.
constexpr double kMinMovingSpeed = 4;
// Largest speed of a frame at rest, as a share of the speed of the frame in motion.
constexpr double kMaxRestSpeedShare = 0.35;
// Largest distance between the two, frames.
constexpr std::size_t kMaxFramesApart = 4;
// Largest and least number of pairs of a frame in motion and a frame at rest: the largest bounds
// the time.
constexpr std::size_t kMaxPairs = 60;
constexpr std::size_t kMinPairs = 8;
// Largest length of a blur that is tried, as a multiple of the motion in one frame interval.
constexpr double kMaxLengthShare = 1.3;
// Error that all pairs share, as a share of the interval and of the value: the scatter of virtual
// flights (docs/calibration/shutter.md). The codec takes detail from frames in motion, too.
constexpr double kSharedError = 0.04;
constexpr double kSharedRelativeError = 0.1;
// Least share of the interval that is measured, in standard errors: below it the frames in motion
// are as sharp as those at rest.
constexpr double kMinShareInErrors = 2;

// The picture without the detail that noise dominates.
cv::Mat softened(const cv::Mat& grey) {
  cv::Mat soft;
  cv::GaussianBlur(grey, soft, {}, 1.0);
  return soft;
}

// Energy of the gradients of a softened picture along a direction divided by that across it.
double slope_ratio(const cv::Mat& soft, const Pixel& along) {
  cv::Mat gx, gy;
  cv::Sobel(soft, gx, CV_32F, 1, 0);
  cv::Sobel(soft, gy, CV_32F, 0, 1);
  const double xx = gx.dot(gx), xy = gx.dot(gy), yy = gy.dot(gy);
  const double c = along.x(), s = along.y();
  return (c * c * xx + 2 * c * s * xy + s * s * yy) /
         std::max(1e-6, c * c * yy - 2 * c * s * xy + s * s * xx);
}

// Weights of cubic convolution (Keys 1981, a = -1/2) for four pixels, from the one before the place
// to the second one after it. Linear interpolation would blur.
std::array<double, 4> cubic(double f) {
  return {((-0.5 * f + 1) * f - 0.5) * f,
          (1.5 * f - 2.5) * f * f + 1,
          ((-1.5 * f + 2) * f + 0.5) * f,
          (0.5 * f - 0.5) * f * f};
}

// The picture blurred along a straight line of the given length.
cv::Mat blurred(const cv::Mat& grey, const Pixel& along, double length_px) {
  if (length_px < 0.05) return grey;
  const int half = static_cast<int>(std::ceil(length_px / 2)) + 2;
  cv::Mat kernel(2 * half + 1, 2 * half + 1, CV_32F, cv::Scalar(0));
  // Points along the line.
  constexpr int kPoints = 64;
  for (int i = 0; i < kPoints; ++i) {
    const Pixel p = along * length_px * ((i + 0.5) / kPoints - 0.5);
    const int x = static_cast<int>(std::floor(p.x()));
    const int y = static_cast<int>(std::floor(p.y()));
    const std::array<double, 4> wx = cubic(p.x() - x), wy = cubic(p.y() - y);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k)
        kernel.at<float>(half + y + j - 1, half + x + k - 1) += static_cast<float>(
            wx[static_cast<std::size_t>(k)] * wy[static_cast<std::size_t>(j)] / kPoints);
  }
  cv::Mat result;
  cv::filter2D(grey, result, CV_32F, kernel);
  return result;
}

// The length of the blur that gives the softened still picture the gradient ratio of the moving
// one; empty if no length up to `most_px` does. The method is the false position of Dowell and
// Jarratt (1971, "Illinois") in the square of the length, of which the ratio is nearly a linear
// function.
std::optional<double> length_of(const cv::Mat& still,
                                const cv::Mat& moving,
                                const Pixel& along,
                                double most_px) {
  // Largest error of the length as a share of `most_px`, and the number of rounds, which ends an
  // iteration that does not converge.
  constexpr double kMaxError = 1.0 / 512;
  constexpr int kMaxRounds = 9;
  const double wanted = slope_ratio(moving, along);
  const auto excess = [&](double squared_px) {
    return slope_ratio(blurred(still, along, std::sqrt(squared_px)), along) - wanted;
  };
  double low = 0, above = excess(0);
  if (above <= 0) return 0.0;
  double high = most_px * most_px, below = excess(high);
  if (below > 0) return std::nullopt;
  double found = high;
  for (int round = 0, same = 0; round < kMaxRounds && below < 0; ++round) {
    const double before = found;
    found = low + (high - low) * above / (above - below);
    if (std::abs(std::sqrt(found) - std::sqrt(before)) < kMaxError * most_px) break;
    const double here = excess(found);
    const int side = here > 0 ? 1 : -1;
    if (side > 0) {
      low = found, above = here;
      if (same == side) below /= 2;
    } else {
      high = found, below = here;
      if (same == side) above /= 2;
    }
    same = side;
  }
  return std::sqrt(found);
}

// The derivative of evenly spaced samples at index k, in pixels per sample, by the differentiator
// of shake.h, which is accurate to near the Nyquist frequency. Empty within kReach of either end.
std::optional<Pixel> rate_at(const std::vector<Pixel>& places, std::size_t k) {
  // Half the length of the differentiator, frames.
  constexpr int kReach = 12;
  if (k < kReach || k + kReach >= places.size()) return std::nullopt;
  Pixel rate = Pixel::Zero();
  for (int j = 1; j <= kReach; ++j) {
    rate += motion::differentiator_weight(j, kReach) *
            (places[k + static_cast<std::size_t>(j)] - places[k - static_cast<std::size_t>(j)]);
  }
  return rate;
}

}  // namespace

void BlurMeter::add(const image::Picture& frame, const std::optional<Pixel>& moved) {
  if (frames_++ >= kMaxFrames) return;
  Shot& shot = shots_.back();
  const Pixel before = shot.places.empty() ? Pixel(0, 0) : shot.places.back();
  shot.places.push_back(before + moved.value_or(Pixel(0, 0)));
  shot.known.push_back(moved.has_value());
  const cv::Mat luma = image::luma_of(frame);
  const int width = std::min(kCropWidth, luma.cols);
  const int height = std::min(kCropHeight, luma.rows);
  const int x0 = (luma.cols - width) / 2;
  const int y0 = (luma.rows - height) / 2;
  cv::Mat crop = luma(cv::Rect(x0, y0, width, height)).clone();
  const double sum = cv::sum(crop)[0];
  // The shake of the camera does not blur the own aircraft, so its pixels are set to the mean.
  if (own_aircraft_ != nullptr)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (!own_aircraft_->is_free(x0 + x, y0 + y))
          crop.at<unsigned char>(y, x) = static_cast<unsigned char>(sum / width / height);
  shot.crops.push_back(crop);
}

void BlurMeter::cut() {
  if (!shots_.back().places.empty()) shots_.emplace_back();
}

std::size_t BlurMeter::add_shares(const Shot& shot, std::vector<double>& shares) {
  std::size_t tried = 0;
  for (std::size_t k = 1; k < shot.crops.size() && shares.size() < kMaxPairs; ++k) {
    const auto fast = rate_at(shot.places, k);
    if (!fast || !shot.known[k] || fast->norm() < kMinMovingSpeed) continue;
    const Pixel along = fast->normalized();
    std::optional<std::size_t> partner;
    double slowest = kMaxRestSpeedShare * fast->norm();
    for (std::size_t j = k > kMaxFramesApart ? k - kMaxFramesApart : 0;
         j <= k + kMaxFramesApart && j < shot.crops.size();
         ++j) {
      const auto rate = rate_at(shot.places, j);
      if (j == k || !rate || !shot.known[j] || rate->norm() >= slowest) continue;
      slowest = rate->norm();
      partner = j;
    }
    if (!partner) continue;
    ++tried;
    cv::Mat still, moving;
    shot.crops[*partner].convertTo(still, CV_32F);
    shot.crops[k].convertTo(moving, CV_32F);
    const auto length =
        length_of(softened(still), softened(moving), along, kMaxLengthShare * fast->norm());
    if (!length) continue;
    // The neighbour is slightly blurred as well; variances add.
    const double own = slowest * slowest / fast->squaredNorm();
    shares.push_back(*length / fast->norm() / std::sqrt(std::max(0.2, 1 - own)));
  }
  return tried;
}

Measured<Estimate> BlurMeter::share() const {
  std::vector<double> shares;
  std::size_t tried = 0;
  for (const Shot& shot : shots_) tried += add_shares(shot, shares);
  if (shares.size() < kMinPairs) {
    return NotMeasured{
        tried < kMinPairs
            ? "too few frames in fast motion have a neighbour at rest"
            : "moving frames have lost more detail than a whole frame's exposure would take"};
  }
  const double share = median(shares);
  const double scatter = 1.25 * half_spread(shares) / std::sqrt(double(shares.size()));
  const Estimate result{share, std::hypot(scatter, kSharedError, kSharedRelativeError * share)};
  if (result.value < kMinShareInErrors * result.sigma) {
    return NotMeasured{
        "frames in motion are as sharp as others: the exposure is too short to be measured"};
  }
  return result;
}

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
// The least share of a readout along the rows that is told from none, in standard errors. Chosen by
// judgement: twice what tells a readout along the columns, since without a readout 0 is right.
constexpr double kMinErrorsAlongRows = 4;

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

// The pairs of a sensor that is read along the picture's columns, and of one along its rows. The
// former shears with the horizontal and stretches with the vertical change of speed, the latter the
// other way round, so that the sum of products of either is 0 where the other is true.
struct ReadoutPairs {
  Pairs along_columns, along_rows;
};

// Appends, for the frames of one shot, the change of speed over the extent of the picture together
// with the shear and the stretch.
void add_pairs(const Steps& steps, const Pixel& centre, ReadoutPairs& pairs) {
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
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      pairs.along_columns.push_back({x, y});
      const double other = slow_part(bends[1 - axis], k);
      pairs.along_rows.push_back({x * centre.y() / centre.x(), axis == 0 ? -other : other});
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
  ReadoutPairs pairs;
  for (const Steps& shot : shots) add_pairs(shot, {width / 2.0, height / 2.0}, pairs);
  if (pairs.along_columns.size() < kMinFrames)
    return NotMeasured{"the motion of too few frames is known"};
  const Estimate share = line_through_origin(pairs.along_columns);
  if (!(share.sigma > 0) || share.sigma > kMaxShareError)
    return NotMeasured{"the picture's speed changes too little from frame to frame"};
  if (std::abs(share.value) > kMaxShare)
    return NotMeasured{"the picture's shear follows its speed by more than a whole frame would"};
  const Estimate across = line_through_origin(pairs.along_rows);
  const double errors = std::abs(across.value) / across.sigma;
  if (errors > kMinErrorsAlongRows && errors > std::abs(share.value) / share.sigma)
    return NotMeasured{fmt::format(
        "the sensor is read along the picture's rows, to the {}, in about {:.2f} of a frame "
        "interval; only a readout along its columns is measured",
        across.value > 0 ? "right" : "left",
        std::abs(across.value))};
  return share;
}

}  // namespace airtruth::sensor
