// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "foundation/geometry/transform.h"

// Paths: the position, the velocity and the attitude of an object as functions of time. The world
// frame is north-east-down in metres; docs/conventions.md.
//
// Example: spline_at_speed({(0, 0, -150), (300, 0, -150)}, 30) flies 300 m north at 30 m/s and 150
// m above the origin. It starts at 0 s and ends at 10 s; at(4) has the position (120, 0, -150), the
// velocity (30, 0, 0) and a yaw, pitch and roll of 0; at(11) is empty.
namespace airtruth::trajectory {

// Position, velocity and attitude at one time.
struct State {
  Vector3 position_in_world = Vector3::Zero();
  Vector3 velocity_in_world_mps = Vector3::Zero();
  Quaternion world_from_body = Quaternion::Identity();

  Rigid world_from_body_rigid() const { return {world_from_body, position_in_world}; }
};

// Angles of the attitude that the user states. A stated angle replaces the one that follows from
// the path; an empty one leaves it.
struct AttitudeOverride {
  std::optional<double> yaw_deg;
  std::optional<double> pitch_deg;
  std::optional<double> roll_deg;
};

// Shortest difference between two times, in seconds. Times that differ by less count as equal.
constexpr double kShortestStep_s = 1e-6;

// A path over the times [start_s, end_s]. The object does not exist outside of them. Paths are
// immutable and cheap to copy.
class Path {
 public:
  // `at` is called only with times from start_s to end_s, by several threads at once.
  Path(double start_s, double end_s, std::function<State(double time_s)> at)
      : start_s_(start_s), end_s_(end_s), at_(std::move(at)) {}

  // The state at a time. The result is empty before the start, after the end, and for a time that
  // is not finite.
  std::optional<State> at(double time_s) const;
  double start_s() const { return start_s_; }
  // The last time of the path; +infinity for uniform and steady flight, whose start is -infinity.
  double end_s() const { return end_s_; }

 private:
  double start_s_;
  double end_s_;
  std::function<State(double time_s)> at_;
};

// A cubic spline (C2) through the waypoints, flown from time 0 at constant speed along the curve.
// The arc length is integrated by Gauss-Legendre quadrature (Abramowitz and Stegun, eq. 25.4.30).
// The heading and the climb angle follow from the tangent and the bank angle from a coordinated
// turn, tan(bank) = (lateral acceleration) / g; each angle that `attitude` states replaces the
// computed one.
//
// An Error is thrown for fewer than two waypoints, two equal neighbours, a number that is not
// finite, and a speed that is not positive. The Error names no file: the caller adds the line of
// the scene.
Path spline_at_speed(std::span<const Vector3> waypoints_ned_m,
                     double speed_mps,
                     const AttitudeOverride& attitude = {});

// The same spline, flown through the waypoints at the stated, strictly increasing times. Where it
// is slower over the ground than kCourseMps, its heading is held (Heading), its bank is that of the
// acceleration across the heading, and its climb angle goes to 0 with its speed.
Path spline_at_times(std::span<const Vector3> waypoints_ned_m,
                     std::span<const double> times_s,
                     const AttitudeOverride& attitude = {});

// The same path, delayed by `start_s` seconds.
Path shifted(const Path& path, double start_s);

// The same path, which goes straight on before its beginning and after its end, to these times.
Path straight_on(const Path& path, double start_s, double end_s);

// The same path, at the attitudes that a function gives for its state and the time.
Path at_attitudes(const Path& path,
                  std::function<Quaternion(const State&, double time_s)> world_from_body);

// The same path, at one attitude throughout.
Path at_attitude(const Path& path, const YawPitchRoll& attitude);

// The same path, displaced by a constant vector.
Path displaced(const Path& path, const Vector3& offset_ned_m);

// Straight flight at constant velocity and attitude. The path has neither start nor end.
Path uniform(const Vector3& position_ned_m,
             const Vector3& velocity_ned_mps,
             const YawPitchRoll& attitude);

// Positions at strictly increasing times, and the angles that are stated for them.
struct Samples {
  std::vector<double> times_s;
  std::vector<Vector3> positions_ned_m;
  // Yaw, pitch and roll of each sample; used where has_angle is true, and empty where none is.
  std::vector<Vector3> angles_deg;
  std::array<bool, 3> has_angle{};
};

// The C2 spline through samples, flown as that at times. Between equal neighbouring positions it
// stands still, and the spline ends there and begins anew (C1). An angle that the samples state
// follows a spline through its unwrapped values, and three together also across the pole
// (nearest_angles()); any other angle is that of `otherwise`, or follows from the path as above.
// The samples must hold at least two times.
Path path_through_samples(const Samples& samples, const AttitudeOverride& otherwise = {});

// Flight at constant speed, climb and rate of turn: a straight line or a helix. It passes
// `position_ned_m` at `time_s` and has neither start nor end.
struct SteadyFlight {
  Vector3 position_ned_m = Vector3::Zero();
  double time_s = 0;
  // Direction over the ground at that time, from north towards east.
  double course_deg = 0;
  double ground_speed_mps = 0;
  double climb_mps = 0;      // positive up
  double turn_rate_dps = 0;  // positive to the right
};
// The wings bank as in a coordinated turn; each angle that `attitude` states replaces that of the
// flight.
Path steady(const SteadyFlight& flight, const AttitudeOverride& attitude = {});

// Reads a sampled path: CSV with a header and the columns
// time_s,north_m,east_m,down_m[,yaw_deg,pitch_deg,roll_deg] in any order. The position follows the
// C2 spline through the samples. An angle that the file states follows a spline through its
// unwrapped samples; any other angle follows from the path as above. The path goes straight on for
// half a millisecond at both ends, since a container may round the times of its frames.
//
// Errors carry file and line: a missing or unknown column (the message offers the nearest
// spelling), a cell that is not a number, times that do not increase, fewer than two rows.
Path read_path_file(const std::filesystem::path& path);
Path parse_path_csv(std::string_view text, const std::filesystem::path& name);
// The samples of such a file, with the same errors.
Samples read_path_samples(const std::filesystem::path& path);

}  // namespace airtruth::trajectory
