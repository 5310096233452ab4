// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/encounter_record.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "aircraft/model/mesh.h"
#include "labels/annotation/object_class.h"

namespace airtruth::pipeline {
namespace {

using Json = nlohmann::ordered_json;

// The aircraft as a mover at the middle of its height, and half of that height's angle.
passage::AgainstHorizon against_horizon(const setup::Actor& actor,
                                        const trajectory::State& own,
                                        const trajectory::State& intruder,
                                        double time_s) {
  const projection::SilhouettePoints& silhouette = actor.type->silhouette;
  double highest_m = HUGE_VAL, lowest_m = -HUGE_VAL;  // along down, from the reference point
  for (std::size_t part = 0; part < silhouette.points.size(); ++part) {
    const Eigen::Affine3d body_from_part =
        model::body_from_part(silhouette.mesh->parts[part], actor.turned_s(time_s)).cast<double>();
    for (const Eigen::Vector3f& point : silhouette.points[part]) {
      const Vector3 p_in_body = body_from_part * point.cast<double>();
      const double down_m = (intruder.world_from_body * p_in_body).z();
      highest_m = std::min(highest_m, down_m);
      lowest_m = std::max(lowest_m, down_m);
    }
  }
  separation::Mover middle = passage::mover_of(intruder);
  if (highest_m <= lowest_m) middle.position_ned_m.z() += 0.5 * (highest_m + lowest_m);
  const double range_m = (middle.position_ned_m - own.position_in_world).norm();
  const double half_height_m = std::max(0.0, 0.5 * (lowest_m - highest_m));
  return passage::against_horizon(
      passage::mover_of(own), middle, degrees(std::atan2(half_height_m, range_m)));
}

EncounterRecord record_of(const setup::World& world,
                          const setup::Actor& actor,
                          const std::optional<FirstSeen>& seen,
                          double last_s) {
  const double end_s = last_s + world.lookahead_s;
  const trajectory::Path camera = passage::beyond_clip(world.camera, last_s);
  const trajectory::Path path = passage::beyond_clip(actor.path, last_s);
  EncounterRecord record;
  record.id = actor.id;
  record.first_seen = seen;
  const auto nearest = passage::closest_approach(camera, path, 0, end_s);
  if (nearest) {
    if (!nearest->is_cut_off && !nearest->is_kept) record.closest = nearest;
    const auto own = camera.at(nearest->time_s);
    const auto intruder = path.at(nearest->time_s);
    check(own && intruder, "both are in the world where they are nearest");
    record.meeting = passage::meeting_of(passage::mover_of(*own), passage::mover_of(*intruder));
    record.vertical_motion = passage::vertical_motion_of(passage::mover_of(*intruder));
    if (seen) record.horizon = against_horizon(actor, *own, *intruder, nearest->time_s);
  }
  if (seen)
    record.horizon_when_first_seen =
        against_horizon(actor, *camera.at(seen->time_s), *path.at(seen->time_s), seen->time_s);
  for (const auto& [name, volume] : world.volumes)
    for (const separation::Interval& time : passage::violations(volume, camera, path, 0, end_s))
      record.violations.push_back({name, time});
  return record;
}

template <typename Enum>
Json name_or_null(const std::optional<Enum>& value) {
  return value ? Json(enum_name(*value)) : Json();
}

Json json_of(const passage::Approach& closest) {
  return {{"time_s", closest.time_s},
          {"distance_m", closest.distance_m},
          {"horizontal_m", closest.horizontal_m},
          {"ahead_m", closest.offset.ahead_m},
          {"right_m", closest.offset.right_m},
          {"above_m", closest.offset.above_m}};
}

Json json_of(const FirstSeen& seen, const EncounterRecord& record) {
  return {{"frame", seen.frame},
          {"time_s", seen.time_s},
          {"range_m", seen.range_m},
          {"width_px", seen.exact_box_px.width},
          {"height_px", seen.exact_box_px.height},
          {"to_closest_approach_s",
           record.closest ? Json(record.closest->time_s - seen.time_s) : Json()},
          {"horizon", name_or_null(record.horizon_when_first_seen)}};
}

Json json_of(const EncounterRecord& record) {
  Json object = {{"id", record.id},
                 {"closest_approach", record.closest ? json_of(*record.closest) : Json()},
                 {"meeting", name_or_null(record.meeting)},
                 {"vertical_motion", name_or_null(record.vertical_motion)},
                 {"horizon", name_or_null(record.horizon)},
                 {"first_seen", record.first_seen ? json_of(*record.first_seen, record) : Json()},
                 {"violations", Json::array()}};
  for (const NamedInterval& violation : record.violations)
    object["violations"].push_back({{"volume", violation.volume},
                                    {"begin_s", violation.time.begin_s},
                                    {"end_s", violation.time.end_s}});
  return object;
}

}  // namespace

std::optional<FirstSeen> seen_in(const annotation::Frame& frame,
                                 const annotation::Intruder& intruder) {
  if (intruder.state != annotation::State::kVisible || !intruder.exact_box_px || !intruder.range_m)
    return std::nullopt;
  return FirstSeen{frame.frame, frame.time_s, *intruder.range_m, *intruder.exact_box_px};
}

std::vector<EncounterRecord> encounter_records(
    const setup::World& world,
    const std::vector<std::optional<FirstSeen>>& first_seen,
    double last_s) {
  std::vector<EncounterRecord> records;
  for (std::size_t i = 0; i < world.actors.size(); ++i)
    if (annotation::is_aircraft(world.actors[i].object_class))
      records.push_back(record_of(
          world, world.actors[i], i < first_seen.size() ? first_seen[i] : std::nullopt, last_s));
  return records;
}

nlohmann::ordered_json json_of(const std::vector<EncounterRecord>& records) {
  Json list = Json::array();
  for (const EncounterRecord& record : records) list.push_back(json_of(record));
  return list;
}

namespace {

template <typename Enum>
std::optional<Enum> maybe_named(const JsonObject& object, const std::string& key) {
  const auto name = object.maybe_text(key);
  if (!name) return std::nullopt;
  const auto value = enum_named<Enum>(*name);
  if (!value) object.fail(key, fmt::format("one of {}", fmt::join(all_enum_names<Enum>(), ", ")));
  return value;
}

passage::Approach approach_of(const JsonObject& object) {
  return {object.number("time_s"),
          object.number("distance_m"),
          object.number("horizontal_m"),
          {object.number("ahead_m"), object.number("right_m"), object.number("above_m")}};
}

FirstSeen first_seen_of(const JsonObject& object) {
  return {object.count("frame"),
          object.number("time_s"),
          object.number("range_m"),
          {0, 0, object.number("width_px"), object.number("height_px")}};
}

EncounterRecord record_of(const JsonObject& object) {
  EncounterRecord record;
  record.id = object.text("id");
  if (object.has("closest_approach"))
    record.closest = approach_of(object.object("closest_approach"));
  record.meeting = maybe_named<passage::Meeting>(object, "meeting");
  record.vertical_motion = maybe_named<passage::VerticalMotion>(object, "vertical_motion");
  record.horizon = maybe_named<passage::AgainstHorizon>(object, "horizon");
  if (object.has("first_seen")) {
    const JsonObject seen = object.object("first_seen");
    record.first_seen = first_seen_of(seen);
    record.horizon_when_first_seen = maybe_named<passage::AgainstHorizon>(seen, "horizon");
  }
  for (const JsonObject& violation : object.objects("violations"))
    record.violations.push_back(
        {violation.text("volume"), {violation.number("begin_s"), violation.number("end_s")}});
  return record;
}

}  // namespace

std::vector<EncounterRecord> read_encounter_records(const JsonObject& sequence) {
  std::vector<EncounterRecord> records;
  for (const JsonObject& object : sequence.objects("encounters"))
    records.push_back(record_of(object));
  return records;
}

}  // namespace airtruth::pipeline
