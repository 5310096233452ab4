// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "aircraft/model/finish.h"
#include "foundation/geometry/transform.h"

// An aircraft as triangles with what they look like. Body frame: x forward, y right, z down,
// metres, double-free floats (an aircraft is small). The origin is the model's own reference point,
// which the path moves along.
namespace airtruth::aircraft {

// sRGB texture, decoded to linear and premultiplied before its mip chain is built (level 0 is the
// full size, each further level half of it, down to 1x1).
struct Texture {
  struct Level {
    int width = 0;
    int height = 0;
    std::vector<std::array<float, 4>>
        texels;  // linear premultiplied RGBA; row 0 is v = 0 (the bottom, as OpenGL's)
    bool operator==(const Level&) const = default;
  };
  std::vector<Level> levels;
  bool repeat_u = true;
  bool repeat_v = true;
  bool has_translucency = false;  // some texel has alpha below kOpaque
  bool operator==(const Texture&) const = default;
};

// Opacity at which a surface counts as opaque: 254 / 255, since files round.
constexpr float kOpaque = 0.996f;

struct Material {
  std::array<float, 3> diffuse = {1, 1, 1};   // linear
  std::array<float, 3> emission = {0, 0, 0};  // linear
  std::array<float, 3> specular = {0, 0, 0};  // linear
  float shininess = 0;                        // Blinn-Phong exponent, 0..128
  float opacity = 1;
  int texture = -1;  // index into Mesh::textures, -1: none
  Finish finish = Finish::kPaint;
  bool operator==(const Material&) const = default;
};

struct Triangle {
  std::array<std::uint32_t, 3> vertex{};
  std::uint32_t material = 0;
  bool operator==(const Triangle&) const = default;
};

// Triangles that move together. part 0 is the airframe; a spinning part (propeller, rotor) turns
// about its axis.
struct Part {
  std::string name;
  std::vector<Triangle> triangles;
  bool spins = false;
  Eigen::Vector3f axis_in_body{1, 0, 0};
  Eigen::Vector3f centre_in_body{0, 0, 0};
  double revolutions_per_s = 0;
  bool operator==(const Part&) const = default;
};

struct Mesh {
  std::vector<Eigen::Vector3f> positions;  // in body
  std::vector<Eigen::Vector3f> normals;    // unit, one per position, averaged over smooth edges
  std::vector<Eigen::Vector2f> uvs;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Part> parts;

  std::size_t triangle_count() const;
  bool operator==(const Mesh&) const = default;
};

// body_from_part at a time: the identity for the airframe, a rotation about the axis for a spinning
// part.
Eigen::Affine3f body_from_part(const Part& part, double time_s);

// The points whose projections bound what can be seen: vertices of opaque triangles, and for
// translucent ones (a propeller disc drawn on a square) points on the border of the texels with
// alpha >= 1/255, dense enough for 0.05 px at 400 px. One list per part, in part coordinates.
std::vector<std::vector<Eigen::Vector3f>> silhouette_points(const Mesh& mesh);

// Extents in metres.
struct Extents {
  Vector3 low_in_body = Vector3::Zero();
  Vector3 high_in_body = Vector3::Zero();
  double length_m() const { return high_in_body.x() - low_in_body.x(); }
  double span_m() const { return high_in_body.y() - low_in_body.y(); }
  double height_m() const { return high_in_body.z() - low_in_body.z(); }
};
Extents extents(const Mesh& mesh);

}  // namespace airtruth::aircraft
