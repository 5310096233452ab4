// SPDX-License-Identifier: Apache-2.0
#include "scene/trajectory/path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"
#include "foundation/geometry/units.h"
#include "scene/trajectory/heading.h"

namespace airtruth::trajectory {

namespace {

// Below this horizontal speed, in metres a second, or this share of the length of a curve's
// tangent, what flies at a stated speed goes straight up or down.
constexpr double kHorizontalMps = 1e-6;
// Points that are nearer to each other are the same.
constexpr double kSamePointM = 1e-6;
// Largest coordinate, in metres. It keeps squares and lengths far from overflow.
constexpr double kFarthestM = 1e9;

// Where a spline stands still before its first knot, or after its last one: its slope is 0 there.
struct Rests {
  bool before = false;
  bool after = false;
};

// Second derivatives at the knots: the tridiagonal system of a continuous slope, solved by Thomas's
// algorithm.
std::vector<Vector3> second_derivatives(std::span<const double> t,
                                        std::span<const Vector3> p,
                                        const Rests& rests) {
  const std::size_t n = p.size();
  std::vector<Vector3> m(n, Vector3::Zero());
  std::vector<double> upper(n, 0.0);
  const auto slope = [&](std::size_t i) -> Vector3 {
    return (p[i + 1] - p[i]) / (t[i + 1] - t[i]);
  };
  if (rests.before) {
    upper[0] = 0.5;
    m[0] = 3.0 / (t[1] - t[0]) * slope(0);
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = t[i] - t[i - 1];
    const double after = t[i + 1] - t[i];
    const Vector3 right = 6.0 * (slope(i) - slope(i - 1));
    const double pivot = 2.0 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    m[i] = (right - before * m[i - 1]) / pivot;
  }
  if (rests.after)
    m[n - 1] = (-6.0 / (t[n - 1] - t[n - 2]) * slope(n - 2) - m[n - 2]) / (2.0 - upper[n - 2]);
  for (std::size_t i = n - 1; i-- > 0;) m[i] -= upper[i] * m[i + 1];
  return m;
}

// A natural cubic spline (C2, second derivative 0 at both ends) through points at strictly
// increasing knots. Two points make a straight line. Source: de Boor (1978), chapter IV. A spline
// that `rests` where neighbouring points are equal holds the value there; each stretch between
// rests is a spline whose slope is 0 at its rests (C1).
class CubicSpline {
 public:
  CubicSpline(std::vector<double> knots, std::vector<Vector3> points, bool rests = false)
      : knots_(std::move(knots)),
        points_(std::move(points)),
        rests_(rests),
        curvature_(points_.size(), Vector3::Zero()) {
    const std::size_t pieces = points_.size() - 1;
    for (std::size_t first = 0; first < pieces; ++first) {
      if (is_rest(first)) continue;
      std::size_t last = first + 1;
      while (last < pieces && !is_rest(last)) ++last;
      const std::size_t count = last - first + 1;
      std::ranges::copy(second_derivatives(std::span(knots_).subspan(first, count),
                                           std::span(points_).subspan(first, count),
                                           {first > 0, last < pieces}),
                        curvature_.begin() + static_cast<std::ptrdiff_t>(first));
      first = last;
    }
  }

  // The value (derivative 0) or the derivative 1 or 2 at u. A u outside the knots' range is clamped
  // to it.
  Vector3 at(double u, int derivative) const {
    u = std::clamp(u, begin(), end());
    const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, u);
    const auto i = static_cast<std::size_t>(after - knots_.begin()) - 1;
    if (is_rest(i)) return derivative == 0 ? points_[i] : Vector3::Zero();
    const double h = knots_[i + 1] - knots_[i];
    const double a = (knots_[i + 1] - u) / h;
    const double b = (u - knots_[i]) / h;
    if (derivative == 2) return a * curvature_[i] + b * curvature_[i + 1];
    if (derivative == 1) {
      return (points_[i + 1] - points_[i]) / h +
             h / 6.0 * ((3 * b * b - 1) * curvature_[i + 1] - (3 * a * a - 1) * curvature_[i]);
    }
    return a * points_[i] + b * points_[i + 1] +
           h * h / 6.0 * ((a * a * a - a) * curvature_[i] + (b * b * b - b) * curvature_[i + 1]);
  }
  double begin() const { return knots_.front(); }
  double end() const { return knots_.back(); }
  const std::vector<double>& knots() const { return knots_; }

