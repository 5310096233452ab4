// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/truth_table.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

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
  void add(const std::string& name, const std::optional<Vector3>& v) {
    const bool is_in_camera = name == "position_in_cam_m";
    add(name,
        is_in_camera ? "x y z" : "north east down",
        v ? Numbers{v->x(), v->y(), v->z()} : Numbers());
  }
  void add(const std::string& name, const std::optional<YawPitchRoll>& a) {
    add(name, "yaw pitch roll", a ? Numbers{a->yaw_deg, a->pitch_deg, a->roll_deg} : Numbers());
  }
  void add(const std::string& name, const std::optional<Pixel>& p) {
    add(name, "x y", p ? Numbers{p->x(), p->y()} : Numbers());
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
  const auto& encounter = intruder.encounter;
  const auto measures = encounter ? encounter->measures : separation::Measures();
  annotation::each_measure(
      [&](const char* key, std::optional<double> value) {
        row.add(key, encounter ? value : std::nullopt);
      },
      measures);
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
  using passage::Approach;
  Row row;
  const auto of = [](const auto& known, auto value) {
    return known ? std::optional<double>(value(*known)) : std::nullopt;
  };
  const auto closest = [&](const char* name, auto value) {
    row.add(std::string("closest_approach_") + name, of(record.closest, value));
  };
  closest("time_s", [](const Approach& a) { return a.time_s; });
  closest("distance_m", [](const Approach& a) { return a.distance_m; });
  closest("horizontal_m", [](const Approach& a) { return a.horizontal_m; });
  closest("ahead_m", [](const Approach& a) { return a.offset.ahead_m; });
  closest("right_m", [](const Approach& a) { return a.offset.right_m; });
  closest("above_m", [](const Approach& a) { return a.offset.above_m; });
  row.add("meeting", enum_name(record.meeting, ""));
  row.add("vertical_motion", enum_name(record.vertical_motion, ""));
  row.add("horizon", enum_name(record.horizon, ""));
  const auto seen = [&](const char* name, auto value) {
    row.add(std::string("first_seen_") + name, of(record.first_seen, value));
  };
  using pipeline::FirstSeen;
  seen("frame", [](const FirstSeen& s) { return double(s.frame); });
  seen("time_s", [](const FirstSeen& s) { return s.time_s; });
  seen("range_m", [](const FirstSeen& s) { return s.range_m; });
  seen("width_px", [](const FirstSeen& s) { return s.exact_box_px.width; });
  seen("height_px", [](const FirstSeen& s) { return s.exact_box_px.height; });
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
