// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include "aircraft/confined/child.h"
#include "aircraft/confined/model_cache.h"
#include "aircraft/fleet/fleet.h"
#include "aircraft/fleet/scale.h"
#include "aircraft/wrapper/model_files.h"
#include "aircraft/wrapper/reader.h"
#include "foundation/base/error.h"

namespace airtruth::aircraft {
namespace {

// The place of a model: its files, and its own path below their folder.
struct Source {
  fs::path folder;
  fs::path in_data_root;
  fs::path file;
  bool from_debian = false;
};

// Whether Debian's package installs the file. If so, `below` receives its path below the data root.
bool is_from_debian(const fs::path& file, fs::path& below) {
  std::error_code missing;
  const fs::path real = fs::canonical(file, missing);
  if (missing) return false;
  below = real.lexically_relative(data_root_of(kDebianAircraft));
  return !below.empty() && *below.begin() != "..";
}

Source source_of(const fs::path& file, const fs::path& folder, const fs::path& in_data_root) {
  Source source{folder, in_data_root, file.lexically_relative(folder), false};
  if (folder.empty()) source.file = file;
  if (fs::path below; is_from_debian(file, below))
    source = {data_root_of(kDebianAircraft), {}, below, true};
  return source;
}

Source source_of_path(const fs::path& file) {
  const fs::path folder = file.parent_path();
  Source source = source_of(file, folder, place_in_data_root(folder));
  if (!source.from_debian) source.file = file.filename();
  return source;
}

Source source_of_entry(const Entry& entry) {
  const fs::path root = data_root_of(entry.catalogue_folder);
  return source_of(fs::absolute(entry.file).lexically_normal(), root, {});
}

// The model, and every file that it was read from.
RawModel read_source(const Source& source,
                     const LoadOptions& options,
                     std::vector<fs::path>& sources) {
  if (source.from_debian) {
    DiskFiles files(source.folder, source.in_data_root);
    RawModel model = read_model(files, source.file, options);
    sources = files.sources();
    return model;
  }
  DiskFiles before(source.folder, source.in_data_root, true);
  const auto key = model_key(before, source.file, options);
  if (auto kept = key ? cached_model(*key, before) : std::nullopt) {
    sources = before.sources();
    return std::move(*kept);
  }
  DiskFiles files(source.folder, source.in_data_root, true);
  RawModel model = read_in_child(files, source.file, options);
  if (key) keep_model(*key, files, model);
  sources = files.sources();
  return model;
}

// A model file states its own unit. A catalogue model is scaled to the published size of its type.
double scale_of(const std::string& name, const LoadOptions& options, const Mesh& mesh) {
  if (options.catalogue_scale) return *options.catalogue_scale;
  const PublishedSize* published = is_model_file(name) ? nullptr : published_size(name);
  if (published == nullptr || !published->is_known()) return 1;
  return scale_to_published(extents(mesh), *published);
}

}  // namespace

Aircraft load_aircraft(const std::string& name, const LoadOptions& options, const Warn& warn_to) {
  Aircraft aircraft;
  aircraft.name = name;
  Source source;
  if (is_model_file(name)) {
    if (options.catalogue_scale)
      throw Error(
          "catalogue_scale is for names of `airtruth aircraft list`; expected model_scale "
          "for the model file '" +
          name + "'");
    aircraft.file = name;
    source = source_of_path(name);
  } else {
    const Entry entry = find_aircraft(name);
    if (options.axes)
      throw Error("model_forward, model_up and model_scale are for a model file; '" + name +
                  "' has its own axes and metres");
    aircraft.file = entry.file;
    source = source_of_entry(entry);
  }
  RawModel model = read_source(source, options, aircraft.sources);
  for (const std::string& warning : model.warnings) warn(warn_to, name + ": " + warning);
  aircraft.mesh = mesh_of(std::move(model));
  aircraft.catalogue_scale = scale_of(name, options, aircraft.mesh);
  if (aircraft.catalogue_scale != 1) scale_mesh(aircraft.mesh, aircraft.catalogue_scale);
  std::sort(aircraft.sources.begin(), aircraft.sources.end());
  aircraft.sources.erase(std::unique(aircraft.sources.begin(), aircraft.sources.end()),
                         aircraft.sources.end());
  return aircraft;
}

}  // namespace airtruth::aircraft