 private:
  bool is_rest(std::size_t piece) const { return rests_ && points_[piece] == points_[piece + 1]; }

  std::vector<double> knots_;
  std::vector<Vector3> points_;
  bool rests_;
  // Second derivatives at the knots, beside a rest those of the stretch.
  std::vector<Vector3> curvature_;
};

// Heading and climb angle from the velocity, bank angle from a coordinated turn: tan(bank) = v_h *
// turn rate / g, which is the acceleration across the heading over g. What is slow has the heading
// that is kept and banks by the acceleration across it; it is level where it stands still.
YawPitchRoll attitude_along(const Vector3& velocity,
                            const Vector3& acceleration,
                            const std::optional<double>& kept_yaw_deg,
                            double least_mps) {
  const double horizontal = std::hypot(velocity.x(), velocity.y());
  YawPitchRoll attitude;
  attitude.pitch_deg = velocity.norm() > 0 ? degrees(std::atan2(-velocity.z(), horizontal)) : 0.0;
  if (kept_yaw_deg) {
    attitude.pitch_deg *= std::min(1.0, velocity.norm() / least_mps);
    attitude.yaw_deg = *kept_yaw_deg;
    const double yaw = radians(*kept_yaw_deg);
    const double across_mps2 = acceleration.y() * std::cos(yaw) - acceleration.x() * std::sin(yaw);
    // Without the sign of a zero.
    if (across_mps2 != 0)
      attitude.roll_deg = degrees(std::atan2(across_mps2, kStandardGravityMps2));
    return attitude;
  }
  attitude.yaw_deg = degrees(std::atan2(velocity.y(), velocity.x()));
  const double turn_rate = (velocity.x() * acceleration.y() - velocity.y() * acceleration.x()) /
                           (horizontal * horizontal);
  attitude.roll_deg = degrees(std::atan2(horizontal * turn_rate, kStandardGravityMps2));
  return attitude;
}

State state_with(const Vector3& position,
                 const Vector3& velocity,
                 YawPitchRoll attitude,
                 const AttitudeOverride& stated) {
  attitude.yaw_deg = stated.yaw_deg.value_or(attitude.yaw_deg);
  attitude.pitch_deg = stated.pitch_deg.value_or(attitude.pitch_deg);
  attitude.roll_deg = stated.roll_deg.value_or(attitude.roll_deg);
  return {position, velocity, world_from_body(attitude)};
}

// A spline that an object flies along. Neighbouring points may be equal: the object then stands
// still. Below `least`, of its derivative, it keeps its heading.
class Curve : public CubicSpline {
 public:
  Curve(std::vector<double> knots,
        std::vector<Vector3> points,
        const AttitudeOverride& stated,
        double least)
      : CubicSpline(std::move(knots), std::move(points), true),
        stated_(stated),
        least_(least),
        heading_([this](double u) { return at(u, 1); }, this->knots(), least) {}
  // Where the knots are times.
  State state_at(double t) const { return state(t, at(t, 1), at(t, 2)); }
  State state(double u, const Vector3& velocity, const Vector3& acceleration) const {
    std::optional<double> kept_yaw_deg;
    if (heading_.is_slow(velocity)) kept_yaw_deg = heading_.held_deg_at(u).value_or(0);
    return state_with(
        at(u, 0), velocity, attitude_along(velocity, acceleration, kept_yaw_deg, least_), stated_);
  }

