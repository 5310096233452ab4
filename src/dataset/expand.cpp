// SPDX-License-Identifier: Apache-2.0
#include "dataset/expand.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/seed.h"

namespace airtruth::dataset {
namespace {

constexpr double kRateHz =
    30;  // of a background whose own rate is not known yet: only for drawing when they meet

std::int64_t size_of(const Rule& rule) {
  if (const auto* product = std::get_if<Product>(&rule))
    return static_cast<std::int64_t>(product->backgrounds.size()) *
           static_cast<std::int64_t>(product->trajectories.size()) *
           static_cast<std::int64_t>(product->aircraft.size());
  if (const auto* drawn = std::get_if<Drawn>(&rule)) return drawn->count;
  return 1;
}

std::string filled(std::string pattern, std::string_view key, const std::string& value) {
  for (std::size_t at = pattern.find(key); at != std::string::npos;
       at = pattern.find(key, at + value.size()))
    pattern.replace(at, key.size(), value);
  return pattern;
}

scene::Scene scene_over(const Catalogue& catalogue, const Background& background) {
  scene::Scene scene;
  scene.lens = background.lens;
  scene.camera = background.camera;
  scene.motion = background.motion;
  scene.camera_model = background.camera_model;
  scene.realism = background.realism;
  scene.light = background.light;
  scene.render = catalogue.render;
  scene.composite = catalogue.composite;
  scene.output = catalogue.output;
  scene.file = catalogue.file;
  scene.background.where = background.where;
  return scene;
}

std::int64_t frames_of(const Catalogue& catalogue,
                       std::size_t background,
                       const std::optional<std::int64_t>& own,
                       const std::optional<std::int64_t>& of_trajectory) {
  if (own) return *own;
  if (of_trajectory) return *of_trajectory;
  const auto* flight =
      std::get_if<synthetic::FlightOptions>(&catalogue.backgrounds[background].source);
  return flight != nullptr ? flight->frame_count : 0;  // 0: to the video's end
}

Item item_of(const Catalogue& catalogue,
             const std::string& name,
             std::size_t background,
             std::size_t trajectory,
             std::size_t aircraft,
             const std::optional<std::int64_t>& frame_count) {
  Item item;
  item.name = name;
  item.background = background;
  const Trajectory& path = catalogue.trajectories[trajectory];
  item.frame_count = frames_of(catalogue, background, frame_count, path.frame_count);
  item.scene = scene_over(catalogue, catalogue.backgrounds[background]);
  scene::Intruder intruder;
  intruder.id = catalogue.aircraft[aircraft].name;
  intruder.aircraft = catalogue.aircraft[aircraft].aircraft;
  intruder.waypoints_ned_m = path.waypoints_ned_m;
  intruder.times_s = path.times_s;
  intruder.speed_mps = path.speed_mps;
  intruder.where = path.where;
  item.scene.intruders = {intruder};
  return item;
}

Item item_of(const Catalogue& catalogue, const Listed& rule, std::int64_t) {
  return item_of(
      catalogue, rule.name, rule.background, rule.trajectory, rule.aircraft, rule.frame_count);
}

Item item_of(const Catalogue& catalogue, const Product& rule, std::int64_t index) {
  auto i = static_cast<std::size_t>(index);
  const std::size_t aircraft = rule.aircraft[i % rule.aircraft.size()];
  i /= rule.aircraft.size();
  const std::size_t trajectory = rule.trajectories[i % rule.trajectories.size()];
  const std::size_t background = rule.backgrounds[i / rule.trajectories.size()];
  std::string name = filled(rule.name, "{background}", catalogue.backgrounds[background].name);
  name = filled(name, "{trajectory}", catalogue.trajectories[trajectory].name);
  name = filled(name, "{aircraft}", catalogue.aircraft[aircraft].name);
  return item_of(catalogue, name, background, trajectory, aircraft, rule.frame_count);
}

double drawn(Random& random, const Range& range) { return random.uniform(range.low, range.high); }

template <typename T>
const T& drawn(Random& random, const std::vector<T>& things) {
  return things[std::min(
      things.size() - 1,
      static_cast<std::size_t>(random.uniform() * static_cast<double>(things.size())))];
}

// Straight through a point of the view at a moment of the clip, well past both its ends.
std::vector<Vector3> straight_line(Random& random,
                                   const Drawn& rule,
                                   const scene::Camera& camera,
                                   double speed_mps,
                                   double clip_s) {
  const double meeting_s = random.uniform(0.2, 0.8) * clip_s;
  const double range_m =
      rule.range_m.low * std::pow(rule.range_m.high / rule.range_m.low, random.uniform());
  const double azimuth = radians(drawn(random, rule.azimuth_deg));
  const double elevation = radians(drawn(random, rule.elevation_deg));
  const double heading = radians(drawn(random, rule.heading_deg));
  const double climb = radians(drawn(random, rule.climb_deg));
  const Vector3 in_body(std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth),
                        -std::sin(elevation));
  const Vector3 meeting = camera.position_ned_m + meeting_s * camera.velocity_ned_mps +
                          range_m * (world_from_body(camera.attitude_yaw_pitch_roll_deg) * in_body);
  const Vector3 velocity = speed_mps * Vector3(std::cos(climb) * std::cos(heading),
                                               std::cos(climb) * std::sin(heading),
                                               -std::sin(climb));
  return {meeting - meeting_s * velocity, meeting + (clip_s + 1 - meeting_s) * velocity};
}

Item item_of(const Catalogue& catalogue, const Drawn& rule, std::int64_t index) {
  Random random =
      Seed(catalogue.seed).stream("sequence " + rule.name, static_cast<std::uint64_t>(index));
  Item item;
  item.name = filled(rule.name, "{index}", fmt::format("{:06}", index));
  item.background = drawn(random, rule.backgrounds);
  item.frame_count = rule.frame_count;
  item.scene = scene_over(catalogue, catalogue.backgrounds[item.background]);
  scene::Intruder intruder;
  intruder.id = "intruder";
  intruder.aircraft = drawn(random, rule.aircraft);
  const double clip_s = static_cast<double>(rule.frame_count) / kRateHz;
  intruder.speed_mps = drawn(random, rule.speed_mps);
  intruder.waypoints_ned_m =
      straight_line(random, rule, item.scene.camera, *intruder.speed_mps, clip_s);
  if (rule.sun_azimuth_deg) item.scene.light.sun_azimuth_deg = drawn(random, *rule.sun_azimuth_deg);
  if (rule.sun_elevation_deg)
    item.scene.light.sun_elevation_deg = drawn(random, *rule.sun_elevation_deg);
  item.scene.intruders = {intruder};
  return item;
}

}  // namespace

