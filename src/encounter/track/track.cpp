// SPDX-License-Identifier: Apache-2.0
#include "encounter/track/track.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "foundation/base/error.h"

namespace airtruth::track {
namespace {

// The derivative at times[at] of the parabola through the samples middle - 1, middle and middle + 1
// (divided differences; Abramowitz and Stegun, 25.1.2).
Vector3 parabola_slope(const Track& track, std::size_t middle, std::size_t at) {
  const auto& t = track.times_s;
  const auto& p = track.positions_ned_m;
  const Vector3 before = (p[middle] - p[middle - 1]) / (t[middle] - t[middle - 1]);
  const Vector3 after = (p[middle + 1] - p[middle]) / (t[middle + 1] - t[middle]);
  const Vector3 half_curvature = (after - before) / (t[middle + 1] - t[middle - 1]);
  return before + half_curvature * (2 * t[at] - t[middle - 1] - t[middle]);
}

}  // namespace

std::vector<Vector3> velocities_of(const Track& track) {
  if (!track.velocities_ned_mps.empty()) return track.velocities_ned_mps;
  const std::size_t count = track.size();
  std::vector<Vector3> velocities(count, Vector3::Zero());
  if (count == 2)
    velocities[0] = velocities[1] = (track.positions_ned_m[1] - track.positions_ned_m[0]) /
                                    (track.times_s[1] - track.times_s[0]);
  if (count < 3) return velocities;
  for (std::size_t i = 0; i < count; ++i)
    velocities[i] = parabola_slope(track, std::clamp<std::size_t>(i, 1, count - 2), i);
  return velocities;
}

Track with_velocities(Track track) {
  track.velocities_ned_mps = velocities_of(track);
  return track;
}

TrackState state_at(const Track& track, double time_s) {
  check(!track.times_s.empty() && track.velocities_ned_mps.size() == track.size(),
        "the track has samples with velocities");
  const auto& t = track.times_s;
  const auto after = std::ranges::upper_bound(t, time_s);
  if (after == t.begin()) return {track.positions_ned_m.front(), track.velocities_ned_mps.front()};
  if (after == t.end()) return {track.positions_ned_m.back(), track.velocities_ned_mps.back()};
  const auto i = static_cast<std::size_t>(std::distance(t.begin(), after)) - 1;
  const double step = t[i + 1] - t[i];
  const double u = (time_s - t[i]) / step;
  const Vector3& p = track.positions_ned_m[i];
  const Vector3 chord = track.positions_ned_m[i + 1] - p;
  const Vector3 v = track.velocities_ned_mps[i] * step;
  const Vector3 w = track.velocities_ned_mps[i + 1] * step;
  const Vector3 square = 3 * chord - 2 * v - w;
  const Vector3 cube = v + w - 2 * chord;
  return {p + u * (v + u * (square + u * cube)), (v + u * (2 * square + 3 * u * cube)) / step};
}

Track with_samples_at(const Track& track, const std::vector<double>& times_s) {
  Track result{track.name, {}, {}, {}};
  std::set_union(track.times_s.begin(),
                 track.times_s.end(),
                 times_s.begin(),
                 times_s.end(),
                 std::back_inserter(result.times_s));
  std::erase_if(result.times_s, [&](double time_s) {
    return time_s < track.times_s.front() || time_s > track.times_s.back();
  });
  for (const double time_s : result.times_s) {
    const TrackState state = state_at(track, time_s);
    result.positions_ned_m.push_back(state.position_ned_m);
    result.velocities_ned_mps.push_back(state.velocity_ned_mps);
  }
  return result;
}

void turn_and_move(Track& track,
                   double angle_rad,
                   const Vector3& pivot_ned_m,
                   const Vector3& shift_m) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const auto turned = [&](const Vector3& v) {
    return Vector3(c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z());
  };
  for (Vector3& position : track.positions_ned_m)
    position = turned(position - pivot_ned_m) + pivot_ned_m + shift_m;
  for (Vector3& velocity : track.velocities_ned_mps) velocity = turned(velocity);
}

}  // namespace airtruth::track
