// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/same_ground.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <Eigen/Cholesky>

#include "calibration/air/sky_curve.h"

namespace airtruth::air {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// surroundings_slow_test.cpp, whose figures are in docs/realism.md.

// Error of the light of far ground: as a share of the light of the mean ground, and its lower bound
// in linear light.
constexpr double kFarError = 0.25, kMinFarError = 0.006;
// Range in heights at which the loss of contrast among squares is stated.
constexpr double kMixedRange = 15;

// The equations of same_ground.h for one channel and one extinction.

// The unknowns of one channel: the airlight of each sector, the mean light of the ground, and the
// relative change of contrast among squares at the range kMixedRange, which grows with the range
// squared.
constexpr int kMean = kSectors, kMixed = kSectors + 1, kUnknowns = kSectors + 2;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

// One channel of a square in a view, or of a band of far ground.
struct Row {
  int square = 0, sector = 0;
  double range = 0, light = 0;
  // `contrast` is used for squares alone: their own light minus the mean.
  double weight = 1, contrast = 0;
};

// Weighted least squares for one extinction. The squares' own light is eliminated, since each
// occurs only in the rows of its own square.
struct System {
  struct Square {
    double tt = 0, ty = 0;
    Unknowns ta = Unknowns::Zero();
  };
  std::vector<Square> squares;
  Normal aa = Normal::Zero();
  Unknowns ay = Unknowns::Zero();
  double yy = 0;

  // Adds the prior that `unknown` is `value`, with the relative error `trust`.
  void expect(int unknown, double value, double trust) {
    const double weight = 1 / (trust * value * trust * value);
    aa(unknown, unknown) += weight, ay[unknown] += weight * value, yy += weight * value * value;
  }

  // Adds a square in a view; `t` is the share of its light that arrives.
  void add_square(const Row& r, double t) {
    Square& q = squares[static_cast<std::size_t>(r.square)];
    const double air = 1 - t;
    const double mixed = t * r.contrast * r.range * r.range / (kMixedRange * kMixedRange);
    q.tt += r.weight * t * t, q.ty += r.weight * t * r.light;
    q.ta[r.sector] += r.weight * t * air, q.ta[kMixed] += r.weight * t * mixed;
    aa(r.sector, r.sector) += r.weight * air * air, aa(kMixed, kMixed) += r.weight * mixed * mixed;
    aa(r.sector, kMixed) += r.weight * air * mixed, aa(kMixed, r.sector) += r.weight * air * mixed;
    ay[r.sector] += r.weight * air * r.light, ay[kMixed] += r.weight * mixed * r.light;
    yy += r.weight * r.light * r.light;
  }

  // Adds a band of far ground.
  void add_far(const Row& r, double t, double mean_light) {
    const double error = std::hypot(kMinFarError, kFarError * mean_light * t);
    const double w = 1 / (error * error);
    Unknowns row = Unknowns::Zero();
    row[r.sector] = 1 - t, row[kMean] = t;
    aa += w * row * row.transpose(), ay += w * r.light * row, yy += w * r.light * r.light;
  }

  // Eliminates the squares' own light. It is called once, after all squares were added.
  void eliminate_own_light() {
    for (const Square& q : squares) {
      if (q.tt == 0) continue;
      aa -= q.ta * q.ta.transpose() / q.tt, ay -= q.ta * q.ty / q.tt, yy -= q.ty * q.ty / q.tt;
    }
  }

