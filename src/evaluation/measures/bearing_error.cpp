// SPDX-License-Identifier: Apache-2.0
#include "evaluation/measures/bearing_error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "evaluation/statistics/bootstrap.h"

namespace airtruth::measures {
namespace {

// A pair of samples may be this much more or less than kRateBase_s apart.
constexpr double kRateTolerance_s = 0.1;

// A value of the sequence with this index.
struct Value {
  std::size_t sequence = 0;
  double value = 0;
};

// The spread of values that each count as often as their sequence is drawn.
Spread spread_of(std::span<const Value> by_size, std::span<const double> counts) {
  Spread spread;
  double n = 0;
  double sum = 0;
  double squares = 0;
  for (const auto& [sequence, value] : by_size) {
    n += counts[sequence];
    sum += counts[sequence] * value;
    squares += counts[sequence] * value * value;
  }
  spread.count = static_cast<std::int64_t>(n);
  if (spread.count == 0) return spread;
  spread.mean = sum / n;
  spread.rms = std::sqrt(squares / n);
  double about_mean = 0;
  for (const auto& [sequence, value] : by_size)
    about_mean += counts[sequence] * (value - spread.mean) * (value - spread.mean);
  spread.deviation = spread.count > 1 ? std::sqrt(about_mean / (n - 1)) : 0;
  std::vector<double> sizes;
  sizes.reserve(static_cast<std::size_t>(spread.count));
  for (const auto& [sequence, value] : by_size)
    sizes.insert(sizes.end(), static_cast<std::size_t>(counts[sequence]), std::abs(value));
  spread.within_95 = statistics::quantile(sizes, 0.95);
  return spread;
}

void add_intervals(std::span<const Value> by_size, std::size_t sequences, Spread& spread) {
  if (sequences < 2) return;
  std::vector<Spread> drawn;
  statistics::ClusterDraws draws(sequences, "bearing");
  for (std::size_t left = statistics::draws_for(2 * by_size.size()); left > 0; --left)
    drawn.push_back(spread_of(by_size, draws.next()));
  const auto interval_of = [&](double Spread::*member) {
    std::vector<double> values;
    for (const Spread& one : drawn) values.push_back(one.*member);
    return statistics::percentile_interval(std::move(values));
  };
  spread.mean_interval = interval_of(&Spread::mean);
  spread.deviation_interval = interval_of(&Spread::deviation);
  spread.rms_interval = interval_of(&Spread::rms);
  spread.within_95_interval = interval_of(&Spread::within_95);
}

// Numbers the sequences that have a value through.
Spread spread_of(std::vector<Value> values) {
  std::map<std::size_t, std::size_t> numbers;
  for (Value& one : values)
    one.sequence = numbers.try_emplace(one.sequence, numbers.size()).first->second;
  std::ranges::stable_sort(values, {}, [](const Value& one) { return std::abs(one.value); });
  Spread spread = spread_of(values, std::vector<double>(numbers.size(), 1.0));
  add_intervals(values, numbers.size(), spread);
  return spread;
}

// The sample of `track` that is nearest to `time_s`, which lies before that of index `end`.
const BearingSample* nearest_before(const std::vector<const BearingSample*>& track,
                                    std::size_t end,
                                    double time_s) {
  const auto last = track.begin() + static_cast<std::ptrdiff_t>(end);
  const auto after = std::lower_bound(
      track.begin(), last, time_s, [](const BearingSample* a, double t) { return a->time_s < t; });
  const BearingSample* best = nullptr;
  if (after != last) best = *after;
  if (after != track.begin()) {
    const BearingSample* before = *std::prev(after);
    if (best == nullptr || std::abs(before->time_s - time_s) <= std::abs(best->time_s - time_s))
      best = before;
  }
  return best != nullptr && std::abs(best->time_s - time_s) <= kRateTolerance_s ? best : nullptr;
}

}  // namespace

std::optional<BearingError> bearing_error(std::span<const BearingSample> samples) {
  if (samples.empty()) return std::nullopt;
  std::vector<Value> azimuths;
  std::vector<Value> elevations;
  std::map<std::pair<std::size_t, std::int64_t>, std::vector<const BearingSample*>> tracks;
  for (const BearingSample& sample : samples) {
    azimuths.push_back({sample.sequence, sample.azimuth_mrad});
    elevations.push_back({sample.sequence, sample.elevation_mrad});
    tracks[{sample.sequence, sample.object}].push_back(&sample);
  }
  std::vector<Value> azimuth_rates;
  std::vector<Value> elevation_rates;
  for (const auto& [object, track] : tracks)
    for (std::size_t i = 1; i < track.size(); ++i) {
      const BearingSample& now = *track[i];
      const BearingSample* before = nearest_before(track, i, now.time_s - kRateBase_s);
      if (before == nullptr) continue;
      const double seconds = now.time_s - before->time_s;
      azimuth_rates.push_back({now.sequence, (now.azimuth_mrad - before->azimuth_mrad) / seconds});
      elevation_rates.push_back(
          {now.sequence, (now.elevation_mrad - before->elevation_mrad) / seconds});
    }
  BearingError error{spread_of(std::move(azimuths)), spread_of(std::move(elevations)), {}, {}};
  if (!azimuth_rates.empty()) {
    error.azimuth_rate = spread_of(std::move(azimuth_rates));
    error.elevation_rate = spread_of(std::move(elevation_rates));
  }
  return error;
}

}  // namespace airtruth::measures