 private:
  AttitudeOverride stated_;
  double least_;
  Heading heading_;
};

// The angles of all samples, without turns by 360 degrees from one to the next in yaw and roll. An
// attitude whose angles are all sampled goes across the pole.
std::vector<Vector3> unwrapped_angles(const Samples& samples) {
  const bool all_sampled = samples.has_angle == std::array{true, true, true};
  std::vector<Vector3> angles = samples.angles_deg;
  angles.resize(samples.times_s.size(), Vector3::Zero());
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (all_sampled) {
      angles[i] = nearest_angles(angles[i], angles[i - 1]);
      continue;
    }
    for (const int axis : {0, 2})
      angles[i][axis] = nearest_turn(angles[i][axis], angles[i - 1][axis]);
  }
  return angles;
}

// A path at constant speed. The arc length comes from five-point Gauss-Legendre quadrature on equal
// parts of each span (Abramowitz and Stegun, eq. 25.4.30).
class AtSpeed {
 public:
  AtSpeed(std::vector<double> knots,
          std::vector<Vector3> points,
          double speed,
          const AttitudeOverride& stated)
      : curve_(std::move(knots), std::move(points), stated, kHorizontalMps), speed_(speed) {
    // Number of equal parts of a span.
    constexpr int kParts = 64;
    u_.push_back(curve_.begin());
    length_.push_back(0);
    for (std::size_t i = 0; i + 1 < curve_.knots().size(); ++i) {
      const double a = curve_.knots()[i];
      const double h = (curve_.knots()[i + 1] - a) / kParts;
      for (int part = 0; part < kParts; ++part) {
        length_.push_back(length_.back() + arc(a + h * part, a + h * (part + 1)));
        u_.push_back(a + h * (part + 1));
      }
    }
  }
  double end_s() const { return length_.back() / speed_; }
  State at(double t) const {
    const double u = parameter(t * speed_);
    const Vector3 slope = curve_.at(u, 1);
    const Vector3 bend = curve_.at(u, 2);
    const double rate = slope.norm();
    if (rate < 1e-12) return curve_.state(u, Vector3::Zero(), Vector3::Zero());
    const Vector3 tangent = slope / rate;
    const Vector3 curvature =
        // The derivative of the unit tangent by arc length.
        (bend - tangent * tangent.dot(bend)) / (rate * rate);
    return curve_.state(u, speed_ * tangent, speed_ * speed_ * curvature);
  }

