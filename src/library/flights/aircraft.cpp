// SPDX-License-Identifier: Apache-2.0
#include <airtruth/aircraft.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/fleet/scale.h"
#include "aircraft/model/load_options.h"
#include "aircraft/model/mesh.h"

namespace airtruth {
namespace {

AircraftEntry entry_of(const std::string& name) {
  AircraftEntry entry;
  entry.name = name;
  const fleet::PublishedSize* size = fleet::published_size(name);
  if (size == nullptr) return entry;
  entry.type = size->type;
  entry.source = size->source;
  if (!size->is_known()) return entry;
  entry.span_m = size->span_m;
  entry.length_m = size->length_m;
  entry.height_m = size->height_m;
  return entry;
}

}  // namespace

std::vector<AircraftEntry> list_aircraft(const std::string& filter) {
  std::vector<AircraftEntry> entries;
  for (const std::string& name : fleet::expect_aircraft_named_like(filter))
    entries.push_back(entry_of(name));
  return entries;
}

std::map<std::string, std::string> left_out_aircraft(const std::string& filter) {
  return fleet::expect_left_out_named_like(filter);
}

AircraftModel show_aircraft(const std::string& name, const ShowOptions& options) {
  model::LoadOptions load;
  load.axes = model::stated_axes(options.forward, options.up, options.scale);
  load.stop = options.stop;
  const fleet::Aircraft loaded = fleet::load_aircraft(name, load, options.warn);
  const model::Extents size = model::extents(loaded.mesh);
  return {loaded.name,
          loaded.file,
          size.length_m(),
          size.span_m(),
          size.height_m(),
          static_cast<std::int64_t>(loaded.mesh.triangle_count()),
          std::ssize(loaded.mesh.textures),
          loaded.catalogue_scale,
          fleet::liveries(name)};
}

}  // namespace airtruth
