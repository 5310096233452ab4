// SPDX-License-Identifier: Apache-2.0
#include "camera/focal_length/lens_estimator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "camera/motion/corners.h"
#include "camera/motion/rotation_fit.h"
#include "foundation/base/median.h"
#include "foundation/image/mats.h"

namespace airtruth::focal_length {

namespace {

// The limits below are chosen by judgement, but for kMaxMisfitRatio (docs/lenses.md).
// A pair of frames is used when the median corner has moved by this share of the image's width: a
// smaller turn says little about the lens.
constexpr double kMinCornerShiftShare = 0.09;
// The largest number of frames between the two of a pair.
constexpr int kMaxPairSpanFrames = 40;
// The number of pairs: at most, which bounds the time, and at least, which is one for each stretch.
constexpr std::size_t kMaxPairs = 80;
constexpr std::size_t kMinPairs = 4;
// The number of stretches of the clip that are estimated on their own: at least, at most, and the
// number of pairs in each between the two.
constexpr std::size_t kMinStretches = kMinPairs;
constexpr std::size_t kMaxStretches = 8;
constexpr std::size_t kStretchPairs = 5;
// The 97.5 % points of Student's t with 3 to 7 degrees of freedom, one less than the stretches.
constexpr std::array<double, 5> kStudentT = {3.182, 2.776, 2.571, 2.447, 2.365};
// The least number of corners that are tracked through a pair.
constexpr int kMinPairCorners = 30;
// The residual at which a corner is cut off, px: beyond it a corner does not turn with the far
// scene.
constexpr double kOutlierPx = 2.5;
// The shortest and longest focal length that is tried, in widths of the image, and the number of
// focal lengths between them, evenly spaced in their logarithm: by 4.6 %.
constexpr double kShortest = 0.25;
constexpr double kLongest = 6.0;
constexpr std::size_t kTried = 72;
const double kLogStep = std::log(kLongest / kShortest) / double(kTried - 1);
// A lens fits as well as the best where its mean squared misfit is below this multiple of the
// least.
constexpr double kMaxMisfitRatio = 1.02;
// The limits of a certain estimate, as shares of the focal length: its uncertainty, and the excess
// of the longest focal length that fits as well.
constexpr double kMaxSigmaShare = 0.12;
constexpr double kMaxExcessShare = 0.25;

using Pair = std::vector<motion::Step>;

// The mean squared residual of a pair's points, px^2, each cut off at kOutlierPx.
double miss_of(const Pair& pair, const lens::Lens& lens) {
  std::vector<motion::Bearings> bearings;
  std::vector<const motion::Step*> known;
  for (const motion::Step& m : pair) {
    const auto a = lens.ray_from_pixel(m.from);
    const auto b = lens.ray_from_pixel(m.to);
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
    sum += pixel ? std::min(kCut, (*pixel - known[i]->to).squaredNorm()) : kCut;
  }
  return sum / double(pair.size());
}

// The pictures of a camera.
struct Format {
  lens::ImageSize size;
  double width_of_height = 1;  // of a pixel
};

// The focal length at a place among those that are tried.
double focal_at(double place, const Format& format) {
  return kShortest * format.size.width * format.width_of_height * std::exp(place * kLogStep);
}

// The mean squared residual of a pair with each of the focal lengths that are tried.
using Profile = std::array<double, kTried>;

std::vector<Profile> profiles_of(const std::vector<Pair>& pairs,
                                 bool fisheye,
                                 const Format& format) {
  std::vector<Profile> profiles(pairs.size());
  for (std::size_t k = 0; k < kTried; ++k) {
    const lens::Lens lens = lens::undistorted(
        fisheye, focal_at(double(k), format), format.size, format.width_of_height);
    for (std::size_t i = 0; i < pairs.size(); ++i) profiles[i][k] = miss_of(pairs[i], lens);
  }
  return profiles;
}

Profile mean_of(std::span<const Profile> profiles) {
  Profile mean{};
  for (const Profile& one : profiles)
    for (std::size_t k = 0; k < kTried; ++k) mean[k] += one[k] / double(profiles.size());
  return mean;
}

struct Best {
  double place = 0;  // among the focal lengths that are tried
  double miss = 0;
};

// The least of a profile, by the parabola through it and its neighbours.
Best best_of(const Profile& profile) {
  const auto least = std::ranges::min_element(profile);
  const double k = double(least - profile.begin());
  if (least == profile.begin() || least + 1 == profile.end()) return {k, *least};
  const double bend = least[-1] - 2 * *least + least[1];
  return {bend > 0 ? k + 0.5 * (least[-1] - least[1]) / bend : k, *least};
}

// How far the estimate of another stretch of the clip may lie from the whole one, as a difference
// of places: its standard deviation, and the half-width of its 95 % interval.
struct Spread {
  double sigma = 0;
  double half_width = 0;
};

Spread spread_of(std::span<const Profile> profiles) {
  const std::size_t stretches =
      std::clamp(profiles.size() / kStretchPairs, kMinStretches, kMaxStretches);
  std::vector<double> places;
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t from = profiles.size() * s / stretches;
    const std::size_t to = profiles.size() * (s + 1) / stretches;
    places.push_back(best_of(mean_of(profiles.subspan(from, to - from))).place);
  }
  const double count = double(stretches);
  const double mean = std::accumulate(places.begin(), places.end(), 0.0) / count;
  double squares = 0;
  for (const double place : places) squares += (place - mean) * (place - mean);
  const double sigma = std::sqrt(squares / (count - 1) * (1 + 1 / count));
  return {sigma, kStudentT[stretches - kMinStretches] * sigma};
}

// The ends of the places about the least that fit as well.
std::pair<double, double> fitting(const Profile& profile, const Best& best) {
  const auto fits = [&](std::size_t k) { return profile[k] < kMaxMisfitRatio * best.miss; };
  std::size_t low = static_cast<std::size_t>(std::lround(best.place));
  std::size_t high = low;
  while (low > 0 && fits(low - 1)) --low;
  while (high + 1 < kTried && fits(high + 1)) ++high;
  return {double(low), double(high)};
}

}  // namespace