 private:
  double arc(double a, double b) const {
    // Nodes and weights on [-1, 1], from the middle outwards.
    constexpr double kNode[] = {0.0, 0.5384693101056831, 0.9061798459386640};
    constexpr double kWeight[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    const double middle = 0.5 * (a + b);
    const double half = 0.5 * (b - a);
    double sum = kWeight[0] * curve_.at(middle, 1).norm();
    for (int i = 1; i < 3; ++i)
      sum += kWeight[i] * (curve_.at(middle - half * kNode[i], 1).norm() +
                           curve_.at(middle + half * kNode[i], 1).norm());
    return half * sum;
  }
  // The spline's parameter at an arc length: the table gives the first guess and Newton's method
  // refines it.
  double parameter(double length) const {
    const auto after = std::upper_bound(length_.begin() + 1, length_.end() - 1, length);
    const auto i = static_cast<std::size_t>(after - length_.begin()) - 1;
    const double span = length_[i + 1] - length_[i];
    double u = u_[i] + (span > 0 ? (length - length_[i]) / span : 0.0) * (u_[i + 1] - u_[i]);
    for (int n = 0; n < 8; ++n) {
      const double rate = curve_.at(u, 1).norm();
      if (rate < 1e-12) break;
      const double step = (length - length_[i] - arc(u_[i], u)) / rate;
      u = std::clamp(u + step, u_[i], u_[i + 1]);
      if (std::abs(step) < 1e-14 * (1 + std::abs(u))) break;
    }
    return u;
  }

  Curve curve_;
  double speed_;
  std::vector<double> u_;
  std::vector<double> length_;
};

State steady_state(const SteadyFlight& flight, const AttitudeOverride& stated, double time_s) {
  const double after_s = time_s - flight.time_s;
  const double rate = radians(flight.turn_rate_dps);
  const double course = radians(flight.course_deg);
  const double speed_mps = flight.ground_speed_mps;
  // The chord of a turn by an angle has the direction of half the angle and the length of the arc
  // times sin(angle / 2) / (angle / 2).
  const double half_angle = 0.5 * rate * after_s;
  const double share = std::abs(half_angle) < 1e-6 ? 1 - half_angle * half_angle / 6
                                                   : std::sin(half_angle) / half_angle;
  const double chord_m = speed_mps * after_s * share;
  const Vector3 moved(chord_m * std::cos(course + half_angle),
                      chord_m * std::sin(course + half_angle),
                      -flight.climb_mps * after_s);
  const double now = course + 2 * half_angle;
  const Vector3 velocity(speed_mps * std::cos(now), speed_mps * std::sin(now), -flight.climb_mps);
  const Vector3 acceleration(-velocity.y() * rate, velocity.x() * rate, 0);
  std::optional<double> kept_yaw_deg;
  if (!(speed_mps > kHorizontalMps)) kept_yaw_deg = degrees(now);
  return state_with(flight.position_ned_m + moved,
                    velocity,
                    attitude_along(velocity, acceleration, kept_yaw_deg, kHorizontalMps),
                    stated);
}

constexpr double kEndless = std::numeric_limits<double>::infinity();

void check_waypoints(std::span<const Vector3> points) {
  if (points.size() < 2)
    throw Error(
        fmt::format("waypoints_ned_m has {}; expected at least two waypoints", points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(points[i].cwiseAbs().maxCoeff() <= kFarthestM) || !points[i].allFinite())
      throw Error(fmt::format("waypoint {} is [{:g}]; expected finite numbers within 1e9 m",
                              i + 1,
                              fmt::join(points[i], ", ")));
    if (i > 0 && (points[i] - points[i - 1]).norm() < kSamePointM)
      throw Error(
          fmt::format("waypoints {} and {} are the same point [{:g}]; expected different points",
                      i,
                      i + 1,
                      fmt::join(points[i], ", ")));
  }
}

}  // namespace

std::optional<State> Path::at(double time_s) const {
  // Slack at both ends, in seconds. A frame's time is rounded to the clock of its stream, and the
  // ends belong to the path.
  constexpr double kClock = 1e-9;
  if (!std::isfinite(time_s)) return std::nullopt;
  if (!(time_s >= start_s_ - kClock && time_s <= end_s_ + kClock)) return std::nullopt;
  return at_(std::clamp(time_s, start_s_, end_s_));
}

Path spline_at_speed(std::span<const Vector3> waypoints_ned_m,
                     double speed_mps,
                     const AttitudeOverride& attitude) {
  check_waypoints(waypoints_ned_m);
  if (!std::isfinite(speed_mps) || speed_mps <= 0)
    throw Error(fmt::format("speed_mps is {:g}; expected a positive number", speed_mps));
  // The knots are the cumulative chord lengths.
  std::vector<double> knots = {0};
  for (std::size_t i = 1; i < waypoints_ned_m.size(); ++i)
    knots.push_back(knots.back() + (waypoints_ned_m[i] - waypoints_ned_m[i - 1]).norm());
  const auto curve = std::make_shared<const AtSpeed>(
      std::move(knots),
      std::vector<Vector3>(waypoints_ned_m.begin(), waypoints_ned_m.end()),
      speed_mps,
      attitude);
  return Path(0, curve->end_s(), [curve](double t) { return curve->at(t); });
}

