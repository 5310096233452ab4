// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <limits>
#include <string>
#include <type_traits>
#include <variant>

#include "bindings.h"
#include "values.h"

namespace airtruth::python {
namespace {

// In the order of IntruderState.
constexpr std::array<const char*, 5> kStates = {"visible", "hidden", "outside", "behind", "ended"};

template <typename Visit>
void each_frame_field(Visit&& visit, const FrameTruth& t) {
  visit("frame", t.frame);
  visit("time_s", t.time_s);
  visit("damaged", t.damaged);
  visit("camera_position_ned_m", t.camera_position_ned_m);
  visit("camera_attitude_yaw_pitch_roll_deg", t.camera_attitude_yaw_pitch_roll_deg);
  visit("motion_state", t.motion_state);
  visit("frame_from_reference", t.frame_from_reference);
  visit("frame_from_reference_per_s", t.frame_from_reference_per_s);
  visit("rotation", t.rotation);
  visit("rate_radps", t.rate_radps);
}

template <typename Visit>
void each_intruder_field(Visit&& visit, const IntruderTruth& t) {
  visit("id", t.id);
  visit("aircraft", t.aircraft);
  visit("object_class", t.object_class);
  visit("state", std::string(kStates.at(static_cast<std::size_t>(t.state))));
  visit("position_ned_m", t.position_ned_m);
  visit("velocity_ned_mps", t.velocity_ned_mps);
  visit("attitude_yaw_pitch_roll_deg", t.attitude_yaw_pitch_roll_deg);
  visit("position_in_cam_m", t.position_in_cam_m);
  visit("range_m", t.range_m);
  visit("range_rate_mps", t.range_rate_mps);
  visit("azimuth_deg", t.azimuth_deg);
  visit("elevation_deg", t.elevation_deg);
  visit("nominal_azimuth_deg", t.nominal_azimuth_deg);
  visit("nominal_elevation_deg", t.nominal_elevation_deg);
  visit("exact_box_px", t.exact_box_px);
  visit("covered_box_px", t.covered_box_px);
  visit("covered_area_px", t.covered_area_px);
  visit("visible_box_px", t.visible_box_px);
  visit("contrast_to_noise", t.contrast_to_noise);
  visit("visible_area_px", t.visible_area_px);
  visit("alpha_sum_px", t.alpha_sum_px);
  visit("centroid_px", t.centroid_px);
  visit("hidden_by_own_aircraft", t.hidden_by_own_aircraft);
  visit("hidden_by_occluder", t.hidden_by_occluder);
  visit("hidden_by_intruder", t.hidden_by_intruder);
  visit("cut_by_frame", t.cut_by_frame);
}

template <typename Visit>
void each_measure(Visit&& visit, const std::optional<EncounterTruth>& e) {
  const auto of = [&](auto member) {
    return e ? std::optional<double>((*e).*member) : std::nullopt;
  };
  visit("horizontal_m", of(&EncounterTruth::horizontal_m));
  visit("above_m", of(&EncounterTruth::above_m));
  visit("closing_speed_mps", of(&EncounterTruth::closing_speed_mps));
  visit("bearing_deg", of(&EncounterTruth::bearing_deg));
  visit("bearing_rate_dps", of(&EncounterTruth::bearing_rate_dps));
  visit("relative_bearing_deg", of(&EncounterTruth::relative_bearing_deg));
  visit("line_of_sight_rate_dps", of(&EncounterTruth::line_of_sight_rate_dps));
  visit("tcpa_s", of(&EncounterTruth::tcpa_s));
  visit("dcpa_m", of(&EncounterTruth::dcpa_m));
  visit("hmd_m", of(&EncounterTruth::hmd_m));
  visit("vmd_m", of(&EncounterTruth::vmd_m));
  visit("tau_mod_s", of(&EncounterTruth::tau_mod_s));
  visit("tcoa_s", of(&EncounterTruth::tcoa_s));
}

py::object encounter_dict(const std::optional<EncounterTruth>& encounter) {
  if (!encounter) return py::none();
  py::dict dict;
  each_measure(IntoDict{dict}, encounter);
  py::list volumes;
  for (const VolumeTruth& volume : encounter->volumes)
    volumes.append(
        py::make_tuple(text(volume.name), volume.inside, python_of(volume.to_violation_s)));
  dict["volumes"] = volumes;
  return dict;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Rows become columns: begin_row(), then the same calls with other values for each row. What is
// empty is NaN. A vector of k numbers makes a column of n x k.
class Columns {
 public:
  void begin_row() {
    at_ = 0;
    ++rows_;
  }

  template <typename T>
  void operator()(const char* name, const T& value) {
    if (at_ == columns_.size()) columns_.push_back({name, {}});
    add(columns_[at_++].values, value);
  }

  py::dict dict() && {
    py::dict result;
    for (Column& column : columns_)
      result[column.name] =
          std::visit([&](auto& values) { return finished(values); }, column.values);
    return result;
  }

 private:
  using Values = std::variant<std::monostate,
                              std::vector<double>,
                              std::vector<std::int64_t>,
                              py::list,
                              std::vector<bool>>;
  struct Column {
    const char* name;
    Values values;
  };

  template <typename T>
  static T& as(Values& values) {
    if (!std::holds_alternative<T>(values)) values.emplace<T>();
    return std::get<T>(values);
  }

  static void add(Values& to, const std::string& value) { as<py::list>(to).append(text(value)); }
  static void add(Values& to, bool value) { as<std::vector<bool>>(to).push_back(value); }
  static void add(Values& to, std::int64_t value) {
    as<std::vector<std::int64_t>>(to).push_back(value);
  }
  static void add(Values& to, double value) { as<std::vector<double>>(to).push_back(value); }
  static void add(Values& to, const std::optional<std::int64_t>& value) {
    add(to, value ? static_cast<double>(*value) : kNone);
  }
  static void add(Values& to, const std::optional<double>& value) {
    add(to, value.value_or(kNone));
  }
  template <std::size_t N>
  static void add(Values& to, const std::array<double, N>& value) {
    auto& numbers = as<std::vector<double>>(to);
    numbers.insert(numbers.end(), value.begin(), value.end());
  }
  template <std::size_t N>
  static void add(Values& to, const std::optional<std::array<double, N>>& value) {
    std::array<double, N> none;
    none.fill(kNone);
    add(to, value.value_or(none));
  }
  template <typename AnyBox>
  static void add(Values& to, const std::optional<AnyBox>& box) {
    if (!box) return add(to, std::optional<std::array<double, 4>>());
    add(to,
        std::array<double, 4>{
            double(box->x), double(box->y), double(box->width), double(box->height)});
  }

  static py::object finished(std::monostate&) { return py::none(); }
  static py::object finished(py::list& texts) {
    return py::module_::import("numpy").attr("array")(texts, py::arg("dtype") = "U");
  }
  static py::object finished(std::vector<bool>& flags) {
    py::array_t<bool> array(std::ssize(flags));
    for (std::size_t i = 0; i < flags.size(); ++i) array.mutable_at(i) = flags[i];
    return array;
  }
  template <typename T>
  py::object finished(std::vector<T>& values) const {
    const py::ssize_t width = std::ssize(values) / rows_;
    return array_of(
        std::move(values),
        width == 1 ? std::vector<py::ssize_t>{rows_} : std::vector<py::ssize_t>{rows_, width});
  }

  std::vector<Column> columns_;
  std::size_t at_ = 0;
  py::ssize_t rows_ = 0;
};

void add_intruder(Columns& columns, const FrameTruth& frame, const IntruderTruth& intruder) {
  columns.begin_row();
  columns("frame", frame.frame);
  columns("time_s", frame.time_s);
  each_intruder_field(columns, intruder);
  each_measure(columns, intruder.encounter);
}

// The first `rows` rows of each column.
py::dict first_rows(const py::dict& columns, py::ssize_t rows) {
  py::dict result;
  for (const auto& [name, column] : columns)
    result[name] = column[py::slice(0, rows, 1)].cast<py::object>();
  return result;
}

}  // namespace

py::dict truth_dict(const FrameTruth& truth) {
  py::dict dict;
  each_frame_field(IntoDict{dict}, truth);
  for (const char* matrix : {"frame_from_reference", "frame_from_reference_per_s"})
    dict[matrix] = dict[matrix].attr("reshape")(3, 3);
  py::list intruders;
  for (const IntruderTruth& intruder : truth.intruders) {
    py::dict fields;
    each_intruder_field(IntoDict{fields}, intruder);
    fields["encounter"] = encounter_dict(intruder.encounter);
    intruders.append(fields);
  }
  dict["intruders"] = intruders;
  return dict;
}

py::dict intruder_columns(const std::vector<FrameTruth>& frames) {
  Columns columns;
  bool is_empty = true;
  for (const FrameTruth& frame : frames)
    for (const IntruderTruth& intruder : frame.intruders) {
      add_intruder(columns, frame, intruder);
      is_empty = false;
    }
  if (!is_empty) return std::move(columns).dict();
  // A row tells the columns' types.
  add_intruder(columns, {}, {});
  return first_rows(std::move(columns).dict(), 0);
}

py::dict frame_columns(const std::vector<FrameTruth>& frames) {
  Columns columns;
  for (const FrameTruth& frame : frames) {
    columns.begin_row();
    each_frame_field(columns, frame);
  }
  if (!frames.empty()) return std::move(columns).dict();
  columns.begin_row();
  each_frame_field(columns, FrameTruth());
  return first_rows(std::move(columns).dict(), 0);
}

}  // namespace airtruth::python
