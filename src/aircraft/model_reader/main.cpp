// SPDX-License-Identifier: Apache-2.0
// airtruth-model-reader reads one 3D model for the program that started it and returns plain
// arrays. Its standard input is a socket, through which it requests files by name and receives
// them.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <assimp/BaseImporter.h>
#include <assimp/GltfMaterial.h>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <unistd.h>

#include "aircraft/confined/protocol.h"
#include "aircraft/wrapper/assembly.h"
#include "aircraft/wrapper/reader.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "foundation/image/colour.h"
#include "foundation/sandbox/child.h"
#include "foundation/sandbox/confine.h"

namespace airtruth::model_reader {
namespace {

constexpr float kSmoothBelowDeg = 60;  // the crease angle where a file states no normals; chosen
constexpr float kDefaultAlphaCutoff = 0.5f;  // of glTF 2.0, section 5.19 (alphaCutoff)
constexpr int kMaxNodeDepth = 256;           // bounds the recursion over a hostile file
constexpr std::array<float, 3> kBlack = {0, 0, 0};
constexpr std::array<float, 3> kWhite = {1, 1, 1};
// Of STL and PLY that state no colour, in sRGB: that of an OBJ without materials.
constexpr std::array<float, 3> kGrey = {0.6f, 0.6f, 0.6f};
constexpr std::size_t kNamedFiles = 5;  // missing files that a message names

// The bytes of a file as assimp reads them, also where it asks for values of no size.
class MemoryStream : public Assimp::MemoryIOStream {
 public:
  using Assimp::MemoryIOStream::MemoryIOStream;
  std::size_t Read(void* target, std::size_t size, std::size_t count) override {
    return size == 0 ? 0 : MemoryIOStream::Read(target, size, count);
  }
  static MemoryStream* of(std::string_view bytes) {
    auto* own = new std::uint8_t[bytes.size()];
    std::copy(bytes.begin(), bytes.end(), own);
    return new MemoryStream(own, bytes.size(), true);
  }
};

// Normalises a path as models spell it: "..\x.mtl", "./x.mtl".
fs::path plain_path(const char* path) {
  std::string text = path;
  std::replace(text.begin(), text.end(), '\\', '/');
  return fs::path(text).lexically_normal();
}

// The text of an OBJ file as assimp (5.2.5) reads it rightly: without a byte order mark and blanks
// at the beginning of a line, and with a 0 before each number of a vertex that begins with its dot.
// assimp drops such lines, so that all faces behind them name other vertices.
std::string plain_obj(std::string_view obj) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  std::string text;
  text.reserve(obj.size());
  char first = '\n';  // of the line; a line break before there is one
  for (const char c : without_mark(obj)) {
    if (first == '\n' && is_blank(c)) continue;
    if (c == '.' && first == 'v' && is_blank(text.back())) text += '0';
    const bool goes_on = text.ends_with('\\') || text.ends_with("\\\r");
    if (c == '\n' ? !goes_on : first == '\n') first = c;
    text += c;
  }
  return text;
}

struct Mtl {
  std::string text;
  bool moves_pictures = false;  // or scales or warps those of a material
};

// An .mtl file, in which a material with a picture and without a colour is white beneath it: assimp
// takes such a one for grey.
Mtl read_mtl(std::string mtl) {
  std::replace(mtl.begin(), mtl.end(), '\t', ' ');
  std::istringstream lines(std::move(mtl));
  Mtl result;
  bool has_colour = false, has_picture = false;
  const auto end_material = [&] {
    if (has_picture && !has_colour) result.text += "Kd 1 1 1\n";
    has_colour = has_picture = false;
  };
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> words = words_in(line);
    const std::string key = words.empty() ? "" : lower_case(words[0]);
    if (key == "newmtl") end_material();
    has_colour = has_colour || key == "kd";
    if (key == "map_kd") {
      has_picture = true;
      result.moves_pictures =
          result.moves_pictures || std::ranges::any_of(words, [](const auto& word) {
            return word == "-s" || word == "-o" || word == "-t";
          });
    }
    result.text += line + "\n";
    // One number is that of red, green and blue.
    if (key == "kd" && words.size() == 2)
      result.text += "Kd " + words[1] + " " + words[1] + " " + words[1] + "\n";
  }
  end_material();
  return result;
}

