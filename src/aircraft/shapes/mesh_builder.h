// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "aircraft/model/mesh.h"

// Builds a mesh out of tubes, bodies of revolution and sheets, in body coordinates (x forward, y
// right, z down; metres). Normals are averaged over the triangles that share a vertex.
namespace airtruth::shapes {

// A ring of an elongated body: an ellipse across the body's axis, or a rounded box.
struct Ring {
  Eigen::Vector3f centre{0, 0, 0};
  float half_width = 0;   // along the first axis across
  float half_height = 0;  // along the second
  // The exponent of a superellipse: 2 is an ellipse, 4 nearly a box.
  float squareness = 2;
};

// A cross-section of a wing or a tail, from its leading to its trailing edge.
struct Rib {
  Eigen::Vector3f leading{0, 0, 0};
  Eigen::Vector3f trailing{0, 0, 0};
  float thickness = 0;
};

class MeshBuilder {
 public:
  // Returns the index of the material.
  std::uint32_t add_material(const std::array<float, 3>& linear_rgb,
                             model::Finish finish = model::Finish::kMat);
  // What is added next belongs to this part.
  void begin_part(model::Part part);

  // A closed skin around rings of `sides` corners whose plane is spanned by `across` and `along`.
  void add_body(std::span<const Ring> rings,
                const Eigen::Vector3f& across,
                const Eigen::Vector3f& along,
                int sides,
                std::uint32_t material);
  // A straight tube between two points, closed at both ends.
  void add_tube(const Eigen::Vector3f& from,
                const Eigen::Vector3f& to,
                float radius,
                int sides,
                std::uint32_t material);
  void add_box(const Eigen::Vector3f& low, const Eigen::Vector3f& high, std::uint32_t material);
  // A wing over ribs: a thin skin of lens-shaped sections with one material for its upper side, to
  // which `above` points, and one for its lower side. Its ends are open unless the first and the
  // last rib have no thickness.
  void add_wing(std::span<const Rib> ribs,
                std::uint32_t upper,
                std::uint32_t lower,
                const Eigen::Vector3f& above = {0, 0, -1});

  // The number of the part's triangles so far: what is added next begins there.
  std::size_t triangles() const { return mesh_.parts.back().triangles.size(); }
  // Cuts the part's triangles from `first` on in two where a plane crosses them.
  void cut(std::size_t first, const Eigen::Hyperplane<float, 3>& plane);
  // Gives the part's triangles from `first` on a material where their middles are wanted.
  void paint(std::size_t first,
             std::uint32_t material,
             const std::function<bool(const Eigen::Vector3f&)>& is_wanted);

  // The mesh with its normals. The builder is used up.
  model::Mesh take();

 private:
  std::uint32_t add_vertex(const Eigen::Vector3f& position);
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material);
  void add_quad(
      std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::uint32_t material);

  model::Mesh mesh_;
};

}  // namespace airtruth::shapes
