// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/distractors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include <fmt/format.h>

#include "dataset/catalogue/meeting.h"
#include "scene/scene/flock.h"
#include "scene/scene/limits.h"

namespace airtruth::catalogue {
namespace {

using scene::DistractorKind;
using scene::Limits;
using scene::TableReader;

constexpr std::int64_t kMostOfAKind = 100;  // of one rule in one sequence: chosen
constexpr Limits kBodySize{"[low, high] in metres from 0.05 to 20", 0.05, 20};
constexpr Limits kSpreadM{"[low, high] in metres from 0 to 1e4", 0, 1e4};
constexpr Limits kSpotPx{"[low, high] in pixels from 1 to 5000", 1, 5000};
constexpr Limits kSpotSpeed{"[low, high] in pixels a second from 1 to 1e6", 1, 1e6};
constexpr Limits kOpacity{"[low, high] from 0.01 to 1", 0.01, 1};

const TableReader::Keys kAirKeys = scene::keys(
    "size_m range_m size_px azimuth_deg elevation_deg heading_deg climb_deg "
    "speed_mps flock spread_m");
const TableReader::Keys kBirdKeys = {"plumage", "glide"};
const TableReader::Keys kLensKeys = {"spot_px", "opacity", "speed_px_s"};

// The values of a rule that states its kind and nothing else: gull to eagle, a toy to a freight
// carrier, a party's to a weather station's balloon.
DistractorRule usual_rule(DistractorKind kind) {
  using enum DistractorKind;
  // A balloon is risen by helium at 1 to 5 m/s and carried by the wind.
  static const std::map<DistractorKind, DistractorRule> kUsual = {
      {kBird, {.size_m = {0.6, 2.2}, .climb_deg = {-5, 5}, .speed_mps = {8, 18}}},
      {kMultirotor, {.size_m = {0.3, 1.2}, .climb_deg = {-10, 10}, .speed_mps = {0.5, 18}}},
      {kBalloon, {.size_m = {0.25, 2}, .climb_deg = {15, 60}, .speed_mps = {2, 9}}},
      {kGlint, {.spot_px = {40, 200}, .opacity = {0.1, 0.4}}},
      {kDirt, {.spot_px = {20, 120}, .opacity = {0.15, 0.5}}},
      {kInsect, {.spot_px = {8, 30}, .opacity = {0.4, 0.8}, .speed_px_s = {600, 4000}}}};
  DistractorRule rule = kUsual.at(kind);
  rule.kind = kind;
  return rule;
}

void read_air(const TableReader& table, DistractorRule& rule) {
  table.refuse(kLensKeys, enum_name(rule.kind));
  read_range(table, "size_m", kBodySize, rule.size_m);
  read_place(table, rule.place);
  read_range(table, "climb_deg", scene::kPitch, rule.climb_deg);
  read_range(table, "speed_mps", scene::kSpeed, rule.speed_mps);
  rule.flock = whole_range(table, "flock", scene::kMaxFlock).value_or(rule.flock);
  read_range(table, "spread_m", kSpreadM, rule.spread_m);
  if (rule.kind != DistractorKind::kBird) return table.refuse(kBirdKeys, enum_name(rule.kind));
  read_range(table, "glide", scene::kShare, rule.glide);
  const auto words = table.texts("plumage");
  if (!words) return;
  rule.plumages.clear();
  for (std::size_t i = 0; i < words->size(); ++i) {
    const auto plumage = enum_named<shapes::Plumage>((*words)[i]);
    if (!plumage)
      throw Error(fmt::format("plumage[{}] is '{}'; expected gull, dark, brown or grey",
                              i,
                              (*words)[i].substr(0, 60)),
                  table.where("plumage", i));
    rule.plumages.push_back(*plumage);
  }
}

void read_lens(const TableReader& table, DistractorRule& rule) {
  table.refuse(kAirKeys, enum_name(rule.kind));
  table.refuse(kBirdKeys, enum_name(rule.kind));
  read_range(table, "spot_px", kSpotPx, rule.spot_px);
  read_range(table, "opacity", kOpacity, rule.opacity);
  if (rule.kind != DistractorKind::kInsect)
    return table.refuse({"speed_px_s"}, enum_name(rule.kind));
  read_range(table, "speed_px_s", kSpotSpeed, rule.speed_px_s);
}

}  // namespace

std::vector<DistractorRule> distractor_rules(const TableReader& root) {
  TableReader::Keys keys = {"kind", "share", "count"};
  for (const TableReader::Keys* more : {&kAirKeys, &kBirdKeys, &kLensKeys})
    keys.insert(keys.end(), more->begin(), more->end());
  std::vector<DistractorRule> rules;
  std::int64_t most = 0;
  for (const TableReader& table : root.tables("distractor", keys)) {
    const auto kind = table.choice<DistractorKind>("kind");
    if (!kind)
      throw Error(
          "[[distractor]] has no kind; expected bird, multirotor, balloon, glint, dirt or insect",
          table.where());
    DistractorRule rule = usual_rule(*kind);
    rule.where = table.where();
    rule.share = table.number("share", scene::kShare).value_or(1);
    rule.count = whole_range(table, "count", kMostOfAKind).value_or(rule.count);
    if (scene::is_on_lens(*kind))
      read_lens(table, rule);
    else
      read_air(table, rule);
    // A scene holds them beside the intruders.
    constexpr auto kMostThings = static_cast<std::int64_t>(scene::kMaxThings) - kMaxIntruders;
    most += rule.count.high * (scene::is_on_lens(*kind) ? 1 : rule.flock.high);
    if (most > kMostThings)
      throw Error(fmt::format("[[distractor]] takes a sequence to {} things at most, with those "
                              "before it; expected up to {}: a lower count or flock",
                              most,
                              kMostThings),
                  rule.where);
    rules.push_back(std::move(rule));
  }
  return rules;
}

namespace {

// Spans squared over wing areas (Pennycuick 1996, table 1) in the order of shapes::Plumage: gulls,
// crows, buzzards and eagles, pigeons.
constexpr std::array<double, 4> kUsualAspectRatios = {9.6, 6.5, 6.3, 7.2};

// The next of the primes that rules turn by: all but 5, a choice.
int prime_after(int number) {
  const auto is_prime = [](int n) {
    for (int divisor = 2; divisor * divisor <= n; ++divisor)
      if (n % divisor == 0) return false;
    return true;
  };
  do ++number;
  while (number == 5 || !is_prime(number));
  return number;
}

// True for a share of the sequences; rule by rule the root of another prime turns. Square roots of
// two primes have no rational ratio.
bool is_in_share(const DistractorRule& rule, int prime, double turn, std::int64_t index) {
  const double turned = turn + static_cast<double>(index) * std::sqrt(prime);
  return turned - std::floor(turned) < rule.share;
}

scene::Intruder drawn_leader(const DistractorRule& rule, Random& random) {
  scene::Intruder leader;
  leader.where = rule.where;
  leader.aircraft = enum_name(rule.kind);
  leader.distractor =
      scene::usual_distractor(rule.kind, drawn_evenly_in_logarithm(random, rule.size_m));
  scene::Distractor& one = *leader.distractor;
  one.plumage = one_of(random, rule.plumages);
  one.aspect_ratio = kUsualAspectRatios[static_cast<std::size_t>(one.plumage)];
  one.glide = drawn(random, rule.glide);
  one.flap_phase = random.uniform(0, model::kStrokesOfBout);
  // Numbers of rotors, drawn with equal chances: a choice.
  constexpr std::array<int, 3> kRotors = {4, 4, 6};
  one.rotors = kRotors[static_cast<std::size_t>(random.uniform() * kRotors.size())];
  if (rule.kind != scene::DistractorKind::kBird) {
    // From black to white, most of it grey, with some colour.
    const double grey = random.uniform(0.02, 0.6);
    for (double& value : one.colour) value = std::clamp(grey * random.uniform(0.5, 1.5), 0.0, 1.0);
  }
  return leader;
}

// The arms of a multirotor: as its shell, dark, white, or in a colour by which its pilot tells
// front from rear, with equal chances: a choice.
std::array<double, 3> drawn_arm_colour(Random& random, const std::array<double, 3>& shell) {
  const std::array<std::array<double, 3>, 5> among = {
      shell, shell, {0.02, 0.02, 0.022}, {0.6, 0.6, 0.58}, {0.45, 0.06, 0.02}};
  return among[static_cast<std::size_t>(random.uniform() * among.size())];
}

DrawnFlock drawn_flock(const DistractorRule& rule, Random random) {
  DrawnFlock flock;
  flock.leader = drawn_leader(rule, random);
  flock.count = drawn(random, rule.flock);
  flock.spread_m = drawn(random, rule.spread_m);
  flock.seed = random();
  Encounter& encounter = flock.encounter;
  encounter.aircraft = enum_name(rule.kind);
  encounter.meeting_share = random.uniform(0.1, 0.9);
  draw_place(random, rule.place, encounter);
  encounter.climb_deg = drawn(random, rule.climb_deg);
  encounter.speed_mps = drawn(random, rule.speed_mps);
  flock.leader.speed_mps = encounter.speed_mps;
  if (rule.kind == scene::DistractorKind::kMultirotor)
    flock.leader.distractor->arm_colour = drawn_arm_colour(random, flock.leader.distractor->colour);
  return flock;
}

DrawnMark drawn_mark(const DistractorRule& rule, Random random) {
  DrawnMark result;
  scene::LensMark& mark = result.mark;
  mark = scene::usual_mark(rule.kind);
  mark.where = rule.where;
  const double slender = mark.length_px / mark.size_px;
  mark.size_px = drawn_evenly_in_logarithm(random, rule.spot_px);
  mark.length_px = std::min(scene::kSpotSize.high, slender * mark.size_px);
  mark.opacity = drawn(random, rule.opacity);
  mark.softness = random.uniform(rule.kind == scene::DistractorKind::kInsect ? 0.85 : 0.5, 1);
  // Reflections of a sun in front of the camera lie beyond the image's centre.
  mark.along = random.uniform(-1.2, -0.2);
  result.across = random.uniform();
  result.down = random.uniform();
  result.meeting_share = random.uniform();
  result.direction_rad = random.uniform(0, 2 * kPi);
  if (rule.kind == scene::DistractorKind::kInsect)
    result.speed_px_s = drawn_evenly_in_logarithm(random, rule.speed_px_s);
  return result;
}

scene::LensMark laid(const DrawnMark& drawn, const DrawnClip& clip) {
  const auto& [width, height] = clip.size;
  scene::LensMark mark = drawn.mark;
  if (mark.kind == scene::DistractorKind::kGlint) return mark;
  const Pixel middle(drawn.across * width, drawn.down * height);
  mark.pixel = middle;
  mark.velocity_px_s = Pixel::Zero();
  if (mark.kind != scene::DistractorKind::kInsect) return mark;
  // It crosses the whole picture.
  const double crossing_s = 2 * (std::hypot(width, height) + mark.length_px) / drawn.speed_px_s;
  const double meets_s = drawn.meeting_share * clip.duration_s();
  mark.velocity_px_s =
      drawn.speed_px_s * Pixel(std::cos(drawn.direction_rad), std::sin(drawn.direction_rad));
  mark.begin_s = meets_s - crossing_s / 2;
  mark.end_s = meets_s + crossing_s / 2;
  mark.pixel = middle - crossing_s / 2 * mark.velocity_px_s;
  return mark;
}

}  // namespace

DrawnDistractors draw_distractors(const std::vector<DistractorRule>& rules,
                                  std::uint64_t seed,
                                  std::int64_t index) {
  DrawnDistractors result;
  std::map<scene::DistractorKind, int> numbers;
  int prime = 1;
  for (std::size_t place = 0; place < rules.size(); ++place) {
    const DistractorRule& rule = rules[place];
    prime = prime_after(prime);
    const std::string name = fmt::format("distractor {} ", place + 1);
    if (!is_in_share(rule, prime, Seed(seed).stream(name + "turn").uniform(), index)) continue;
    const auto number = static_cast<std::uint64_t>(index);
    Random of_count = Seed(seed).stream(name + "count", number);
    const std::int64_t count = drawn(of_count, rule.count);
    for (std::int64_t k = 0; k < count; ++k) {
      const Random random = Seed(seed).stream(fmt::format("{}thing {}", name, k), number);
      const std::string id = fmt::format("{}-{}", enum_name(rule.kind), ++numbers[rule.kind]);
      if (scene::is_on_lens(rule.kind)) {
        result.marks.push_back(drawn_mark(rule, random));
        result.marks.back().mark.id = id;
      } else {
        result.flocks.push_back(drawn_flock(rule, random));
        result.flocks.back().leader.id = id;
      }
    }
  }
  return result;
}

void lay_distractors(scene::Scene& scene,
                     const DrawnDistractors& drawn,
                     const DrawnClip& clip,
                     setup::SharedInputs* shared) {
  // A range until the size of the picture is known.
  constexpr double kProvisionalRangeM = 100;
  std::erase_if(scene.intruders, [](const auto& intruder) { return !is_aircraft(intruder); });
  scene.lens_marks.clear();
  for (const DrawnFlock& flock : drawn.flocks) {
    scene::Intruder leader = flock.leader;
    const Encounter& encounter = flock.encounter;
    if (clip.size.width == 0)
      lay_path(leader, encounter, scene.camera, clip, kProvisionalRangeM);
    else
      meet(leader, scene, encounter, clip, shared);
    for (scene::Intruder& one : scene::flock_of(leader, flock.count, flock.spread_m, flock.seed))
      scene.intruders.push_back(std::move(one));
  }
  for (const DrawnMark& mark : drawn.marks) scene.lens_marks.push_back(laid(mark, clip));
}

}  // namespace airtruth::catalogue
