// SPDX-License-Identifier: Apache-2.0
#include "camera/focal_length/lens_estimator.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "camera/motion/corners.h"
#include "camera/motion/rotation_fit.h"
#include "foundation/base/median.h"

namespace airtruth::focal_length {
namespace {

// The limits below are chosen by judgement, but for kMaxMisfitRatio (docs/lenses.md).
// A pair of frames is used when the median corner has moved by this share of the image's width: a
// smaller turn says little about the lens.
constexpr double kMinCornerShiftShare = 0.09;
// The largest number of frames between the two of a pair.
constexpr int kMaxPairSpanFrames = 40;
// The number of pairs: at most, which bounds the time, and at least, since two halves of two pairs
// give the uncertainty.
constexpr std::size_t kMaxPairs = 40;
constexpr std::size_t kMinPairs = 4;
// The least number of corners that are tracked through a pair.
constexpr int kMinPairCorners = 30;
// The residual at which a corner is cut off, px: beyond it a corner does not turn with the far
// scene.
constexpr double kOutlierPx = 2.5;
// The shortest and longest focal length that is tried, in widths of the image.
constexpr double kShortest = 0.25;
constexpr double kLongest = 6.0;
// A lens fits as well as the best where its mean squared misfit is below this multiple of the
// least.
constexpr double kMaxMisfitRatio = 1.02;
// The ratio of two focal lengths that are tried for the ends of that interval: 5 %.
constexpr double kIntervalStep = 1.05;
// The limits of a certain estimate, as shares of the focal length: its uncertainty, and the excess
// of the longest focal length that fits as well.
constexpr double kMaxSigmaShare = 0.12;
constexpr double kMaxExcessShare = 0.25;

struct Match {
  Pixel before, after;  // pixels with the corner origin
};
using Pair = std::vector<Match>;

lens::Lens candidate(bool fisheye, double focal_px, const lens::ImageSize& size) {
  const Pixel focal(focal_px, focal_px);
  const Pixel centre(size.width / 2.0, size.height / 2.0);
  if (fisheye) return lens::Lens(lens::Fisheye{focal, centre, {0, 0, 0, 0}}, size);
  return lens::Lens(lens::Pinhole{focal, centre}, size);
}

// The mean squared residual of a pair's points, px^2, each cut off at kOutlierPx.
double miss_of(const Pair& pair, const lens::Lens& lens) {
  std::vector<motion::Bearings> bearings;
  std::vector<const Match*> known;
  for (const Match& m : pair) {
    const auto a = lens.ray_from_pixel(m.before);
    const auto b = lens.ray_from_pixel(m.after);
    if (a && b) bearings.push_back({*a, *b}), known.push_back(&m);
  }
  // The squared residual at which a corner is cut off, px^2.
  constexpr double kCut = kOutlierPx * kOutlierPx;
  const auto fit =
      motion::fit_rotation(bearings, kOutlierPx / lens.focal_px(), kMinPairCorners / 2, 1);
  if (!fit) return kCut;
  double sum = kCut * double(pair.size() - known.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    const auto pixel = lens.pixel_from_cam(fit->cam_from_reference * bearings[i].in_reference);
    sum += pixel ? std::min(kCut, (*pixel - known[i]->after).squaredNorm()) : kCut;
  }
  return sum / double(pair.size());
}

double miss_of(const std::vector<Pair>& pairs,
               std::size_t from,
               std::size_t step,
               const lens::Lens& lens) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = from; i < pairs.size(); i += step) sum += miss_of(pairs[i], lens), ++count;
  return sum / std::max(1, count);
}

struct Best {
  double focal_px = 0;
  double miss = 1e300;
};

Best search(const std::vector<Pair>& pairs,
            std::size_t from,
            std::size_t step,
            bool fisheye,
            const lens::ImageSize& size) {
  Best best;
  const double low = kShortest * size.width, high = kLongest * size.width;
  const auto look = [&](double f) {
    const double m = miss_of(pairs, from, step, candidate(fisheye, f, size));
    if (m < best.miss) best = {f, m};
  };
  for (double f = low; f <= high; f *= 1.12) look(f);
  for (double width = 0.06; width > 0.002; width *= 0.5) {
    const double middle = best.focal_px;
    look(middle * (1 - width));
    look(middle * (1 + width));
  }
  return best;
}

// The end of the interval of focal lengths that fit as well: steps from the best focal length by
// `factor` while the lens fits, within the range of the search.
template <typename Fits>
double end_of_fit(double focal_px, double factor, const lens::ImageSize& size, const Fits& fits) {
  const double low = kShortest * size.width;
  const double high = kLongest * size.width;
  double end = focal_px;
  while (end * factor >= low && end * factor <= high && fits(end * factor)) end *= factor;
  if (end * factor < low) return low;
  return end * factor > high ? high : end;
}

}  // namespace