// The file system that assimp sees: the model's files, complete and read-only. The class records
// the requested files that do not exist.
class AssimpFiles : public Assimp::IOSystem {
 public:
  explicit AssimpFiles(wrapper::ModelFiles& files) : files_(files) {}
  bool Exists(const char* path) const override { return is_file(named(path)); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (std::strpbrk(mode, "wa+") != nullptr) return nullptr;
    const fs::path file = named(path);
    if (!is_file(file)) {
      missing_.insert(file.string());
      return nullptr;
    }
    std::string bytes = files_.read(file, model::kMaxModelBytes);
    if (wrapper::ending_of(file) == ".obj") bytes = plain_obj(bytes);
    if (wrapper::ending_of(file) == ".mtl") {
      Mtl mtl = read_mtl(std::move(bytes));
      moves_pictures_ = moves_pictures_ || mtl.moves_pictures;
      bytes = std::move(mtl.text);
    }
    return MemoryStream::of(bytes);
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }
  const std::set<std::string>& missing() const { return missing_; }
  bool moves_pictures_of_obj() const { return moves_pictures_; }

 private:
  bool is_file(const fs::path& file) const {
    return files_.kind(file) == wrapper::ModelFiles::Kind::kFile;
  }
  // A file, also where a URI spells its name with %XX.
  fs::path named(const char* path) const {
    const fs::path file = plain_path(path);
    const auto decoded = percent_decoded(file.native());
    if (!decoded || *decoded == file.native() || is_file(file) || !is_file(*decoded)) return file;
    return *decoded;
  }

  wrapper::ModelFiles& files_;
  std::set<std::string> missing_;
  bool moves_pictures_ = false;
};

// The colour with components in 0..1; a component that is not finite becomes 0.
std::array<float, 3> colour_of(const aiColor3D& c, bool is_linear) {
  std::array<float, 3> result{c.r, c.g, c.b};
  for (float& channel : result) {
    channel = channel >= 0 ? std::min(channel, 1.0f) : 0.0f;
    if (is_linear) channel = image::srgb_from_linear(channel);
  }
  return result;
}

// What is done to the coordinates of a texture beyond moving them (KHR_texture_transform).
bool turns_or_scales(const aiMaterial& material) {
  aiUVTransform change;
  for (const aiTextureType kind : {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR})
    if (material.Get(AI_MATKEY_UVTRANSFORM(kind, 0), change) == aiReturn_SUCCESS &&
        (change.mRotation != 0 || change.mScaling.x != 1 || change.mScaling.y != 1))
      return true;
  return false;
}

// A picture of where the material is there, which is not read. Where it is that of the colour, its
// alpha is.
bool has_picture_of_opacity(const aiMaterial& material) {
  aiString opacity, colour;
  return material.GetTexture(aiTextureType_OPACITY, 0, &opacity) == aiReturn_SUCCESS &&
         (material.GetTexture(aiTextureType_DIFFUSE, 0, &colour) != aiReturn_SUCCESS ||
          !(opacity == colour));
}

class SceneReader {
 public:
  SceneReader(const aiScene& scene, wrapper::Assembly& assembly, const wrapper::ModelFile& file)
      : scene_(scene), assembly_(assembly), file_(file), ending_(wrapper::ending_of(file.path)) {}

  void read() {
    // assimp turns 3D Studio's axes here; model_forward and model_up speak of the file's own.
    const aiMatrix4x4 root = ending_ == ".3ds" ? aiMatrix4x4() : scene_.mRootNode->mTransformation;
    read_node(*scene_.mRootNode, root, 0);
    if (has_vertex_colours_)
      assembly_.warn("the colours of its vertices are not read; materials and textures show");
    if (is_inverted_)
      assembly_.warn("a material that states that nothing of it is seen is shown opaque");
    if (is_mirrored_)
      assembly_.warn("a texture is to be mirrored beyond its edges; it is repeated there");
    if (has_bones_) assembly_.warn("bones are not read; the mesh stands as its node puts it");
  }

