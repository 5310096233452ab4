// SPDX-License-Identifier: Apache-2.0
#include "calibration/same_ground.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calibration/rays.h"
#include "image/colour.h"

namespace airtruth::calibration {
namespace {

constexpr double kNearest = 2.5;       // heights
constexpr double kShareSeen = 0.6;     // of a square's pixels
constexpr double kFewestPixels = 3;    // of a square
constexpr double kMostPixels = 1.5e6;  // of a view that are looked at
constexpr std::size_t kFewestSeen = 300;

// How far a square's light may be from the model: a share of its own light, and at the least.
constexpr double kUneven = 0.05, kLeastError = 0.004;
constexpr double kApart = 4;            // views of one square whose errors are not the same error
constexpr double kAirlightTrust = 0.2;  // of its value: clouds stand at the horizon
constexpr double kUsualSlope = 0.5, kSlopeSpread = 0.5, kMostSlope = 2, kSlopeStep = 0.1;
constexpr std::array kWavelengthNm{610.0, 550.0, 465.0};
constexpr double kModelError = 0.1;  // of the value
constexpr double kLeastKnown = 0.3;  // of the value: a larger error is no answer

// Extinctions that are tried, per km.
constexpr int kTried = 160;
constexpr double kWeakest = 0.01, kStrongest = 2;
double tried(double i) { return kWeakest * std::pow(kStrongest / kWeakest, i / (kTried - 1)); }
double place_of(double per_km) {
  return std::log(per_km / kWeakest) / std::log(kStrongest / kWeakest) * (kTried - 1);
}

// One channel of a square in a view.
struct Row {
  int square = 0;
  double range = 0, light = 0, weight = 1;
};

// Weighted least squares for one extinction.
struct Solution {
  double cost = 0;
  Estimate airlight;
  std::vector<double> own;  // light of each square
};

Solution solved(const std::vector<Row>& rows, double airlight, double per_height) {
  struct Square {
    double tt = 0, ta = 0, ty = 0;
  };
  std::vector<Square> squares(static_cast<std::size_t>(rows.back().square) + 1);
  const double trust = 1 / (kAirlightTrust * airlight * kAirlightTrust * airlight);
  double aa = trust, ay = trust * airlight, yy = trust * airlight * airlight;
  for (const Row& r : rows) {
    const double t = std::exp(-per_height * r.range);
    Square& q = squares[static_cast<std::size_t>(r.square)];
    q.tt += r.weight * t * t, q.ta += r.weight * t * (1 - t), q.ty += r.weight * t * r.light;
    aa += r.weight * (1 - t) * (1 - t), ay += r.weight * (1 - t) * r.light;
    yy += r.weight * r.light * r.light;
  }
  // The squares' own light is eliminated: each stands in its own rows alone.
  for (const Square& q : squares) {
    if (q.tt == 0) continue;
    aa -= q.ta * q.ta / q.tt, ay -= q.ta * q.ty / q.tt, yy -= q.ty * q.ty / q.tt;
  }
  Solution result{yy - ay * ay / aa, {ay / aa, std::sqrt(1 / aa)}, {}};
  for (const Square& q : squares)
    result.own.push_back(q.tt > 0 ? (q.ty - ay / aa * q.ta) / q.tt : 0);
  return result;
}

struct Channel {
  std::vector<Row> rows;
  double airlight = 0;
  std::vector<double> cost;  // of each extinction that is tried

