// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/encounter_rule.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "aircraft/fleet/flight_limits.h"
#include "dataset/catalogue/catalogue.h"
#include "dataset/catalogue/drawing.h"
#include "dataset/catalogue/drawn_rule.h"
#include "dataset/catalogue/folder.h"
#include "dataset/catalogue/meeting.h"
#include "encounter/encounter_model/sampler.h"
#include "encounter/pairing/strata.h"
#include "encounter/sets/sets.h"
#include "encounter/track/track.h"
#include "foundation/base/error.h"
#include "foundation/base/seed.h"
#include "foundation/geometry/units.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/moment.h"

namespace airtruth::catalogue {
namespace {

using scene::Limits;
using scene::TableReader;

constexpr const char* kBayes = "bayes";
constexpr const char* kGeometric = "geometric";
// Clips of these lengths have tracks of kMaxDuration_s at kSlowestRateHz.
constexpr std::int64_t kMaxFrames = 86'000;
// The rate for which the closest approach is drawn where the rule states no time.
constexpr double kUsualRateHz = 30;
constexpr Limits kClimb{"metres a second from -300 to 300", -300, 300};
constexpr Limits kShareOfBin{"a share from 0 to 1e9", 0, 1e9};

// A number, or the edges of bins; with the shares of the bins at `shares_key`, if that is not "".
pairing::Distribution distribution_in(const TableReader& table,
                                      const char* key,
                                      const char* shares_key,
                                      const Limits& limits,
                                      const pairing::Distribution& otherwise) {
  std::vector<double> shares;
  if (*shares_key != '\0' && table.has(shares_key)) {
    if (!table.has(key))
      table.fail(shares_key, fmt::format("{} is for {}, which is not there", shares_key, key));
    shares = *table.numbers(shares_key, kShareOfBin);
  }
  if (!table.has(key)) return otherwise;
  std::vector<double> edges;
  if (table.is_array(key))
    edges = *table.numbers(key, limits);
  else
    edges = {*table.number(key, limits)};
  try {
    return pairing::Distribution(edges, shares, key);
  } catch (const Error& error) {
    table.fail(key, error.message());
  }
}

std::vector<std::size_t> bins_in(const TableReader& table, const char* key) {
  std::vector<std::size_t> bins;
  const Limits limits{"numbers of the model's bins, from 1", 1, 1000};
  for (const double number : table.numbers(key, limits).value_or(std::vector<double>{})) {
    if (number != std::floor(number))
      table.fail(key, fmt::format("{} holds {}; expected whole numbers", key, number));
    bins.push_back(static_cast<std::size_t>(number));
  }
  return bins;
}

encounter_model::Cut cut_in(const TableReader& table) {
  const Limits altitude{"feet from 0 to 1e5", 0, 1e5};
  return {bins_in(table, "domains"),
          bins_in(table, "airspaces"),
          table.tuple<std::array<double, 2>>("altitude_ft", altitude)};
}

void read_geometry(const TableReader& table, EncounterRule& rule) {
  pairing::GeometricOptions& geometry = rule.geometry;
  const double clip_s = static_cast<double>(rule.frame_count) / kUsualRateHz;
  geometry.cpa_time_s = distribution_in(
      table, "cpa_time_s", "", scene::kTime, pairing::Distribution({0.2 * clip_s, 0.8 * clip_s}));
  if (geometry.cpa_time_s.low() < 0 || geometry.cpa_time_s.high() > rule.length_s)
    table.fail("cpa_time_s",
               fmt::format("cpa_time_s is outside of the clip; expected 0 to {} s", rule.length_s));
  geometry.hmd_m = distribution_in(table, "hmd_m", "hmd_shares", scene::kMiss, geometry.hmd_m);
  geometry.vmd_m = distribution_in(table, "vmd_m", "vmd_shares", scene::kMiss, geometry.vmd_m);
  geometry.course_deg = distribution_in(table, "course_deg", "", scene::kTurn, geometry.course_deg);
  rule.states_speed = table.has("speed_mps");
  geometry.speed_mps = distribution_in(table, "speed_mps", "", scene::kSpeed, geometry.speed_mps);
  geometry.climb_mps = distribution_in(table, "climb_mps", "", kClimb, geometry.climb_mps);
  geometry.turn_rate_dps =
      distribution_in(table, "turn_rate_dps", "", scene::kTurnRate, geometry.turn_rate_dps);
}

void read_model(const TableReader& table, const Catalogue& catalogue, EncounterRule& rule) {
  const auto file = table.path("model");
  if (!file) throw Error("has no model; expected the file of an encounter model", table.where());
  for (const char* key : {"hmd_m", "vmd_m"}) {
    const auto& distance = *key == 'h' ? rule.geometry.hmd_m : rule.geometry.vmd_m;
    if (!(distance.low() < distance.high()))
      table.fail(key, fmt::format("{} is a single value; expected a range", key));
  }
  rule.model_file = *file;
  const fs::path folder = catalogue.file.parent_path();
  const bool is_copy = fs::is_directory(Folder{folder}.sequences());
  const fs::path kept = kept_model(folder, *file);
  encounter_model::SampleOptions options{rule.seed, rule.length_s, cut_in(table)};
  try {
    rule.tracks = std::make_shared<const encounter_model::Sampler>(
        encounter_model::read_model(is_copy && fs::exists(kept) ? kept : *file), options);
  } catch (const Error& error) {
    throw Error(error.what(), table.where("model"));
  }
}

EncounterRule rule_from(const TableReader& table, const Catalogue& catalogue) {
  EncounterRule rule{numbered_rule(table, catalogue, "e{index}", 240, kMaxFrames)};
  rule.seed = Seed(catalogue.seed).stream("encounters of " + rule.name)();
  rule.length_s = static_cast<int>(std::ceil(double(rule.frame_count) / kSlowestRateHz)) + 1;
  const Limits share{"a share from 0 to 1", 0, 1};
  rule.negatives = table.number("negatives", share).value_or(catalogue.negatives);
  rule.two_intruders = table.number("two_intruders", share).value_or(0);
  rule.in_view = table.truth("in_view").value_or(true);
  const Limits seen{"seconds from 0 to 3600", 0, 3600};
  rule.seen_s = table.number("seen_s", seen).value_or(rule.seen_s);
  if (!rule.in_view && table.has("seen_s"))
    table.fail("seen_s", "seen_s is for in_view = true, and in_view is false");
  read_geometry(table, rule);
  const auto kind = table.choice("kind", {kBayes, kGeometric});
  if (!kind) throw Error("has no kind; expected \"bayes\" or \"geometric\"", table.where());
  if (*kind == kBayes) {
    table.refuse({"course_deg", "speed_mps", "climb_mps", "turn_rate_dps"}, kBayes);
    read_model(table, catalogue, rule);
  } else {
    table.refuse({"model", "domains", "airspaces", "altitude_ft"}, kGeometric);
  }
  return rule;
}

// A data set keeps the models of its rules by their file names.
void refuse_same_files(const std::vector<EncounterRule>& rules) {
  std::map<fs::path, fs::path> file_of;
  for (const EncounterRule& rule : rules) {
    if (!rule.tracks) continue;
    const auto [first, is_new] = file_of.emplace(rule.model_file.filename(), rule.model_file);
    if (!is_new && first->second != rule.model_file)
      throw Error(fmt::format("the models {} and {} have the same name; expected different ones",
                              first->second.string(),
                              rule.model_file.string()),
                  rule.where);
  }
}

}  // namespace

fs::path kept_model(const fs::path& folder, const fs::path& model_file) {
  return folder / "models" / model_file.filename();
}

std::vector<EncounterRule> encounter_rules(const TableReader& root, const Catalogue& catalogue) {
  std::vector<EncounterRule> rules;
  for (const TableReader& table : root.tables(
           "encounter_model",
           scene::keys("name kind model count frame_count backgrounds aircraft domains airspaces "
                       "altitude_ft cpa_time_s hmd_m hmd_shares vmd_m vmd_shares course_deg "
                       "speed_mps climb_mps turn_rate_dps negatives two_intruders in_view seen_s")))
    rules.push_back(rule_from(table, catalogue));
  refuse_same_files(rules);
  return rules;
}

namespace {

constexpr double kOwnStep_s = 0.25;  // between the samples of the own path: chosen
// The spline through a track loses its curvature at its ends, by a factor of 0.27 a sample.
constexpr double kMargin_s = 8;
constexpr std::uint64_t kMaxTracks = 100;  // that are drawn for one intruder: chosen
// Where the indices of a next intruder and of a next attempt begin; sets are smaller.
constexpr std::uint64_t kNextIntruder = std::uint64_t{1} << 56;
constexpr std::uint64_t kNextAttempt = std::uint64_t{1} << 48;
constexpr std::int64_t kMostLooks = 1000;  // at a clip, for what is in view: chosen
constexpr std::uint64_t kNextDraw = std::uint64_t{1} << 40;

// What a track asks of an aircraft.
struct Demands {
  double slowest_mps = HUGE_VAL, fastest_mps = 0, mean_mps = 0;
  double climb_mps = 0, descent_mps = 0, bank_deg = 0;
};

Demands demands_of(const track::Track& track) {
  Demands demands;
  for (std::size_t i = 0; i < track.size(); ++i) {
    const Vector3& velocity = track.velocities_ned_mps[i];
    const double speed = velocity.norm();
    demands.slowest_mps = std::min(demands.slowest_mps, speed);
    demands.fastest_mps = std::max(demands.fastest_mps, speed);
    demands.mean_mps += speed / static_cast<double>(track.size());
    demands.climb_mps = std::max(demands.climb_mps, -velocity.z());
    demands.descent_mps = std::max(demands.descent_mps, velocity.z());
    if (i == 0) continue;
    const Vector3& before = track.velocities_ned_mps[i - 1];
    const double turned = std::atan2(before.x() * velocity.y() - before.y() * velocity.x(),
                                     before.head<2>().dot(velocity.head<2>()));
    const double rate = std::abs(turned) / (track.times_s[i] - track.times_s[i - 1]);
    // A coordinated turn.
    demands.bank_deg =
        std::max(demands.bank_deg, degrees(std::atan(speed * rate / kStandardGravityMps2)));
  }
  return demands;
}

// The largest ratio of what is asked to what the class can; up to 1 where it flies the track.
double strain(const fleet::FlightLimits& limits, const Demands& demands) {
  const double slowness =
      limits.slowest_mps > 0 ? limits.slowest_mps / std::max(demands.slowest_mps, 1e-9) : 0;
  return std::max({slowness,
                   demands.fastest_mps / limits.fastest_mps,
                   demands.climb_mps / limits.most_climb_mps,
                   demands.descent_mps / limits.most_descent_mps,
                   demands.bank_deg / limits.most_bank_deg});
}

// The types that fly the track, only those at their usual speed where there are some. Where none
// flies it, those that come nearest. A type without a class flies everything.
struct Fitting {
  std::vector<const AircraftType*> types;
  bool can_fly = false;
};
Fitting fitting_types(const EncounterRule& rule, const Demands& demands) {
  std::vector<const AircraftType*> usual, able, nearest;
  double least = HUGE_VAL;
  for (const AircraftType& type : rule.types) {
    const auto* limits = fleet::flight_limits(type.name);
    const double asked = limits == nullptr ? 0 : strain(*limits, demands);
    if (asked < least) nearest.clear();
    least = std::min(least, asked);
    if (asked == least) nearest.push_back(&type);
    if (asked > 1) continue;
    able.push_back(&type);
    if (limits != nullptr && demands.mean_mps >= limits->usual_low_mps &&
        demands.mean_mps <= limits->usual_high_mps)
      usual.push_back(&type);
  }
  if (able.empty()) return {nearest, false};
  return {usual.empty() ? able : usual, true};
}

track::Track own_track(const scene::Scene& scene, const EncounterRule& rule) {
  const trajectory::Path path = setup::camera_path(scene.camera);
  track::Track own{"own", {}, {}, {}};
  for (int i = 0; i * kOwnStep_s <= rule.length_s; ++i) {
    const auto state = path.at(i * kOwnStep_s);
    if (!state) continue;
    own.times_s.push_back(i * kOwnStep_s);
    own.positions_ned_m.push_back(state->position_in_world);
    own.velocities_ned_mps.push_back(state->velocity_in_world_mps);
  }
  if (own.size() < 2 || own.times_s.front() > 0 ||
      own.times_s.back() < rule.geometry.cpa_time_s.high())
    throw Error(fmt::format("the camera's path of the background does not hold 0 to {:.1f} s, the "
                            "times of the closest approach",
                            rule.geometry.cpa_time_s.high()),
                rule.where);
  return own;
}

bool is_high_enough(const track::Track& track, const track::Track& own, double cpa_s) {
  if (track::state_at(own, cpa_s).position_ned_m.z() > -kLowestFlightM) return true;
  return std::ranges::all_of(track.positions_ned_m,
                             [](const Vector3& p) { return p.z() <= -kLowestFlightM; });
}

struct Passage {
  track::Track track;
  double weight = 1;
};

// An intruder from the model. `number` counts sequences and intruders.
Passage from_model(const EncounterRule& rule, const track::Track& own, std::uint64_t number) {
  Random random = Seed(rule.seed).stream("closest approach", number);
  pairing::PairingOptions options;
  options.cpa_time_s = std::clamp(
      std::round(rule.geometry.cpa_time_s.quantile(random.uniform())), 0.0, own.times_s.back());
  options.hmd_m = rule.geometry.hmd_m;
  options.vmd_m = rule.geometry.vmd_m;
  const auto draw = sets::model_pairs(rule.tracks, own, options, rule.seed);
  for (std::uint64_t attempt = 0; attempt < kMaxTracks; ++attempt) {
    sets::DrawnEncounter drawn = draw(number + attempt * kNextAttempt);
    Passage passage{std::move(drawn.encounter.aircraft[1]), drawn.encounter.weight};
    if (!is_high_enough(passage.track, own, options.cpa_time_s)) continue;
    if (fitting_types(rule, demands_of(passage.track)).can_fly) return passage;
  }
  throw Error(
      fmt::format("none of {} tracks of the model is flown by an aircraft of the rule, {:.0f} "
                  "m above the ground or more; expected other aircraft, or a higher vmd_m",
                  kMaxTracks,
                  kLowestFlightM),
      rule.where);
}

Passage from_geometry(const EncounterRule& rule,
                      const track::Track& own,
                      const AircraftType& wanted,
                      std::uint64_t index,
                      std::uint64_t intruder) {
  pairing::GeometricOptions options = rule.geometry;
  const auto* limits = fleet::flight_limits(wanted.name);
  if (!rule.states_speed && limits != nullptr)
    options.speed_mps = pairing::Distribution({limits->usual_low_mps, limits->usual_high_mps});
  for (std::uint64_t attempt = 0; attempt < kMaxTracks; ++attempt) {
    const std::uint64_t seed =
        Seed(rule.seed).stream("geometry of intruder", intruder + attempt * kNextAttempt)();
    const pairing::GeometricSampler sampler(options, seed, static_cast<std::uint64_t>(rule.count));
    pairing::GeometricPassage drawn = setup::at_place(rule.where, [&] {
      return pairing::geometric_passage(sampler, index, own, -kMargin_s, rule.length_s + kMargin_s);
    });
    if (is_high_enough(drawn.track, own, drawn.geometry.approach.time_s))
      return {std::move(drawn.track), 1};
  }
  throw Error(fmt::format("none of {} intruders that were drawn stays {:.0f} m above the ground or "
                          "more; expected a higher vmd_m, or a climb_mps nearer to 0",
                          kMaxTracks,
                          kLowestFlightM),
              rule.where);
}

// True for the share of the sequences that have two intruders. A rotation by the golden ratio
// spreads them evenly, and independently of the negatives, which are evenly spaced.
bool has_second(const EncounterRule& rule, std::int64_t index) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  const double turned = Seed(rule.seed).stream("second intruders").uniform() +
                        std::fmod(static_cast<double>(index) * kGoldenRatio, 1.0);
  return std::fmod(turned, 1.0) < rule.two_intruders;
}

// The type of an intruder, each as often as the others within one in the whole rule, negative
// sequences included.
const AircraftType& wanted_type(const EncounterRule& rule, std::uint64_t index, std::uint64_t k) {
  const pairing::Strata strata(
      Seed(rule.seed).stream("types of intruder", k)(), static_cast<std::uint64_t>(rule.count), 1);
  return rule.types[static_cast<std::size_t>(
      strata.spaced(index % static_cast<std::uint64_t>(rule.count), 0) *
      static_cast<double>(rule.types.size()))];
}

// Of a long clip not every frame is looked at.
std::int64_t look_step(const Views& views) { return 1 + views.frames / kMostLooks; }

// How long the reference point of an intruder is in the view, in all.
double seen_s(const scene::Intruder& intruder, const scene::Camera& camera, const Views& views) {
  const auto looks = std::ssize(frames_in_view(intruder, camera, views));
  return static_cast<double>(looks * look_step(views)) / views.frame_rate_hz;
}

}  // namespace