 private:
  void read_node(const aiNode& node, const aiMatrix4x4& file_from_node, int depth) {
    if (depth > kMaxNodeDepth) throw Error("nests objects too deep");
    const bool named = node.mName.length > 0;
    if (named) names_.emplace_back(node.mName.C_Str());
    const wrapper::PartChoice choice =
        node.mNumMeshes > 0 ? file_.choose(names_) : wrapper::PartChoice{};
    for (unsigned i = 0; i < node.mNumMeshes && !choice.hidden; ++i)
      assembly_.add(batch_of(*scene_.mMeshes[node.mMeshes[i]], file_from_node), choice, file_);
    for (unsigned i = 0; i < node.mNumChildren; ++i)
      read_node(*node.mChildren[i], file_from_node * node.mChildren[i]->mTransformation, depth + 1);
    if (named) names_.pop_back();
  }

  ac3d::Batch batch_of(const aiMesh& mesh, const aiMatrix4x4& file_from_node) {
    ac3d::Batch batch;
    unsigned uv_channel = 0;
    read_material(*scene_.mMaterials[mesh.mMaterialIndex], batch, uv_channel);
    if (uv_channel >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !mesh.HasTextureCoords(uv_channel))
      uv_channel = 0;
    aiMatrix3x3 normals_from_node(file_from_node);
    normals_from_node.Inverse().Transpose();
    if (mesh.HasVertexColors(0)) has_vertex_colours_ = true;
    if (mesh.HasBones()) has_bones_ = true;
    const auto add_vertex = [&](unsigned i, const aiVector3D& normal) {
      const aiVector3D p = file_from_node * mesh.mVertices[i];
      batch.positions.emplace_back(p.x, p.y, p.z);
      const aiVector3D n = normals_from_node * normal;
      batch.normals.emplace_back(n.x, n.y, n.z);
      const aiVector3D uv = mesh.HasTextureCoords(uv_channel) ? mesh.mTextureCoords[uv_channel][i]
                                                              : aiVector3D(0, 0, 0);
      batch.uvs.emplace_back(uv.x, uv.y);
    };
    for (unsigned i = 0; i < mesh.mNumVertices && mesh.HasNormals(); ++i)
      add_vertex(i, mesh.mNormals[i]);
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      std::array<std::uint32_t, 3> triangle = {
          face.mIndices[0], face.mIndices[1], face.mIndices[2]};
      for (const std::uint32_t vertex : triangle)
        if (vertex >= mesh.mNumVertices) throw Error("has a triangle without its vertex");
      const aiVector3D normal = normal_of(mesh, triangle);
      for (std::uint32_t& vertex : triangle) {
        // Many files state the normal 0 0 0 where they mean that of the triangle.
        if (mesh.HasNormals() && mesh.mNormals[vertex].SquareLength() > 0) continue;
        add_vertex(vertex, normal);
        vertex = static_cast<std::uint32_t>(batch.positions.size() - 1);
      }
      batch.triangles.push_back(triangle);
    }
    return batch;
  }

  // The normal of a flat triangle, of no certain length.
  static aiVector3D normal_of(const aiMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
    const aiVector3D& a = mesh.mVertices[triangle[0]];
    return (mesh.mVertices[triangle[1]] - a) ^ (mesh.mVertices[triangle[2]] - a);
  }

  void read_material(const aiMaterial& material, ac3d::Batch& batch, unsigned& uv_channel) {
    const bool is_linear = ending_ == ".gltf" || ending_ == ".glb";
    aiColor3D colour;
    if (material.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == aiReturn_SUCCESS)
      batch.srgb.diffuse = colour_of(colour, is_linear);
    if (material.Get(AI_MATKEY_COLOR_EMISSIVE, colour) == aiReturn_SUCCESS)
      batch.srgb.emission = colour_of(colour, is_linear);
    // A material that shines by itself alone is seen as paint of that colour.
    if (batch.srgb.diffuse == kBlack) std::swap(batch.srgb.diffuse, batch.srgb.emission);
    if (material.Get(AI_MATKEY_COLOR_SPECULAR, colour) == aiReturn_SUCCESS)
      batch.srgb.specular = colour_of(colour, is_linear);
    aiString name;
    if (material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS)
      batch.srgb.finish = model::finish_named(name.C_Str());
    float value = 0;
    if (material.Get(AI_MATKEY_OPACITY, value) == aiReturn_SUCCESS && value >= 0)
      batch.srgb.opacity = std::min(value, 1.0f);
    // Exporters of COLLADA state for opaque materials that they are wholly transparent.
    if (ending_ == ".dae" && batch.srgb.opacity == 0) {
      batch.srgb.opacity = 1;
      is_inverted_ = true;
    }
    if (material.Get(AI_MATKEY_SHININESS, value) == aiReturn_SUCCESS && value >= 0)
      batch.srgb.shininess =
          std::min(ending_ == ".obj" ? value / 4 : value, 128.0f);  // it takes 4 Ns
    read_alpha_mode(material, batch);
    read_texture(material, batch, uv_channel);
    // assimp has white where these state no colour; beneath a texture that is right.
    if ((ending_ == ".stl" || ending_ == ".ply") && batch.texture.empty() &&
        batch.srgb.diffuse == kWhite)
      batch.srgb.diffuse = kGrey;
  }

  // Opaque materials of glTF have no alpha, and of masks a place is there or not (glTF 2.0, section
  // 3.9.4): the alpha of the texture times that of the material decides.
  static void read_alpha_mode(const aiMaterial& material, ac3d::Batch& batch) {
    aiString mode;
    if (material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) != aiReturn_SUCCESS) return;
    const bool is_mask = mode == aiString("MASK");
    if (!is_mask && mode != aiString("OPAQUE")) return;
    float cutoff = 0;
    if (is_mask && material.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff) != aiReturn_SUCCESS)
      cutoff = kDefaultAlphaCutoff;
    const float alpha = batch.srgb.opacity;
    batch.srgb.opacity = alpha >= cutoff ? 1.0f : 0.0f;
    batch.sampling.alpha_cutoff = alpha > 0 ? cutoff / alpha : 0;
  }

  void read_texture(const aiMaterial& material, ac3d::Batch& batch, unsigned& uv_channel) {
    aiString path;
    aiTextureMapMode modes[3] = {
        aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    for (const aiTextureType kind : {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR}) {
      if (material.GetTexture(kind, 0, &path, nullptr, &uv_channel, nullptr, nullptr, modes) !=
          aiReturn_SUCCESS)
        continue;
      is_mirrored_ = is_mirrored_ || modes[0] == aiTextureMapMode_Mirror ||
                     modes[1] == aiTextureMapMode_Mirror;
      batch.sampling.repeat_u =
          modes[0] == aiTextureMapMode_Wrap || modes[0] == aiTextureMapMode_Mirror;
      batch.sampling.repeat_v =
          modes[1] == aiTextureMapMode_Wrap || modes[1] == aiTextureMapMode_Mirror;
      if (const aiTexture* inside = scene_.GetEmbeddedTexture(path.C_Str())) {
        batch.picture = picture_of(*inside, batch.sampling);
      } else {
        batch.texture = std::string(trimmed(path.C_Str()));
      }
      return;
    }
  }

  int picture_of(const aiTexture& texture, const ac3d::Sampling& sampling) {
    const std::pair key(&texture, sampling);
    const auto known = picture_of_texture_.find(key);
    if (known != picture_of_texture_.end()) return known->second;
    const std::string_view bytes(reinterpret_cast<const char*>(texture.pcData), texture.mWidth);
    if (texture.mHeight != 0)
      throw Error("has a texture inside that is no file; expected PNG, JPEG, WebP or BMP");
    return picture_of_texture_[key] = assembly_.add_picture(bytes, sampling);
  }

  const aiScene& scene_;
  wrapper::Assembly& assembly_;
  const wrapper::ModelFile& file_;
  std::string ending_;
  std::vector<std::string> names_;
  std::map<std::pair<const aiTexture*, ac3d::Sampling>, int> picture_of_texture_;
  bool has_vertex_colours_ = false;
  bool is_inverted_ = false;
  bool is_mirrored_ = false;
  bool has_bones_ = false;
};