struct LensEstimator::Impl {
  lens::ImageSize size;
  cv::Mat allowed;
  motion::Options options;
  motion::Pyramid previous;
  std::vector<cv::Point2f> begun, now;
  int frames = 0;
  std::vector<Pair> pairs;

  void begin(const cv::Mat& grey) {
    begun = now = motion::spread_corners(grey, allowed, options);
    frames = 0;
  }

  void add(const cv::Mat& grey, bool begins_shot) {
    if (pairs.size() >= kMaxPairs) return;
    motion::Pyramid pyramid = motion::pyramid_of(grey);
    if (previous.empty() || begins_shot) {
      begin(grey);
      previous = std::move(pyramid);
      return;
    }
    std::vector<cv::Point2f> moved;
    const auto good = motion::follow(previous, pyramid, allowed, now, moved, false, options);
    std::vector<cv::Point2f> kept_begun, kept_now;
    std::vector<double> far;
    for (std::size_t i = 0; i < good.size(); ++i) {
      if (!good[i]) continue;
      kept_begun.push_back(begun[i]);
      kept_now.push_back(moved[i]);
      far.push_back(cv::norm(moved[i] - begun[i]));
    }
    begun = kept_begun, now = kept_now;
    previous = std::move(pyramid);
    ++frames;
    if (static_cast<int>(now.size()) < kMinPairCorners || frames > kMaxPairSpanFrames) {
      begin(grey);
      return;
    }
    if (median(std::move(far)) < kMinCornerShiftShare * size.width) return;
    Pair pair;
    for (std::size_t i = 0; i < now.size(); ++i)
      pair.push_back({{begun[i].x + 0.5, begun[i].y + 0.5}, {now[i].x + 0.5, now[i].y + 0.5}});
    pairs.push_back(std::move(pair));
    begin(grey);
  }
};

LensEstimator::LensEstimator(int width, int height, const image::Mask* own_aircraft)
    : impl_(std::make_unique<Impl>()) {
  impl_->size = {width, height};
  impl_->allowed = motion::allowed_area(width, height, own_aircraft);
}
LensEstimator::~LensEstimator() = default;

void LensEstimator::add(const image::Picture& picture, bool begins_shot) {
  impl_->add(motion::luma_of(picture), begins_shot);
}

std::optional<LensEstimator::Result> LensEstimator::result(std::string& why) const {
  const auto& pairs = impl_->pairs;
  const lens::ImageSize& size = impl_->size;
  if (pairs.size() < kMinPairs) {
    why = "the camera turns far enough to tell only " + std::to_string(pairs.size()) +
          " times; it takes " + std::to_string(kMinPairs);
    return std::nullopt;
  }
  const Best pinhole = search(pairs, 0, 1, false, size);
  const Best fisheye = search(pairs, 0, 1, true, size);
  Result result;
  result.fisheye = fisheye.miss < pinhole.miss;
  const Best& best = result.fisheye ? fisheye : pinhole;
  result.focal_px = best.focal_px;
  result.rms_px = std::sqrt(best.miss);
  result.other_rms_px = std::sqrt(result.fisheye ? pinhole.miss : fisheye.miss);
  result.pairs = static_cast<int>(pairs.size());
  // The difference between the estimates of two halves of the pairs gives the uncertainty.
  const Best odd = search(pairs, 1, 2, result.fisheye, size);
  const Best even = search(pairs, 0, 2, result.fisheye, size);
  result.sigma_px = std::max(0.004 * best.focal_px, std::abs(odd.focal_px - even.focal_px) / 2);
  const auto fits = [&](double focal_px) {
    return miss_of(pairs, 0, 1, candidate(result.fisheye, focal_px, size)) <
           kMaxMisfitRatio * best.miss;
  };
  result.low_px = std::min(end_of_fit(best.focal_px, 1 / kIntervalStep, size, fits),
                           best.focal_px - result.sigma_px);
  result.high_px = std::max(end_of_fit(best.focal_px, kIntervalStep, size, fits),
                            best.focal_px + result.sigma_px);
  result.is_certain = result.sigma_px <= kMaxSigmaShare * best.focal_px &&
                      result.high_px < (1 + kMaxExcessShare) * best.focal_px;
  if (!result.is_certain)
    why = "the way the picture turns fits every focal length from " +
          std::to_string(static_cast<int>(result.low_px)) + " to " +
          std::to_string(static_cast<int>(result.high_px)) + " px";
  return result;
}

}  // namespace airtruth::focal_length
