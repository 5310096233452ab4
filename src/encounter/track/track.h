// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "foundation/geometry/transform.h"

// The path of one aircraft as samples in time, and several such paths at once. Positions and
// velocities are in a local frame of north, east and down, in metres and metres per second
// (docs/conventions.md); the altitude is -down.
//
// Example: {"own", {0, 1}, {(0, 0, -300), (60, 0, -300)}, {}} flies north at 60 m/s, 300 m up.
namespace airtruth::track {

struct Track {
  std::string name;
  // Strictly increasing, in seconds.
  std::vector<double> times_s;
  // One for each time.
  std::vector<Vector3> positions_ned_m;
  // One for each time, or none where they are not known.
  std::vector<Vector3> velocities_ned_mps;

  std::size_t size() const { return times_s.size(); }
};

// Aircraft that fly at the same time; the own aircraft is the first.
struct Encounter {
  std::vector<Track> aircraft;
  // How many encounters of real traffic this one stands for, up to a factor that all encounters of
  // a set share. Positive.
  double weight = 1;
};

// Position and velocity at one time.
struct TrackState {
  Vector3 position_ned_m = Vector3::Zero();
  Vector3 velocity_ned_mps = Vector3::Zero();
};

// The velocities of the track: those that it states, otherwise the derivatives of the parabola
// through each sample and its two neighbours; the first and the last sample use the parabola of
// their neighbour. Two samples give one constant velocity, and one sample gives zero.
std::vector<Vector3> velocities_of(const Track& track);

// The track with its velocities filled in.
Track with_velocities(Track track);

// The state at a time from the cubic Hermite polynomial between the two samples around it; a time
// outside of the track gives its nearest end. The track must have velocities and one sample or
// more.
TrackState state_at(const Track& track, double time_s);

// The track with further samples, from state_at(), at those of the times that lie within it. The
// times increase; the track must have velocities.
Track with_samples_at(const Track& track, const std::vector<double>& times_s);

// Turns the track by `angle_rad` from north towards east about the vertical through `pivot_ned_m`,
// then moves it by `shift_m`.
void turn_and_move(Track& track,
                   double angle_rad,
                   const Vector3& pivot_ned_m,
                   const Vector3& shift_m);

}  // namespace airtruth::track
