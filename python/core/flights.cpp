// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <airtruth/aircraft.h>
#include <airtruth/encounters.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

namespace fs = std::filesystem;
using namespace py::literals;

py::list aircraft(const std::string& filter) {
  py::list entries;
  for (const AircraftEntry& entry : list_aircraft(filter))
    entries.append(py::dict("name"_a = text(entry.name),
                            "type"_a = text(entry.type),
                            "span_m"_a = entry.span_m,
                            "length_m"_a = entry.length_m,
                            "height_m"_a = entry.height_m,
                            "source"_a = text(entry.source)));
  return entries;
}

py::dict left_out(const std::string& filter) {
  py::dict reasons;
  for (const auto& [name, reason] : left_out_aircraft(filter)) reasons[text(name)] = text(reason);
  return reasons;
}

py::dict show(const fs::path& name,
              const std::string& forward,
              const std::string& up,
              double scale) {
  ShowOptions options;
  options.forward = forward;
  options.up = up;
  options.scale = scale;
  const AircraftModel model =
      stoppable(options, [&](const ShowOptions& o) { return show_aircraft(name.string(), o); });
  return py::dict("name"_a = text(model.name),
                  "file"_a = model.file,
                  "length_m"_a = model.length_m,
                  "span_m"_a = model.span_m,
                  "height_m"_a = model.height_m,
                  "triangles"_a = model.triangles,
                  "textures"_a = model.textures,
                  "catalogue_scale"_a = model.catalogue_scale,
                  "liveries"_a = python_of(model.liveries));
}

// Whole numbers from 1, such as those of classes.
std::vector<std::size_t> numbers_from_1(const py::object& value, const char* what) {
  std::vector<std::size_t> numbers;
  for (const double number : list_of(value, what)) {
    if (!(number >= 1 && number <= 1e6) || number != std::floor(number))
      throw py::value_error(std::string(what) +
                            " holds a number that is no whole one of 1 to 1000000");
    numbers.push_back(static_cast<std::size_t>(number));
  }
  return numbers;
}

py::dict encounters(const py::kwargs& given) {
  EncounterOptions options;
  const FromKeywords take{given};
  fs::path model;
  fs::path own;
  take("model", model);
  take("own", own);
  options.own = own.string();
  take("count", options.count);
  take("seed", options.seed);
  take("duration_s", options.duration_s);
  options.domain = numbers_from_1(given["domain"], "domain");
  options.airspace = numbers_from_1(given["airspace"], "airspace");
  take("cpa_time_s", options.cpa_time_s);
  const auto take_list = [&](const char* name, std::vector<double>& numbers) {
    numbers = list_of(given[name], name);
  };
  take_list("altitude_ft", options.altitude_ft);
  take_list("hmd_m", options.hmd_m);
  take_list("hmd_shares", options.hmd_shares);
  take_list("vmd_m", options.vmd_m);
  take_list("vmd_shares", options.vmd_shares);
  take_list("course_deg", options.course_deg);
  take_list("speed_mps", options.speed_mps);
  take_list("climb_mps", options.climb_mps);
  take_list("turn_rate_dps", options.turn_rate_dps);
  options.jobs = checked_threads(given["jobs"], "jobs");
  const SampledEncounters set = stoppable(
      options,
      [&](const EncounterOptions& o) { return sample_encounters(model.string(), o); },
      given["progress"]);
  return py::dict("aircraft_names"_a = python_of(set.aircraft_names),
                  "weights"_a = python_of(set.weights),
                  "encounter"_a = python_of(set.encounter),
                  "aircraft"_a = python_of(set.aircraft),
                  "time_s"_a = python_of(set.time_s),
                  "position_ned_m"_a = python_of(set.position_ned_m),
                  "velocity_ned_mps"_a = python_of(set.velocity_ned_mps),
                  "share"_a = set.share,
                  "draws"_a = set.draws,
                  "effective_count"_a = set.effective_count);
}

}  // namespace

void bind_flights(py::module_& core) {
  core.def("aircraft", named(&aircraft, "filter"));
  core.def("left_out_aircraft", named(&left_out, "filter"));
  core.def("show_aircraft", named(&show, "name", "forward", "up", "scale"));
  core.def("sample_encounters", &encounters);
}

}  // namespace airtruth::python
