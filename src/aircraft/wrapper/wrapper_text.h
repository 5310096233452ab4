// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aircraft/wrapper/condition.h"
#include "foundation/geometry/transform.h"

// The content of one FlightGear PropertyList, before the files that it names are searched.
// Coordinates are FlightGear's: x back, y right, z up, metres; rotations are right-handed.
namespace airtruth::aircraft {

namespace fs = std::filesystem;

struct Animation {
  std::string type;                  // "select", "rotate", "spin", "translate", "scale", ...
  std::string name;                  // by which later animations may call what this one moves
  std::vector<std::string> objects;  // empty: the whole model
  std::optional<Condition> condition;
  Driven value;                 // degrees, metres, turns a minute, or a share
  std::array<Driven, 3> scale;  // of scale animations, along x, y, z
  std::string table_file;       // the value's table comes from this file
  Vector3 centre{0, 0, 0};
  Vector3 axis{0, 0, 0};
  std::string axis_object;  // the axis is an object of the model, which is not
                            // looked for
  double least_m = 0;       // of range animations
  double most_m = 1e9;
  std::string texture;  // of material animations: replaces the objects' own
};

struct WrapperText {
  std::string path;
  std::string texture_path;
  std::string include;
  std::optional<Eigen::Affine3d> parent_from_model;  // of <offsets>
  std::vector<Animation> animations;
  struct Nested {
    std::string path;
    std::string name;
    Eigen::Affine3d parent_from_model = Eigen::Affine3d::Identity();
    std::optional<Condition> condition;
  };
  std::vector<Nested> nested;
};

// Throws Error with the line where the text is not XML or has no <PropertyList>.
WrapperText parse_wrapper(std::string_view text, const fs::path& name);

// The <entry> children of a file that an <interpolation> includes, sorted by <ind>.
std::vector<std::pair<double, double>> parse_table(std::string_view text, const fs::path& name);

}  // namespace airtruth::aircraft
