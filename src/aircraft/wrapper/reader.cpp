// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "aircraft/wrapper/part_names.h"
#include "aircraft/wrapper/scope.h"
#include "aircraft/wrapper/wrapper.h"
#include "foundation/base/error.h"
#include "foundation/base/names.h"

namespace airtruth::wrapper {
namespace {

// Vertices within this distance are in the same place: the two sides of the catalogue's propeller
// discs are up to 0.04 mm apart, and a decal is farther from what it is on.
constexpr float kSamePlaceM = 1e-4f;

// For each vertex the first one in the same place.
std::vector<std::uint32_t> places_of(const std::vector<Eigen::Vector3f>& positions) {
  constexpr float kCellM = 1e-3f;
  const auto cell_of = [](const Eigen::Vector3f& p) {
    std::size_t hash = 0;
    for (const float x : p)
      hash = hash * 1'000'003 + std::hash<float>()(std::floor(x / kCellM) + 0.0f);
    return hash;
  };
  std::unordered_multimap<std::size_t, std::uint32_t> firsts;
  const auto place_of = [&](std::uint32_t vertex) {
    const Eigen::Vector3f& p = positions[vertex];
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3f side((corner & 1U) != 0 ? kSamePlaceM : -kSamePlaceM,
                                 (corner & 2U) != 0 ? kSamePlaceM : -kSamePlaceM,
                                 (corner & 4U) != 0 ? kSamePlaceM : -kSamePlaceM);
      const auto [begin, end] = firsts.equal_range(cell_of(p + side));
      for (auto it = begin; it != end; ++it)
        if ((positions[it->second] - p).norm() <= kSamePlaceM) return it->second;
    }
    firsts.emplace(cell_of(p), vertex);
    return vertex;
  };
  std::vector<std::uint32_t> places;
  for (std::uint32_t i = 0; i < positions.size(); ++i) places.push_back(place_of(i));
  return places;
}

void drop_doubles(model::Mesh& mesh) {
  const std::vector<std::uint32_t> places = places_of(mesh.positions);
  for (model::Part& part : mesh.parts) {
    std::set<std::array<std::uint32_t, 3>> seen;
    std::erase_if(part.triangles, [&](const model::Triangle& triangle) {
      std::array<std::uint32_t, 3> key;
      for (std::size_t i = 0; i < 3; ++i) key[i] = places[triangle.vertex[i]];
      const Eigen::Vector3f a =
          mesh.positions[triangle.vertex[1]] - mesh.positions[triangle.vertex[0]];
      const Eigen::Vector3f b =
          mesh.positions[triangle.vertex[2]] - mesh.positions[triangle.vertex[0]];
      if (!(a.cross(b).norm() > 1e-10f)) return true;
      std::sort(key.begin(), key.end());
      return !seen.insert(key).second;
    });
  }
}

void drop_unused(model::Mesh& mesh) {
  constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  std::vector<std::uint32_t> new_from_old(mesh.positions.size(), kUnused);
  model::Mesh kept;
  for (model::Part& part : mesh.parts) {
    for (model::Triangle& triangle : part.triangles) {
      for (std::uint32_t& vertex : triangle.vertex) {
        std::uint32_t& moved = new_from_old[vertex];
        if (moved == kUnused) {
          moved = static_cast<std::uint32_t>(kept.positions.size());
          kept.positions.push_back(mesh.positions[vertex]);
          kept.normals.push_back(mesh.normals[vertex]);
          kept.uvs.push_back(mesh.uvs[vertex]);
        }
        vertex = moved;
      }
    }
  }
  mesh.positions = std::move(kept.positions);
  mesh.normals = std::move(kept.normals);
  mesh.uvs = std::move(kept.uvs);
}

// Removes triangles without area, which have no normal; the second of two triangles in the same
// place with opposite sides, since a translucent surface would be drawn twice; and the vertices and
// parts that are then unused.
void tidy(model::Mesh& mesh) {
  drop_doubles(mesh);
  drop_unused(mesh);
  if (mesh.parts.size() > 1)
    mesh.parts.erase(std::remove_if(mesh.parts.begin() + 1,
                                    mesh.parts.end(),
                                    [](const model::Part& part) { return part.triangles.empty(); }),
                     mesh.parts.end());
}

const std::set<std::string> kOthers = {
    ".obj", ".3ds", ".stl", ".ply", ".dae", ".gltf", ".glb", ".fbx"};
const std::set<std::string> kScenes = {".osgt", ".osgb", ".osgx", ".osg", ".ive"};
constexpr const char* kReadable = ".ac, .obj, .3ds, .stl, .ply, .dae, .gltf, .glb or .fbx";

// FlightGear: x back, y right, z up. Body: x forward, y right, z down.
Eigen::Affine3d body_from_flightgear() {
  return Eigen::Affine3d(Eigen::Matrix3d(Vector3(-1, 1, -1).asDiagonal()));
}

// AC3D files have y up; FlightGear stands them up by a quarter turn about x.
Eigen::Affine3d flightgear_from_ac() {
  Eigen::Matrix3d m;
  m << 1, 0, 0,  //
      0, 0, -1,  //
      0, 1, 0;
  return Eigen::Affine3d(m);
}

Vector3 axis_vector(const std::string& text, const char* what) {
  const bool negative = !text.empty() && text[0] == '-';
  const std::string letter =
      !text.empty() && (text[0] == '-' || text[0] == '+') ? text.substr(1) : text;
  if (letter != "x" && letter != "y" && letter != "z")
    throw Error(std::string(what) + " is '" + text +
                "'; expected x, y or z, or one of them with a minus");
  return (negative ? -1.0 : 1.0) * Vector3::Unit(letter[0] - 'x');
}

Eigen::Affine3d body_from_axes(const model::ModelAxes& axes) {
  const Vector3 forward = axis_vector(axes.forward, "model_forward");
  const Vector3 up = axis_vector(axes.up, "model_up");
  if (std::abs(forward.dot(up)) > 0.5)
    throw Error(
        "model_forward and model_up are the same axis; expected two "
        "different ones");
  if (!std::isfinite(axes.scale) || axes.scale <= 0)
    throw Error("model_scale is not positive; expected metres per unit");
  Eigen::Matrix3d m;
  m.row(0) = forward;
  m.row(1) = forward.cross(up);  // right
  m.row(2) = -up;
  return Eigen::Affine3d(axes.scale * m);
}

// Animations without an effect here: lamps, and what is visible only in a cockpit or at night.
bool is_known(const std::string& type) {
  static const std::set<std::string> kKnown = {
      "",          "select",   "rotate", "spin",        "translate",  "scale",
      "billboard", "flash",    "blend",  "dist-scale",  "range",      "material",
      "timed",     "noshadow", "shader", "point",       "alpha-test", "trail",
      "light",     "none",     "pick",   "shadow",      "slider",     "textranslate",
      "texrotate", "touch",    "knob",   "interaction", "enable-hot", "null"};
  return kKnown.contains(type);
}

// In FlightGear's files.
PartChoice choice_by_names(const std::vector<std::string>& names) {
  PartChoice choice;
  choice.hidden = std::any_of(names.begin(), names.end(), is_effect);
  choice.is_propeller_disc = is_propeller_disc(names);
  return choice;
}

// Whether any texel is not wholly transparent.
bool has_opacity(const texture_file::Picture& picture) {
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4)
    if (picture.rgba[i] > 0) return true;
  return false;
}

