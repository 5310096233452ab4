// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/drawing.h"

#include <algorithm>
#include <cmath>

#include "aircraft/fleet/flight_limits.h"
#include "dataset/catalogue/catalogue.h"
#include "encounter/pairing/strata.h"
#include "foundation/geometry/transform.h"

namespace airtruth::catalogue {
namespace {

// Defaults where the rule states no value and the type has no class
// (aircraft/fleet/flight_limits.h).
constexpr Range kAnySpeedMps{40, 140};
constexpr Range kAnyHours{8, 17};
constexpr double kAnyBankDeg = 30;
constexpr double kUsualClimbDeg = 5;

// The number of sequences before `index` that is_chosen() chooses.
std::int64_t chosen_before(const std::string& what,
                           double share,
                           std::uint64_t seed,
                           std::int64_t index) {
  Random random = Seed(seed).stream(what);
  return static_cast<std::int64_t>(
      std::floor(static_cast<double>(index) * share + random.uniform()));
}

// The place of a sequence among those of its rule that are like it: with an intruder, or without.
// A stream goes on after the rule's count, by strata of their own for every `count` sequences.
struct Turn {
  std::uint64_t place = 0;
  std::uint64_t of = 1;
  bool is_negative = false;
  std::uint64_t round = 0;

  // The strata of a quantity, of which each place has `each`.
  pairing::Strata strata(const Seed& seed, const std::string& what, std::uint64_t each = 1) const {
    return {seed.stream(what + (is_negative ? " without an intruder" : ""), round)(), of * each, 1};
  }
};

Turn turn_of(const Drawn& rule, std::uint64_t seed, std::int64_t index) {
  const std::int64_t first = index - index % rule.count;  // of the round
  const auto chosen = [&](std::int64_t end) {
    return chosen_before("negatives of " + rule.name, rule.negatives, seed, end);
  };
  const std::int64_t before = chosen(index) - chosen(first);
  const std::int64_t negatives = chosen(first + rule.count) - chosen(first);
  const bool is_negative = chosen(index + 1) > chosen(index);
  return {static_cast<std::uint64_t>(is_negative ? before : index - first - before),
          static_cast<std::uint64_t>(is_negative ? negatives : rule.count - negatives),
          is_negative,
          static_cast<std::uint64_t>(index / rule.count)};
}

// The types take turns; the fraction of one number selects the livery.
const std::string& drawn_aircraft(Random& random,
                                  double share_of_types,
                                  const std::vector<AircraftType>& types) {
  const double at = random.uniform() * static_cast<double>(types.size());
  return one_at(at - std::floor(at), one_at(share_of_types, types).liveries);
}

// Factors and distances are even in their logarithm, but for those that may be 0.
bool is_even_in_logarithm(const scene::WeatherKey& key) { return key.limits.low > 0; }

// strata_of(key) are those of the sequence's turn, whose place is `place`.
void draw_weather(const DrawnWeather& weather,
                  std::uint64_t place,
                  const auto& strata_of,
                  DrawnSequence& result) {
  const auto share = [&](const DrawnNumber& number, const char* key) {
    const pairing::Strata strata = strata_of(key);
    return number.any_of.empty() ? strata.at(place, 0) : strata.spaced(place, 0);
  };
  if (weather.visibility_m)
    result.visibility_m =
        weather.visibility_m->at_in_logarithm(share(*weather.visibility_m, scene::kVisibilityKey));
  for (std::size_t i = 0; i < weather.factors.size(); ++i) {
    const scene::WeatherKey& key = scene::kWeatherKeys[i];
    const auto& factor = weather.factors[i];
    if (!factor) continue;
    const double at = share(*factor, key.name);
    result.weather.*key.member =
        is_even_in_logarithm(key) ? factor->at_in_logarithm(at) : factor->at(at);
  }
  result.weather.where = weather.where;
}

Range speed_range(const Drawn& rule, const fleet::FlightLimits* limits) {
  if (rule.speed_mps) return *rule.speed_mps;
  return limits != nullptr ? Range{limits->usual_low_mps, limits->usual_high_mps} : kAnySpeedMps;
}

// Limits the slope to the type's climb and descent at that speed.
Range climb_range(const Drawn& rule, const fleet::FlightLimits* limits, double speed_mps) {
  if (rule.climb_deg) return *rule.climb_deg;
  Range range{-kUsualClimbDeg, kUsualClimbDeg};
  if (limits == nullptr) return range;
  const auto angle_deg = [&](double vertical_mps) {
    return degrees(std::asin(std::min(1.0, vertical_mps / speed_mps)));
  };
  range.low = std::max(range.low, -angle_deg(limits->most_descent_mps));
  range.high = std::min(range.high, angle_deg(limits->most_climb_mps));
  return range;
}

// Below the type's usual speeds it turns no faster than at the slowest of them: a bank of 20
// degrees would spin a helicopter at walking speed once in two seconds.
double drawn_bank_deg(Random random,
                      const Drawn& rule,
                      const fleet::FlightLimits* limits,
                      double speed_mps) {
  if (rule.bank_deg) return drawn(random, *rule.bank_deg);
  if (!rule.bank_suits_type) return 0;
  double most_deg = limits != nullptr ? limits->usual_bank_deg : kAnyBankDeg;
  const double slow_mps = limits != nullptr ? limits->usual_low_mps : kAnySpeedMps.low;
  if (speed_mps < slow_mps)
    most_deg = degrees(std::atan(std::tan(radians(most_deg)) * speed_mps / slow_mps));
  return random.uniform(-most_deg, most_deg);
}

// A path by its closest approach or by what is seen; false where the rule has neither.
bool draw_stated_path(const Drawn& rule, Random of_path, Encounter& encounter) {
  if (rule.approach) {
    encounter.approach = rule.approach->draw(of_path, encounter.speed_mps);
    encounter.approaches_at_meeting = !rule.approach->cpa_time_s;
  }
  for (const DrawnSeen& seen : rule.seen) encounter.seen.push_back(seen.draw(of_path));
  return rule.approach || !rule.seen.empty();
}

// What was added later has a stream of its own, so that older catalogues draw what they drew.
Encounter drawn_encounter(
    Random& random, Random of_bank, Random of_path, double share_of_types, const Drawn& rule) {
  Encounter encounter;
  encounter.aircraft = drawn_aircraft(random, share_of_types, rule.types);
  const fleet::FlightLimits* limits = fleet::flight_limits(encounter.aircraft);
  encounter.speed_mps = drawn(random, speed_range(rule, limits));
  encounter.meeting_share = random.uniform(0.2, 0.8);
  if (draw_stated_path(rule, of_path, encounter)) return encounter;
  draw_place(random, rule.place, encounter);
  encounter.climb_deg = drawn(random, climb_range(rule, limits, encounter.speed_mps));
  encounter.bank_deg = drawn_bank_deg(of_bank, rule, limits, encounter.speed_mps);
  return encounter;
}

// The sun at a random hour of daylight.
SunPosition drawn_sun(Random random, const DaytimeRange& daytime, const std::string& aircraft) {
  Range hours = kAnyHours;
  if (daytime.hours)
    hours = *daytime.hours;
  else if (const auto* limits = fleet::flight_limits(aircraft))
    hours = {limits->first_hour, limits->last_hour};
  const Range light =
      daylight_hours(daytime.latitude_deg, daytime.day_of_year).value_or(Range{12, 12});
  const double low = std::clamp(hours.low, light.low, light.high);
  const double high = std::clamp(hours.high, light.low, light.high);
  return sun_position(random.uniform(low, high), daytime.latitude_deg, daytime.day_of_year);
}

}  // namespace

void draw_place(Random& random, const MeetingPlace& place, Encounter& encounter) {
  if (place.size_px)
    encounter.size_px = drawn_evenly_in_logarithm(random, *place.size_px);
  else
    encounter.range_m = drawn_evenly_in_logarithm(random, place.range_m);
  encounter.azimuth_deg = drawn(random, place.azimuth_deg);
  encounter.elevation_deg = drawn(random, place.elevation_deg);
  encounter.heading_deg = drawn(random, place.heading_deg);
}

std::size_t background_at(double share,
                          const std::vector<std::size_t>& among,
                          const std::vector<Background>& backgrounds) {
  double sum = 0;
  for (const std::size_t place : among) sum += backgrounds[place].weight;
  double left = sum * share;
  for (const std::size_t place : among) {
    left -= backgrounds[place].weight;
    if (left < 0) return place;
  }
  return among.back();
}

std::size_t stratified_background(const std::vector<std::size_t>& among,
                                  const std::vector<Background>& backgrounds,
                                  std::uint64_t seed,
                                  std::int64_t count,
                                  std::int64_t index) {
  const pairing::Strata strata(
      Seed(seed).stream("background")(), static_cast<std::uint64_t>(count), 1);
  return background_at(
      strata.spaced(static_cast<std::uint64_t>(index % count), 0), among, backgrounds);
}

DrawnSequence draw(const Drawn& rule,
                   const std::vector<Background>& backgrounds,
                   std::uint64_t seed_value,
                   std::int64_t index) {
  const Seed seed(seed_value);
  const auto number = static_cast<std::uint64_t>(index);
  const auto stream = [&](const std::string& of) { return seed.stream(of + rule.name, number); };
  DrawnSequence result;
  Random random = stream("sequence ");
  one_of(random, rule.backgrounds);  // so that all else is drawn as it was
  result.background = stratified_background(
      rule.backgrounds, backgrounds, seed.stream("of " + rule.name)(), rule.count, index);
  const Turn turn = turn_of(rule, seed_value, index);
  const auto each = static_cast<std::uint64_t>(rule.intruders.high);
  const pairing::Strata types = turn.strata(seed, "types of " + rule.name, each);
  Random of_count = stream("intruders of sequence ");
  const std::int64_t count = drawn(of_count, rule.intruders);
  for (std::int64_t k = 0; k < count; ++k) {
    const std::string which =
        k == 0 ? "sequence " : "intruder " + std::to_string(k + 1) + " of sequence ";
    Random other = stream(which);
    result.encounters.push_back(
        drawn_encounter(k == 0 ? random : other,
                        stream("bank of " + which),
                        stream("path of " + which),
                        types.spaced(turn.place * each + static_cast<std::uint64_t>(k), 0),
                        rule));
  }
  if (rule.sun_azimuth_deg) result.sun_azimuth_deg = drawn(random, *rule.sun_azimuth_deg);
  if (rule.sun_elevation_deg) result.sun_elevation_deg = drawn(random, *rule.sun_elevation_deg);
  if (rule.daytime) {
    const SunPosition sun =
        drawn_sun(stream("time of sequence "), *rule.daytime, result.encounters[0].aircraft);
    result.sun_azimuth_deg = sun.azimuth_deg;
    result.sun_elevation_deg = sun.elevation_deg;
  }
  Random of_start = stream("start of sequence ");
  result.start_share = of_start.uniform();
  if (rule.weather)
    draw_weather(
        *rule.weather,
        turn.place,
        [&](const char* key) { return turn.strata(seed, std::string(key) + " of " + rule.name); },
        result);
  if (is_chosen("negatives of " + rule.name, rule.negatives, seed_value, index))
    result.encounters.clear();
  return result;
}

bool is_chosen(const std::string& what, double share, std::uint64_t seed, std::int64_t index) {
  return chosen_before(what, share, seed, index + 1) > chosen_before(what, share, seed, index);
}

namespace {

constexpr double kObliquityDeg = 23.45;  // of the Earth's axis, as Cooper has it
constexpr double kDegreesPerHour = 15;   // 360 degrees in 24 hours

// P. I. Cooper, The absorption of radiation in solar stills, Solar Energy 12 (1969).
double declination_rad(int day_of_year) {
  return radians(kObliquityDeg * std::sin(radians(360.0 * (284 + day_of_year) / 365)));
}

}  // namespace

SunPosition sun_position(double hour, double latitude_deg, int day_of_year) {
  const double declination = declination_rad(day_of_year);
  const double latitude = radians(latitude_deg);
  const double turn = radians(kDegreesPerHour * (hour - 12));
  // The sun's direction in axes east, north, up.
  const double east = -std::cos(declination) * std::sin(turn);
  const double north = std::cos(latitude) * std::sin(declination) -
                       std::sin(latitude) * std::cos(declination) * std::cos(turn);
  const double up = std::sin(latitude) * std::sin(declination) +
                    std::cos(latitude) * std::cos(declination) * std::cos(turn);
  const double azimuth_deg = degrees(std::atan2(east, north));
  return {azimuth_deg < 0 ? azimuth_deg + 360 : azimuth_deg,
          degrees(std::asin(std::clamp(up, -1.0, 1.0)))};
}

std::optional<Range> daylight_hours(double latitude_deg, int day_of_year) {
  const double declination = declination_rad(day_of_year);
  const double latitude = radians(latitude_deg);
  const double lowest =
      std::sin(radians(kLowestSunDeg)) - std::sin(latitude) * std::sin(declination);
  const double widest = std::cos(latitude) * std::cos(declination);
  if (lowest >= widest) return std::nullopt;  // polar night
  const double half_h =
      lowest <= -widest ? 12 : degrees(std::acos(lowest / widest)) / kDegreesPerHour;
  return Range{12 - half_h, 12 + half_h};
}

}  // namespace airtruth::catalogue