  Unknowns solution() const { return aa.ldlt().solve(ay); }
  double cost() const { return yy - ay.dot(solution()); }
  Unknowns sigma() const { return aa.ldlt().solve(Normal::Identity()).diagonal().cwiseSqrt(); }
  std::vector<double> own_light() const {
    const Unknowns x = solution();
    std::vector<double> own;
    for (const Square& q : squares) own.push_back(q.tt > 0 ? (q.ty - q.ta.dot(x)) / q.tt : 0);
    return own;
  }
};

// Least number of squares for a fit: fewer do not average out that the light of ground depends on
// the direction from which it is seen.
constexpr std::size_t kMinSquares = 300;

// Error of a square's light relative to the model: kSquareError is a share of the square's own
// light, and kMinSquareError is the lower bound in linear light. Views of one square share its
// error, and squares share it in part, so the number of independent measurements is smaller than
// their count.
constexpr double kSquareError = 0.05, kMinSquareError = 0.004;
constexpr double kIndependentViews = 4, kIndependentShare = 0.3;
// Relative error of the light of the mean ground.
constexpr double kMeanPrior = 0.05;
// Standard deviation of the prior that the airlight equals the light of the sky at the horizon: for
// sectors in which the sky was seen, and for the others.
constexpr double kSkyPrior = 0.03, kUnseenSkyPrior = 0.15;
// Prior error of the loss of contrast among squares (kMixedRange). Large pixels and errors of
// the path mix the light of neighbouring squares.
constexpr double kMixedPrior = 0.03;
// The extinction follows the wavelength to the power of -slope (Angstrom 1929): mean and standard
// deviation of the prior of the slope, its largest value and the spacing of those that are tried.
// Air between haze, where the slope is near 0, and small particles, where it is above 1.
constexpr double kMeanAngstrom = 0.5, kAngstromSigma = 0.5, kMaxAngstrom = 2, kAngstromStep = 0.1;
// Wavelengths of the channels red, green and blue.
constexpr std::array kWavelengthNm{610.0, 550.0, 465.0};
// Relative error that is added to the extinction: its scatter over virtual flights (same_ground.h).
constexpr double kFlightScatter = 0.1;
// Largest relative error of an extinction that is returned.
constexpr double kMaxSharedRelativeError = 0.3;

// Number and range of the extinctions that are tried, per km, in equal ratios.
constexpr int kTried = 240;
constexpr double kMinSharedExtinctionPerKm = 0.01, kMaxSharedExtinctionPerKm = 2;
// Spacing of the first search for the least cost among them. The cost has one minimum, which is
// many times as wide.
constexpr int kCoarseTried = 16;
// Excess over the least cost beyond which a hypothesis has no weight: exp(-100 / 2) is 2e-22.
constexpr double kMaxExcessCost = 100;
double tried(double i) {
  return kMinSharedExtinctionPerKm *
         std::pow(kMaxSharedExtinctionPerKm / kMinSharedExtinctionPerKm, i / (kTried - 1));
}
double place_of(double per_km) {
  return std::log(per_km / kMinSharedExtinctionPerKm) /
         std::log(kMaxSharedExtinctionPerKm / kMinSharedExtinctionPerKm) * (kTried - 1);
}

struct Channel {
  std::vector<Row> squares, far;
  std::array<double, kSectors> sky{}, sky_trust{};
  // Starting value of the mean light of the ground.
  double mean_light = 0.2;
  // The cost of each extinction that is tried.
  std::vector<double> cost;

  System system(double per_height) const {
    System result;
    result.squares.resize(static_cast<std::size_t>(squares.back().square) + 1);
    result.aa(kMixed, kMixed) = 1 / (kMixedPrior * kMixedPrior);
    for (std::size_t s = 0; s < kSectors; ++s)
      result.expect(static_cast<int>(s), sky[s], sky_trust[s]);
    result.expect(kMean, mean_light, kMeanPrior);
    for (const Row& r : squares) result.add_square(r, std::exp(-per_height * r.range));
    result.eliminate_own_light();
    for (const Row& r : far) result.add_far(r, std::exp(-per_height * r.range), mean_light);
    return result;
  }

  void weigh(double per_height) {
    const std::vector<double> own_light = system(per_height).own_light();
    std::vector<int> views(own_light.size(), 0);
    for (const Row& r : squares) ++views[static_cast<std::size_t>(r.square)];
    double sum = 0, total = 0;
    for (Row& r : squares) {
      const auto square = static_cast<std::size_t>(r.square);
      const double own = std::clamp(own_light[square], 0.01, 1.0);
      const double error = std::hypot(kMinSquareError, kSquareError * own);
      const double share = std::min(1.0, kIndependentViews / views[square]);
      r.weight = kIndependentShare * share / (error * error);
      r.contrast = own;
      sum += share * own, total += share;
    }
    mean_light = sum / total;
    for (Row& r : squares) r.contrast -= mean_light;
  }

  // The number of the extinction with the least cost, under the weights of the rows.
  int least_cost(double altitude_m) const {
    std::map<int, double> known;
    const auto cost_at = [&](int i) {
      const auto [found, is_new] = known.try_emplace(i, 0.0);
      if (is_new) found->second = system(tried(i) * altitude_m * 1e-3).cost();
      return found->second;
    };
    int best = 0;
    for (int i = 0; i < kTried; i += kCoarseTried)
      if (cost_at(i) < cost_at(best)) best = i;
    for (int step = kCoarseTried / 2; step > 0; step /= 2) {
      const int middle = best;
      for (const int i : {std::max(0, middle - step), std::min(kTried - 1, middle + step)})
        if (cost_at(i) < cost_at(best)) best = i;
    }
    return best;
  }

