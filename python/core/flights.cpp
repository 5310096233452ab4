// SPDX-License-Identifier: Apache-2.0
#include <airtruth/aircraft.h>
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

}  // namespace

void bind_flights(py::module_& core) {
  core.def("aircraft", &aircraft);
  core.def("left_out_aircraft", &left_out);
  core.def("show_aircraft", &show);
}

}  // namespace airtruth::python