Path spline_at_times(std::span<const Vector3> waypoints_ned_m,
                     std::span<const double> times_s,
                     const AttitudeOverride& attitude) {
  check_waypoints(waypoints_ned_m);
  if (times_s.size() != waypoints_ned_m.size())
    throw Error(fmt::format("times_s has {} numbers for {} waypoints; expected one each",
                            times_s.size(),
                            waypoints_ned_m.size()));
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (!std::isfinite(times_s[i]))
      throw Error(
          fmt::format("times_s[{}] = {:g} is not finite; expected a number", i, times_s[i]));
    if (i > 0 && !(times_s[i] - times_s[i - 1] >= kShortestStep_s))
      throw Error(fmt::format(
          "times_s[{}] = {:g} is not after times_s[{}] = {:g}; expected times that increase",
          i,
          times_s[i],
          i - 1,
          times_s[i - 1]));
  }
  const auto curve = std::make_shared<const Curve>(
      std::vector<double>(times_s.begin(), times_s.end()),
      std::vector<Vector3>(waypoints_ned_m.begin(), waypoints_ned_m.end()),
      attitude,
      kCourseMps);
  return Path(times_s.front(), times_s.back(), [curve](double t) { return curve->state_at(t); });
}

Path uniform(const Vector3& position_ned_m,
             const Vector3& velocity_ned_mps,
             const YawPitchRoll& attitude) {
  return Path(-kEndless,
              kEndless,
              [position_ned_m, velocity_ned_mps, turn = world_from_body(attitude)](double t) {
                return State{position_ned_m + t * velocity_ned_mps, velocity_ned_mps, turn};
              });
}

Path steady(const SteadyFlight& flight, const AttitudeOverride& attitude) {
  return Path(-kEndless, kEndless, [flight, attitude](double t) {
    return steady_state(flight, attitude, t);
  });
}

// Position and its derivatives follow the samples. Angles follow the samples where they state them,
// else `otherwise`, else the path.
Path path_through_samples(const Samples& samples, const AttitudeOverride& otherwise) {
  const auto along = std::make_shared<const Curve>(
      samples.times_s, samples.positions_ned_m, otherwise, kCourseMps);
  const std::array<bool, 3> sampled = samples.has_angle;
  const auto angles =
      std::make_shared<const CubicSpline>(samples.times_s, unwrapped_angles(samples));
  return Path(angles->begin(), angles->end(), [along, angles, sampled](double t) {
    State state = along->state_at(t);
    YawPitchRoll turned = yaw_pitch_roll(state.world_from_body);
    const Vector3 angle = angles->at(t, 0);
    if (sampled[0]) turned.yaw_deg = angle[0];
    if (sampled[1]) turned.pitch_deg = angle[1];
    if (sampled[2]) turned.roll_deg = angle[2];
    state.world_from_body = world_from_body(turned);
    return state;
  });
}

Path displaced(const Path& path, const Vector3& offset_ned_m) {
  return Path(path.start_s(), path.end_s(), [path, offset_ned_m](double t) {
    State state = *path.at(t);
    state.position_in_world += offset_ned_m;
    return state;
  });
}

Path straight_on(const Path& path, double start_s, double end_s) {
  return Path(std::min(start_s, path.start_s()), std::max(end_s, path.end_s()), [path](double t) {
    const double within_s = std::clamp(t, path.start_s(), path.end_s());
    State state = *path.at(within_s);
    state.position_in_world += (t - within_s) * state.velocity_in_world_mps;
    return state;
  });
}

Path at_attitudes(const Path& path,
                  std::function<Quaternion(const State&, double time_s)> world_from_body) {
  return Path(path.start_s(), path.end_s(), [path, turn = std::move(world_from_body)](double t) {
    State state = *path.at(t);
    state.world_from_body = turn(state, t);
    return state;
  });
}

Path at_attitude(const Path& path, const YawPitchRoll& attitude) {
  return at_attitudes(path,
                      [turn = world_from_body(attitude)](const State&, double) { return turn; });
}

Path shifted(const Path& path, double start_s) {
  return Path(path.start_s() + start_s, path.end_s() + start_s, [path, start_s](double t) {
    return *path.at(std::clamp(t - start_s, path.start_s(), path.end_s()));
  });
}

}  // namespace airtruth::trajectory
