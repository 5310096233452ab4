// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "aircraft/model/load_options.h"
#include "aircraft/model/mesh.h"
#include "foundation/base/log.h"

// The aircraft of Debian's flightgear-data-ai, by name ("738/738-Ryanair"), and bare model files.
namespace airtruth::aircraft {

namespace fs = std::filesystem;

struct Entry {
  std::string name;  // "738/738-Ryanair": the wrapper XML under AI/Aircraft, without its extension
  std::filesystem::path file;
  std::filesystem::path catalogue_folder = {};  // the one of the folders searched that holds it
};

// Where Debian's package flightgear-data-ai puts its aircraft.
constexpr const char* kDebianAircraft = "/usr/share/games/flightgear/AI/Aircraft";

// FlightGear's data root of a folder of aircraft: what holds its AI/Aircraft, or the folder itself.
std::filesystem::path data_root_of(const std::filesystem::path& catalogue_folder);

// Folders searched: $AIRTRUTH_AIRCRAFT_PATH (colon-separated), else kDebianAircraft. Sorted by
// name. Throws Error, saying which package to install, where there is no such folder.
std::vector<Entry> list_aircraft();

// The names that a word means, sorted: those it fits as a pattern over the whole name where it
// holds
// * or ?, else those that contain it. Letter case does not matter. Empty where none does.
std::vector<std::string> aircraft_named_like(const std::string& word);

// The names that a pattern with * and ? fits as a whole, sorted. Letter case matters where it
// decides: a pattern that fits no name as it is written fits whatever the case of its letters.
std::vector<std::string> aircraft_fitting(const std::string& pattern);

// Names for a message about a word that is no name, at most `count`: first those that contain the
// word in whatever case, then those nearest in spelling.
std::vector<std::string> nearest_aircraft(const std::string& word, std::size_t count);

// The entry of that name; Error with the nearest names otherwise.
Entry find_aircraft(const std::string& name);

// The file of the aircraft that `name` means: the model file itself where is_model_file(name)
// (aircraft/wrapper/reader.h), else the wrapper of that catalogue name. Error where the model file
// does not exist, or no aircraft has that name; the message holds the nearest names.
std::filesystem::path aircraft_file(const std::string& name);

struct Aircraft {
  std::string name;
  std::filesystem::path file;
  Mesh mesh;
  double catalogue_scale = 1;                  // that the catalogue's model was scaled by
  std::vector<std::filesystem::path> sources;  // every file read, for checksums
};

// `name` is a catalogue name, or a path to a model file (.ac .obj .3ds .stl .ply .dae .gltf .glb
// .fbx, or a FlightGear .xml) when it has one of those endings. All that it names lies in its own
// folder or below. Debian's own aircraft are read here, all other files in a child process that can
// do nothing but hand back triangles and pixels. Throws Error for what is unknown (nearest names),
// unreadable, without triangles, or lacks a texture, and Interrupted where options.stop is
// requested. Animations and properties that are not understood are named once in a warning.
Aircraft load_aircraft(const std::string& name,
                       const LoadOptions& options = {},
                       const Warn& warn = {});

// The other liveries of the same model folder: names that differ in the livery alone.
std::vector<std::string> liveries(const std::string& name);

}  // namespace airtruth::aircraft
