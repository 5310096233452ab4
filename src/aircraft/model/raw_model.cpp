// SPDX-License-Identifier: Apache-2.0
#include "aircraft/model/raw_model.h"

#include <algorithm>
#include <cmath>

#include "aircraft/model/texture.h"
#include "foundation/base/error.h"

namespace airtruth::model {
namespace {

// Largest deviation of a unit vector's length by rounding.
constexpr float kUnitTolerance = 1e-3f;
// Bounds for untrusted files; a texture coordinate is in repetitions of the texture.
constexpr float kLargestModelUv = 1e6f;
constexpr double kFastestSpin = 1000;  // revolutions a second

void expect_sound(bool condition, const char* what) {
  if (!condition) throw Error(std::string("the model's reader handed back ") + what);
}

bool within(const Eigen::Vector3f& v, float largest) {
  return std::abs(v.x()) <= largest && std::abs(v.y()) <= largest && std::abs(v.z()) <= largest;
}

bool is_unit_vector(const Eigen::Vector3f& v) {
  return within(v, 2) && std::abs(v.norm() - 1) <= kUnitTolerance;
}

bool is_share(float value) { return value >= 0 && value <= 1; }

bool are_shares(const std::array<float, 3>& values) {
  return std::all_of(values.begin(), values.end(), is_share);
}

void check_vertices(const Mesh& mesh) {
  expect_sound(mesh.positions.size() <= kMaxCorners, "too many vertices");
  expect_sound(
      mesh.normals.size() == mesh.positions.size() && mesh.uvs.size() == mesh.positions.size(),
      "arrays of different lengths");
  const auto largest = static_cast<float>(kLargestCoordinate);
  for (const Eigen::Vector3f& p : mesh.positions)
    expect_sound(within(p, largest), "a position beyond 1,000 km");
  for (const Eigen::Vector3f& n : mesh.normals)
    expect_sound(is_unit_vector(n), "a normal that is no unit vector");
  for (const Eigen::Vector2f& uv : mesh.uvs)
    expect_sound(std::abs(uv.x()) <= kLargestModelUv && std::abs(uv.y()) <= kLargestModelUv,
                 "a texture coordinate beyond 1e6");
}

void check_materials(const RawModel& model) {
  expect_sound(model.mesh.materials.size() <= kMaxMaterials, "too many materials");
  const auto pictures = static_cast<int>(model.pictures.size());
  for (const Material& m : model.mesh.materials) {
    expect_sound(are_shares(m.diffuse) && are_shares(m.emission) && are_shares(m.specular) &&
                     is_share(m.opacity) && m.shininess >= 0 && m.shininess <= 128,
                 "a material out of range");
    expect_sound(m.texture >= -1 && m.texture < pictures, "a material without its texture");
    expect_sound(static_cast<std::uint8_t>(m.finish) < kFinishes, "a finish that there is not");
  }
}

void check_parts(const Mesh& mesh) {
  expect_sound(!mesh.parts.empty() && mesh.parts.size() <= kMaxParts, "too many parts, or none");
  expect_sound(mesh.triangle_count() <= kMaxTriangles, "too many triangles");
  for (const Part& part : mesh.parts) {
    expect_sound(within(part.centre_in_body, static_cast<float>(kLargestCoordinate)) &&
                     std::abs(part.revolutions_per_s) <= kFastestSpin &&
                     (!part.spins || is_unit_vector(part.axis_in_body)),
                 "a part that turns about no axis");
    for (const Triangle& triangle : part.triangles) {
      for (const std::uint32_t vertex : triangle.vertex)
        expect_sound(vertex < mesh.positions.size(), "a triangle without its vertex");
      expect_sound(triangle.material < mesh.materials.size(), "a triangle without its material");
    }
  }
}

void check_pictures(const std::vector<RawPicture>& pictures) {
  expect_sound(pictures.size() <= kMaxPictures, "too many textures");
  std::size_t pixels = 0;
  for (const RawPicture& raw : pictures) {
    expect_sound(raw.picture.width > 0 && raw.picture.height > 0 &&
                     raw.picture.width <= texture_file::PictureLimits{}.side_px &&
                     raw.picture.height <= texture_file::PictureLimits{}.side_px,
                 "a texture of a wrong size");
    const std::size_t count = pixels_in(raw.picture.width, raw.picture.height);
    expect_sound(raw.picture.rgba.size() == 4 * count, "a texture of a wrong length");
    pixels += count;
  }
  expect_sound(pixels <= kMaxPixels, "too large textures");
}

}  // namespace

void check_model(const RawModel& model) {
  expect_sound(model.mesh.textures.empty(), "textures of the wrong kind");
  expect_sound(model.warnings.size() <= kMaxWarnings, "too many warnings");
  check_vertices(model.mesh);
  check_pictures(model.pictures);
  check_materials(model);
  check_parts(model.mesh);
}

Mesh mesh_of(RawModel model) {
  Mesh mesh = std::move(model.mesh);
  for (RawPicture& raw : model.pictures)
    mesh.textures.push_back(
        texture_from_picture(std::move(raw.picture), raw.repeat_u, raw.repeat_v));
  return mesh;
}

}  // namespace airtruth::model
