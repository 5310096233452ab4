// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/distractor_rule.h"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "scene/scene/flock.h"

namespace airtruth::dataset {
namespace {

using scene::DistractorKind;
using scene::Limits;
using scene::TableReader;

constexpr std::int64_t kMostOfAKind = 100;
constexpr Limits kBodySize{
    .expected = "[low, high] in metres from 0.05 to 20", .low = 0.05, .high = 20};
constexpr Limits kSpreadM{.expected = "[low, high] in metres from 0 to 1e4", .low = 0, .high = 1e4};
constexpr Limits kSpotPx{
    .expected = "[low, high] in pixels from 1 to 5000", .low = 1, .high = 5000};
constexpr Limits kSpotSpeed{
    .expected = "[low, high] in pixels a second from 1 to 1e6", .low = 1, .high = 1e6};
constexpr Limits kOpacity{.expected = "[low, high] from 0.01 to 1", .low = 0.01, .high = 1};

const TableReader::Keys kAirKeys = {"size_m",
                                    "range_m",
                                    "size_px",
                                    "azimuth_deg",
                                    "elevation_deg",
                                    "heading_deg",
                                    "climb_deg",
                                    "speed_mps",
                                    "flock",
                                    "spread_m"};
const TableReader::Keys kBirdKeys = {"plumage", "glide"};
const TableReader::Keys kLensKeys = {"spot_px", "opacity", "speed_px_s"};

void refuse(const TableReader& table, const TableReader::Keys& keys, DistractorKind kind) {
  for (const std::string_view key : keys)
    if (table.has(key))
      table.fail(key, fmt::format("{} has no effect with kind = \"{}\"", key, enum_name(kind)));
}

void read(const TableReader& table, std::string_view key, const Limits& limits, Span& span) {
  if (!table.has(key)) return;
  const auto values = table.tuple(key, {limits, limits});
  if ((*values)[0] > (*values)[1])
    table.fail(key, std::string(key) + " falls; expected [low, high]");
  span = {(*values)[0], (*values)[1]};
}

// A whole number, or [low, high] of whole numbers.
void read(const TableReader& table, std::string_view key, std::int64_t most, WholeSpan& span) {
  if (!table.has(key)) return;
  if (!table.is_array(key)) {
    span.low = span.high = *table.whole(key, 1, most);
    return;
  }
  const std::string expected = fmt::format("a whole number from 1 to {}", most);
  Span numbers;
  read(table, key, {.expected = expected, .low = 1, .high = double(most)}, numbers);
  if (numbers.low != std::floor(numbers.low) || numbers.high != std::floor(numbers.high))
    table.fail(key, std::string(key) + " is no whole number; expected a number or [low, high]");
  span = {static_cast<std::int64_t>(numbers.low), static_cast<std::int64_t>(numbers.high)};
}

// The values of a rule that states its kind and nothing else: gull to eagle, a toy to a freight
// carrier, a party's to a weather station's balloon.
DistractorRule usual_rule(DistractorKind kind) {
  DistractorRule rule;
  rule.kind = kind;
  rule.plumages = {aircraft::Plumage::kGull,
                   aircraft::Plumage::kDark,
                   aircraft::Plumage::kBrown,
                   aircraft::Plumage::kGrey};
  switch (kind) {
    case DistractorKind::kBird:
      rule.size_m = {0.6, 2.2};
      rule.speed_mps = {8, 18};
      rule.climb_deg = {-5, 5};
      break;
    case DistractorKind::kMultirotor:
      rule.size_m = {0.3, 1.2};
      rule.speed_mps = {0.5, 18};
      rule.climb_deg = {-10, 10};
      break;
    case DistractorKind::kBalloon:
      // Risen by helium at 1 to 5 m/s and carried by the wind.
      rule.size_m = {0.25, 2};
      rule.speed_mps = {2, 9};
      rule.climb_deg = {15, 60};
      break;
    case DistractorKind::kGlint:
      rule.spot_px = {40, 200};
      rule.opacity = {0.1, 0.4};
      break;
    case DistractorKind::kDirt:
      rule.spot_px = {20, 120};
      rule.opacity = {0.15, 0.5};
      break;
    case DistractorKind::kInsect:
      rule.spot_px = {8, 30};
      rule.opacity = {0.4, 0.8};
      rule.speed_px_s = {600, 4000};
      break;
  }
  return rule;
}

void read_air(const TableReader& table, DistractorRule& rule) {
  refuse(table, kLensKeys, rule.kind);
  table.exclude("size_px", {"range_m"});
  read(table, "size_m", kBodySize, rule.size_m);
  read(table, "range_m", scene::kRangeToAircraft, rule.range_m);
  if (table.has("size_px")) read(table, "size_px", scene::kApparentSize, rule.size_px.emplace());
  read(table, "azimuth_deg", scene::kTurn, rule.azimuth_deg);
  read(table, "elevation_deg", scene::kPitch, rule.elevation_deg);
  read(table, "heading_deg", scene::kTurn, rule.heading_deg);
  read(table, "climb_deg", scene::kPitch, rule.climb_deg);
  read(table, "speed_mps", scene::kSpeed, rule.speed_mps);
  read(table, "flock", scene::kMaxFlock, rule.flock);
  read(table, "spread_m", kSpreadM, rule.spread_m);
  if (rule.kind != DistractorKind::kBird) return refuse(table, kBirdKeys, rule.kind);
  read(table, "glide", scene::kShare, rule.glide);
  const auto words = table.texts("plumage");
  if (!words) return;
  rule.plumages.clear();
  for (std::size_t i = 0; i < words->size(); ++i) {
    const auto plumage = enum_named<aircraft::Plumage>((*words)[i]);
    if (!plumage)
      throw Error(fmt::format("plumage[{}] is '{}'; expected gull, dark, brown or grey",
                              i,
                              (*words)[i].substr(0, 60)),
                  table.where("plumage", i));
    rule.plumages.push_back(*plumage);
  }
}

void read_lens(const TableReader& table, DistractorRule& rule) {
  refuse(table, kAirKeys, rule.kind);
  refuse(table, kBirdKeys, rule.kind);
  read(table, "spot_px", kSpotPx, rule.spot_px);
  read(table, "opacity", kOpacity, rule.opacity);
  if (rule.kind != DistractorKind::kInsect) return refuse(table, {"speed_px_s"}, rule.kind);
  read(table, "speed_px_s", kSpotSpeed, rule.speed_px_s);
}

}  // namespace

std::vector<DistractorRule> distractor_rules(const TableReader& root) {
  TableReader::Keys keys = {"kind", "share", "count"};
  for (const TableReader::Keys* more : {&kAirKeys, &kBirdKeys, &kLensKeys})
    keys.insert(keys.end(), more->begin(), more->end());
  std::vector<DistractorRule> rules;
  for (const TableReader& table : root.tables("distractor", keys)) {
    const auto kind = table.choice<DistractorKind>("kind");
    if (!kind)
      throw Error(
          "[[distractor]] has no kind; expected bird, multirotor, balloon, glint, dirt or insect",
          table.where());
    DistractorRule rule = usual_rule(*kind);
    rule.where = table.where();
    rule.share = table.number("share", scene::kShare).value_or(1);
    read(table, "count", kMostOfAKind, rule.count);
    if (scene::is_on_lens(*kind))
      read_lens(table, rule);
    else
      read_air(table, rule);
    rules.push_back(std::move(rule));
  }
  return rules;
}

}  // namespace airtruth::dataset
