// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/assembly.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "aircraft/ac3d/ac_file.h"
#include "aircraft/ac3d/ac_mesh.h"
#include "aircraft/wrapper/reader.h"
#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "foundation/image/colour.h"

namespace airtruth::wrapper {
namespace {

// A propeller at cruise transmits nine tenths of the light, because its blades cover a tenth of its
// disc (solidities are 0.04 to 0.15: Torenbeek 1982, section 6). The blades are dark and mat.
// Models made for games draw denser and paler discs.
constexpr float kDiscOpacity = 0.1f;
constexpr float kBladeAlbedo = 0.06f;  // linear; black or grey paint, behind tips of any colour
// A part that turns and covers less than this of the light where it is drawn at all is a picture of
// turning blades. Of the package's parts that turn, such discs cover 0.10 to 0.35 and blades 0.51
// or more.
constexpr float kMaxDiscCover = 0.43f;

int texel_alpha(const texture_file::Picture& picture, const Eigen::Vector2f& uv) {
  const auto place = [](float share, int size) {
    return std::clamp(
        static_cast<int>((share - std::floor(share)) * static_cast<float>(size)), 0, size - 1);
  };
  const int x = place(uv.x(), picture.width);
  const int y = place(uv.y(), picture.height);
  return picture.rgba[4 * index_in(picture.width, x, y) + 3];
}

// The mean opacity of a batch's own texels, without the transparent ones. A disc may share its
// picture with the airframe.
float cover_of(const ac3d::Batch& batch, const texture_file::Picture& picture) {
  constexpr int kMinAlphaCodes = 8;  // of 255; chosen: fainter texels are rounding of the file
  constexpr int kSteps = 6;          // samples along a side of a triangle
  double sum = 0;
  double weight = 0;
  for (const auto& [i, j, k] : batch.triangles) {
    const Eigen::Vector2f a = batch.uvs[i], b = batch.uvs[j] - a, c = batch.uvs[k] - a;
    const double area = std::abs(static_cast<double>(b.x()) * c.y() - b.y() * c.x());
    if (!std::isfinite(area)) continue;
    for (int m = 0; m < kSteps; ++m)
      for (int n = 0; m + n < kSteps; ++n) {
        const float along_b = (static_cast<float>(m) + 1.0f / 3) / kSteps;
        const float along_c = (static_cast<float>(n) + 1.0f / 3) / kSteps;
        const int alpha = texel_alpha(picture, a + along_b * b + along_c * c);
        if (alpha < kMinAlphaCodes) continue;
        sum += area * alpha / 255.0;
        weight += area;
      }
  }
  return weight > 0 ? static_cast<float>(sum / weight) : 1;
}

void make_propeller_disc(model::Material& material, float cover) {
  material.opacity = std::min(material.opacity, kDiscOpacity / cover);
  material.diffuse = {kBladeAlbedo, kBladeAlbedo, kBladeAlbedo};
  material.emission = {};
  material.specular = {};
  material.shininess = 0;
  material.finish = model::Finish::kMat;
}

}  // namespace

Assembly::Assembly(ModelFiles& files) : files_(files) {
  model_.mesh.parts.push_back({.name = "airframe"});
}

int Assembly::add_picture(std::string_view bytes, const ac3d::Sampling& sampling) {
  texture_file::Picture picture =
      texture_file::read_picture(bytes, {.pixels = model::kMaxPixels - pixels_});
  const auto& cutoff = sampling.alpha_cutoff;
  for (std::size_t i = 3; cutoff && i < picture.rgba.size(); i += 4)
    picture.rgba[i] = static_cast<float>(picture.rgba[i]) >= 255 * *cutoff ? 255 : 0;
  pixels_ += picture.rgba.size() / 4;
  if (model_.pictures.size() >= model::kMaxPictures)
    throw Error("has more than " + std::to_string(model::kMaxPictures) + " textures");
  model_.pictures.push_back({std::move(picture), sampling.repeat_u, sampling.repeat_v});
  return static_cast<int>(model_.pictures.size()) - 1;
}

int Assembly::read_texture(const fs::path& path, const ac3d::Sampling& sampling) {
  const std::pair key(path.string(), sampling);
  const auto known = picture_of_file_.find(key);
  if (known != picture_of_file_.end()) return known->second;
  return picture_of_file_[key] = add_picture(files_.read(path, model::kMaxModelBytes), sampling);
}

void Assembly::warn(const std::string& text) {
  if (model_.warnings.size() < model::kMaxWarnings) model_.warnings.push_back(text);
}

// The models of FlightGear's catalogue (AC3D) are complete. Those of other formats often lack a
// texture, and then show the material's plain colour.
void Assembly::warn_of_texture(const std::string& name) {
  const std::string text = "the texture " + name.substr(0, 200) +
                           " is not there; the material's plain colour stands for it";
  if (std::find(model_.warnings.begin(), model_.warnings.end(), text) == model_.warnings.end())
    warn(text);
}

int Assembly::texture_of(const ac3d::Batch& batch,
                         const PartChoice& choice,
                         const ModelFile& file) {
  const bool replaced = !choice.texture.empty();
  if (!replaced && batch.picture >= 0) return batch.picture;
  if (!replaced && batch.texture.empty()) return -1;
  const Where where{files_.shown(file.path).string(), replaced ? 0 : batch.texture_line};
  const fs::path path =
      replaced ? fs::path(choice.texture) : find_texture(files_, batch.texture, file.folders);
  if (path.empty() && ending_of(file.path) != ".ac") {
    warn_of_texture(batch.texture);
    return -1;
  }
  if (path.empty()) {
    std::vector<std::string> searched;
    for (const fs::path& folder : file.folders)
      searched.push_back(files_.shown(folder.empty() ? "." : folder).string());
    throw Error(fmt::format("wants the texture {}, which is in none of: {}",
                            batch.texture,
                            fmt::join(searched, ", ")),
                where);
  }
  try {
    ac3d::Sampling sampling = batch.sampling;
    if (replaced) sampling.repeat_u = sampling.repeat_v = true;
    return read_texture(path, sampling);
  } catch (const Error& error) {
    throw Error("wants the texture " + files_.shown(path).string() + ", which " + error.message(),
                where);
  }
}

std::uint32_t Assembly::material_of(const ac3d::Batch& batch,
                                    const PartChoice& choice,
                                    int texture) {
  model::Material material = batch.srgb;
  for (std::array<float, 3>* colour : {&material.diffuse, &material.emission, &material.specular})
    for (float& channel : *colour) channel = image::linear_from_srgb(channel);
  material.shininess = std::clamp(material.shininess, 0.0f, 128.0f);
  material.opacity = choice.opacity * std::clamp(material.opacity, 0.0f, 1.0f);
  material.texture = texture;
  if (const bool turns = choice.part > 0; turns || choice.is_propeller_disc) {
    const float cover =
        texture < 0 ? 1
                    : cover_of(batch, model_.pictures[static_cast<std::size_t>(texture)].picture);
    if (choice.is_propeller_disc || cover < kMaxDiscCover) make_propeller_disc(material, cover);
  }
  auto& materials = model_.mesh.materials;
  const auto same = std::find(materials.begin(), materials.end(), material);
  const auto index = static_cast<std::uint32_t>(same - materials.begin());
  if (same != materials.end()) return index;
  if (materials.size() >= model::kMaxMaterials)
    throw Error("has more than " + std::to_string(model::kMaxMaterials) + " materials");
  materials.push_back(material);
  return index;
}

void Assembly::add_vertices(const ac3d::Batch& batch, const Eigen::Affine3d& body_from_file) {
  model::Mesh& mesh = model_.mesh;
  const Eigen::Matrix3d normal_map = body_from_file.linear().inverse().transpose();
  for (std::size_t i = 0; i < batch.positions.size(); ++i) {
    const Vector3 position = body_from_file * batch.positions[i].cast<double>();
    if (!(position.cwiseAbs().maxCoeff() <= model::kLargestCoordinate))
      throw Error("has a vertex farther than 1,000 km from the model's origin, once it is placed");
    mesh.positions.push_back(position.cast<float>());
    Vector3 normal = normal_map * batch.normals[i].cast<double>();
    if (!(normal.norm() > 1e-12) || !std::isfinite(normal.norm())) normal = Vector3::UnitZ();
    mesh.normals.push_back(normal.normalized().cast<float>());
    mesh.uvs.push_back(batch.uvs[i]);
  }
}

void Assembly::add(const ac3d::Batch& batch, const PartChoice& choice, const ModelFile& file) {
  if (batch.triangles.empty()) return;
  model::Mesh& mesh = model_.mesh;
  triangles_ += batch.triangles.size();
  if (triangles_ > model::kMaxTriangles ||
      mesh.positions.size() + batch.positions.size() > model::kMaxCorners)
    throw Error("makes an aircraft of more than " + std::to_string(model::kMaxTriangles) +
                    " triangles or " + std::to_string(model::kMaxCorners) + " vertices",
                {files_.shown(file.path).string()});
  const std::uint32_t material = material_of(batch, choice, texture_of(batch, choice, file));
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  try {
    add_vertices(batch, choice.body_from_file);
  } catch (const Error& error) {
    throw Error(error.message(), {files_.shown(file.path).string()});
  }
  model::Part& part = mesh.parts[static_cast<std::size_t>(choice.part)];
  for (const auto& [a, b, c] : batch.triangles)
    part.triangles.push_back({{base + a, base + b, base + c}, material});
}

void append_ac(Assembly& assembly, const ModelFile& file) {
  ModelFiles& files = assembly.files();
  const ac3d::AcFile ac =
      ac3d::parse_ac(files.read(file.path, model::kMaxModelBytes), files.shown(file.path));
  for (std::size_t i = 0; i < ac.objects.size(); ++i) {
    if (ac.objects[i].surfaces.empty()) continue;
    const PartChoice choice = file.choose(ac3d::names_of(ac, i));
    if (choice.hidden) continue;
    for (const ac3d::Batch& batch : ac3d::batches_of(ac, ac.objects[i]))
      assembly.add(batch, choice, file);
  }
}

}  // namespace airtruth::wrapper
