// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <limits>
#include <string>
#include <utility>

#include "bindings.h"
#include "values.h"

namespace airtruth::python {
namespace {

std::string state_of(const IntruderTruth& intruder) {
  // In the order of IntruderState.
  constexpr std::array kNames = {"visible", "hidden", "outside", "behind", "ended"};
  static_assert(kNames.size() == static_cast<std::size_t>(IntruderState::kEnded) + 1);
  return kNames.at(static_cast<std::size_t>(intruder.state));
}

// visit(name, field): a pointer to a member, or a function of the whole.
template <typename Visit>
void each_frame_field(const Visit& visit) {
  visit("frame", &FrameTruth::frame);
  visit("time_s", &FrameTruth::time_s);
  visit("damaged", &FrameTruth::damaged);
  visit("camera_position_ned_m", &FrameTruth::camera_position_ned_m);
  visit("camera_attitude_yaw_pitch_roll_deg", &FrameTruth::camera_attitude_yaw_pitch_roll_deg);
  visit("motion_state", &FrameTruth::motion_state);
  visit("frame_from_reference", &FrameTruth::frame_from_reference);
  visit("frame_from_reference_per_s", &FrameTruth::frame_from_reference_per_s);
  visit("rotation", &FrameTruth::rotation);
  visit("rate_radps", &FrameTruth::rate_radps);
}

template <typename Visit>
void each_intruder_field(const Visit& visit) {
  visit("id", &IntruderTruth::id);
  visit("aircraft", &IntruderTruth::aircraft);
  visit("object_class", &IntruderTruth::object_class);
  visit("state", &state_of);
  visit("position_ned_m", &IntruderTruth::position_ned_m);
  visit("velocity_ned_mps", &IntruderTruth::velocity_ned_mps);
  visit("attitude_yaw_pitch_roll_deg", &IntruderTruth::attitude_yaw_pitch_roll_deg);
  visit("position_in_cam_m", &IntruderTruth::position_in_cam_m);
  visit("range_m", &IntruderTruth::range_m);
  visit("range_rate_mps", &IntruderTruth::range_rate_mps);
  visit("azimuth_deg", &IntruderTruth::azimuth_deg);
  visit("elevation_deg", &IntruderTruth::elevation_deg);
  visit("nominal_azimuth_deg", &IntruderTruth::nominal_azimuth_deg);
  visit("nominal_elevation_deg", &IntruderTruth::nominal_elevation_deg);
  visit("exact_box_px", &IntruderTruth::exact_box_px);
  visit("covered_box_px", &IntruderTruth::covered_box_px);
  visit("covered_area_px", &IntruderTruth::covered_area_px);
  visit("visible_box_px", &IntruderTruth::visible_box_px);
  visit("contrast_to_noise", &IntruderTruth::contrast_to_noise);
  visit("visible_area_px", &IntruderTruth::visible_area_px);
  visit("alpha_sum_px", &IntruderTruth::alpha_sum_px);
  visit("centroid_px", &IntruderTruth::centroid_px);
  visit("hidden_by_own_aircraft", &IntruderTruth::hidden_by_own_aircraft);
  visit("hidden_by_occluder", &IntruderTruth::hidden_by_occluder);
  visit("hidden_by_intruder", &IntruderTruth::hidden_by_intruder);
  visit("cut_by_frame", &IntruderTruth::cut_by_frame);
}

template <typename Visit>
void each_measure(const Visit& visit) {
  visit("horizontal_m", &EncounterTruth::horizontal_m);
  visit("above_m", &EncounterTruth::above_m);
  visit("closing_speed_mps", &EncounterTruth::closing_speed_mps);
  visit("bearing_deg", &EncounterTruth::bearing_deg);
  visit("bearing_rate_dps", &EncounterTruth::bearing_rate_dps);
  visit("relative_bearing_deg", &EncounterTruth::relative_bearing_deg);
  visit("line_of_sight_rate_dps", &EncounterTruth::line_of_sight_rate_dps);
  visit("tcpa_s", &EncounterTruth::tcpa_s);
  visit("dcpa_m", &EncounterTruth::dcpa_m);
  visit("hmd_m", &EncounterTruth::hmd_m);
  visit("vmd_m", &EncounterTruth::vmd_m);
  visit("tau_mod_s", &EncounterTruth::tau_mod_s);
  visit("tcoa_s", &EncounterTruth::tcoa_s);
}

py::object encounter_dict(const std::optional<EncounterTruth>& encounter) {
  if (!encounter) return py::none();
  py::dict dict;
  each_measure([&](const char* name, auto field) {
    dict[name] = python_of(std::invoke(field, *encounter));
  });
  py::list volumes;
  for (const VolumeTruth& volume : encounter->volumes)
    volumes.append(
        py::make_tuple(text(volume.name), volume.inside, python_of(volume.to_violation_s)));
  dict["volumes"] = volumes;
  return dict;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// A value with NaN for what is empty, and a box as four numbers.
template <typename T>
T filled(const T& value) {
  return value;
}
double filled(const std::optional<double>& value) { return value.value_or(kNone); }
double filled(const std::optional<std::int64_t>& value) {
  return value ? static_cast<double>(*value) : kNone;
}
template <std::size_t N>
std::array<double, N> filled(const std::optional<std::array<double, N>>& value) {
  std::array<double, N> none;
  none.fill(kNone);
  return value.value_or(none);
}
template <typename AnyBox>
std::array<double, 4> filled(const std::optional<AnyBox>& box) {
  return row_of(box);
}

// The field of each row as an array.
template <typename Row, typename Field>
py::object array_column(const std::vector<Row>& rows, const Field& field) {
  py::object values = column(rows, [&](const Row& row) { return filled(std::invoke(field, row)); });
  if (!py::isinstance<py::list>(values)) return values;
  return py::module_::import("numpy").attr("array")(values, py::arg("dtype") = "U");
}

}  // namespace

py::dict truth_dict(const FrameTruth& truth) {
  py::dict dict;
  each_frame_field(
      [&](const char* name, auto field) { dict[name] = python_of(std::invoke(field, truth)); });
  for (const char* matrix : {"frame_from_reference", "frame_from_reference_per_s"})
    dict[matrix] = dict[matrix].attr("reshape")(3, 3);
  py::list intruders;
  for (const IntruderTruth& intruder : truth.intruders) {
    py::dict fields;
    each_intruder_field([&](const char* name, auto field) {
      fields[name] = python_of(std::invoke(field, intruder));
    });
    fields["encounter"] = encounter_dict(intruder.encounter);
    intruders.append(fields);
  }
  dict["intruders"] = intruders;
  return dict;
}

py::dict intruder_columns(const std::vector<FrameTruth>& frames) {
  using Row = std::pair<const FrameTruth*, const IntruderTruth*>;
  std::vector<Row> rows;
  for (const FrameTruth& frame : frames)
    for (const IntruderTruth& intruder : frame.intruders) rows.emplace_back(&frame, &intruder);
  py::dict columns;
  columns["frame"] = column(rows, [](const Row& row) { return row.first->frame; });
  columns["time_s"] = column(rows, [](const Row& row) { return row.first->time_s; });
  each_intruder_field([&](const char* name, auto field) {
    columns[name] =
        array_column(rows, [&](const Row& row) { return std::invoke(field, *row.second); });
  });
  each_measure([&](const char* name, auto field) {
    columns[name] = array_column(rows, [&](const Row& row) {
      const std::optional<EncounterTruth>& encounter = row.second->encounter;
      return encounter ? std::optional<double>(std::invoke(field, *encounter)) : std::nullopt;
    });
  });
  return columns;
}

py::dict frame_columns(const std::vector<FrameTruth>& frames) {
  py::dict columns;
  each_frame_field(
      [&](const char* name, auto field) { columns[name] = array_column(frames, field); });
  return columns;
}

}  // namespace airtruth::python