// Removes all importers except those of the ending, so that the content of a file cannot choose
// another. An ending may have several: those of glTF 1 and of glTF 2 share two.
void keep_importers_of(Assimp::Importer& importer, const std::string& ending) {
  const std::string wanted = ending.substr(ending.find_first_not_of('.'));
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    std::set<std::string> endings;
    importer.GetImporter(i)->GetExtensionList(endings);
    if (!endings.contains(wanted)) importer.UnregisterLoader(importer.GetImporter(i));
  }
}

void warn_of_missing(wrapper::Assembly& assembly, const AssimpFiles& files) {
  if (files.missing().empty()) return;
  std::string names;
  std::size_t shown = 0;
  for (const std::string& name : files.missing())
    if (++shown <= kNamedFiles) names += (shown == 1 ? "" : ", ") + name;
  assembly.warn("files that are not in its folder and are left out: " + names +
                (shown > kNamedFiles ? ", ..." : ""));
}

// Extensions of glTF by which a file states pictures or vertices otherwise, and which assimp passes
// over in silence.
constexpr std::array<const char*, 6> kUnreadExtensions = {"EXT_texture_webp",
                                                          "EXT_mesh_gpu_instancing",
                                                          "KHR_texture_basisu",
                                                          "MSFT_texture_dds",
                                                          "EXT_meshopt_compression",
                                                          "KHR_mesh_quantization"};

