// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <airtruth/error.h>
#include <airtruth/export.h>

// The aircraft that can be flown, as `airtruth aircraft list` and `airtruth aircraft show` tell
// them.
//
// Example: the Cessnas of Debian's package flightgear-data-ai.
//   for (const AircraftEntry& one : list_aircraft("c172/*"))
//     std::cout << one.name << ' ' << one.type << '\n';   // "c172/c-fgfs Cessna 172P", ...
//   show_aircraft("c172/news").liveries.size()            // 11
namespace airtruth {

// One name of the catalogue: a model in one livery.
struct AircraftEntry {
  // As scenes name it: "738/738-Ryanair". What stands before the slash is the model's folder.
  std::string name;
  // "Boeing 737-800"; in words, with its sizes, what is made in code or is no type of aircraft;
  // empty where nothing is published.
  std::string type;
  // Published sizes of the type; empty: unknown.
  std::optional<double> span_m;
  std::optional<double> length_m;
  std::optional<double> height_m;
  // Where they are published.
  std::string source;
};

// The aircraft whose names match a word, sorted: one with * or ? is a pattern for the whole name,
// any other matches the names that contain it, whatever the case of letters. Throws Error with the
// nearest names where none does.
AIRTRUTH_API std::vector<AircraftEntry> list_aircraft(const std::string& filter = {});

// Names of the installed package that are not offered, with the reason. `filter` as above.
AIRTRUTH_API std::map<std::string, std::string> left_out_aircraft(const std::string& filter = {});

struct ShowOptions {
  // Of a model file that states them not: the axes that are the nose and up (x, -y, ...), and
  // metres per unit. Empty, or 0: those of FlightGear's .ac files.
  std::string forward;
  std::string up;
  double scale = 0;
  Warn warn;
  // Ends the reading of a model file: show_aircraft() throws Interrupted.
  std::stop_token stop;
};

// An aircraft as its model has it.
struct AircraftModel {
  std::string name;
  std::filesystem::path file;
  double length_m = 0;
  double span_m = 0;
  double height_m = 0;
  std::int64_t triangles = 0;
  std::int64_t textures = 0;
  // The factor by which a model of the catalogue is brought to the size that is published.
  double catalogue_scale = 1;
  // Names of the same model in other liveries.
  std::vector<std::string> liveries;
};

// Reads an aircraft: a name of the catalogue, or a model file (.ac .obj .3ds .stl .ply .dae .gltf
// .glb .fbx, FlightGear's .xml), which a confined process reads. Throws Error for an unknown name,
// with the nearest ones, and for a file that cannot be read.
AIRTRUTH_API AircraftModel show_aircraft(const std::string& name, const ShowOptions& options = {});

}  // namespace airtruth
