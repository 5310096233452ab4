// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "aircraft/model/load_options.h"
#include "aircraft/model/mesh.h"
#include "foundation/base/files.h"
#include "foundation/base/log.h"

// Aircraft by name from Debian's package flightgear-data-ai ("738/738-Ryanair") or made in code
// ("helicopter-light/red", aircraft/shapes/airframes.h), and aircraft from single model files.
//
// Example: load_aircraft("738/738-Ryanair") reads AI/Aircraft/738/738-Ryanair.xml and everything
// that this wrapper names. load_aircraft("models/drone.obj") reads that file. A catalogue model
// whose wings span 9.63 m, where 11.00 m is published for its type, gets a catalogue_scale of
// 11.00 / 9.63 = 1.142 if its length is too short as well (scale.h).
namespace airtruth::fleet {

struct Entry {
  // The path of the wrapper XML below AI/Aircraft without its extension: "738/738-Ryanair".
  std::string name;
  // Empty for what is made in code.
  std::filesystem::path file;
  // The searched folder that holds the wrapper.
  std::filesystem::path catalogue_folder = {};
};

// The folder in which Debian's package flightgear-data-ai installs its aircraft.
constexpr const char* kDebianAircraft = "/usr/share/games/flightgear/AI/Aircraft";

// All aircraft of the catalogue, sorted by name: those made in code, and those in the folders of
// $AIRTRUTH_AIRCRAFT_PATH (colon-separated), or in kDebianAircraft where that is not set.
std::vector<Entry> list_aircraft();

// The names that match a word, sorted. A word with * or ? is a pattern for the whole name; any
// other word matches the names that contain it. Letter case does not matter. Throws Error with the
// nearest names where no name matches.
std::vector<std::string> expect_aircraft_named_like(const std::string& word);

// The names that a pattern with * and ? matches as a whole, sorted. Letter case matters first; a
// pattern that matches no name as it is written is matched again without regard to letter case.
std::vector<std::string> aircraft_fitting(const std::string& pattern);

// At most `count` names to suggest in a message about an unknown name: first the names that contain
// the word without regard to letter case, then the names nearest in spelling.
std::vector<std::string> nearest_aircraft(const std::string& word, std::size_t count);

// The entry of that name. Throws Error with the nearest names where there is none.
Entry find_aircraft(const std::string& name);

// The file of an aircraft: the model file itself where is_model_file(name)
// (aircraft/wrapper/reader.h), else the wrapper of that catalogue name; empty for what is made in
// code. Throws Error where the model file does not exist, or where no aircraft has that name; the
// message then holds the nearest names.
std::filesystem::path aircraft_file(const std::string& name);

struct Aircraft {
  std::string name;
  std::filesystem::path file;
  model::Mesh mesh;
  // The factor by which the catalogue's model was scaled.
  double catalogue_scale = 1;
  // Every file that was read, for checksums.
  std::vector<std::filesystem::path> sources;
};

// `name` is a catalogue name, or a path to a model file (.ac .obj .3ds .stl .ply .dae .gltf .glb
// .fbx, or a FlightGear .xml) when it has one of those endings. All files that a model file names
// must lie in its own folder or below. Debian's own aircraft are read in this process. All other
// files are read in a confined child process that can only return triangles and pixels. Throws
// Error for an unknown name (with the nearest names), an unreadable file, a model without
// triangles, or a missing texture. Throws Interrupted where options.stop is requested. One warning
// names the animations and properties that are not supported.
Aircraft load_aircraft(const std::string& name,
                       const model::LoadOptions& options = {},
                       const Warn& warn = {});

// The other liveries in the same model folder: the names that differ in the livery alone.
std::vector<std::string> liveries(const std::string& name);

// The configuration (gear, flaps, propellers) that an aircraft shows at the airspeed and the height
// of the options, as text. load_aircraft() returns the same aircraft wherever the text and the
// other options are the same. Most aircraft of the list have one configuration for all cruising
// speeds: their gear follows a limit, and their flaps are up above it. The text is empty for a bare
// model file. Of wrappers that are read in a confined process it states the airspeed and the height
// themselves.
std::string configuration_of(const std::string& name, const model::LoadOptions& options);

// Names of Debian's catalogue that cannot be drawn, or are no aircraft, with the reason
// (data/aircraft-left-out/README.md). They are not offered.
const std::map<std::string, std::string>& left_out();
// Those whose names match a word, as in expect_aircraft_named_like(). Throws Error where none does.
std::map<std::string, std::string> expect_left_out_named_like(const std::string& word);
// data/aircraft-left-out/left-out.csv, which the build embeds in the program: the name and the
// reason, a line each, below one heading.
std::string_view left_out_table();

}  // namespace airtruth::fleet
