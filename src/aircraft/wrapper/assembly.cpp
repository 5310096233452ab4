// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/assembly.h"

#include <algorithm>
#include <cmath>

#include "aircraft/ac3d/ac_file.h"
#include "aircraft/ac3d/ac_mesh.h"
#include "aircraft/model/texture.h"
#include "foundation/base/error.h"

namespace airtruth::aircraft {
namespace {

constexpr std::size_t kMaxPictureBytes = std::size_t{256} << 20;

bool look_the_same(const Material& a, const Material& b) {
  return a.diffuse == b.diffuse && a.emission == b.emission && a.specular == b.specular &&
         a.shininess == b.shininess && a.opacity == b.opacity && a.texture == b.texture &&
         a.finish == b.finish;
}

std::array<float, 3> linear_colour(const std::array<float, 3>& srgb) {
  return {linear_channel(srgb[0]), linear_channel(srgb[1]), linear_channel(srgb[2])};
}

// A propeller at cruise transmits nine tenths of the light, because its blades cover a tenth of its
// disc (solidities are 0.04 to 0.15: Torenbeek 1982, section 6). The blades are dark and mat.
// Models made for games draw denser and paler discs.
constexpr float kDiscOpacity = 0.1f;
constexpr float kBladeAlbedo = 0.06f;  // linear; black or grey paint, behind tips of any colour

void make_propeller_disc(Material& material, const Picture* picture) {
  float cover = 1;  // the mean opacity of the texels that are not transparent
  if (picture != nullptr) {
    constexpr int kMinAlphaCodes = 8;  // of 255; chosen: fainter texels are rounding of the file
    double sum = 0;
    double count = 0;
    for (std::size_t i = 3; i < picture->rgba.size(); i += 4)
      if (picture->rgba[i] >= kMinAlphaCodes) sum += picture->rgba[i] / 255.0, count += 1;
    if (count > 0) cover = static_cast<float>(sum / count);
  }
  material.opacity = std::min(material.opacity, kDiscOpacity / cover);
  material.diffuse = {kBladeAlbedo, kBladeAlbedo, kBladeAlbedo};
  material.emission = {};
  material.specular = {};
  material.shininess = 0;
  material.finish = Finish::kMat;
}

std::string listed_folders(const ModelFiles& files, const std::vector<fs::path>& folders) {
  std::string text;
  for (const fs::path& folder : folders)
    text += (text.empty() ? "" : ", ") + files.shown(folder.empty() ? "." : folder).string();
  return text;
}

}  // namespace

Assembly::Assembly(ModelFiles& files) : files_(files) {
  model_.mesh.parts.push_back({.name = "airframe"});
}

PictureLimits Assembly::picture_limits() const {
  PictureLimits limits;
  limits.pixels = kMaxPixels - pixels_;
  return limits;
}

int Assembly::add_picture(Picture picture, bool repeat_u, bool repeat_v) {
  pixels_ += picture.rgba.size() / 4;
  if (model_.pictures.size() >= kMaxPictures)
    throw Error("has more than " + std::to_string(kMaxPictures) + " textures");
  model_.pictures.push_back({std::move(picture), repeat_u, repeat_v});
  return static_cast<int>(model_.pictures.size()) - 1;
}

int Assembly::read_texture(const fs::path& path, bool repeat_u, bool repeat_v) {
  const std::string key = path.string() + (repeat_u ? "|u" : "|") + (repeat_v ? "v" : "");
  const auto known = picture_of_file_.find(key);
  if (known != picture_of_file_.end()) return known->second;
  const int index = add_picture(
      read_picture(files_.read(path, kMaxPictureBytes), picture_limits()), repeat_u, repeat_v);
  picture_of_file_[key] = index;
  return index;
}

int Assembly::texture_of(const Batch& batch,
                         const PartChoice& choice,
                         const fs::path& file,
                         const std::vector<fs::path>& folders) {
  const bool replaced = !choice.texture.empty();
  if (!replaced && batch.picture >= 0) return batch.picture;
  if (!replaced && batch.texture.empty()) return -1;
  const Where where{files_.shown(file).string(), replaced ? 0 : batch.texture_line};
  const fs::path path =
      replaced ? fs::path(choice.texture) : find_texture(files_, batch.texture, folders);
  if (path.empty())
    throw Error("wants the texture " + batch.texture +
                    ", which is in none of: " + listed_folders(files_, folders),
                where);
  try {
    return read_texture(path, replaced || batch.repeat_u, replaced || batch.repeat_v);
  } catch (const Error& error) {
    throw Error("wants the texture " + files_.shown(path).string() + ", which " + error.message(),
                where);
  }
}

std::uint32_t Assembly::material_of(const Batch& batch, const PartChoice& choice, int texture) {
  Material material;
  material.diffuse = linear_colour(batch.diffuse);
  material.emission = linear_colour(batch.emission);
  material.specular = linear_colour(batch.specular);
  material.shininess = std::clamp(batch.shininess, 0.0f, 128.0f);
  material.opacity = choice.opacity * std::clamp(batch.opacity, 0.0f, 1.0f);
  material.texture = texture;
  material.finish = batch.finish;
  if (choice.is_propeller_disc)
    make_propeller_disc(
        material,
        texture < 0 ? nullptr : &model_.pictures[static_cast<std::size_t>(texture)].picture);
  auto& materials = model_.mesh.materials;
  for (std::size_t i = 0; i < materials.size(); ++i)
    if (look_the_same(materials[i], material)) return static_cast<std::uint32_t>(i);
  if (materials.size() >= kMaxMaterials)
    throw Error("has more than " + std::to_string(kMaxMaterials) + " materials");
  materials.push_back(material);
  return static_cast<std::uint32_t>(materials.size() - 1);
}

void Assembly::add_vertices(const Batch& batch, const Eigen::Affine3d& body_from_file) {
  Mesh& mesh = model_.mesh;
  const Eigen::Matrix3d normal_map = body_from_file.linear().inverse().transpose();
  for (std::size_t i = 0; i < batch.positions.size(); ++i) {
    const Vector3 position = body_from_file * batch.positions[i].cast<double>();
    if (!(position.cwiseAbs().maxCoeff() <= kLargestCoordinate))
      throw Error("has a vertex farther than 1,000 km from the model's origin, once it is placed");
    mesh.positions.push_back(position.cast<float>());
    Vector3 normal = normal_map * batch.normals[i].cast<double>();
    if (!(normal.norm() > 1e-12) || !std::isfinite(normal.norm())) normal = Vector3::UnitZ();
    mesh.normals.push_back(normal.normalized().cast<float>());
    mesh.uvs.push_back(batch.uvs[i]);
  }
}

void Assembly::add(const Batch& batch,
                   const PartChoice& choice,
                   const fs::path& file,
                   const std::vector<fs::path>& folders) {
  if (batch.triangles.empty()) return;
  Mesh& mesh = model_.mesh;
  triangles_ += batch.triangles.size();
  if (triangles_ > kMaxTriangles || mesh.positions.size() + batch.positions.size() > kMaxCorners)
    throw Error("makes an aircraft of more than " + std::to_string(kMaxTriangles) +
                    " triangles or " + std::to_string(kMaxCorners) + " vertices",
                {files_.shown(file).string()});
  const std::uint32_t material =
      material_of(batch, choice, texture_of(batch, choice, file, folders));
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  try {
    add_vertices(batch, choice.body_from_file);
  } catch (const Error& error) {
    throw Error(error.message(), {files_.shown(file).string()});
  }
  Part& part = mesh.parts[static_cast<std::size_t>(choice.part)];
  for (const auto& [a, b, c] : batch.triangles)
    part.triangles.push_back({{base + a, base + b, base + c}, material});
}

void append_ac(Assembly& assembly,
               const fs::path& file,
               const std::vector<fs::path>& folders,
               const ChoosePart& choose) {
  ModelFiles& files = assembly.files();
  const AcFile ac = parse_ac(files.read(file, kMaxModelBytes), files.shown(file));
  for (std::size_t i = 0; i < ac.objects.size(); ++i) {
    if (ac.objects[i].surfaces.empty()) continue;
    const PartChoice choice = choose(names_of(ac, i));
    if (choice.hidden) continue;
    for (const Batch& batch : batches_of(ac, ac.objects[i]))
      assembly.add(batch, choice, file, folders);
  }
}

}  // namespace airtruth::aircraft