std::vector<std::int64_t> frames_in_view(const scene::Intruder& intruder,
                                         const scene::Camera& camera,
                                         const Views& views) {
  const trajectory::Path own = setup::unmeasured_camera_path(camera);
  const trajectory::Path path = setup::path_of(intruder, own);
  std::vector<std::int64_t> frames;
  for (std::int64_t i = 0; i < views.frames; i += look_step(views)) {
    const double time_s = static_cast<double>(i) / views.frame_rate_hz;
    const auto from = own.at(time_s);
    const auto to = path.at(time_s);
    if (!from || !to) continue;
    const projection::Sight sight = setup::sight_of(views.lens, {}, own, *from, time_s, {});
    const auto pixel = views.lens.pixel_from_cam(sight.cam_from_world * to->position_in_world);
    if (pixel && views.lens.size().holds(*pixel)) frames.push_back(i);
  }
  return frames;
}

namespace {

struct DrawnIntruder {
  scene::Intruder intruder;
  double weight = 1;
};

DrawnIntruder drawn_intruder(const EncounterRule& rule,
                             const track::Track& own,
                             std::uint64_t index,
                             std::uint64_t k,
                             std::uint64_t draw) {
  const std::uint64_t number = index + k * kNextIntruder + draw * kNextDraw;
  const AircraftType& wanted = wanted_type(rule, index, k);
  Passage passage = rule.tracks ? from_model(rule, own, number)
                                : from_geometry(rule, own, wanted, index, k + draw * kNextDraw);
  Random random = Seed(rule.seed).stream("aircraft", number);
  const Fitting fitting = fitting_types(rule, demands_of(passage.track));
  const bool suits = std::ranges::count(fitting.types, &wanted) > 0;
  const AircraftType& type = suits ? wanted : *one_of(random, fitting.types);
  return {{.id = rule.two_intruders > 0 ? fmt::format("intruder-{}", k + 1) : "intruder",
           .aircraft = one_of(random, type.liveries),
           .waypoints_ned_m = std::move(passage.track.positions_ned_m),
           .times_s = std::move(passage.track.times_s),
           .where = rule.where},
          passage.weight};
}

// An intruder that is in view for as long as the rule asks, or the longest of all that were drawn.
DrawnIntruder seen_intruder(const EncounterRule& rule,
                            const scene::Camera& camera,
                            const track::Track& own,
                            std::uint64_t index,
                            std::uint64_t k,
                            const Views& views,
                            Draws& draws) {
  DrawnIntruder longest;
  double longest_s = -1;
  for (std::uint64_t draw = 0; draw < kMostDraws; ++draw) {
    DrawnIntruder one = drawn_intruder(rule, own, index, k, draw);
    const double now_s = seen_s(one.intruder, camera, views);
    ++draws.drawn;
    if (now_s <= longest_s) continue;
    longest_s = now_s;
    longest = std::move(one);
    if (longest_s >= rule.seen_s) return longest;
  }
  ++draws.unseen;
  return longest;
}

// The mean weight of an intruder of the rule, whose distances are drawn evenly: its speed alone
// varies. A pair's product is counted in it, so that pairs are as large a share of all weights as
// they are of the sequences.
double mean_weight(const EncounterRule& rule, const track::Track& own, std::uint64_t number) {
  constexpr std::uint64_t kTracks = 32;  // their mean is within a tenth: chosen
  EncounterRule even = rule;
  for (pairing::Distribution* one : {&even.geometry.hmd_m, &even.geometry.vmd_m})
    *one = pairing::Distribution({one->low(), one->high()});
  double sum = 0;
  for (std::uint64_t i = 0; i < kTracks; ++i)
    sum += from_model(even, own, 2 * kNextIntruder + number * kTracks + i).weight;
  return sum / kTracks;
}

}  // namespace