// A model file by its ending; how it is read.
void append_file(Assembly& assembly, const ModelFile& file, const AppendOther& append_other) {
  const std::string ending = ending_of(file.path);
  const std::string shown = assembly.files().shown(file.path).string();
  if (kScenes.contains(ending))
    throw Error("is a scene of OpenSceneGraph, which can run code and is not read; export the " +
                    std::string("model as ") + kReadable,
                {shown});
  if (ending == ".ac") return append_ac(assembly, file);
  if (!kOthers.contains(ending) || !append_other)
    throw Error("is no 3D model that can be read; expected " + std::string(kReadable), {shown});
  append_other(assembly, file);
}

// Adds the models of a wrapper and of those that it nests.
class Loader {
 public:
  Loader(Assembly& assembly, const AppendOther& append) : assembly_(assembly), append_(append) {}

  void add(const Wrapper& wrapper, const Scope& outside, const std::vector<fs::path>& outer) {
    if (!wrapper.condition.value_or(true)) return;
    note_unknown(wrapper);
    const Scope scope = outside.inside(wrapper);
    std::vector<fs::path> folders;
    if (!wrapper.texture_folder.empty()) folders.push_back(wrapper.texture_folder);
    folders.push_back(wrapper.file.parent_path());
    if (!wrapper.model.empty()) folders.push_back(wrapper.model.parent_path());
    folders.insert(folders.end(), outer.begin(), outer.end());
    if (!wrapper.model.empty()) add_model(wrapper.model, scope, folders);
    for (const Wrapper& nested : wrapper.nested) add(nested, scope, folders);
  }

  const std::set<std::string>& unknown() const { return unknown_; }