  // With weights that fit the best of them.
  void try_all(double altitude_m);
};

void Channel::try_all(double altitude_m) {
  std::vector<int> views(static_cast<std::size_t>(rows.back().square) + 1, 0);
  for (const Row& r : rows) ++views[static_cast<std::size_t>(r.square)];
  cost.resize(kTried);
  double best = 0.1;
  for (int round = 0; round < 3; ++round) {
    const Solution at = solved(rows, airlight, best * altitude_m * 1e-3);
    for (Row& r : rows) {
      const auto square = static_cast<std::size_t>(r.square);
      const double error = std::hypot(kLeastError, kUneven * std::clamp(at.own[square], 0.01, 1.0));
      r.weight = std::min(1.0, kApart / views[square]) / (error * error);
    }
    for (int i = 0; i < kTried; ++i)
      cost[static_cast<std::size_t>(i)] = solved(rows, airlight, tried(i) * altitude_m * 1e-3).cost;
    best = tried(double(std::min_element(cost.begin(), cost.end()) - cost.begin()));
  }
}

// A guess of all channels' extinction, and how well it fits.
struct Guess {
  std::array<double, 3> per_km{};
  double cost = 0;
};

std::vector<Guess> guesses(const std::array<Channel, 3>& channels) {
  std::vector<Guess> result;
  for (int i = 0; i < kTried; ++i)
    for (double slope = 0; slope <= kMostSlope; slope += kSlopeStep) {
      Guess guess;
      guess.cost = (slope - kUsualSlope) * (slope - kUsualSlope) / (kSlopeSpread * kSlopeSpread);
      bool inside = true;
      for (std::size_t c = 0; c < 3 && inside; ++c) {
        guess.per_km[c] = tried(i) * std::pow(550 / kWavelengthNm[c], slope);
        const double place = place_of(guess.per_km[c]);
        inside = place >= 0 && place < kTried - 1;
        if (!inside) continue;
        const auto k = static_cast<std::size_t>(place);
        const auto& cost = channels[c].cost;
        guess.cost += cost[k] + (place - double(k)) * (cost[k + 1] - cost[k]);
      }
      if (inside) result.push_back(guess);
    }
  return result;
}

// Mean and spread of the guesses, each by exp(-cost / 2).
ColourEstimate mean_of(const std::vector<Guess>& guesses) {
  const double least =
      std::min_element(guesses.begin(), guesses.end(), [](const Guess& a, const Guess& b) {
        return a.cost < b.cost;
      })->cost;
  double total = 0;
  std::array<double, 3> sum{}, squares{};
  for (const Guess& guess : guesses) {
    const double p = std::exp(0.5 * (least - guess.cost));
    total += p;
    for (std::size_t c = 0; c < 3; ++c) {
      sum[c] += p * guess.per_km[c];
      squares[c] += p * guess.per_km[c] * guess.per_km[c];
    }
  }
  ColourEstimate result;
  for (std::size_t c = 0; c < 3; ++c) {
    const double mean = sum[c] / total;
    result[c] = {mean, std::sqrt(std::max(0.0, squares[c] / total - mean * mean))};
  }
  return result;
}

}  // namespace

std::vector<GroundSeen> ground_seen(const std::vector<GroundView>& views,
                                    const GroundTrack& track,
                                    const lens::Lens& lens,
                                    const image::Mask* own_aircraft,
                                    const image::ToneCurve& tone) {
  const double pixels = double(lens.size().width) * lens.size().height;
  const int step = std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / kMostPixels))));
  const double step_rad = step / lens.focal_px();
  const double farthest = std::sqrt(1 / step_rad);
  const std::vector<PixelRay> rays = pixel_rays(lens, own_aircraft, step / 2, step);
  struct Sum {
    double count = 0, range = 0;
    std::array<double, 3> light{};
  };
  std::map<std::pair<int, int>, int> squares;
  std::vector<GroundSeen> all;
  for (std::size_t k = 0; k < track.places.size(); ++k) {
    const GroundView& view = views[track.first + k];
    const image::ColourCode code(view.picture->colour);
    const Quaternion level_from_cam = track.level_from_world * view.cam_from_world.conjugate();
    std::map<std::pair<int, int>, Sum> sums;
    for (const PixelRay& ray : rays) {
      const auto way = place_on_ground(level_from_cam * ray.in_cam);
      if (!way) continue;
      const double range = std::hypot(way->norm(), 1.0);
      if (range < kNearest || range > farthest) continue;
      const Eigen::Vector2d place = track.places[k] + *way;
      Sum& sum =
          sums[{static_cast<int>(std::floor(place.x())), static_cast<int>(std::floor(place.y()))}];
      const image::Rgb linear = image::linear_at(*view.picture, code, ray.x, ray.y, tone);
      sum.count += 1, sum.range += range;
      for (std::size_t c = 0; c < 3; ++c) sum.light[c] += double(linear[c]);
    }
    for (const auto& [at, sum] : sums) {
      const double range = sum.range / sum.count;
      const double whole = 1 / (range * range * range * step_rad * step_rad);
      if (sum.count < std::max(kFewestPixels, kShareSeen * whole)) continue;
      GroundSeen seen;
      seen.square = squares.emplace(at, static_cast<int>(squares.size())).first->second;
      seen.range = range;
      for (std::size_t c = 0; c < 3; ++c) seen.light[c] = sum.light[c] / sum.count;
      all.push_back(seen);
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const GroundSeen& a, const GroundSeen& b) {
    return a.square < b.square;
  });
  return all;
}

std::optional<SeenAgain> fading_of_same_ground(const std::vector<GroundSeen>& seen,
                                               const ColourEstimate& airlight,
                                               double altitude_m) {
  if (seen.size() < kFewestSeen) return std::nullopt;
  std::array<Channel, 3> channels;
  for (std::size_t c = 0; c < 3; ++c) {
    for (const GroundSeen& s : seen) channels[c].rows.push_back({s.square, s.range, s.light[c], 1});
    channels[c].airlight = airlight[c].value;
    channels[c].try_all(altitude_m);
  }
  SeenAgain result;
  result.extinction_per_km = mean_of(guesses(channels));
  for (std::size_t c = 0; c < 3; ++c) {
    Estimate& extinction = result.extinction_per_km[c];
    const Solution at =
        solved(channels[c].rows, airlight[c].value, extinction.value * altitude_m * 1e-3);
    extinction.sigma = std::hypot(extinction.sigma, kModelError * extinction.value);
    if (extinction.sigma > kLeastKnown * extinction.value) return std::nullopt;
    result.airlight[c] = {at.airlight.value,
                          std::hypot(at.airlight.sigma, kModelError * at.airlight.value)};
  }
  return result;
}

}  // namespace airtruth::calibration
