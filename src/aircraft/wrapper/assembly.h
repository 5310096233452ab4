// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "aircraft/ac3d/ac_mesh.h"
#include "aircraft/model/raw_model.h"
#include "aircraft/wrapper/model_files.h"

// Builds one aircraft from the triangles of its model files.
namespace airtruth::wrapper {

// What to do with the triangles below a chain of named nodes (outermost first).
struct PartChoice {
  bool hidden = false;
  Eigen::Affine3d body_from_file = Eigen::Affine3d::Identity();
  int part = 0;                    // index into mesh.parts
  float opacity = 1;               // times the material's own
  bool is_propeller_disc = false;  // stands for blades that turn too fast to be seen
  std::string texture;  // below the files' folder; in place of the part's own; empty: its own
};
using ChoosePart = std::function<PartChoice(const std::vector<std::string>& names)>;

struct ModelFile {
  fs::path path;
  std::vector<fs::path> folders;  // in which its textures are searched, in order
  ChoosePart choose;
};

class Assembly {
 public:
  explicit Assembly(ModelFiles& files);

  ModelFiles& files() { return files_; }
  model::RawModel& model() { return model_; }

  void warn(const std::string& text);  // unless the model has many warnings already

  // Appends triangles of a file. A texture that is missing is a warning, but for AC3D. Throws
  // Error, with the file and the line that names the texture, where one is unreadable, and where
  // triangles, vertices or pixels exceed a limit.
  void add(const ac3d::Batch& batch, const PartChoice& choice, const ModelFile& file);

  // Adds a picture from inside a model file and returns its index for Batch::picture.
  int add_picture(std::string_view bytes, const ac3d::Sampling& sampling);

 private:
  void warn_of_texture(const std::string& name);
  int texture_of(const ac3d::Batch& batch, const PartChoice& choice, const ModelFile& file);
  int read_texture(const fs::path& path, const ac3d::Sampling& sampling);
  std::uint32_t material_of(const ac3d::Batch& batch, const PartChoice& choice, int texture);
  void add_vertices(const ac3d::Batch& batch, const Eigen::Affine3d& body_from_file);

  ModelFiles& files_;
  model::RawModel model_;
  std::map<std::pair<std::string, ac3d::Sampling>, int> picture_of_file_;
  std::size_t pixels_ = 0;
  std::size_t triangles_ = 0;
};

void append_ac(Assembly& assembly, const ModelFile& file);

}  // namespace airtruth::wrapper
