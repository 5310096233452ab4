// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "aircraft/model/mesh.h"
#include "foundation/base/files.h"

// The content of an AC3D text file (.ac) after checks, without interpretation. The format:
// https://www.inivis.com/ac3d/man/ac3dfileformat.html
namespace airtruth::ac3d {

struct AcCorner {
  std::uint32_t vertex = 0;  // index into AcObject::vertices
  float u = 0;               // texrep and texoff applied
  float v = 0;
};

struct AcSurface {
  bool smooth = false;
  bool two_sided = false;
  std::uint32_t material = 0;
  std::uint32_t first_corner = 0;
  std::uint32_t corners = 0;  // at least 3
};

struct AcObject {
  int parent = -1;  // index into AcFile::objects
  std::string name;
  std::string
      texture;  // its own, or that of an object around it, as the file names it; empty: none
  int texture_line = 0;
  float crease_deg = 61;                  // AC3D's own where the file states none
  std::vector<Eigen::Vector3f> vertices;  // in the file's frame: rot and loc applied
  std::vector<AcSurface> surfaces;        // lines are left out
  std::vector<AcCorner> corners;
};

// Objects in the order of the file: one comes before what it holds.
struct AcFile {
  std::vector<model::Material> materials;  // colours in sRGB, without textures
  std::vector<AcObject> objects;
};

// Throws Error with `name` and line where the text is not AC3D or ends early, where an index
// exceeds what the file holds, where a number is not finite or beyond its range, and where a count
// exceeds its limit. A kid that is stated but does not begin before the text ends is left out.
AcFile parse_ac(std::string_view text, const fs::path& name);

// The names of the objects around an object, outermost first. Objects without a name are left out.
// The outermost is called World, as FlightGear's animations expect.
std::vector<std::string> names_of(const AcFile& file, std::size_t object);

}  // namespace airtruth::ac3d