std::string likely_aircraft(const EncounterRule& rule, std::int64_t index) {
  const auto number = static_cast<std::uint64_t>(index);
  Random random = Seed(rule.seed).stream("aircraft", number);
  return one_of(random, wanted_type(rule, number, 0).liveries);
}

Draws add_encounter(scene::Scene& scene,
                    const EncounterRule& rule,
                    std::int64_t index,
                    const Views& views) {
  Draws draws;
  if (is_chosen("negatives", rule.negatives, rule.seed, index)) return draws;
  const track::Track own = own_track(scene, rule);
  const auto number = static_cast<std::uint64_t>(index);
  const double clip_s = static_cast<double>(views.frames) / views.frame_rate_hz;
  if (rule.in_view && rule.seen_s > clip_s)
    throw Error(fmt::format("seen_s is {:.3g}, and the clip lasts {:.3g} s; expected at most that",
                            rule.seen_s,
                            clip_s),
                rule.where);
  double weight = 1;
  const std::uint64_t count = has_second(rule, index) ? 2 : 1;
  for (std::uint64_t k = 0; k < count; ++k) {
    DrawnIntruder one = rule.in_view
                            ? seen_intruder(rule, scene.camera, own, number, k, views, draws)
                            : drawn_intruder(rule, own, number, k, 0);
    weight *= one.weight;
    scene.intruders.push_back(std::move(one.intruder));
  }
  if (rule.tracks) scene.weight = count == 2 ? weight / mean_weight(rule, own, number) : weight;
  return draws;
}

}  // namespace airtruth::catalogue