void warn_of_extensions(wrapper::Assembly& assembly, const fs::path& file) {
  const std::string text = assembly.files().read(file, model::kMaxModelBytes);
  for (const char* extension : kUnreadExtensions)
    if (text.find('"' + std::string(extension) + '"') != std::string::npos)
      assembly.warn(std::string("the extension ") + extension +
                    " of glTF is not read; what it states is missing");
}

std::string one_sentence(const char* message) {
  std::string text = message;
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? "it holds no model" : text;
}

// Gives each face of a mesh vertices of its own, as assimp's steps have it; its reader of PLY does
// not.
void unshare(aiMesh& mesh) {
  std::vector<unsigned> shared;  // of each new vertex
  std::for_each_n(mesh.mFaces, mesh.mNumFaces, [&](aiFace& face) {
    std::for_each_n(face.mIndices, face.mNumIndices, [&](unsigned& index) {
      shared.push_back(index);
      index = static_cast<unsigned>(shared.size() - 1);
    });
  });
  const auto spread = [&]<typename Value>(Value*& values) {
    if (values == nullptr) return;
    auto* own = new Value[shared.size()];  // the mesh deletes it
    std::ranges::transform(shared, own, [&](unsigned index) { return values[index]; });
    delete[] std::exchange(values, own);
  };
  spread(mesh.mVertices);
  spread(mesh.mNormals);
  std::ranges::for_each(mesh.mColors, spread);
  std::ranges::for_each(mesh.mTextureCoords, spread);
  mesh.mNumVertices = static_cast<unsigned>(shared.size());
}