struct LensEstimator::Impl {
  Format format;
  cv::Mat allowed;
  motion::Pyramid previous;
  motion::Tracks tracks;
  int frames = 0;
  std::vector<Pair> pairs;
  std::size_t turns = 0;
  std::size_t every = 1;  // of the turns, one is kept

  // Keeps at most kMaxPairs pairs, evenly over the clip.
  void keep(Pair pair) {
    if (turns++ % every != 0) return;
    pairs.push_back(std::move(pair));
    if (pairs.size() < kMaxPairs) return;
    for (std::size_t i = 1; 2 * i < pairs.size(); ++i) pairs[i] = std::move(pairs[2 * i]);
    pairs.resize(kMaxPairs / 2);
    every *= 2;
  }

  void begin(const cv::Mat& grey) {
    tracks.begun = tracks.now = motion::spread_corners(grey, allowed);
    frames = 0;
  }

  void add(const cv::Mat& grey, bool begins_shot) {
    motion::Pyramid pyramid = motion::pyramid_of(grey);
    if (previous.empty() || begins_shot) {
      begin(grey);
      previous = std::move(pyramid);
      return;
    }
    tracks = motion::followed(previous, pyramid, allowed, tracks);
    const auto& [begun, now] = tracks;
    previous = std::move(pyramid);
    ++frames;
    if (static_cast<int>(now.size()) < kMinPairCorners || frames > kMaxPairSpanFrames) {
      begin(grey);
      return;
    }
    std::vector<double> far;
    Pair pair;
    for (std::size_t i = 0; i < now.size(); ++i) {
      far.push_back(cv::norm(now[i] - begun[i]));
      pair.push_back({{begun[i].x + 0.5, begun[i].y + 0.5}, {now[i].x + 0.5, now[i].y + 0.5}});
    }
    if (median(std::move(far)) < kMinCornerShiftShare * format.size.width) return;
    keep(std::move(pair));
    begin(grey);
  }
};

LensEstimator::LensEstimator(int width,
                             int height,
                             const image::Mask* own_aircraft,
                             double width_of_height)
    : impl_(std::make_unique<Impl>()) {
  impl_->format = {{width, height}, width_of_height};
  impl_->allowed = motion::allowed_area(width, height, own_aircraft);
}
LensEstimator::~LensEstimator() = default;

void LensEstimator::add(const image::Picture& picture, bool begins_shot) {
  impl_->add(image::luma_of(picture), begins_shot);
}

std::optional<LensEstimator::Result> LensEstimator::result(std::string& why) const {
  const auto& pairs = impl_->pairs;
  const Format& format = impl_->format;
  if (pairs.size() < kMinPairs) {
    why = fmt::format("the camera turns far enough to tell in {} of the {} places that it takes",
                      pairs.size(),
                      kMinPairs);
    return std::nullopt;
  }
  const std::vector<Profile> as_pinhole = profiles_of(pairs, false, format);
  const std::vector<Profile> as_fisheye = profiles_of(pairs, true, format);
  const Profile pinhole = mean_of(as_pinhole);
  const Profile fisheye = mean_of(as_fisheye);
  Result result;
  result.fisheye = best_of(fisheye).miss < best_of(pinhole).miss;
  const Profile& whole = result.fisheye ? fisheye : pinhole;
  const Best best = best_of(whole);
  result.focal_px = focal_at(best.place, format);
  result.rms_px = std::sqrt(best.miss);
  result.other_rms_px = std::sqrt(best_of(result.fisheye ? pinhole : fisheye).miss);
  result.pairs = static_cast<int>(pairs.size());
  const Spread spread = spread_of(result.fisheye ? as_fisheye : as_pinhole);
  result.sigma_px = spread.sigma * kLogStep * result.focal_px;
  const auto [low, high] = fitting(whole, best);
  const auto tried_px = [&](double place) {
    return focal_at(std::clamp(place, 0.0, double(kTried - 1)), format);
  };
  const double lowest = std::min(low, best.place - spread.half_width);
  const double highest = std::max(high, best.place + spread.half_width);
  result.low_px = tried_px(lowest);
  result.high_px = tried_px(highest);
  result.is_open_low = lowest <= 0;
  result.is_open_high = highest >= double(kTried - 1);
  result.is_certain = !result.is_open_low && !result.is_open_high &&
                      result.sigma_px <= kMaxSigmaShare * result.focal_px &&
                      result.high_px < (1 + kMaxExcessShare) * result.focal_px;
  if (!result.is_certain)
    why = "the way the picture turns fits focal lengths from " + interval_words(result);
  return result;
}

std::string LensEstimator::interval_words(const Result& found, const char* unit) {
  return fmt::format("{:.0f}{} to {:.0f}{}{}",
                     found.low_px,
                     found.is_open_low ? " or less" : "",
                     found.high_px,
                     unit,
                     found.is_open_high ? " or more" : "");
}

}  // namespace airtruth::focal_length
