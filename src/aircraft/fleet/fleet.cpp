// SPDX-License-Identifier: Apache-2.0
#include "aircraft/fleet/fleet.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "aircraft/confined/child.h"
#include "aircraft/fleet/scale.h"
#include "aircraft/shapes/airframes.h"
#include "aircraft/wrapper/model_files.h"
#include "aircraft/wrapper/part_names.h"
#include "aircraft/wrapper/reader.h"
#include "aircraft/wrapper/scope.h"
#include "aircraft/wrapper/wrapper.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"

namespace airtruth::fleet {
namespace {

// FlightGear's data root for a folder of aircraft: the folder that holds its AI/Aircraft, or the
// folder itself where its path has no such part.
fs::path data_root_of(const fs::path& catalogue_folder) {
  const fs::path whole = fs::absolute(catalogue_folder / "").lexically_normal().parent_path();
  const fs::path above = whole.parent_path();
  return whole.filename() == "Aircraft" && above.filename() == "AI" ? above.parent_path() : whole;
}

std::vector<fs::path> folders() {
  const char* stated = std::getenv("AIRTRUTH_AIRCRAFT_PATH");
  std::vector<fs::path> result;
  std::istringstream list(stated != nullptr && *stated != '\0' ? stated : kDebianAircraft);
  for (std::string folder; std::getline(list, folder, ':');)
    if (!folder.empty() && fs::is_directory(folder)) result.push_back(normal_path(folder));
  return result;
}

// The properties of a wrapper that the catalogue needs.
struct Sketch {
  fs::path file;
  bool deep = false;  // in a folder below the aircraft's own
  fs::path includes;  // in normal form; empty where it includes none
  std::vector<fs::path> nests;
  std::string path;  // of its model; empty where it has none of its own
  bool animated = false;
};

using Sketches = std::map<fs::path, Sketch>;

// The result is empty for a file that is no wrapper, since these folders hold other XML too.
std::optional<Sketch> sketch_of(const fs::path& file,
                                wrapper::ModelFiles& files,
                                const fs::path& root) {
  const std::string name = file.filename().string();
  if (wrapper::is_effect_name(name)) return std::nullopt;
  try {
    const wrapper::Wrapper text =
        wrapper::parse_wrapper(read_file(file, wrapper::kMaxWrapperBytes), file);
    Sketch sketch;
    sketch.file = file;
    const fs::path folder = file.parent_path();
    if (!text.include.empty()) sketch.includes = (folder / text.include).lexically_normal();
    for (const wrapper::Wrapper& nested : text.nested) {
      if (wrapper::is_effect_path(nested.path)) continue;
      const fs::path found =
          wrapper::find_named_file(files, nested.path, folder.lexically_relative(root));
      if (!found.empty()) sketch.nests.push_back((root / found).lexically_normal());
    }
    sketch.path = text.path;
    sketch.animated = !text.animations.empty();
    return sketch;
  } catch (const Error&) {
    return std::nullopt;
  }
}

// The wrappers in the folder of an aircraft and in the folders directly below it.
Sketches sketches_in(const fs::path& folder) {
  Sketches sketches;
  const fs::path root = data_root_of(folder.parent_path());
  wrapper::DiskFiles files(root, {});
  const auto add = [&](const fs::path& file, bool deep) {
    if (file.extension() != ".xml") return;
    if (auto sketch = sketch_of(file, files, root)) {
      sketch->deep = deep;
      sketches[file.lexically_normal()] = std::move(*sketch);
    }
  };
  for (const auto& at : fs::directory_iterator(folder)) {
    add(at.path(), false);
    if (!at.is_directory() || wrapper::is_effect_name(at.path().filename().string() + "/"))
      continue;
    for (const auto& below : fs::directory_iterator(at.path())) add(below.path(), true);
  }
  return sketches;
}

// The property that a wrapper states itself or, where it states none, through what it includes.
template <typename Value>
Value inherited(const Sketches& sketches, const Sketch& sketch, Value Sketch::*field) {
  const Sketch* at = &sketch;
  for (std::size_t i = 0; at->*field == Value{} && i < sketches.size(); ++i) {
    const auto base = sketches.find(at->includes);
    if (base == sketches.end()) break;
    at = &base->second;
  }
  return at->*field;
}

std::string model_of(const Sketches& sketches, const Sketch& sketch) {
  return inherited(sketches, sketch, &Sketch::path);
}

// Whole aircraft: wrappers that show a model, and that no other includes or
// nests. Wrappers in folders below (Models/c182-ai.xml) count where the
// aircraft's own folder holds none, and only with animations, since parts of
// aircraft lie there too.
std::vector<const Sketch*> aircraft_among(const Sketches& sketches) {
  std::set<fs::path> parts;
  for (const auto& [file, sketch] : sketches) {
    parts.insert(sketch.includes);
    parts.insert(sketch.nests.begin(), sketch.nests.end());
  }
  std::vector<const Sketch*> whole;
  bool any_shallow = false;
  for (const auto& [file, sketch] : sketches) {
    if (parts.contains(file)) continue;
    if (model_of(sketches, sketch).empty() && sketch.nests.empty()) continue;
    if (sketch.deep && !inherited(sketches, sketch, &Sketch::animated)) continue;
    whole.push_back(&sketch);
    any_shallow = any_shallow || !sketch.deep;
  }
  if (any_shallow) std::erase_if(whole, [](const Sketch* sketch) { return sketch->deep; });
  return whole;
}

std::string name_of(const fs::path& file, const fs::path& root) {
  return file.lexically_relative(root).replace_extension().generic_string();
}

void list_folder(const fs::path& root, std::vector<Entry>& entries) {
  for (const auto& folder : fs::directory_iterator(root)) {
    if (!folder.is_directory()) continue;
    const Sketches sketches = sketches_in(folder.path());
    for (const Sketch* sketch : aircraft_among(sketches)) {
      const std::string name = name_of(sketch->file, root);
      if (!left_out().contains(name)) entries.push_back({name, sketch->file, root});
    }
  }
}

std::vector<std::string> names_that(const std::function<bool(const std::string&)>& wanted) {
  std::vector<std::string> names;
  for (const Entry& entry : list_aircraft())
    if (wanted(entry.name)) names.push_back(entry.name);
  return names;
}

// All that the model depends on and the state at cruise decides, as text. Two states with the same
// outcomes give the same model.
std::string outcomes_of(const wrapper::Wrapper& wrapper) {
  std::string text = fmt::format("({}", wrapper.condition ? int{*wrapper.condition} : -1);
  for (const wrapper::Animation& animation : wrapper.animations)
    text += '|' + wrapper::effect_of(animation);
  for (const wrapper::Wrapper& nested : wrapper.nested) text += outcomes_of(nested);
  return text + ")";
}

}  // namespace

const std::map<std::string, std::string>& left_out() {
  static const std::map<std::string, std::string> reasons = [] {
    std::map<std::string, std::string> by_name;
    for (const std::string& row : rows_of(left_out_table())) {
      const auto comma = row.find(',');
      check(comma != std::string::npos, "a row of what is left out has a name and a reason");
      by_name[row.substr(0, comma)] = row.substr(comma + 1);
    }
    return by_name;
  }();
  return reasons;
}

std::vector<Entry> list_aircraft() {
  std::vector<Entry> entries;
  for (const std::string& name : shapes::made_names()) entries.push_back({name, {}, {}});
  for (const fs::path& folder : folders()) list_folder(folder, entries);
  std::ranges::stable_sort(entries, {}, &Entry::name);
  const auto is_same = [](const Entry& a, const Entry& b) { return a.name == b.name; };
  entries.erase(std::unique(entries.begin(), entries.end(), is_same), entries.end());
  return entries;
}

Entry find_aircraft(const std::string& name) {
  if (shapes::made_airframe(name) != nullptr) return {name, {}, {}};
  const std::vector<fs::path> searched = folders();
  for (const fs::path& folder : searched) {
    const fs::path file = folder / (name + ".xml");
    std::error_code ignored;
    const bool plain = !name.empty() && name.find("..") == std::string::npos && name.front() != '/';
    if (plain && fs::is_regular_file(file, ignored)) return {name, file, folder};
  }
  if (is_pattern(name))
    if (const std::vector<std::string> fitting = aircraft_fitting(name); !fitting.empty())
      throw Error(
          fmt::format("'{}' is a pattern, which the rules of a catalogue take; expected one "
                      "name, such as {} (`airtruth aircraft list '{}'` shows {})",
                      name,
                      fitting.front(),
                      name,
                      fitting.size()));
  throw Error(fmt::format(
      "unknown aircraft '{}'; the nearest names are {} (`airtruth aircraft list` shows all{})",
      name,
      fmt::join(nearest_aircraft(name, 3), ", "),
      searched.empty() ? "; the package flightgear-data-ai, or a folder that "
                         "AIRTRUTH_AIRCRAFT_PATH names, has more"
                       : ""));
}

fs::path aircraft_file(const std::string& name) {
  if (!wrapper::is_model_file(name)) return find_aircraft(name).file;
  if (!fs::exists(name)) throw Error("model file '" + name + "' does not exist");
  return name;
}

std::vector<std::string> expect_aircraft_named_like(const std::string& word) {
  std::vector<std::string> names =
      names_that([&](const std::string& name) { return is_named_like(name, word); });
  if (names.empty())
    throw Error(fmt::format(
        "no name among {} aircraft {} '{}'; the nearest are {}; `airtruth aircraft list` shows all",
        list_aircraft().size(),
        is_pattern(word) ? "fits" : "contains",
        word,
        fmt::join(nearest_aircraft(word, 3), ", ")));
  return names;
}

std::map<std::string, std::string> expect_left_out_named_like(const std::string& word) {
  std::map<std::string, std::string> found;
  for (const auto& [name, reason] : left_out())
    if (is_named_like(name, word)) found.emplace(name, reason);
  if (found.empty())
    throw Error(
        fmt::format("no name that is left out {} '{}'; `airtruth aircraft list --left-out` "
                    "shows all {}",
                    is_pattern(word) ? "fits" : "contains",
                    word,
                    left_out().size()));
  return found;
}

std::vector<std::string> aircraft_fitting(const std::string& pattern) {
  std::vector<std::string> exact;
  std::vector<std::string> in_any_case;
  for (const Entry& entry : list_aircraft()) {
    if (matches(pattern, entry.name)) exact.push_back(entry.name);
    if (matches(pattern, entry.name, LetterCase::kIgnored)) in_any_case.push_back(entry.name);
  }
  return exact.empty() ? in_any_case : exact;
}

std::vector<std::string> nearest_aircraft(const std::string& word, std::size_t count) {
  const std::vector<std::string> all = names_that([](const std::string&) { return true; });
  std::vector<std::string> names;
  if (!word.empty())
    for (const std::string& name : all)
      if (contains_ignoring_case(name, word)) names.push_back(name);
  for (const std::string& name : nearest_spellings(word, all, count))
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  names.resize(std::min(names.size(), count));
  return names;
}

std::vector<std::string> liveries(const std::string& name) {
  std::vector<std::string> result;
  if (wrapper::is_model_file(name)) return result;
  if (shapes::made_airframe(name) != nullptr) {
    const std::string folder = name.substr(0, name.find('/') + 1);
    for (const std::string& other : shapes::made_names())
      if (other != name && other.starts_with(folder)) result.push_back(other);
    return result;
  }
  for (const fs::path& root : folders()) {
    const fs::path own = (root / (name + ".xml")).lexically_normal();
    const auto slash = name.find('/');
    if (slash == std::string::npos || !fs::is_regular_file(own)) continue;
    const Sketches sketches = sketches_in(root / name.substr(0, slash));
    const auto known = sketches.find(own);
    if (known == sketches.end()) continue;
    const std::string model = model_of(sketches, known->second);
    for (const Sketch* sketch : aircraft_among(sketches))
      if (!model.empty() && sketch != &known->second && model_of(sketches, *sketch) == model &&
          !left_out().contains(name_of(sketch->file, root)))
        result.push_back(name_of(sketch->file, root));
    break;
  }
  std::sort(result.begin(), result.end());
  return result;
}

namespace {

struct Source : confined::ModelPlace {
  bool from_debian = false;
};

// The place of a file in Debian's package; `otherwise` where the package does not install it.
Source source_of(const fs::path& file, const confined::ModelPlace& otherwise) {
  std::error_code missing;
  const fs::path root = data_root_of(kDebianAircraft);
  const fs::path below = fs::canonical(file, missing).lexically_relative(root);
  if (missing || below.empty() || *below.begin() == "..") return {otherwise};
  return {{root, {}, below}, true};
}

Source source_of_path(const fs::path& file) {
  const fs::path folder = wrapper::folder_of_model(file);
  const fs::path below = folder == file.parent_path()
                             ? file.filename()
                             : file.parent_path().filename() / file.filename();
  return source_of(file,
                   {folder, wrapper::place_in_data_root(folder), below, LetterCase::kIgnored});
}

Source source_of_entry(const Entry& entry) {
  const fs::path root = data_root_of(entry.catalogue_folder);
  const fs::path file = fs::absolute(entry.file).lexically_normal();
  return source_of(file, {root, {}, file.lexically_relative(root)});
}

model::RawModel read_source(const Source& source,
                            const model::LoadOptions& options,
                            std::vector<fs::path>& sources) {
  if (!source.from_debian) return confined::read_in_child(source, options, sources);
  wrapper::DiskFiles files(source.folder, source.in_data_root);
  model::RawModel model = wrapper::read_model(files, source.file, options);
  sources = files.sources();
  return model;
}

// A model file states its own unit. A catalogue model is scaled to the published size of its type.
double scale_of(const std::string& name,
                const model::LoadOptions& options,
                const model::Mesh& mesh) {
  if (options.catalogue_scale) return *options.catalogue_scale;
  const PublishedSize* published = wrapper::is_model_file(name) ? nullptr : published_size(name);
  if (published == nullptr || !published->is_known()) return 1;
  return scale_to_published(model::extents(mesh), *published);
}

// Longer than any aircraft: the airship Hindenburg had 245 m.
constexpr double kLongest_m = 250;

// Many models are in centimetres or millimetres, and most files do not state their unit; those of a
// larger drawing may lie far from its origin, which is what a scene places.
void warn_of_size_and_origin(const std::string& name,
                             const model::Mesh& mesh,
                             const Warn& warn_to) {
  const model::Extents size = model::extents(mesh);
  const double longest_m = std::max({size.length_m(), size.span_m(), size.height_m()});
  const double from_origin_m = ((size.low_in_body + size.high_in_body) / 2).norm();
  constexpr double kFarLengths = 10;  // a part of an aircraft has the aircraft's origin: chosen
  if (from_origin_m > kFarLengths * longest_m)
    warn(warn_to,
         fmt::format("{}: its middle lies {:.4g} m from its origin, which is what a scene places; "
                     "expected an origin within the aircraft",
                     name,
                     from_origin_m));
  if (std::max(size.length_m(), size.span_m()) <= kLongest_m) return;
  warn(warn_to,
       fmt::format("{}: is {:.0f} m long and {:.0f} m wide; where the file is in other units than "
                   "metres, model_scale (of `aircraft show`: --scale) has the metres of one",
                   name,
                   size.length_m(),
                   size.span_m()));
}

}  // namespace

Aircraft load_aircraft(const std::string& name,
                       const model::LoadOptions& options,
                       const Warn& warn_to) {
  Aircraft aircraft;
  aircraft.name = name;
  Source source;
  const bool is_made = shapes::made_airframe(name) != nullptr;
  if (wrapper::is_model_file(name)) {
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
    if (!is_made) source = source_of_entry(entry);
  }
  if (is_made) {
    aircraft.mesh = shapes::made_mesh(name);
  } else {
    model::RawModel model = read_source(source, options, aircraft.sources);
    for (const std::string& warning : model.warnings) warn(warn_to, name + ": " + warning);
    aircraft.mesh = model::mesh_of(std::move(model));
  }
  aircraft.catalogue_scale = scale_of(name, options, aircraft.mesh);
  if (aircraft.catalogue_scale != 1) scale_mesh(aircraft.mesh, aircraft.catalogue_scale);
  if (wrapper::is_model_file(name) && wrapper::ending_of(name) != ".xml")
    warn_of_size_and_origin(name, aircraft.mesh, warn_to);
  std::vector<fs::path>& sources = aircraft.sources;
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  return aircraft;
}

std::string configuration_of(const std::string& name, const model::LoadOptions& options) {
  if (wrapper::is_model_file(name) && wrapper::ending_of(name) != ".xml") return {};
  if (shapes::made_airframe(name) != nullptr) return {};
  const std::string state = fmt::format("{:a} {:a}", options.airspeed_kt, options.altitude_agl_ft);
  if (wrapper::is_model_file(name)) return state;
  try {
    const Entry entry = find_aircraft(name);
    if (entry.catalogue_folder != fs::path(kDebianAircraft)) return state;
    const fs::path root = data_root_of(entry.catalogue_folder);
    wrapper::DiskFiles files(root, {});
    std::set<std::string> missing;
    return outcomes_of(wrapper::read_wrapper(files,
                                             fs::absolute(entry.file).lexically_relative(root),
                                             {options.airspeed_kt, options.altitude_agl_ft},
                                             missing));
  } catch (const Error&) {
    return state;  // load_aircraft() reports it
  }
}

}  // namespace airtruth::fleet
