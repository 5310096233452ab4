// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <fmt/format.h>

#include "sequence/sequence/encounter_record.h"

namespace airtruth::sequence {
namespace {

template <typename Enum>
std::optional<Enum> maybe_named(const JsonObject& object, const std::string& key) {
  const auto name = object.maybe_text(key);
  if (!name) return std::nullopt;
  const auto value = enum_named<Enum>(*name);
  if (!value) object.fail(key, fmt::format("one of {}", fmt::join(all_enum_names<Enum>(), ", ")));
  return value;
}

encounter::Approach approach_of(const JsonObject& object) {
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
  record.meeting = maybe_named<encounter::Meeting>(object, "meeting");
  record.vertical_motion = maybe_named<encounter::VerticalMotion>(object, "vertical_motion");
  record.horizon = maybe_named<encounter::AgainstHorizon>(object, "horizon");
  if (object.has("first_seen")) {
    const JsonObject seen = object.object("first_seen");
    record.first_seen = first_seen_of(seen);
    record.horizon_when_first_seen = maybe_named<encounter::AgainstHorizon>(seen, "horizon");
  }
  for (const JsonObject& violation : object.objects("violations"))
    record.violations.push_back(
        {violation.text("volume"), {violation.number("begin_s"), violation.number("end_s")}});
  return record;
}

}  // namespace

std::vector<EncounterRecord> read_encounter_records(const JsonObject& sequence) {
  std::vector<EncounterRecord> records;
  if (!sequence.has("encounters")) return records;
  for (const JsonObject& object : sequence.objects("encounters"))
    records.push_back(record_of(object));
  return records;
}

}  // namespace airtruth::sequence
