// SPDX-License-Identifier: Apache-2.0
#include "scene/flight_log/local_path.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <GeographicLib/Ellipsoid.hpp>
#include <fmt/format.h>

#include "foundation/base/error.h"

namespace airtruth::flight_log {
namespace {

// Frames before the first record and after the last one take the path on for so long: a log of one
// record a second ends up to a second before its video.
constexpr double kMaxExtensionS = 1.5;

template <typename Record>
std::size_t after(const std::vector<Record>& records, double time_s) {
  const auto later = std::ranges::upper_bound(records, time_s, {}, &Record::time_s);
  return static_cast<std::size_t>(later - records.begin());
}

// A value between the two records around a time, or of the nearest one outside of them.
template <typename Record, typename Value>
auto between(const std::vector<Record>& records, double time_s, const Value& value) {
  const std::size_t next = after(records, time_s);
  if (next == 0) return value(records.front());
  if (next == records.size()) return value(records.back());
  const Record &a = records[next - 1], &b = records[next];
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  const auto before = value(a);
  return decltype(before)(before + share * (value(b) - before));
}

template <typename Record>
void require_covered(const std::vector<Record>& records, const char* what, double offset_s) {
  const double first_s = records.front().time_s, last_s = records.back().time_s;
  if (offset_s >= first_s - kMaxExtensionS && offset_s <= last_s + kMaxExtensionS) return;
  throw Error(fmt::format(
      "the log's {} go from {:.2f} to {:.2f} s, and the clip begins at {:.3f} s of the log; "
      "expected a log of the same flight, or another log_offset_s",
      what,
      first_s,
      last_s,
      offset_s));
}

// Positions within this time count as one.
constexpr double kBinS = 0.5;

// How many of the fixes [begin, end), whose places are equal, count. Writers of more records than
// the receiver's hold a position until its next one: where they could fill two bins, which would be
// a rest of the path, the first of them is the receiver's. Two fixes can from a third of a second
// on, more of them from half a second on; both with a margin for times that jitter. What stands
// still for longer than receivers take hovers; it then does so until the receiver's last position
// before the next one, about a second before.
std::size_t number_that_counts(const std::vector<Fix>& fixes, std::size_t begin, std::size_t end) {
  constexpr double kHoverS = 2, kReceiverS = 0.9;
  const double length_s = fixes[end - 1].time_s - fixes[begin].time_s;
  if (length_s < (end - begin == 2 ? 0.6 : 0.9) * kBinS) return end - begin;
  if (length_s <= kHoverS) return 1;
  if (end == fixes.size()) return end - begin;
  const double next_s = fixes[end].time_s;
  while (end > begin + 1 && next_s - fixes[end - 1].time_s < kReceiverS) --end;
  return end - begin;
}

std::vector<Fix> without_repeats(const std::vector<Fix>& fixes) {
  std::vector<Fix> kept;
  for (std::size_t begin = 0; begin < fixes.size();) {
    std::size_t end = begin + 1;
    while (end < fixes.size() && fixes[end].latitude_deg == fixes[begin].latitude_deg &&
           fixes[end].longitude_deg == fixes[begin].longitude_deg)
      ++end;
    const auto first = fixes.begin() + static_cast<std::ptrdiff_t>(begin);
    kept.insert(kept.end(),
                first,
                first + static_cast<std::ptrdiff_t>(number_that_counts(fixes, begin, end)));
    begin = end;
  }
  if (kept.size() < 2) kept.push_back(fixes.back());
  return kept;
}

// North, east and down of a step, by the radii of curvature of the meridian and of the prime
// vertical in its middle.
Vector3 step_ned_m(const Fix& from, const Fix& to) {
  const GeographicLib::Ellipsoid& wgs84 = GeographicLib::Ellipsoid::WGS84();
  const double latitude_deg = 0.5 * (from.latitude_deg + to.latitude_deg);
  const double height_m = 0.5 * (from.altitude_m + to.altitude_m);
  return {(wgs84.MeridionalCurvatureRadius(latitude_deg) + height_m) *
              radians(to.latitude_deg - from.latitude_deg),
          (wgs84.TransverseCurvatureRadius(latitude_deg) + height_m) *
              std::cos(radians(latitude_deg)) *
              radians(std::remainder(to.longitude_deg - from.longitude_deg, 360)),
          from.altitude_m - to.altitude_m};
}

// The positions from the first one, in the frame that is carried along (local_path.h). Positions
// within half a second count as one, at the mean of their times: DJI's subtitles repeat a position
// of 0.1 m of resolution in every frame, and a spline through each would shake. An acceleration of
// 5 m/s2 moves the mean by 0.05 m.
trajectory::Samples local_positions(const FlightLog& log, double offset_s) {
  trajectory::Samples samples;
  Fix before = log.fixes.front();
  Vector3 position = Vector3::Zero();
  double bin = 0, members = 0;
  for (const Fix& fix : without_repeats(log.fixes)) {
    const double time_s = fix.time_s - offset_s;
    position += step_ned_m(before, fix);
    before = fix;
    if (samples.times_s.empty() || std::floor(time_s / kBinS) != bin) {
      samples.times_s.push_back(time_s);
      samples.positions_ned_m.push_back(position);
      bin = std::floor(time_s / kBinS), members = 1;
    } else {
      ++members;
      samples.times_s.back() += (time_s - samples.times_s.back()) / members;
      samples.positions_ned_m.back() += (position - samples.positions_ned_m.back()) / members;
    }
  }
  return samples;
}

// No aircraft needs more, and the world of a scene ends at such speeds (scene::kSpeed).
constexpr double kFastestMps = 1e4;

void require_flyable(const trajectory::Samples& samples, double offset_s) {
  for (std::size_t i = 1; i < samples.times_s.size(); ++i) {
    const double step_m = (samples.positions_ned_m[i] - samples.positions_ned_m[i - 1]).norm();
    const double step_s = samples.times_s[i] - samples.times_s[i - 1];
    if (!(step_m <= kFastestMps * step_s))
      throw Error(
          fmt::format("the log's positions jump {:.0f} m in {:.2f} s at {:.2f} s of the "
                      "log; expected less than {:.0f} m/s",
                      step_m,
                      step_s,
                      samples.times_s[i] + offset_s,
                      kFastestMps));
  }
}

// Adds positions before the first one and after the last one, at the velocity that the first two
// and the last two tell for there; where there are more, their change of it goes on.
void extend(trajectory::Samples& samples) {
  auto& times = samples.times_s;
  auto& positions = samples.positions_ned_m;
  const std::size_t n = times.size();
  const auto velocity = [&](std::size_t a, std::size_t b) -> Vector3 {
    return (positions[b] - positions[a]) / (times[b] - times[a]);
  };
  Vector3 first = velocity(0, 1), last = velocity(n - 2, n - 1);
  if (n > 2) {
    first = 2 * first - velocity(1, 2);
    last = 2 * last - velocity(n - 3, n - 2);
  }
  const Vector3 before = positions[0] - kMaxExtensionS * first;
  const Vector3 behind = positions[n - 1] + kMaxExtensionS * last;
  times.push_back(times.back() + kMaxExtensionS);
  positions.push_back(behind);
  times.insert(times.begin(), times.front() - kMaxExtensionS);
  positions.insert(positions.begin(), before);
}

}  // namespace

trajectory::Path local_path(const FlightLog& log, const Placement& placement) {
  const double offset_s = placement.offset_s;
  require_covered(log.fixes, "positions", offset_s);
  if (!log.attitudes.empty()) require_covered(log.attitudes, "attitudes", offset_s);
  trajectory::Samples samples = local_positions(log, offset_s);
  if (samples.times_s.size() < 2)
    throw Error(
        "the log's positions span less than half a second; expected one a second or "
        "more");
  require_flyable(samples, offset_s);
  extend(samples);
  // The spline ends beside the means of half seconds. What require_covered() has let through is
  // reached whatever the rounding of a log's clock.
  const trajectory::Path flown =
      trajectory::straight_on(trajectory::path_through_samples(samples),
                              std::min(0.0, log.fixes.front().time_s - offset_s - kMaxExtensionS),
                              std::max(0.0, log.fixes.back().time_s - offset_s + kMaxExtensionS));
  const trajectory::Path placed =
      trajectory::displaced(flown, placement.first_position_ned_m - flown.at(0)->position_in_world);
  if (log.attitudes.empty()) return placed;
  const trajectory::Path covered(
      std::max(placed.start_s(),
               std::min(0.0, log.attitudes.front().time_s - offset_s - kMaxExtensionS)),
      std::min(placed.end_s(),
               std::max(0.0, log.attitudes.back().time_s - offset_s + kMaxExtensionS)),
      [placed](double time_s) { return *placed.at(time_s); });
  // Attitudes are recorded more often than positions are averaged.
  const auto attitudes = std::make_shared<const FlightLog>(FlightLog{.attitudes = log.attitudes});
  return trajectory::at_attitudes(
      covered, [attitudes, offset_s](const trajectory::State&, double time_s) {
        return world_from_body(*attitude_at(*attitudes, time_s + offset_s));
      });
}

std::optional<double> height_at(const FlightLog& log, double time_s) {
  if (log.fixes.empty()) return std::nullopt;
  const std::size_t next = after(log.fixes, time_s);
  const Fix& before = log.fixes[next == 0 ? 0 : next - 1];
  const Fix& later = log.fixes[std::min(next, log.fixes.size() - 1)];
  if (!before.height_m || !later.height_m) return std::nullopt;
  return between(log.fixes, time_s, [](const Fix& fix) { return fix.height_m.value_or(0.0); });
}

std::optional<YawPitchRoll> attitude_at(const FlightLog& log, double time_s) {
  if (log.attitudes.empty()) return std::nullopt;
  const std::size_t next = after(log.attitudes, time_s);
  const Vector3 before = vector_of(numbers_of(log.attitudes[next == 0 ? 0 : next - 1].angles));
  const Vector3 angles = between(log.attitudes, time_s, [&](const Attitude& attitude) {
    return nearest_angles(vector_of(numbers_of(attitude.angles)), before);
  });
  const YawPitchRoll found{angles.x(), angles.y(), angles.z()};
  return std::abs(found.pitch_deg) > 90 ? yaw_pitch_roll(world_from_body(found)) : found;
}

}  // namespace airtruth::flight_log
