// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/truth_table.h"

#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/text.h"
#include "labels/exchange/text.h"

namespace airtruth::labelled {
namespace {

// A row as it is written: the names of its columns and its cells.
class Row {
 public:
  void add(const std::string& name, const std::string& cell) {
    names_.push_back(name);
    cells_.push_back(cell);
  }
  void add(const std::string& name, std::optional<double> value) {
    add(name, value ? exchange::number(*value) : std::string());
  }
  template <std::size_t kCount>
  void add(const std::string& name,
           const std::array<const char*, kCount>& parts,
           const std::optional<std::array<double, kCount>>& values) {
    for (std::size_t i = 0; i < kCount; ++i)
      add(name + "_" + parts[i], values ? std::optional((*values)[i]) : std::nullopt);
  }

  std::vector<std::string> names() && { return std::move(names_); }
  std::vector<std::string> cells() && { return std::move(cells_); }

 private:
  std::vector<std::string> names_, cells_;
};

constexpr std::array<const char*, 3> kNed{"north", "east", "down"}, kCam{"x", "y", "z"},
    kTurns{"yaw", "pitch", "roll"};
constexpr std::array<const char*, 4> kBox{"x", "y", "width", "height"};
constexpr std::array<const char*, 2> kPixel{"x", "y"};

std::optional<std::array<double, 3>> numbers(const std::optional<Vector3>& v) {
  return v ? std::optional(std::array{v->x(), v->y(), v->z()}) : std::nullopt;
}
std::optional<std::array<double, 3>> numbers(const std::optional<YawPitchRoll>& a) {
  return a ? std::optional(std::array{a->yaw_deg, a->pitch_deg, a->roll_deg}) : std::nullopt;
}
template <typename AnyBox>
std::optional<std::array<double, 4>> numbers(const std::optional<AnyBox>& b) {
  return b ? std::optional(
                 std::array{double(b->x), double(b->y), double(b->width), double(b->height)})
           : std::nullopt;
}

void add_encounter(Row& row, const std::optional<annotation::EncounterTruth>& truth) {
  using separation::Measures;
  const auto add = [&](const char* name, auto member) {
    row.add(name, truth ? std::optional<double>(truth->measures.*member) : std::nullopt);
  };
  add("horizontal_m", &Measures::horizontal_m);
  add("above_m", &Measures::above_m);
  add("closing_speed_mps", &Measures::closing_speed_mps);
  add("bearing_deg", &Measures::bearing_deg);
  add("bearing_rate_dps", &Measures::bearing_rate_dps);
  add("relative_bearing_deg", &Measures::relative_bearing_deg);
  add("line_of_sight_rate_dps", &Measures::line_of_sight_rate_dps);
  add("tcpa_s", &Measures::tcpa_s);
  add("dcpa_m", &Measures::dcpa_m);
  add("hmd_m", &Measures::hmd_m);
  add("vmd_m", &Measures::vmd_m);
  add("tau_mod_s", &Measures::tau_mod_s);
  add("tcoa_s", &Measures::tcoa_s);
}

Row row_of(const annotation::Intruder& intruder) {
  Row row;
  row.add("id", intruder.id);
  row.add("aircraft", intruder.aircraft);
  row.add("position_ned_m", kNed, numbers(intruder.position_ned_m));
  row.add("velocity_ned_mps", kNed, numbers(intruder.velocity_ned_mps));
  row.add("attitude_yaw_pitch_roll_deg", kTurns, numbers(intruder.attitude_yaw_pitch_roll_deg));
  row.add("position_in_cam_m", kCam, numbers(intruder.position_in_cam_m));
  row.add("range_rate_mps", intruder.range_rate_mps);
  row.add("azimuth_deg", intruder.azimuth_deg);
  row.add("elevation_deg", intruder.elevation_deg);
  row.add("nominal_azimuth_deg", intruder.nominal_azimuth_deg);
  row.add("nominal_elevation_deg", intruder.nominal_elevation_deg);
  row.add("exact_box_px", kBox, numbers(intruder.exact_box_px));
  row.add("covered_box_px", kBox, numbers(intruder.covered_box_px));
  row.add("visible_box_px", kBox, numbers(intruder.visible_box_px));
  row.add("visible_area_px", double(intruder.visible_area_px));
  row.add("alpha_sum_px", intruder.alpha_sum_px);
  row.add("centroid_px",
          kPixel,
          intruder.centroid_px
              ? std::optional(std::array{intruder.centroid_px->x(), intruder.centroid_px->y()})
              : std::nullopt);
  row.add("hidden_by_own_aircraft", intruder.hidden_by_own_aircraft);
  row.add("hidden_by_occluder", intruder.hidden_by_occluder);
  row.add("hidden_by_intruder", intruder.hidden_by_intruder);
  row.add("cut_by_frame", intruder.cut_by_frame);
  add_encounter(row, intruder.encounter);
  return row;
}

template <typename Enum>
std::string name_or_nothing(const std::optional<Enum>& value) {
  return value ? enum_name(*value) : "";
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
  row.add("meeting", name_or_nothing(record.meeting));
  row.add("vertical_motion", name_or_nothing(record.vertical_motion));
  row.add("horizon", name_or_nothing(record.horizon));
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
  row.add("first_seen_horizon", name_or_nothing(record.horizon_when_first_seen));
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

std::vector<std::string> truth_columns() { return row_of(annotation::Intruder()).names(); }

std::vector<std::string> truth_cells(const annotation::Intruder& intruder) {
  return row_of(intruder).cells();
}

std::string encounters_header() {
  std::vector<std::string> names = {"part", "sequence", "weight", "id", "aircraft"};
  for (const std::string& name : row_of(pipeline::EncounterRecord()).names()) names.push_back(name);
  return line_of(names);
}

std::string encounter_lines(const replay::Finished& sequence, const std::string& part) {
  std::string weight;
  if (sequence.scene && sequence.scene->weight) weight = exchange::number(*sequence.scene->weight);
  std::string text;
  for (const pipeline::EncounterRecord& record : sequence.encounters) {
    std::vector<std::string> cells = {
        part, sequence.name, weight, record.id, aircraft_of(sequence, record.id)};
    for (const std::string& cell : row_of(record).cells()) cells.push_back(cell);
    text += line_of(cells);
  }
  return text;
}

}  // namespace airtruth::labelled
