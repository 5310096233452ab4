// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "foundation/geometry/transform.h"

// Where something is at each time. World is north-east-down in metres; docs/conventions.md.
namespace airtruth::trajectory {

struct State {
  Vector3 position_in_world = Vector3::Zero();
  Vector3 velocity_in_world_mps = Vector3::Zero();
  Quaternion world_from_body = Quaternion::Identity();

  Rigid world_from_body_rigid() const { return {world_from_body, position_in_world}; }
};

// Parts of the attitude that are stated rather than taken from the path.
struct AttitudeOverride {
  std::optional<double> yaw_deg;
  std::optional<double> pitch_deg;
  std::optional<double> roll_deg;
};

// Times that increase by less count as equal.
constexpr double kShortestStep_s = 1e-6;

// A path over [0, duration_s]; before and after it there is nothing. Immutable, cheap to copy.
class Path {
 public:
  // Empty before start and after the end.
  std::optional<State> at(double time_s) const;
  double start_s() const;
  double end_s() const;  // +infinity for a uniform path

  struct Impl;
  explicit Path(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

 private:
  std::shared_ptr<const Impl> impl_;
};

// A C2 cubic spline through the waypoints, flown at constant speed along the curve (arc length by
// Gauss-Legendre quadrature). Attitude: heading and climb from the tangent, bank from a coordinated
// turn, tan(bank) = (lateral acceleration) / g, each replaced where `attitude` states it. Errors
// (std::string_view of the scene's line is added by the caller): fewer than two waypoints, two
// equal neighbours, a number that is not finite, a speed that is not positive.
Path spline_at_speed(std::span<const Vector3> waypoints_ned_m,
                     double speed_mps,
                     const AttitudeOverride& attitude = {});

// The same through the waypoints at stated, strictly increasing times.
Path spline_at_times(std::span<const Vector3> waypoints_ned_m,
                     std::span<const double> times_s,
                     const AttitudeOverride& attitude = {});

// The same path, `start_s` later.
Path shifted(const Path& path, double start_s);

// Straight at constant velocity and attitude, for ever in both directions of time.
Path uniform(const Vector3& position_ned_m,
             const Vector3& velocity_ned_mps,
             const YawPitchRoll& attitude);

// A sampled path: CSV with a header, columns
// time_s,north_m,east_m,down_m[,yaw_deg,pitch_deg,roll_deg] in any order. Positions by the C2
// spline through the samples; angles, where given, by unwrapped spline, else from the path as
// above. Errors carry file and line: missing or unknown column (nearest spelling), a cell that is
// no number, times that do not increase, fewer than two rows.
Path read_path_file(const std::filesystem::path& path, const AttitudeOverride& attitude = {});
Path parse_path_csv(std::string_view text,
                    const std::filesystem::path& name,
                    const AttitudeOverride& attitude = {});

}  // namespace airtruth::trajectory
