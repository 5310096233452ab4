// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "aircraft/model/mesh.h"

namespace airtruth::shade {

// An aircraft prepared for rays: its BVH in body coordinates. A Model is immutable; intruders of
// one type share one.
class Model {
 public:
  // Shares the mesh. `occlusion_cache`: a folder that keeps the ambient occlusion of models from
  // one run to the next (ambient_occlusion.h); empty: none.
  explicit Model(std::shared_ptr<const model::Mesh> mesh,
                 const std::filesystem::path& occlusion_cache = {});
  // Shares the mesh, and takes the ambient occlusion of `same_shape`, whose mesh has the same
  // triangles in another size or other colours; any other is a logic error.
  Model(std::shared_ptr<const model::Mesh> mesh, const Model& same_shape);
  // Copies the mesh.
  explicit Model(const model::Mesh& mesh);
  ~Model();
  Model(Model&&) noexcept;
  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  explicit Model(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace airtruth::shade
