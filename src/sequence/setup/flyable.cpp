// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/flyable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "aircraft/fleet/flight_limits.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/units.h"
#include "sequence/setup/world.h"

namespace airtruth::setup {
namespace {

constexpr double kSampleStep_s = 0.05;  // between looks at the path: chosen
constexpr int kMaxSamples = 4000;       // of a long path, whose looks are further apart
constexpr double kTurnStep_s = 0.01;    // over which the turn rate is taken
// At lower ground speeds a heading has no meaning.
constexpr double kHeadingMps = 1;
// Tolerance as a share of a limit, so that a path drawn at the limit is within it.
constexpr double kToleratedShare = 1e-3;

// The times at which paths are looked at.
std::vector<double> sampled_times(double begin_s, double end_s) {
  const int samples =
      1 + std::clamp(
              static_cast<int>(std::min((end_s - begin_s) / kSampleStep_s, 1e6)), 1, kMaxSamples);
  std::vector<double> times(static_cast<std::size_t>(samples));
  for (int i = 0; i < samples; ++i)
    times[static_cast<std::size_t>(i)] = begin_s + (end_s - begin_s) * i / (samples - 1);
  return times;
}

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
  return degrees(std::atan(speed_mps * turn_rad / (2 * kTurnStep_s) / kStandardGravityMps2));
}

using fleet::FlightLimits;

// What a class limits, and how an excess of it reads.
struct Limited {
  double FlightLimits::*limit;
  double sign;  // -1: the limit is the least, not the most
  const char* words;
};
constexpr std::array<Limited, 5> kLimited = {{
    {&FlightLimits::fastest_mps, 1, "flies {:.1f} m/s, the fastest of its class {:.0f} m/s"},
    {&FlightLimits::slowest_mps, -1, "flies {:.1f} m/s, the slowest of its class {:.0f} m/s"},
    {&FlightLimits::most_bank_deg, 1, "banks {:.1f} degrees, its class at most {:.0f}"},
    {&FlightLimits::most_climb_mps, 1, "climbs {:.1f} m/s, its class at most {:.0f} m/s"},
    {&FlightLimits::most_descent_mps, 1, "descends {:.1f} m/s, its class at most {:.0f} m/s"},
}};

// The quantities at a time, in the same order; empty where the path is not there.
std::optional<std::array<double, 5>> flown(const trajectory::Path& path, double time_s) {
  const auto state = path.at(time_s);
  if (!state) return std::nullopt;
  const Vector3& velocity = state->velocity_in_world_mps;
  return std::array{velocity.norm(),
                    velocity.norm(),
                    std::abs(turn_bank_deg(path, time_s).value_or(0)),
                    -velocity.z(),
                    velocity.z()};
}

// The greatest excess of a limit; 0: none.
struct Excess {
  double by = 0;
  double time_s = 0;  // on the path's clock
  double value = 0;   // m/s, or degrees of bank
};

struct Lowest {
  double down_m = -std::numeric_limits<double>::infinity();
  double time_s = 0;
};

// Where a path is lowest from 0 to end_s.
Lowest lowest(const trajectory::Path& path, double end_s) {
  Lowest lowest;
  for (const double time_s : sampled_times(0, end_s))
    if (const auto state = path.at(time_s); state && state->position_in_world.z() > lowest.down_m)
      lowest = {state->position_in_world.z(), time_s};
  return lowest;
}

}  // namespace

std::string words_beyond_limits(const std::string& aircraft,
                                const trajectory::Path& path,
                                double begin_s,
                                double end_s) {
  const FlightLimits* limits = fleet::flight_limits(aircraft);
  begin_s = std::max(begin_s, path.start_s());
  end_s = std::min(end_s, path.end_s());
  if (limits == nullptr || !(end_s >= begin_s)) return "";
  std::array<Excess, kLimited.size()> worst;
  for (const double time_s : sampled_times(begin_s, end_s)) {
    const auto values = flown(path, time_s);
    for (std::size_t k = 0; values && k < kLimited.size(); ++k) {
      const double limit = limits->*kLimited[k].limit;
      const double sign = kLimited[k].sign;
      const double by = sign * ((*values)[k] - limit);
      if (!(sign * (*values)[k] > limit * (sign + kToleratedShare)) || by <= worst[k].by) continue;
      worst[k] = {by, time_s, (*values)[k]};
    }
  }
  std::string words;
  for (std::size_t k = 0; k < kLimited.size(); ++k) {
    if (!(worst[k].by > 0)) continue;
    words += words.empty() ? fmt::format("{} ({}) cannot fly its path: ", aircraft, limits->name)
                           : std::string("; ");
    words +=
        fmt::format("at {:.2f} s it ", worst[k].time_s) +
        fmt::format(fmt::runtime(kLimited[k].words), worst[k].value, limits->*kLimited[k].limit);
  }
  return words;
}

void warn_not_flyable(const scene::Intruder& intruder,
                      const trajectory::Path& path,
                      double end_s,
                      const Warn& to_warn) {
  const std::string words = words_beyond_limits(intruder.aircraft, path, 0, end_s);
  if (!words.empty())
    warn(to_warn,
         fmt::format("{}: intruder '{}': {}", to_string(intruder.where), intruder.id, words));
}

void warn_below_ground(const scene::Scene& scene,
                       const World& world,
                       double end_s,
                       const Warn& to_warn) {
  if (lowest(world.camera, end_s).down_m >= 0) return;
  for (std::size_t i = 0; i < world.actors.size();) {
    const Where where = scene.intruders[i].where;
    Lowest worst;
    std::string id;
    int below = 0;
    for (; i < world.actors.size() && to_string(scene.intruders[i].where) == to_string(where);
         ++i) {
      const Lowest here = lowest(world.actors[i].path, end_s);
      if (!(here.down_m > 0)) continue;
      ++below;
      if (here.down_m > worst.down_m) worst = here, id = world.actors[i].id;
    }
    if (below > 0)
      warn(to_warn,
           fmt::format("{}: intruder '{}'{} is {:.1f} m below the ground (down = 0) at {:.2f} s",
                       to_string(where),
                       id,
                       below > 1 ? fmt::format(", the lowest of {},", below) : "",
                       worst.down_m,
                       worst.time_s));
  }
}

}  // namespace airtruth::setup
