// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/transform.h"

// FlightGear's wrapper XML of a 3D model: where the model lies, which parts show when, what turns.
// Coordinates here are FlightGear's: x back, y right, z up, metres; rotations are right-handed.
namespace airtruth::aircraft {

namespace fs = std::filesystem;

struct Condition {
  enum class Kind {
    kAnd,
    kOr,
    kNot,
    kLess,
    kLessEquals,
    kGreater,
    kGreaterEquals,
    kEquals,
    kNotEquals,
    kTrue
  };
  Kind kind = Kind::kAnd;  // kAnd without parts is true
  std::string property;
  std::optional<std::string> other_property;
  double value = 0;
  std::vector<Condition> parts;
};

struct Animation {
  std::string type;                  // "select", "rotate", "spin", "translate", "scale", ...
  std::vector<std::string> objects;  // empty: the whole model
  std::optional<Condition> condition;
  std::string property;
  double factor = 1;
  double offset = 0;
  std::vector<std::pair<double, double>> interpolation;
  Vector3 centre{0, 0, 0};
  Vector3 axis{0, 0, 1};
  Vector3 scale{1, 1, 1};
};

struct Wrapper {
  fs::path file;
  fs::path model;                         // empty where the wrapper holds nested models alone
  std::vector<fs::path> texture_folders;  // searched in this order, before the model's own
  Eigen::Affine3d parent_from_model = Eigen::Affine3d::Identity();
  std::vector<Animation> animations;
  std::vector<Wrapper> nested;  // parent_from_model of each places it in this wrapper's model
};

// Reads a wrapper and what it includes and nests. `data_root` is FlightGear's root, against which
// "AI/..." and "Aircraft/..." paths are resolved. Errors carry file and line: not XML, a missing
// file, includes that go round in circles. A nested model that is missing is left out (FlightGear
// does so), and named in `missing`. `sources`: every file read.
Wrapper read_wrapper(const fs::path& file,
                     const fs::path& data_root,
                     std::vector<fs::path>& sources,
                     std::set<std::string>& missing);

// One file's text alone, without includes and nested files; for fuzzing.
Wrapper parse_wrapper(std::string_view text, const fs::path& name);

// What a model can ask of the simulation, in cruise: speed and height from the options, gear down
// near the ground, engines running, surfaces and switches at rest.
struct Cruise {
  double airspeed_kt = 150;
  double altitude_agl_ft = 1000;
};
double property_value(const std::string& property, const Cruise& cruise);
bool holds(const Condition& condition, const Cruise& cruise);
// The animated value: interpolation table or factor * value + offset.
double animated_value(const Animation& animation, const Cruise& cruise);

}  // namespace airtruth::aircraft
