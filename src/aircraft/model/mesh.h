// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "aircraft/texture_file/picture.h"
#include "foundation/geometry/transform.h"

// An aircraft as triangles with materials and textures. Coordinates are in the body frame (x
// forward, y right, z down; metres) and in single precision, which suffices for the size of an
// aircraft. The origin is the model's own reference point; the flight path moves this point.
//
// Example: a Cessna 172P is 11.00 m wide and 8.28 m long. A mesh whose positions lie between
// (-6, -5.5, -1) and (2.28, 5.5, 1) has extents of length_m() = 8.28, span_m() = 11 and
// height_m() = 2. A propeller part with 10 revolutions per second has turned by a third of a
// revolution, 120 degrees, at time_s = 1/30.
namespace airtruth::model {

// Linear light, RGBA, with premultiplied alpha.
using Texel = std::array<float, 4>;

// A texture and its mip chain. Level 0 is the finest. Each coarser level has half the size of the
// level before, down to 1x1, and is averaged from that level's texels.
struct Texture {
  struct Level {
    int width = 0;
    int height = 0;
    // Row 0 is v = 0, the bottom of the picture, as in OpenGL.
    std::vector<Texel> texels;
    bool operator==(const Level&) const = default;
  };
  // A texel is decoded when it is read (texture.h): bytes take a quarter of the memory of floats.
  texture_file::Picture finest;
  std::vector<Level> coarser;
  bool repeat_u = true;
  bool repeat_v = true;
  // Whether the alpha of any texel is below kOpaque.
  bool has_translucency = false;
  bool operator==(const Texture&) const = default;
};

// A texture that several meshes may hold. Two are equal if their texels are.
class SharedTexture {
 public:
  // Not explicit: a mesh takes a texture as it is.
  SharedTexture(Texture texture) : texture_(std::make_shared<const Texture>(std::move(texture))) {}

  const Texture& operator*() const { return *texture_; }
  const Texture* operator->() const { return texture_.get(); }
  const Texture* get() const { return texture_.get(); }
  bool operator==(const SharedTexture& other) const {
    return texture_ == other.texture_ || *texture_ == *other.texture_;
  }

 private:
  std::shared_ptr<const Texture> texture_;
};

// The opacity from which on a surface counts as opaque: 250 / 255, because painting and packing
// leave some code values less than 255 in the alpha of paint that hides all behind it.
constexpr float kOpaque = 0.98f;

// How a surface reflects light, apart from its colour.
enum class Finish : std::uint8_t {
  kPaint,  // diffuse under a clear coat that reflects
  kGlass,  // reflects as the clear coat does, above a dark interior
  kMetal,  // reflects, tinted by its colour, without a diffuse part
  kMat,    // diffuse without a reflection
};
constexpr std::uint8_t kFinishes = 4;

// The finish that the words of a material's name in its file state. A word is a run of letters in
// any case. docs/aircraft.md lists the words for glass and metal. Other names are paint.
Finish finish_named(std::string_view material);

struct Material {
  std::array<float, 3> diffuse = {1, 1, 1};   // linear
  std::array<float, 3> emission = {0, 0, 0};  // linear
  std::array<float, 3> specular = {0, 0, 0};  // linear
  float shininess = 0;                        // Blinn-Phong exponent, 0..128
  float opacity = 1;
  // Index into Mesh::textures; -1 for a material without a texture.
  int texture = -1;
  Finish finish = Finish::kPaint;
  bool operator==(const Material&) const = default;
};

struct Triangle {
  std::array<std::uint32_t, 3> vertex{};
  std::uint32_t material = 0;
  bool operator==(const Triangle&) const = default;
};

// A hinge about which a part swings to and fro, such as the root of a wing. In the pose of the
// mesh's own positions its angle is 0.
struct Hinge {
  Eigen::Vector3f axis_in_body{1, 0, 0};  // unit
  Eigen::Vector3f centre_in_body{0, 0, 0};
  float rest_rad = 0;
  float amplitude_rad = 0;
  // By how much of a stroke the hinge follows the stroke.
  float lag_strokes = 0;
  bool operator==(const Hinge&) const = default;
};

// Wing beats: bouts of strokes with glides between them, in which the hinges are at rest. A bout
// and its glide last kStrokesOfBout strokes.
struct Beat {
  double strokes_per_s = 0;
  // Strokes that are done at the time 0.
  double phase_strokes = 0;
  // Share of the time that is spent gliding, 0..1.
  double glide = 0;
  bool operator==(const Beat&) const = default;
};
// Number of strokes: a choice.
constexpr double kStrokesOfBout = 10;

// Triangles that move together. Part 0 is the airframe. A part that spins (propeller, rotor) turns
// about its axis through its centre. A part with hinges swings: the last hinge moves it first, and
// the hinges before it carry the later ones along.
struct Part {
  std::string name;
  std::vector<Triangle> triangles;
  bool spins = false;
  Eigen::Vector3f axis_in_body{1, 0, 0};
  Eigen::Vector3f centre_in_body{0, 0, 0};
  double revolutions_per_s = 0;
  // Of a part that swings; centre_in_body is the centre of the first hinge.
  std::vector<Hinge> hinges = {};
  Beat beat = {};
  bool moves() const { return spins || !hinges.empty(); }
  bool operator==(const Part&) const = default;
};

struct Mesh {
  std::vector<Eigen::Vector3f> positions;  // in body
  // Unit vectors, one per position, averaged over smooth edges.
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector2f> uvs;
  std::vector<Material> materials;
  std::vector<SharedTexture> textures;
  std::vector<Part> parts;

  std::size_t triangle_count() const;
  // nullptr for a material without one.
  const Texture* texture_of(const Material& material) const {
    return material.texture < 0 ? nullptr
                                : textures[static_cast<std::size_t>(material.texture)].get();
  }
  bool has_translucent_texels(const Material& material) const {
    const Texture* texture = texture_of(material);
    return texture != nullptr && texture->has_translucency;
  }
  bool operator==(const Mesh&) const = default;
};

// The transform from a part to the body at a time: the identity for the airframe, a rotation about
// the axis for a part that spins, and the rotations about its hinges for a part that swings.
Eigen::Affine3f body_from_part(const Part& part, double time_s);

// Radius of the sphere about part.centre_in_body that holds the part at all times.
float reach_m(const Mesh& mesh, const Part& part);

// An upper bound of how fast the part turns, in revolutions a second.
double fastest_turn_per_s(const Part& part);

// The points whose projections bound the visible silhouette, as one list per part in part
// coordinates. An opaque triangle contributes its vertices. A translucent triangle (a propeller
// disc drawn on a square) contributes points on the border of the texels with alpha >= 1/255. These
// are dense enough for an error of 0.05 px on an aircraft of 400 px.
std::vector<std::vector<Eigen::Vector3f>> silhouette_points(const Mesh& mesh);

// The axis-parallel bounds of a mesh in body, in metres.
struct Extents {
  Vector3 low_in_body = Vector3::Zero();
  Vector3 high_in_body = Vector3::Zero();
  double length_m() const { return high_in_body.x() - low_in_body.x(); }
  double span_m() const { return high_in_body.y() - low_in_body.y(); }
  double height_m() const { return high_in_body.z() - low_in_body.z(); }
};
Extents extents(const Mesh& mesh);

}  // namespace airtruth::model