 private:
  void add_model(const fs::path& file, const Scope& scope, const std::vector<fs::path>& folders) {
    const bool is_ac = ending_of(file) == ".ac";
    const Eigen::Affine3d model_from_file =
        is_ac ? flightgear_from_ac() : Eigen::Affine3d::Identity();
    const auto choose = [&](const std::vector<std::string>& names) {
      const Animated animated = scope.animated(names);
      PartChoice choice = choice_by_names(names);
      choice.hidden = choice.hidden || animated.hidden;
      if (choice.hidden) return choice;
      choice.body_from_file = animated.body_from_model * model_from_file;
      choice.opacity = animated.opacity;
      if (!animated.texture.empty())
        choice.texture = find_texture(assembly_.files(), animated.texture, folders).string();
      if (animated.spin) choice.part = part_of(*animated.spin);
      return choice;
    };
    append_file(assembly_, {file, folders, choose}, append_);
  }

  int part_of(const model::Part& spin) {
    auto& parts = assembly_.model().mesh.parts;
    for (std::size_t i = 1; i < parts.size(); ++i)
      if (parts[i].centre_in_body == spin.centre_in_body &&
          parts[i].axis_in_body == spin.axis_in_body &&
          parts[i].revolutions_per_s == spin.revolutions_per_s)
        return static_cast<int>(i);
    if (parts.size() >= model::kMaxParts)
      throw Error("turns more than " + std::to_string(model::kMaxParts) + " parts by themselves");
    parts.push_back(spin);
    return static_cast<int>(parts.size() - 1);
  }

  void note_unknown(const Wrapper& wrapper) {
    for (const Animation& animation : wrapper.animations) {
      if (!is_known(animation.type)) unknown_.insert(animation.type);
      if (!animation.axis_object.empty() && animation.value != 0)
        unknown_.insert(animation.type + " about the object " + animation.axis_object);
    }
  }

  Assembly& assembly_;
  const AppendOther& append_;
  std::set<std::string> unknown_;
};

void read_wrapped(const fs::path& file,
                  const model::LoadOptions& options,
                  const AppendOther& append,
                  Assembly& assembly) {
  if (options.axes)
    throw Error(
        "has its own axes and metres; model_forward, model_up and model_scale are for a model "
        "file without a wrapper",
        {assembly.files().shown(file).string()});
  std::set<std::string> missing;
  const Wrapper wrapper =
      read_wrapper(assembly.files(), file, {options.airspeed_kt, options.altitude_agl_ft}, missing);
  Loader loader(assembly, append);
  loader.add(wrapper, Scope(body_from_flightgear()), {});
  std::vector<std::string>& warnings = assembly.model().warnings;
  if (!loader.unknown().empty())
    warnings.push_back(fmt::format("animations that are not known and are left out: {}",
                                   fmt::join(loader.unknown(), ", ")));
  if (!missing.empty())
    warnings.push_back(
        fmt::format("parts that are not installed and are left out: {}", fmt::join(missing, ", ")));
}

void read_bare(const fs::path& file,
               const model::LoadOptions& options,
               const AppendOther& append,
               Assembly& assembly) {
  const Eigen::Affine3d body_from_file = body_from_axes(options.axes.value_or(model::ModelAxes{}));
  const auto choose = [&](const std::vector<std::string>& names) {
    PartChoice choice = ending_of(file) == ".ac" ? choice_by_names(names) : PartChoice{};
    choice.body_from_file = body_from_file;
    return choice;
  };
  append_file(assembly, {file, {file.parent_path()}, choose}, append);
}

}  // namespace

std::string ending_of(const fs::path& file) { return lower_case(file.extension().string()); }

bool is_model_file(const std::string& name) {
  const std::string ending = ending_of(name);
  return ending == ".ac" || ending == ".xml" || kOthers.contains(ending) ||
         kScenes.contains(ending);
}

model::RawModel read_model(ModelFiles& files,
                           const fs::path& file,
                           const model::LoadOptions& options,
                           const AppendOther& append_other) {
  Assembly assembly(files);
  if (ending_of(file) == ".xml") {
    read_wrapped(file, options, append_other, assembly);
  } else {
    read_bare(file, options, append_other, assembly);
  }
  model::RawModel model = std::move(assembly.model());
  tidy(model.mesh);
  if (model.mesh.triangle_count() == 0)
    throw Error("holds no triangles; expected a 3D model", {files.shown(file).string()});
  model::check_model(model);
  std::vector<bool> has_seen_texel;
  for (const model::RawPicture& raw : model.pictures)
    has_seen_texel.push_back(has_opacity(raw.picture));
  const auto is_seen = [&](const model::Triangle& triangle) {
    const model::Material& material = model.mesh.materials[triangle.material];
    return material.opacity > 0 &&
           (material.texture < 0 || has_seen_texel[static_cast<std::size_t>(material.texture)]);
  };
  if (std::none_of(model.mesh.parts.begin(), model.mesh.parts.end(), [&](const model::Part& part) {
        return std::any_of(part.triangles.begin(), part.triangles.end(), is_seen);
      }))
    throw Error("is wholly transparent; expected a material that is seen",
                {files.shown(file).string()});
  return model;
}

}  // namespace airtruth::wrapper
