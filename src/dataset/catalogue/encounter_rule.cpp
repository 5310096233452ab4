// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/encounter_rule.h"

#include <cmath>
#include <map>
#include <string>

#include <fmt/format.h>

#include "dataset/catalogue/drawn_rule.h"
#include "dataset/catalogue/folder.h"
#include "dataset/catalogue/names.h"
#include "encounter/model/sampler.h"
#include "encounter/track/track.h"
#include "foundation/base/seed.h"

namespace airtruth::dataset {
namespace {

using scene::Limits;
using scene::TableReader;

constexpr const char* kBayes = "bayes";
constexpr const char* kGeometric = "geometric";
// Clips of these lengths have tracks of kMaxDuration_s at kSlowestRateHz.
constexpr std::int64_t kMaxFrames = 86'000;
// The rate for which the closest approach is drawn where the rule states no time.
constexpr double kUsualRateHz = 30;
constexpr Limits kMiss{.expected = "metres from -1e5 to 1e5", .low = -1e5, .high = 1e5};
constexpr Limits kCourse{.expected = "degrees from -360 to 360", .low = -360, .high = 360};
constexpr Limits kHorizontalSpeed{
    .expected = "metres a second from 0 to 1000", .low = 0, .high = 1000};
constexpr Limits kClimb{.expected = "metres a second from -300 to 300", .low = -300, .high = 300};
constexpr Limits kTurnRate{.expected = "degrees a second from -90 to 90", .low = -90, .high = 90};
constexpr Limits kShareOfBin{.expected = "a share from 0 to 1e9", .low = 0, .high = 1e9};

// A number, or the edges of bins; with the shares of the bins at `shares_key`, if that is not "".
encounter::Distribution distribution_in(const TableReader& table,
                                        const char* key,
                                        const char* shares_key,
                                        const Limits& limits,
                                        const encounter::Distribution& otherwise) {
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
    return encounter::Distribution(edges, shares, key);
  } catch (const Error& error) {
    table.fail(key, error.message());
  }
}

std::vector<std::size_t> bins_in(const TableReader& table, const char* key) {
  std::vector<std::size_t> bins;
  const Limits limits{.expected = "numbers of the model's bins, from 1", .low = 1, .high = 1000};
  for (const double number : table.numbers(key, limits).value_or(std::vector<double>{})) {
    if (number != std::floor(number))
      table.fail(key, fmt::format("{} holds {}; expected whole numbers", key, number));
    bins.push_back(static_cast<std::size_t>(number));
  }
  return bins;
}

encounter::Cut cut_in(const TableReader& table) {
  encounter::Cut cut{bins_in(table, "domains"), bins_in(table, "airspaces"), {}};
  const Limits altitude{.expected = "feet from 0 to 1e5", .low = 0, .high = 1e5};
  if (const auto range = table.tuple("altitude_ft", {altitude, altitude}))
    cut.altitude_ft = {(*range)[0], (*range)[1]};
  return cut;
}

// A key that has no effect is refused.
void refuse_keys(const TableReader& table,
                 std::initializer_list<const char*> keys,
                 const char* kind) {
  for (const char* key : keys)
    if (table.has(key))
      table.fail(key, fmt::format("{} has no effect with kind = \"{}\"", key, kind));
}

void read_geometry(const TableReader& table, EncounterRule& rule) {
  encounter::GeometricOptions& geometry = rule.geometry;
  const double clip_s = static_cast<double>(rule.frame_count) / kUsualRateHz;
  geometry.cpa_time_s = distribution_in(
      table, "cpa_time_s", "", scene::kTime, encounter::Distribution({0.2 * clip_s, 0.8 * clip_s}));
  if (geometry.cpa_time_s.low() < 0 || geometry.cpa_time_s.high() > rule.length_s)
    table.fail("cpa_time_s",
               fmt::format("cpa_time_s is outside of the clip; expected 0 to {} s", rule.length_s));
  geometry.hmd_m = distribution_in(table, "hmd_m", "hmd_shares", kMiss, geometry.hmd_m);
  geometry.vmd_m = distribution_in(table, "vmd_m", "vmd_shares", kMiss, geometry.vmd_m);
  geometry.course_deg = distribution_in(table, "course_deg", "", kCourse, geometry.course_deg);
  geometry.speed_mps =
      distribution_in(table, "speed_mps", "", kHorizontalSpeed, geometry.speed_mps);
  geometry.climb_mps = distribution_in(table, "climb_mps", "", kClimb, geometry.climb_mps);
  geometry.turn_rate_dps =
      distribution_in(table, "turn_rate_dps", "", kTurnRate, geometry.turn_rate_dps);
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
  encounter::SampleOptions options{rule.seed, rule.length_s, cut_in(table)};
  try {
    rule.tracks = std::make_shared<const encounter::Sampler>(
        encounter::read_model(is_copy && fs::exists(kept) ? kept : *file), options);
  } catch (const Error& error) {
    throw Error(error.what(), table.where("model"));
  }
}

EncounterRule rule_from(const TableReader& table, const Catalogue& catalogue) {
  EncounterRule rule;
  rule.where = table.where();
  rule.name = table.file_name("name").value_or("e{index}");
  expect_parts(table, rule.name, {"{index}"});
  if (rule.name.find("{index}") == std::string::npos)
    table.fail("name", "name has no {index}; every sequence needs its own");
  rule.seed = Seed(catalogue.seed).stream("encounters of " + rule.name)();
  rule.count = table.whole("count", 1, kMost).value_or(1);
  rule.frame_count = table.whole("frame_count", 1, kMaxFrames).value_or(rule.frame_count);
  rule.length_s = static_cast<int>(std::ceil(double(rule.frame_count) / kSlowestRateHz)) + 1;
  rule.backgrounds = places_of(table, "backgrounds", catalogue.backgrounds, "background");
  rule.types = types_in(table);
  const Limits share{.expected = "a share from 0 to 1", .low = 0, .high = 1};
  rule.negatives = table.number("negatives", share).value_or(catalogue.negatives);
  rule.two_intruders = table.number("two_intruders", share).value_or(0);
  read_geometry(table, rule);
  const auto kind = table.choice("kind", {kBayes, kGeometric});
  if (!kind) throw Error("has no kind; expected \"bayes\" or \"geometric\"", table.where());
  if (*kind == kBayes) {
    refuse_keys(table, {"course_deg", "speed_mps", "climb_mps", "turn_rate_dps"}, kBayes);
    read_model(table, catalogue, rule);
  } else {
    refuse_keys(table, {"model", "domains", "airspaces", "altitude_ft"}, kGeometric);
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
  for (const TableReader& table :
       root.tables("encounter_model",
                   {"name",         "kind",      "model",      "count",         "frame_count",
                    "backgrounds",  "aircraft",  "domains",    "airspaces",     "altitude_ft",
                    "cpa_time_s",   "hmd_m",     "hmd_shares", "vmd_m",         "vmd_shares",
                    "course_deg",   "speed_mps", "climb_mps",  "turn_rate_dps", "negatives",
                    "two_intruders"}))
    rules.push_back(rule_from(table, catalogue));
  refuse_same_files(rules);
  return rules;
}

}  // namespace airtruth::dataset
