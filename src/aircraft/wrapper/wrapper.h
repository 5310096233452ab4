// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "aircraft/wrapper/model_files.h"
#include "foundation/base/files.h"
#include "foundation/geometry/transform.h"

// The content of a FlightGear PropertyList, and of the files that it names. Coordinates are
// FlightGear's: x back, y right, z up, metres; rotations are right-handed.
namespace airtruth::wrapper {

// A bound for untrusted files; the largest wrapper of flightgear-data-ai has 87 KB.
constexpr std::size_t kMaxWrapperBytes = 8u << 20;

// The state of the simulation for which conditions and values are evaluated: engines running, gear
// down only near the ground, control surfaces and switches at rest, daylight.
struct Cruise {
  double airspeed_kt = 250;
  double altitude_agl_ft = 3000;
  // The number of blades of each rotor, by its name; parse_wrapper() takes it from the file.
  std::map<std::string, int> blades = {};
};

struct Animation {
  std::string type;                  // "select", "rotate", "spin", "translate", "scale", ...
  std::string name;                  // by which later animations may call what this one moves
  std::vector<std::string> objects;  // empty: the whole model
  std::optional<bool> condition;     // whether it holds at cruise; empty: none is stated
  // Of the state at cruise: degrees, metres, turns a minute, or a share.
  double value = 0;
  Vector3 scale{0, 0, 0};  // of scale animations
  Vector3 centre{0, 0, 0};
  Vector3 axis{0, 0, 0};
  // The axis is an object of the model, which is not searched.
  std::string axis_object;
  double least_m = 0;  // of range animations
  double most_m = 1e9;
  std::string texture;  // of material animations: replaces the objects' own
};

// A 3D model with its animations. `path`, `texture_path` and `include` are as the file states them.
// Of a nested wrapper the text states path, name, parent_from_nested and condition alone; the rest
// is in a file of its own.
struct Wrapper {
  std::string path;
  std::string texture_path;
  std::string include;
  std::string name;  // what the wrapper that nests this one calls it
  Eigen::Affine3d parent_from_nested = Eigen::Affine3d::Identity();  // where a nested one is put
  std::optional<bool> condition;                     // as that of an animation, for it to show
  std::optional<Eigen::Affine3d> nested_from_model;  // its own <offsets>
  std::vector<Animation> animations;
  std::vector<Wrapper> nested;
  // What read_wrapper() finds, below the folder of the model's files.
  fs::path file;
  fs::path model;           // empty where the wrapper holds nested models alone
  fs::path texture_folder;  // searched before all else; empty: none
};

// The numbers of an <interpolation>, by rising first number.
using Table = std::vector<std::pair<double, double>>;

// Reads the file of a table that an <interpolation> includes by this name.
using ReadTable = std::function<Table(const std::string& name)>;

// Throws Error with the line where the text is not XML or has no <PropertyList>. Without
// `read_table`, tables that are included count as empty.
Wrapper parse_wrapper(std::string_view text,
                      const fs::path& name,
                      const Cruise& cruise = {},
                      const ReadTable& read_table = {});

// The <entry> children of a file that an <interpolation> includes.
Table parse_table(std::string_view text, const fs::path& name);

// Reads a FlightGear wrapper XML of a 3D model, what it includes and what it nests. A property of
// the file itself overrides one that it includes. Paths are below the folder of `files`. A nested
// model that is missing is left out, as in FlightGear, and added to `missing`. Lamps, smoke, rain
// and sounds are left out. Throws Error with file and line where a file is no XML or missing, and
// where includes form a cycle.
Wrapper read_wrapper(ModelFiles& files,
                     const fs::path& file,
                     const Cruise& cruise,
                     std::set<std::string>& missing);

// The file that a path such as "Models/a.ac" or "AI/Aircraft/x/b.xml" means in a wrapper in
// `folder`. It is searched beside the wrapper, below FlightGear's data root, and in that root's AI.
// Returns an empty path where it is in none of them or not below the folder of `files`.
fs::path find_named_file(ModelFiles& files, const std::string& path, const fs::path& folder);

}  // namespace airtruth::wrapper
