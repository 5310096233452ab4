// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>

#include "foundation/base/files.h"
#include "scene/scene/flock.h"
#include "scene/scene/limits.h"
#include "scene/scene/scene.h"
#include "scene/scene/tables.h"

namespace airtruth::scene {
namespace {

constexpr const char* kTitle = "[[distractor]]";
const TableReader::Keys kBirdKeys = {"plumage", "aspect_ratio", "flap_hz", "flap_phase", "glide"};
const TableReader::Keys kAirKeys = keys(
    "size_m position_ned_m velocity_ned_mps count spread_m offset_ned_m "
    "path_file encounter seen start_s yaw_deg pitch_deg roll_deg "
    "waypoints_ned_m speed_mps times_s");
const TableReader::Keys kLensKeys = {
    "pixel", "velocity_px_s", "size_px", "length_px", "softness", "opacity", "begin_s", "end_s"};

constexpr Limits kAspect{"a number from 2 to 30", 2, 30};
constexpr Limits kStrokes{"strokes from -1e6 to 1e6", -1e6, 1e6};
constexpr Limits kColour{"a number from 0 to 1", 0, 1};
constexpr Limits kFlockRadius{"metres from 0 to 1e4", 0, 1e4};
constexpr Limits kSpotSpeed{"pixels a second from -1e6 to 1e6", -1e6, 1e6};
constexpr Limits kOpacity{
    .expected = "a number above 0, up to 1", .low = 0, .high = 1, .without_low = true};
constexpr Limits kAlong{"a number from -10 to 10", -10, 10};

TableReader::Keys all_keys() {
  TableReader::Keys keys = {"kind", "id", "colour", "arm_colour", "rotors", "along"};
  for (const TableReader::Keys* more : {&kBirdKeys, &kAirKeys, &kLensKeys})
    keys.insert(keys.end(), more->begin(), more->end());
  return keys;
}

using LinearColour = std::array<double, 3>;

Distractor distractor_in(const TableReader& table, DistractorKind kind) {
  Distractor one =
      usual_distractor(kind, table.number("size_m", kDistractorSize).value_or(usual_size_m(kind)));
  if (kind == DistractorKind::kBird) {
    one.plumage = table.choice<shapes::Plumage>("plumage").value_or(one.plumage);
    one.aspect_ratio = table.number("aspect_ratio", kAspect).value_or(one.aspect_ratio);
    one.flap_hz = table.number("flap_hz", kStrokeRate).value_or(one.flap_hz);
    one.flap_phase = table.number("flap_phase", kStrokes).value_or(one.flap_phase);
    one.glide = table.number("glide", kShare).value_or(one.glide);
    table.refuse({"colour"}, enum_name(kind));
  } else {
    table.refuse(kBirdKeys, enum_name(kind));
    one.colour = table.tuple<LinearColour>("colour", kColour).value_or(one.colour);
  }
  one.arm_colour = table.tuple<LinearColour>("arm_colour", kColour).value_or(one.colour);
  if (kind != DistractorKind::kMultirotor) {
    table.refuse({"rotors", "arm_colour"}, enum_name(kind));
  } else if (const auto rotors = table.whole("rotors", 4, 8)) {
    if (*rotors % 2 != 0)
      table.fail("rotors", fmt::format("rotors is {}; expected 4, 6 or 8", *rotors));
    one.rotors = static_cast<int>(*rotors);
  }
  return one;
}

// A place and a velocity in place of a path.
void read_drift(const TableReader& table, Intruder& intruder) {
  table.exclude(
      "position_ned_m",
      {"waypoints_ned_m", "speed_mps", "times_s", "path_file", "encounter", "seen", "start_s"});
  intruder.position_ned_m = table.tuple<Vector3>("position_ned_m", kPosition);
  intruder.velocity_ned_mps =
      table.tuple<Vector3>("velocity_ned_mps", kVelocity).value_or(Vector3::Zero());
}

Intruder intruder_from(const TableReader& table, DistractorKind kind) {
  table.refuse(kLensKeys, enum_name(kind));
  table.refuse({"along"}, enum_name(kind));
  Intruder intruder;
  intruder.where = table.where();
  intruder.aircraft = enum_name(kind);
  intruder.distractor = distractor_in(table, kind);
  intruder.offset_ned_m = table.tuple<Vector3>("offset_ned_m", kPosition).value_or(Vector3::Zero());
  if (table.has("position_ned_m"))
    read_drift(table, intruder);
  else if (table.has("velocity_ned_mps"))
    table.fail("velocity_ned_mps", "velocity_ned_mps is for position_ned_m, which is not there");
  else
    read_path(table, kTitle, intruder);
  read_attitude(table, intruder);
  return intruder;
}

std::vector<Intruder> flock_in(const TableReader& table,
                               const Intruder& leader,
                               std::uint64_t seed) {
  const std::int64_t count = table.whole("count", 1, kMaxFlock).value_or(1);
  const auto spread_m = table.number("spread_m", kFlockRadius);
  if (count > 1 && !spread_m)
    table.fail("count",
               fmt::format("count is {} without spread_m; expected the flock's radius in "
                           "metres with it",
                           count));
  if (spread_m && !table.has("count"))
    table.fail("spread_m", "spread_m has no effect without a count");
  return flock_of(leader, count, spread_m.value_or(0), seed);
}

void read_place(const TableReader& table, LensMark& mark) {
  mark.pixel = table.tuple<Pixel>("pixel", kPixel);
  const bool follows_sun = mark.kind == DistractorKind::kGlint && !mark.pixel;
  if (!mark.pixel && !follows_sun)
    throw Error(fmt::format("[[distractor]] of kind \"{}\" has no pixel; expected the place of its "
                            "middle in the picture",
                            enum_name(mark.kind)),
                table.where());
  if (follows_sun) {
    table.refuse({"velocity_px_s"}, enum_name(mark.kind));
    mark.along = table.number("along", kAlong).value_or(mark.along);
  } else if (table.has("along")) {
    table.fail("along", "along is for a glint that follows the sun, without a pixel");
  }
  mark.velocity_px_s = table.tuple<Pixel>("velocity_px_s", kSpotSpeed).value_or(mark.velocity_px_s);
}

LensMark mark_from(const TableReader& table, DistractorKind kind) {
  table.refuse(kAirKeys, enum_name(kind));
  table.refuse(kBirdKeys, enum_name(kind));
  table.refuse({"rotors", "arm_colour"}, enum_name(kind));
  LensMark mark = usual_mark(kind);
  mark.where = table.where();
  read_place(table, mark);
  const double slender = mark.length_px / mark.size_px;
  mark.size_px = table.number("size_px", kSpotSize).value_or(mark.size_px);
  mark.length_px = table.number("length_px", kSpotSize)
                       .value_or(std::min(kSpotSize.high, slender * mark.size_px));
  if (mark.length_px < mark.size_px)
    table.fail(
        "length_px",
        fmt::format(
            "length_px is {}, below size_px; expected {} or more", mark.length_px, mark.size_px));
  mark.softness = table.number("softness", kShare).value_or(mark.softness);
  mark.opacity = table.number("opacity", kOpacity).value_or(mark.opacity);
  mark.colour = table.tuple<LinearColour>("colour", kColour).value_or(mark.colour);
  mark.begin_s = table.number("begin_s", kTime).value_or(mark.begin_s);
  if (mark.end_s) *mark.end_s += mark.begin_s;
  if (const auto end_s = table.number("end_s", kTime)) mark.end_s = end_s;
  if (mark.end_s && *mark.end_s < mark.begin_s)
    table.fail("end_s", fmt::format("end_s is {}, before begin_s", *mark.end_s));
  return mark;
}

}  // namespace

void add_distractors(const TableReader& root, Scene& scene) {
  std::set<std::string> taken;
  for (const Intruder& intruder : scene.intruders) taken.insert(intruder.id);
  std::map<DistractorKind, std::int64_t> count;
  const auto take = [&](const TableReader& table, const std::string& id) {
    if (!taken.insert(id).second)
      table.fail("id", fmt::format("id '{}' is taken; expected another", id));
  };
  for (const TableReader& table : root.tables("distractor", all_keys())) {
    const auto kind = table.choice<DistractorKind>("kind");
    if (!kind)
      throw Error(
          "[[distractor]] has no kind; expected bird, multirotor, balloon, glint, dirt or insect",
          table.where());
    if (scene.intruders.size() + scene.lens_marks.size() >= kMaxThings)
      throw Error(fmt::format("[[distractor]] is beyond the {} intruders and distractors, birds of "
                              "flocks included, that a scene has at most",
                              kMaxThings),
                  table.where());
    const std::int64_t number = ++count[*kind];
    const std::string id =
        table.file_name("id").value_or(fmt::format("{}-{}", enum_name(*kind), number));
    if (is_on_lens(*kind)) {
      take(table, id);
      scene.lens_marks.push_back(mark_from(table, *kind));
      scene.lens_marks.back().id = id;
      continue;
    }
    Intruder leader = intruder_from(table, *kind);
    leader.id = id;
    std::vector<Intruder> flock = flock_in(table, leader, scene.seed);
    if (scene.intruders.size() + scene.lens_marks.size() + flock.size() > kMaxThings)
      table.fail("count",
                 fmt::format("count is {}, with which the scene has more than {} intruders and "
                             "distractors; expected fewer",
                             flock.size(),
                             kMaxThings));
    for (Intruder& one : flock) {
      if (!is_plain_file_name(one.id))
        table.fail("id",
                   "id is too long for a flock, whose members are ID-1, ID-2, ...; expected a "
                   "shorter one");
      take(table, one.id);
      scene.intruders.push_back(std::move(one));
    }
  }
}

}  // namespace airtruth::scene
