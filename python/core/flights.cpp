// SPDX-License-Identifier: Apache-2.0
#include <array>
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

py::dict entry_dict(const AircraftEntry& entry) {
  py::dict dict;
  const IntoDict into{dict};
  into("name", entry.name);
  into("type", entry.type);
  into("span_m", entry.span_m);
  into("length_m", entry.length_m);
  into("height_m", entry.height_m);
  into("source", entry.source);
  return dict;
}

py::list aircraft(const std::string& filter) {
  py::list entries;
  for (const AircraftEntry& entry : list_aircraft(filter)) entries.append(entry_dict(entry));
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
  py::dict dict;
  const IntoDict into{dict};
  into("name", model.name);
  dict["file"] = model.file;
  into("length_m", model.length_m);
  into("span_m", model.span_m);
  into("height_m", model.height_m);
  into("triangles", model.triangles);
  into("textures", model.textures);
  into("catalogue_scale", model.catalogue_scale);
  py::list liveries;
  for (const std::string& livery : model.liveries) liveries.append(text(livery));
  dict["liveries"] = liveries;
  return dict;
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

py::array rows(const std::vector<std::array<double, 3>>& vectors) {
  std::vector<double> numbers;
  numbers.reserve(3 * vectors.size());
  for (const std::array<double, 3>& vector : vectors)
    numbers.insert(numbers.end(), vector.begin(), vector.end());
  return array_of(std::move(numbers), {std::ssize(vectors), 3});
}

py::array numbers(const std::vector<std::int64_t>& values) {
  return array_of(values, {std::ssize(values)});
}

py::dict encounters_dict(const SampledEncounters& set) {
  py::list names;
  for (const std::string& name : set.aircraft_names) names.append(text(name));
  py::dict dict;
  const IntoDict into{dict};
  dict["aircraft_names"] = names;
  into("weights", set.weights);
  dict["encounter"] = numbers(set.encounter);
  dict["aircraft"] = numbers(set.aircraft);
  into("time_s", set.time_s);
  dict["position_ned_m"] = rows(set.position_ned_m);
  dict["velocity_ned_mps"] = rows(set.velocity_ned_mps);
  into("share", set.share);
  into("draws", set.draws);
  into("effective_count", set.effective_count);
  return dict;
}

// `ranges`: a list for each of the members that are named here.
py::dict encounters(const fs::path& model,
                    const fs::path& own,
                    std::int64_t count,
                    std::uint64_t seed,
                    std::optional<int> duration_s,
                    const py::object& domain,
                    const py::object& airspace,
                    std::optional<double> cpa_time_s,
                    const std::array<py::object, 9>& ranges,
                    const py::object& jobs,
                    const py::object& progress) {
  EncounterOptions options;
  options.own = own.string();
  options.count = count;
  options.seed = seed;
  options.duration_s = duration_s;
  options.domain = numbers_from_1(domain, "domain");
  options.airspace = numbers_from_1(airspace, "airspace");
  options.cpa_time_s = cpa_time_s;
  options.altitude_ft = list_of(ranges[0], "altitude_ft");
  options.hmd_m = list_of(ranges[1], "hmd_m");
  options.hmd_shares = list_of(ranges[2], "hmd_shares");
  options.vmd_m = list_of(ranges[3], "vmd_m");
  options.vmd_shares = list_of(ranges[4], "vmd_shares");
  options.course_deg = list_of(ranges[5], "course_deg");
  options.speed_mps = list_of(ranges[6], "speed_mps");
  options.climb_mps = list_of(ranges[7], "climb_mps");
  options.turn_rate_dps = list_of(ranges[8], "turn_rate_dps");
  options.jobs = checked_threads(jobs, "jobs");
  return encounters_dict(stoppable(
      options,
      [&](const EncounterOptions& o) { return sample_encounters(model.string(), o); },
      progress));
}

}  // namespace

void bind_flights(py::module_& core) {
  core.def("aircraft", named(&aircraft, "filter"));
  core.def("left_out_aircraft", named(&left_out, "filter"));
  core.def("show_aircraft", named(&show, "name", "forward", "up", "scale"));
  core.def("sample_encounters",
           named(&encounters,
                 "model",
                 "own",
                 "count",
                 "seed",
                 "duration_s",
                 "domain",
                 "airspace",
                 "cpa_time_s",
                 "ranges",
                 "jobs",
                 "progress"));
}

}  // namespace airtruth::python
