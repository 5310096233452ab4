// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/flyable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "aircraft/fleet/flight_limits.h"
#include "foundation/geometry/transform.h"

namespace airtruth::setup {
namespace {

constexpr double kSampleStep_s = 0.05;
constexpr int kMaxSamples = 4000;
constexpr double kTurnStep_s = 0.01;  // over which the turn rate is taken
// At lower ground speeds a heading has no meaning.
constexpr double kHeadingMps = 1;
// Tolerance as a share of a limit, so that a path drawn at the limit is within it.
constexpr double kToleratedShare = 1e-3;

double ground_speed_mps(const Vector3& v) { return std::hypot(v.x(), v.y()); }

// The bank of the coordinated turn that the path flies at that time; empty at its ends.
std::optional<double> turn_bank_deg(const trajectory::Path& path, double time_s) {
  const auto before = path.at(time_s - kTurnStep_s);
  const auto after = path.at(time_s + kTurnStep_s);
  if (!before || !after) return std::nullopt;
  const Vector3& a = before->velocity_in_world_mps;
  const Vector3& b = after->velocity_in_world_mps;
  const double speed_mps = 0.5 * (ground_speed_mps(a) + ground_speed_mps(b));
  if (speed_mps < kHeadingMps) return std::nullopt;
  const double turn_rad = std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
  return degrees(
      std::atan(speed_mps * turn_rad / (2 * kTurnStep_s) / aircraft::kStandardGravityMps2));
}

// The five quantities, each with the largest share by which it leaves its limit.
class Worst {
 public:
  explicit Worst(const aircraft::FlightLimits& limits) : limits_(limits) {}

  void look(const trajectory::Path& path, double time_s) {
    using Quantity = BeyondLimit::Quantity;
    const auto state = path.at(time_s);
    if (!state) return;
    const Vector3& velocity = state->velocity_in_world_mps;
    const double speed_mps = velocity.norm();
    above(Quantity::kFast, time_s, speed_mps, limits_.fastest_mps);
    if (speed_mps < limits_.slowest_mps * (1 - kToleratedShare))
      take({Quantity::kSlow, time_s, speed_mps, limits_.slowest_mps},
           limits_.slowest_mps - speed_mps);
    above(Quantity::kClimb, time_s, -velocity.z(), limits_.most_climb_mps);
    above(Quantity::kDescent, time_s, velocity.z(), limits_.most_descent_mps);
    if (const auto bank_deg = turn_bank_deg(path, time_s))
      above(Quantity::kBank, time_s, std::abs(*bank_deg), limits_.most_bank_deg);
  }

  std::vector<BeyondLimit> found() const {
    std::vector<BeyondLimit> result;
    for (const auto& [what, by] : worst_)
      if (by > 0) result.push_back(what);
    return result;
  }

 private:
  void above(BeyondLimit::Quantity quantity, double time_s, double value, double limit) {
    if (value > limit * (1 + kToleratedShare))
      take({quantity, time_s, value, limit}, value - limit);
  }
  void take(const BeyondLimit& what, double by) {
    auto& worst = worst_[static_cast<std::size_t>(what.quantity)];
    if (by > worst.second) worst = {what, by};
  }

  const aircraft::FlightLimits& limits_;
  std::array<std::pair<BeyondLimit, double>, 5> worst_{};
};

std::string limit_words(const BeyondLimit& beyond) {
  const auto text = [&](const char* format) {
    return fmt::format(fmt::runtime(format), beyond.time_s, beyond.value, beyond.limit);
  };
  switch (beyond.quantity) {
    case BeyondLimit::Quantity::kFast:
      return text("at {:.2f} s it flies {:.1f} m/s, the fastest of its class {:.0f} m/s");
    case BeyondLimit::Quantity::kSlow:
      return text("at {:.2f} s it flies {:.1f} m/s, the slowest of its class {:.0f} m/s");
    case BeyondLimit::Quantity::kBank:
      return text("at {:.2f} s it banks {:.1f} degrees, its class at most {:.0f}");
    case BeyondLimit::Quantity::kClimb:
      return text("at {:.2f} s it climbs {:.1f} m/s, its class at most {:.0f} m/s");
    case BeyondLimit::Quantity::kDescent:
      return text("at {:.2f} s it descends {:.1f} m/s, its class at most {:.0f} m/s");
  }
  return {};
}

}  // namespace

std::vector<BeyondLimit> beyond_limits(const std::string& aircraft,
                                       const trajectory::Path& path,
                                       double begin_s,
                                       double end_s) {
  const aircraft::FlightLimits* limits = aircraft::flight_limits(aircraft);
  begin_s = std::max(begin_s, path.start_s());
  end_s = std::min(end_s, path.end_s());
  if (limits == nullptr || !(end_s >= begin_s)) return {};
  const int samples =
      1 + std::clamp(
              static_cast<int>(std::min((end_s - begin_s) / kSampleStep_s, 1e6)), 1, kMaxSamples);
  Worst worst(*limits);
  for (int i = 0; i < samples; ++i)
    worst.look(path, begin_s + (end_s - begin_s) * i / (samples - 1));
  return worst.found();
}

std::string words_beyond_limits(const std::string& aircraft,
                                const trajectory::Path& path,
                                double begin_s,
                                double end_s) {
  std::string words;
  for (const BeyondLimit& beyond : beyond_limits(aircraft, path, begin_s, end_s))
    words += (words.empty() ? "" : "; ") + limit_words(beyond);
  if (words.empty()) return words;
  const std::string_view name = aircraft::flight_limits(aircraft)->name;
  return fmt::format("{} ({}) cannot fly its path: {}", aircraft, name, words);
}

}  // namespace airtruth::setup