Expansion::Expansion(const Catalogue& catalogue) : catalogue_(catalogue) {
  for (const Rule& rule : catalogue.rules) {
    first_.push_back(size_);
    size_ += size_of(rule);
  }
}

Item Expansion::at(std::int64_t index) const {
  check(index >= 0 && index < size_, "a sequence's number is within its catalogue");
  const auto after = std::upper_bound(first_.begin(), first_.end(), index);
  const auto rule = static_cast<std::size_t>(after - first_.begin()) - 1;
  Item item =
      std::visit([&](const auto& r) { return item_of(catalogue_, r, index - first_[rule]); },
                 catalogue_.rules[rule]);
  item.index = index;
  item.scene.name = item.name;
  item.scene.seed = catalogue_.seed;
  return item;
}

void place(Item& item, const Catalogue& catalogue, const BackgroundFiles& files) {
  const Background& background = catalogue.backgrounds[item.background];
  item.scene.background.video = files.video;
  item.scene.background.mask = files.mask;
  item.scene.background.first_frame = background.first_frame;
  if (item.frame_count > 0) item.scene.background.frame_count = item.frame_count;
}

bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0;
  std::size_t n = 0;
  std::size_t star = std::string_view::npos;  // the last *, and where in the name it was met
  std::size_t met = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] != '*' && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      met = n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++met;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace airtruth::dataset
