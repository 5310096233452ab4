// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/truth_table.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/text.h"
#include "labels/annotation/truth_fields.h"
#include "labels/exchange/text.h"

namespace airtruth::labelled {
namespace {

// A row as it is written: the names of its columns and its cells. A value of several numbers has a
// column for each of them.
struct Row {
  using Numbers = std::vector<double>;

  void add(const std::string& name, const std::string& cell) {
    names.push_back(name);
    cells.push_back(cell);
  }
  void add(const std::string& name, std::optional<double> value) {
    add(name, value ? exchange::number(*value) : std::string());
  }
  template <std::size_t n>
  void add(const std::string& name, const std::optional<std::array<double, n>>& v) {
    const char* parts = name == "attitude_yaw_pitch_roll_deg" ? "yaw pitch roll"
                        : name == "position_in_cam_m"         ? "x y z"
                        : n == 3                              ? "north east down"
                                                              : "x y";
    add(name, parts, v ? Numbers(v->begin(), v->end()) : Numbers());
  }
  template <typename AnyBox>
  void add(const std::string& name, const std::optional<AnyBox>& b) {
    add(name,
        "x y width height",
        b ? Numbers{double(b->x), double(b->y), double(b->width), double(b->height)} : Numbers());
  }

  // No numbers: the value is not defined.
  void add(const std::string& name, std::string_view parts, const Numbers& numbers) {
    const std::vector<std::string> words = words_in(parts);
    for (std::size_t i = 0; i < words.size(); ++i)
      add(name + "_" + words[i], numbers.empty() ? std::nullopt : std::optional(numbers[i]));
  }

  std::vector<std::string> names, cells;
};

Row row_of(const annotation::Intruder& intruder) {
  Row row;
  row.add("id", intruder.id);
  row.add("aircraft", intruder.aircraft);
  annotation::each_field(
      [&]<typename Value>(const std::string& key, const Value& value) {
        // The label has range, contrast and area in columns of its own. The encounter comes last.
        constexpr bool is_elsewhere =
            std::is_same_v<Value, annotation::State> ||
            std::is_same_v<Value, std::optional<std::int64_t>> ||
            std::is_same_v<Value, std::optional<annotation::EncounterTruth>>;
        if constexpr (!is_elsewhere)
          if (key != "range_m" && key != "contrast_to_noise") row.add(key, value);
      },
      intruder);
  static const annotation::EncounterTruth kNone;
  const auto& encounter = intruder.encounter;
  annotation::each_measure(
      [&](const char* key, std::optional<double> value) {
        row.add(key, encounter ? value : std::nullopt);
      },
      encounter ? *encounter : kNone);
  return row;
}

// "NAME BEGIN END", in seconds, each after a semicolon.
std::string text_of(const std::vector<pipeline::NamedInterval>& violations) {
  std::vector<std::string> words;
  for (const auto& [volume, time] : violations)
    words.push_back(fmt::format("{} {} {}", volume, time.begin_s, time.end_s));
  return fmt::format("{}", fmt::join(words, "; "));
}

Row row_of(const pipeline::EncounterRecord& record) {
  using passage::Approach, passage::Offset, pipeline::FirstSeen;
  Row row;
  const auto add = [&](const char* name, const auto& known, auto value) {
    row.add(name, known ? std::optional<double>(std::invoke(value, *known)) : std::nullopt);
  };
  add("closest_approach_time_s", record.closest, &Approach::time_s);
  add("closest_approach_distance_m", record.closest, &Approach::distance_m);
  add("closest_approach_horizontal_m", record.closest, &Approach::horizontal_m);
  const auto offset = record.closest ? std::optional(record.closest->offset) : std::nullopt;
  add("closest_approach_ahead_m", offset, &Offset::ahead_m);
  add("closest_approach_right_m", offset, &Offset::right_m);
  add("closest_approach_above_m", offset, &Offset::above_m);
  row.add("meeting", enum_name(record.meeting, ""));
  row.add("vertical_motion", enum_name(record.vertical_motion, ""));
  row.add("horizon", enum_name(record.horizon, ""));
  add("first_seen_frame", record.first_seen, &FirstSeen::frame);
  add("first_seen_time_s", record.first_seen, &FirstSeen::time_s);
  add("first_seen_range_m", record.first_seen, &FirstSeen::range_m);
  const auto box =
      record.first_seen ? std::optional(record.first_seen->exact_box_px) : std::nullopt;
  add("first_seen_width_px", box, &Box::width);
  add("first_seen_height_px", box, &Box::height);
  row.add("first_seen_to_closest_approach_s",
          record.first_seen && record.closest
              ? std::optional(record.closest->time_s - record.first_seen->time_s)
              : std::nullopt);
  row.add("first_seen_horizon", enum_name(record.horizon_when_first_seen, ""));
  row.add("violations", text_of(record.violations));
  return row;
}

std::string aircraft_of(const replay::Finished& sequence, const std::string& id) {
  for (const annotation::Frame& frame : sequence.truth.frames)
    for (const annotation::Intruder& intruder : frame.intruders)
      if (intruder.id == id) return intruder.aircraft;
  return {};
}

std::string line_of(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = csv_cell(cell);
  return fmt::format("{}\n", fmt::join(cells, ","));
}

}  // namespace

std::vector<std::string> truth_columns() { return row_of(annotation::Intruder()).names; }

std::vector<std::string> truth_cells(const annotation::Intruder& intruder) {
  return row_of(intruder).cells;
}

std::string encounters_header() {
  std::vector<std::string> names = {"part", "sequence", "weight", "id", "aircraft"};
  for (const std::string& name : row_of(pipeline::EncounterRecord()).names) names.push_back(name);
  return line_of(names);
}

std::string encounter_lines(const replay::Finished& sequence, const std::string& part) {
  std::string weight;
  if (sequence.scene && sequence.scene->weight) weight = exchange::number(*sequence.scene->weight);
  std::string text;
  for (const pipeline::EncounterRecord& record : sequence.encounters) {
    std::vector<std::string> cells = {
        part, sequence.name, weight, record.id, aircraft_of(sequence, record.id)};
    for (const std::string& cell : row_of(record).cells) cells.push_back(cell);
    text += line_of(cells);
  }
  return text;
}

}  // namespace airtruth::labelled
