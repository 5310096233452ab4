// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/distractor_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "foundation/base/seed.h"
#include "scene/scene/flock.h"

namespace airtruth::dataset {
namespace {

double drawn(Random& random, const Span& span) { return random.uniform(span.low, span.high); }

double drawn_evenly_in_logarithm(Random& random, const Span& span) {
  return span.low * std::pow(span.high / span.low, random.uniform());
}

std::int64_t drawn(Random& random, const WholeSpan& span) {
  const double kinds = static_cast<double>(span.high - span.low + 1);
  return std::min(span.high, span.low + static_cast<std::int64_t>(random.uniform() * kinds));
}

// Spans squared over wing areas (Pennycuick 1996, table 1): gulls, crows, buzzards and eagles,
// pigeons.
double usual_aspect_ratio(aircraft::Plumage plumage) {
  switch (plumage) {
    case aircraft::Plumage::kGull:
      return 9.6;
    case aircraft::Plumage::kDark:
      return 6.5;
    case aircraft::Plumage::kBrown:
      return 6.3;
    case aircraft::Plumage::kGrey:
      break;
  }
  return 7.2;
}

// True for a share of the sequences; rule by rule another irrational number turns.
bool is_in_share(const DistractorRule& rule, std::size_t place, double turn, std::int64_t index) {
  constexpr std::array<double, 8> kPrimes = {2, 3, 7, 11, 13, 17, 19, 23};
  const double step = std::sqrt(kPrimes[place % kPrimes.size()]);
  const double turned = turn + static_cast<double>(index) * step;
  return turned - std::floor(turned) < rule.share;
}

scene::Intruder drawn_leader(const DistractorRule& rule, Random& random) {
  scene::Intruder leader;
  leader.where = rule.where;
  leader.aircraft = enum_name(rule.kind);
  leader.distractor =
      scene::usual_distractor(rule.kind, drawn_evenly_in_logarithm(random, rule.size_m));
  scene::Distractor& one = *leader.distractor;
  const auto at = static_cast<std::size_t>(random.uniform() * double(rule.plumages.size()));
  one.plumage = rule.plumages[std::min(at, rule.plumages.size() - 1)];
  one.aspect_ratio = usual_aspect_ratio(one.plumage);
  one.glide = drawn(random, rule.glide);
  one.flap_phase = random.uniform(0, aircraft::kStrokesOfBout);
  constexpr std::array<int, 3> kRotors = {4, 4, 6};
  one.rotors = kRotors[static_cast<std::size_t>(random.uniform() * kRotors.size())];
  if (rule.kind != scene::DistractorKind::kBird) {
    // From black to white, most of it grey, with some colour.
    const double grey = random.uniform(0.02, 0.6);
    for (double& value : one.colour) value = std::clamp(grey * random.uniform(0.5, 1.5), 0.0, 1.0);
  }
  return leader;
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
  if (rule.size_px)
    encounter.size_px = drawn_evenly_in_logarithm(random, *rule.size_px);
  else
    encounter.range_m = drawn_evenly_in_logarithm(random, rule.range_m);
  encounter.azimuth_deg = drawn(random, rule.azimuth_deg);
  encounter.elevation_deg = drawn(random, rule.elevation_deg);
  encounter.heading_deg = drawn(random, rule.heading_deg);
  encounter.climb_deg = drawn(random, rule.climb_deg);
  encounter.speed_mps = drawn(random, rule.speed_mps);
  flock.leader.speed_mps = encounter.speed_mps;
  return flock;
}

DrawnMark drawn_mark(const DistractorRule& rule, Random random) {
  DrawnMark result;
  scene::LensMark& mark = result.mark;
  mark = scene::usual_mark(rule.kind);
  mark.where = rule.where;
  const double slender = mark.length_px / mark.size_px;
  mark.size_px = drawn_evenly_in_logarithm(random, rule.spot_px);
  mark.length_px = slender * mark.size_px;
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

scene::Intruder laid(const scene::Scene& scene,
                     const DrawnFlock& flock,
                     const DrawnClip& clip,
                     const lens::ImageSize& size,
                     sequence::SharedInputs* shared) {
  // A range until the size of the picture is known.
  constexpr double kProvisionalRangeM = 100;
  if (size.width == 0) {
    scene::Intruder leader = flock.leader;
    lay_path(leader,
             flock.encounter,
             scene.camera,
             clip,
             flock.encounter.range_m.value_or(kProvisionalRangeM));
    return leader;
  }
  scene::Scene alone = scene;
  alone.intruders = {flock.leader};
  meet(alone, 0, flock.encounter, clip, size, shared);
  return alone.intruders.front();
}

scene::LensMark laid(const DrawnMark& drawn, const DrawnClip& clip, const lens::ImageSize& size) {
  scene::LensMark mark = drawn.mark;
  if (mark.kind == scene::DistractorKind::kGlint) return mark;
  const Pixel middle(drawn.across * size.width, drawn.down * size.height);
  mark.pixel = middle;
  mark.velocity_px_s = Pixel::Zero();
  if (mark.kind != scene::DistractorKind::kInsect) return mark;
  // It crosses the whole picture.
  const double crossing_s =
      2 * (std::hypot(size.width, size.height) + mark.length_px) / drawn.speed_px_s;
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
  for (std::size_t place = 0; place < rules.size(); ++place) {
    const DistractorRule& rule = rules[place];
    const std::string name = fmt::format("distractor {} ", place + 1);
    if (!is_in_share(rule, place, Seed(seed).stream(name + "turn").uniform(), index)) continue;
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
                     const lens::ImageSize& size,
                     sequence::SharedInputs* shared) {
  std::erase_if(scene.intruders, [](const auto& intruder) { return !is_aircraft(intruder); });
  scene.lens_marks.clear();
  for (const DrawnFlock& flock : drawn.flocks) {
    const scene::Intruder leader = laid(scene, flock, clip, size, shared);
    for (scene::Intruder& one : scene::flock_of(leader, flock.count, flock.spread_m, flock.seed))
      scene.intruders.push_back(std::move(one));
  }
  for (const DrawnMark& mark : drawn.marks) scene.lens_marks.push_back(laid(mark, clip, size));
}

}  // namespace airtruth::dataset
