// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/bearing_error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace airtruth::detection {
namespace {

// A pair of samples may be this much more or less than kRateBase_s apart.
constexpr double kRateTolerance_s = 0.1;

Spread spread_of(const std::vector<double>& values) {
  Spread spread;
  spread.count = std::ssize(values);
  if (values.empty()) return spread;
  const double n = static_cast<double>(values.size());
  double sum = 0;
  double squares = 0;
  for (const double v : values) {
    sum += v;
    squares += v * v;
  }
  spread.mean = sum / n;
  spread.rms = std::sqrt(squares / n);
  double about_mean = 0;
  for (const double v : values) about_mean += (v - spread.mean) * (v - spread.mean);
  spread.deviation = values.size() > 1 ? std::sqrt(about_mean / (n - 1)) : 0;
  std::vector<double> sizes;
  for (const double v : values) sizes.push_back(std::abs(v));
  std::sort(sizes.begin(), sizes.end());
  // Interpolates between the two nearest (Hyndman and Fan 1996, type 7).
  const double at = 0.95 * (n - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sizes.size() - 1);
  spread.within_95 =
      sizes[below] + (at - static_cast<double>(below)) * (sizes[above] - sizes[below]);
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
  std::vector<double> azimuths;
  std::vector<double> elevations;
  std::map<std::pair<std::size_t, std::int64_t>, std::vector<const BearingSample*>> tracks;
  for (const BearingSample& sample : samples) {
    azimuths.push_back(sample.azimuth_mrad);
    elevations.push_back(sample.elevation_mrad);
    tracks[{sample.sequence, sample.object}].push_back(&sample);
  }
  std::vector<double> azimuth_rates;
  std::vector<double> elevation_rates;
  for (const auto& [object, track] : tracks)
    for (std::size_t i = 1; i < track.size(); ++i) {
      const BearingSample& now = *track[i];
      const BearingSample* before = nearest_before(track, i, now.time_s - kRateBase_s);
      if (before == nullptr) continue;
      const double seconds = now.time_s - before->time_s;
      azimuth_rates.push_back((now.azimuth_mrad - before->azimuth_mrad) / seconds);
      elevation_rates.push_back((now.elevation_mrad - before->elevation_mrad) / seconds);
    }
  BearingError error{spread_of(azimuths), spread_of(elevations), {}, {}};
  if (!azimuth_rates.empty()) {
    error.azimuth_rate = spread_of(azimuth_rates);
    error.elevation_rate = spread_of(elevation_rates);
  }
  return error;
}

}  // namespace airtruth::detection