// Appends the triangles of a model file in another format than .ac by the Open Asset Import Library
// (assimp): .obj .3ds .stl .ply .dae .gltf .glb .fbx. Only the importer for the ending of the file
// runs. Files that the model names come from assembly.files(). Coordinates are those of the file;
// PartChoice::body_from_file converts them. Throws Error where the file is unreadable, has no
// triangles or exceeds a limit.
void append_other_format(wrapper::Assembly& assembly, const wrapper::ModelFile& file) {
  const std::string shown = assembly.files().shown(file.path).string();
  if (assembly.files().kind(file.path) != wrapper::ModelFiles::Kind::kFile)
    throw Error("does not exist; expected a 3D model", {shown});
  const std::string ending = wrapper::ending_of(file.path);
  auto* files = new AssimpFiles(assembly.files());
  Assimp::Importer importer;
  importer.SetIOHandler(files);  // the importer deletes it
  keep_importers_of(importer, ending);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kSmoothBelowDeg);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  // Without normals a glTF is flat (glTF 2.0, section 3.7.2.1): its triangles keep their own.
  const bool is_gltf = ending == ".gltf" || ending == ".glb";
  unsigned steps = aiProcess_ValidateDataStructure | aiProcess_Triangulate |
                   aiProcess_JoinIdenticalVertices | aiProcess_SortByPType;
  if (!is_gltf) steps |= aiProcess_GenSmoothNormals;
  // A 3DS states no normals; assimp's are smooth over every edge where it states no groups.
  if (ending == ".3ds") steps |= aiProcess_RemoveComponent;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS);
  if (is_gltf) warn_of_extensions(assembly, file.path);
  const bool is_ply = ending == ".ply";
  const aiScene* scene = importer.ReadFile(
      file.path.string(), is_ply ? unsigned{aiProcess_ValidateDataStructure} : steps);
  if (scene != nullptr && is_ply) {
    std::for_each_n(scene->mMeshes, scene->mNumMeshes, [](aiMesh* mesh) { unshare(*mesh); });
    scene = importer.ApplyPostProcessing(steps);
  }
  if (scene == nullptr || scene->mRootNode == nullptr)
    throw Error("cannot be read as a 3D model: " + one_sentence(importer.GetErrorString()),
                {shown});
  // assimp moves the coordinates of textures rightly; it turns and scales them otherwise than glTF.
  for (unsigned i = 0; i < scene->mNumMaterials; ++i)
    if (turns_or_scales(*scene->mMaterials[i])) {
      assembly.warn("a texture is turned or scaled on its surface, which may not show rightly");
      break;
    }
  scene = importer.ApplyPostProcessing(aiProcess_TransformUVCoords);
  if (scene == nullptr) throw Error("cannot be read as a 3D model", {shown});
  try {
    SceneReader(*scene, assembly, file).read();
  } catch (const Error& error) {
    if (!error.where().file.empty()) throw;
    throw Error(error.message(), {shown});
  }
  if (std::any_of(scene->mMaterials,
                  scene->mMaterials + scene->mNumMaterials,
                  [](const aiMaterial* material) { return has_picture_of_opacity(*material); }))
    assembly.warn("a picture of opacity (map_d of OBJ) is not read; what it cuts out is opaque");
  if (files->moves_pictures_of_obj())
    assembly.warn(
        "the options -s, -o and -t of map_Kd are not read; its picture may not show rightly");
  warn_of_missing(assembly, *files);
}

// The largest message from the parent: the limit of all files of a model together.
constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 30;

// The parent's files, requested by name.
class AskedFiles : public wrapper::ModelFiles {
 public:
  AskedFiles(sandbox::Channel& parent, const confined::ReaderJob& job)
      : ModelFiles(job.shown_folder, job.in_data_root), parent_(parent) {}

 protected:
  Kind kind_below(const fs::path& path) override {
    parent_.send(confined::Message::kAskKind, path.string());
    const std::string answer = answered(confined::Message::kKind);
    return answer.size() == 1 ? static_cast<Kind>(answer[0]) : Kind::kNone;
  }
  std::string read_below(const fs::path& path, std::size_t max_bytes) override {
    sandbox::WireWriter question;
    question.put(static_cast<std::uint64_t>(max_bytes));
    question.put_text(path.string());
    parent_.send(confined::Message::kAskFile, question.take());
    return answered(confined::Message::kFile);
  }

 private:
  std::string answered(confined::Message wanted) {
    sandbox::Channel::Received received = parent_.receive(kMaxMessageBytes);
    if (received.closed) ::_exit(0);
    if (received.is(confined::Message::kError)) throw sandbox::error_from_bytes(received.bytes);
    if (!received.is(wanted)) throw Error("gets an answer that it did not ask for");
    return std::move(received.bytes);
  }

  sandbox::Channel& parent_;
};

void read_for(sandbox::Channel& parent) {
  sandbox::confine({});
  const sandbox::Channel::Received received = parent.receive(kMaxMessageBytes);
  if (received.closed || !received.is(confined::Message::kJob)) return;
  const confined::ReaderJob job = confined::job_from_bytes(received.bytes);
  AskedFiles files(parent, job);
  parent.send(
      confined::Message::kModel,
      confined::bytes_of(wrapper::read_model(files, job.file, job.options, append_other_format)));
}

}  // namespace
}  // namespace airtruth::model_reader

int main(int argc, char** argv) {
  using namespace airtruth;  // the program's own top level
  constexpr sandbox::Faults kFaults{static_cast<std::uint8_t>(confined::Message::kError),
                                    "needs more memory than a model may take",
                                    "cannot be read as a 3D model: "};
  return sandbox::child_main(argc, argv, 0, [&](sandbox::Channel& parent, std::span<char*>) {
    sandbox::told(parent, kFaults, [&] { model_reader::read_for(parent); });
  });
}
