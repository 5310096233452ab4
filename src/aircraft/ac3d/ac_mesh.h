// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "aircraft/ac3d/ac_file.h"

namespace airtruth::ac3d {

// How a picture stands for the surface on which it is.
struct Sampling {
  bool repeat_u = true;
  bool repeat_v = true;
  // A texel of at least this alpha is opaque and any other is absent; 0: all are opaque. Empty:
  // alpha is opacity.
  std::optional<float> alpha_cutoff;
  auto operator<=>(const Sampling&) const = default;
};

// Triangles of a model file that share one material, in the file's own frame, whatever its format.
struct Batch {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  // one a position; of any length
  std::vector<Eigen::Vector2f> uvs;      // one a position; v up from the picture's bottom
  std::vector<std::array<std::uint32_t, 3>> triangles;
  model::Material srgb{
      .diffuse = {0.8f, 0.8f, 0.8f}};  // colours in sRGB; its texture does not count
  std::string texture;                 // the file's name for it; empty: none
  int texture_line = 0;                // where the file names it; 0: unknown
  int picture = -1;  // index into RawModel::pictures, in place of `texture`: inside the file
  Sampling sampling;
};

// The triangles of one object, one batch per material in the order of the materials. Polygons
// become triangles. In a vertex of smooth surfaces, the normals of surfaces that meet at less than
// the crease angle, directly or through others, are averaged with their areas as weights. Other
// surfaces are flat. Both rules are those of OpenSceneGraph's AC3D reader, for which FlightGear's
// models are made.
std::vector<Batch> batches_of(const AcFile& file, const AcObject& object);

// Twice the area of a polygon times its normal: the sum over the fan of its first corner.
Eigen::Vector3f area_normal(std::span<const Eigen::Vector3f> corners);

// Whether the polygon needs another triangulation than a fan, which is where two neighbouring
// corners turn in opposite directions.
bool is_concave(std::span<const Eigen::Vector3f> corners);

// Triangulates a simple polygon by ear clipping (Meisters 1975) in the plane normal to `normal`.
// Returns corners.size() - 2 triangles as indices into `corners`. Where the polygon crosses itself
// and no ear exists, the corner that overlaps least is cut.
std::vector<std::array<std::uint32_t, 3>> ear_clipped(std::span<const Eigen::Vector3f> corners,
                                                      const Eigen::Vector3f& normal);

}  // namespace airtruth::ac3d