  // Computes the cost of every extinction, with the weights that belong to the best one. A cost
  // that exceeds the least one by more than kMaxExcessCost is a lower bound.
  void try_all(double altitude_m) {
    const auto per_height = [&](int i) { return tried(i) * altitude_m * 1e-3; };
    double start_per_km = 0.1;
    for (int round = 0; round < 2; ++round) {
      weigh(start_per_km * altitude_m * 1e-3);
      start_per_km = tried(least_cost(altitude_m));
    }
    weigh(start_per_km * altitude_m * 1e-3);
    const int best = least_cost(altitude_m);
    cost.assign(kTried, 0);
    cost[static_cast<std::size_t>(best)] = system(per_height(best)).cost();
    // Away from the best one, up to the excess beyond which a cost has no weight.
    for (const int way : {-1, 1}) {
      double last = cost[static_cast<std::size_t>(best)];
      const double most = last + kMaxExcessCost;
      for (int i = best + way; i >= 0 && i < kTried; i += way) {
        if (last < most) last = system(per_height(i)).cost();
        cost[static_cast<std::size_t>(i)] = last;
      }
    }
  }
};

// One hypothesis of the extinctions of all channels, with its cost.
struct Guess {
  std::array<double, 3> per_km{};
  double cost = 0;
};

std::vector<Guess> guesses(const std::array<Channel, 3>& channels) {
  std::vector<Guess> result;
  for (int i = 0; i < kTried; ++i)
    for (double slope = 0; slope <= kMaxAngstrom; slope += kAngstromStep) {
      Guess guess;
      guess.cost =
          (slope - kMeanAngstrom) * (slope - kMeanAngstrom) / (kAngstromSigma * kAngstromSigma);
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

// Mean and spread of the hypotheses, each weighted by exp(-cost / 2).
Estimate mean_of(const std::vector<Guess>& guesses, std::size_t channel) {
  std::vector<measured::Likely> all;
  for (const Guess& guess : guesses) all.push_back({guess.per_km[channel], -0.5 * guess.cost});
  return measured::mean_of(all);
}

// Mean over the sectors that the views cover.
Estimate airlight_ahead(const Channel& channel, const System& system) {
  const Unknowns airlight = system.solution(), sigma = system.sigma();
  std::array<bool, kSectors> seen{};
  for (const Row& r : channel.squares) seen[static_cast<std::size_t>(r.sector)] = true;
  Estimate mean;
  int count = 0;
  for (int sector = 0; sector < kSectors; ++sector) {
    if (!seen[static_cast<std::size_t>(sector)]) continue;
    mean.value += airlight[sector], mean.sigma += sigma[sector];
    ++count;
  }
  mean.value /= count, mean.sigma /= count;
  return {mean.value, std::hypot(mean.sigma, kFlightScatter * mean.value)};
}

}  // namespace

std::optional<SeenAgain> fading_of_same_ground(const GroundSeen& seen,
                                               const SkyCurves& sky,
                                               double altitude_m) {
  const auto mean_sky = airlight_of(sky, 0);
  if (!mean_sky || seen.squares.size() < kMinSquares) return std::nullopt;
  std::array<Channel, 3> channels;
  for (std::size_t c = 0; c < 3; ++c) {
    Channel& channel = channels[c];
    for (const SquareSeen& s : seen.squares)
      channel.squares.push_back({s.square, s.sector, s.range, s.light[c]});
    for (const FarGround& f : seen.far) channel.far.push_back({0, f.sector, f.range, f.light[c]});
    for (std::size_t s = 0; s < kSectors; ++s) {
      channel.sky[s] = sky[s] ? sky[s]->at(c, 0) : (*mean_sky)[c].value;
      channel.sky_trust[s] = sky[s] ? kSkyPrior : kUnseenSkyPrior;
    }
    channel.try_all(altitude_m);
  }
  SeenAgain result;
  const std::vector<Guess> all = guesses(channels);
  for (std::size_t c = 0; c < 3; ++c) {
    Estimate& extinction = result.extinction_per_km[c] = mean_of(all, c);
    result.airlight[c] =
        airlight_ahead(channels[c], channels[c].system(extinction.value * altitude_m * 1e-3));
    extinction.sigma = std::hypot(extinction.sigma, kFlightScatter * extinction.value);
    if (extinction.sigma > kMaxSharedRelativeError * extinction.value) return std::nullopt;
  }
  return result;
}

}  // namespace airtruth::air
