// SPDX-License-Identifier: Apache-2.0
#include "aircraft/osg_adapter.h"

#include <algorithm>
#include <mutex>
#include <sstream>

#include <osg/Geode>
#include <osg/Geometry>
#include <osg/Material>
#include <osg/NodeVisitor>
#include <osg/Notify>
#include <osg/Texture2D>
#include <osg/TriangleIndexFunctor>
#include <osgDB/ReadFile>
#include <osgDB/Registry>
#include <osgUtil/SmoothingVisitor>

#include "aircraft/ac_text.h"
#include "aircraft/osg_image.h"
#include "aircraft/texture.h"
#include "base/error.h"

namespace airtruth::aircraft {
namespace {

namespace fs = std::filesystem;

std::mutex& registry_mutex() {  // osgDB's registry is one for the whole process
  static std::mutex mutex;
  return mutex;
}

float linear(float srgb) { return linear_channel(srgb); }

class Collector : public osg::NodeVisitor {
 public:
  Collector(Assembly& assembly, fs::path file, ImageFinder& images, const ChoosePart& choose)
      : osg::NodeVisitor(TRAVERSE_ACTIVE_CHILDREN),
        assembly_(assembly),
        mesh_(assembly.mesh),
        file_(std::move(file)),
        images_(images),
        choose_(choose) {}

  void apply(osg::Node& node) override { enter(node, osg::Matrix::identity()); }
  void apply(osg::Transform& node) override {
    osg::Matrix matrix;
    node.computeLocalToWorldMatrix(matrix, this);
    enter(node, matrix);
  }
  void apply(osg::Geode& node) override {
    const State before = state_;
    push(node, osg::Matrix::identity());
    const PartChoice choice = choose_(state_.names);
    if (!choice.hidden) {
      for (unsigned i = 0; i < node.getNumDrawables(); ++i)
        if (osg::Geometry* geometry = node.getDrawable(i)->asGeometry()) add(*geometry, choice);
    }
    state_ = before;
  }

 private:
  struct State {
    std::vector<std::string> names;
    osg::Matrix file_from_local;
    osg::ref_ptr<osg::Material> material;
    osg::ref_ptr<osg::Texture2D> texture;
  };

  void read_state(State& state, osg::StateSet* set) {
    if (set == nullptr) return;
    if (auto* material =
            dynamic_cast<osg::Material*>(set->getAttribute(osg::StateAttribute::MATERIAL)))
      state.material = material;
    if (auto* texture = dynamic_cast<osg::Texture2D*>(
            set->getTextureAttribute(0, osg::StateAttribute::TEXTURE)))
      state.texture = texture;
  }

  void push(osg::Node& node, const osg::Matrix& parent_from_node) {
    if (!node.getName().empty()) state_.names.push_back(node.getName());
    state_.file_from_local = parent_from_node * state_.file_from_local;
    read_state(state_, node.getStateSet());
  }

  void enter(osg::Node& node, const osg::Matrix& parent_from_node) {
    const State before = state_;
    push(node, parent_from_node);
    traverse(node);
    state_ = before;
  }

  int texture_of(osg::Texture2D* texture, const PartChoice& choice) {
    if (!choice.texture.empty())
      return texture_index(assembly_, *images_.read(choice.texture.string()), true, true, file_);
    if (texture == nullptr || texture->getImage() == nullptr) return -1;
    images_.check_found(*texture->getImage());
    const auto repeats = [&](osg::Texture::WrapParameter p) {
      return texture->getWrap(p) == osg::Texture::REPEAT;
    };
    return texture_index(assembly_,
                         *texture->getImage(),
                         repeats(osg::Texture::WRAP_S),
                         repeats(osg::Texture::WRAP_T),
                         file_);
  }

  std::uint32_t material_index(const State& state,
                               const osg::Vec4& colour,
                               const PartChoice& choice) {
    Material material;
    osg::Vec4 diffuse = colour;
    if (state.material) {
      const auto face = osg::Material::FRONT;
      diffuse = state.material->getDiffuse(face);
      const osg::Vec4 specular = state.material->getSpecular(face);
      const osg::Vec4 emission = state.material->getEmission(face);
      material.specular = {linear(specular.r()), linear(specular.g()), linear(specular.b())};
      material.emission = {linear(emission.r()), linear(emission.g()), linear(emission.b())};
      material.shininess = state.material->getShininess(face);
    }
    material.diffuse = {linear(diffuse.r()), linear(diffuse.g()), linear(diffuse.b())};
    material.opacity = choice.opacity * std::clamp(diffuse.a(), 0.0f, 1.0f);
    material.texture = texture_of(state.texture.get(), choice);
    for (std::size_t i = 0; i < mesh_.materials.size(); ++i)
      if (same(mesh_.materials[i], material)) return static_cast<std::uint32_t>(i);
    mesh_.materials.push_back(material);
    return static_cast<std::uint32_t>(mesh_.materials.size() - 1);
  }

  static bool same(const Material& a, const Material& b) {
    return a.diffuse == b.diffuse && a.emission == b.emission && a.specular == b.specular &&
           a.shininess == b.shininess && a.opacity == b.opacity && a.texture == b.texture;
  }

  struct Triangles {
    std::vector<std::array<unsigned, 3>>* list = nullptr;
    void operator()(unsigned a, unsigned b, unsigned c) const { list->push_back({a, b, c}); }
  };

  void add(osg::Geometry& geometry, const PartChoice& choice) {
    const auto* vertices = dynamic_cast<const osg::Vec3Array*>(geometry.getVertexArray());
    if (vertices == nullptr || vertices->empty()) return;
    std::vector<std::array<unsigned, 3>> triangles;
    osg::TriangleIndexFunctor<Triangles> functor;  // points and lines fall out here
    functor.list = &triangles;
    geometry.accept(functor);
    if (triangles.empty()) return;
    const auto per_vertex = [&](const osg::Array* array) {
      return array != nullptr && array->getBinding() == osg::Array::BIND_PER_VERTEX &&
             array->getNumElements() >= vertices->size();
    };
    if (!per_vertex(geometry.getNormalArray()) || geometry.getNormalArray()->getDataSize() != 3)
      osgUtil::SmoothingVisitor::smooth(geometry, osg::DegreesToRadians(60.0));
    vertices = dynamic_cast<const osg::Vec3Array*>(geometry.getVertexArray());
    triangles.clear();
    geometry.accept(functor);
    const auto* normals = dynamic_cast<const osg::Vec3Array*>(geometry.getNormalArray());
    const auto* uvs = dynamic_cast<const osg::Vec2Array*>(geometry.getTexCoordArray(0));
    State state = state_;
    read_state(state, geometry.getStateSet());
    osg::Vec4 colour(0.8f, 0.8f, 0.8f, 1);
    if (const auto* colours = dynamic_cast<const osg::Vec4Array*>(geometry.getColorArray());
        colours != nullptr && !colours->empty())
      colour = colours->front();
    const std::uint32_t material = material_index(state, colour, choice);
    const auto base = static_cast<std::uint32_t>(mesh_.positions.size());
    const Eigen::Matrix3d normal_map = choice.body_from_file.linear().inverse().transpose();
    for (std::size_t i = 0; i < vertices->size(); ++i) {
      const osg::Vec3d v = osg::Vec3d((*vertices)[i]) * state_.file_from_local;
      mesh_.positions.push_back(
          (choice.body_from_file * Vector3(v.x(), v.y(), v.z())).cast<float>());
      osg::Vec3d n(0, 0, 1);
      if (normals != nullptr && i < normals->size())
        n = osg::Matrix::transform3x3(osg::Vec3d((*normals)[i]), state_.file_from_local);
      Vector3 normal = normal_map * Vector3(n.x(), n.y(), n.z());
      if (!(normal.norm() > 1e-12)) normal = Vector3::UnitZ();
      mesh_.normals.push_back(normal.normalized().cast<float>());
      const bool has_uv = uvs != nullptr && i < uvs->size();
      mesh_.uvs.emplace_back(has_uv ? (*uvs)[i].x() : 0.0f, has_uv ? (*uvs)[i].y() : 0.0f);
    }
    Part& part = mesh_.parts[static_cast<std::size_t>(choice.part)];
    for (const auto& t : triangles) {
      if (t[0] >= vertices->size() || t[1] >= vertices->size() || t[2] >= vertices->size())
        continue;
      part.triangles.push_back({{base + t[0], base + t[1], base + t[2]}, material});
    }
  }

  Assembly& assembly_;
  Mesh& mesh_;
  fs::path file_;
  ImageFinder& images_;
  const ChoosePart& choose_;
  State state_;
};

osg::ref_ptr<osg::Node> read_ac(const fs::path& file,
                                const std::string& text,
                                const osgDB::Options& options) {
  osgDB::ReaderWriter* loader = osgDB::Registry::instance()->getReaderWriterForExtension("ac");
  if (loader == nullptr)
    throw Error(
        "cannot be loaded: OpenSceneGraph's ac plugin is missing "
        "(package libopenscenegraph161)",
        {file.string()});
  std::istringstream stream(text);
  return loader->readNode(stream, &options).takeNode();
}

// OpenSceneGraph speaks on the terminal and keeps one level for the process:
// silent while we read.
class Silence {
 public:
  Silence() : before_(osg::getNotifyLevel()) { osg::setNotifyLevel(osg::ALWAYS); }
  ~Silence() { osg::setNotifyLevel(before_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  osg::NotifySeverity before_;
};

}  // namespace

void append_model(Assembly& assembly,
                  const fs::path& file,
                  const std::vector<fs::path>& folders,
                  const ChoosePart& choose) {
  const std::lock_guard lock(registry_mutex());
  const Silence silence;
  if (!fs::is_regular_file(file))
    throw Error("does not exist; expected a 3D model", {file.string()});
  assembly.sources.push_back(file);
  const bool is_ac = file.extension() == ".ac";
  const PreparedAc ac = is_ac ? prepared_ac(file) : PreparedAc{};
  const osg::ref_ptr<ImageFinder> images =
      new ImageFinder(file, folders, ac.line_of_texture, assembly.sources);
  const osg::ref_ptr<osgDB::Options> options = new osgDB::Options("noRotation");  // of .obj files
  options->setReadFileCallback(images.get());
  const osg::ref_ptr<EveryFile> every_file = new EveryFile;
  options->setFindFileCallback(every_file.get());
  osg::ref_ptr<osg::Node> node;
  if (is_ac) {
    node = read_ac(file, ac.text, *options);
  } else {
    auto* const registry = osgDB::Registry::instance();
    node = registry->readNodeImplementation(file.string(), options.get()).takeNode();
  }
  if (!node) throw Error("cannot be read as a 3D model (.ac .obj .3ds .osgt)", {file.string()});
  Collector collector(assembly, file, *images, choose);
  node->accept(collector);
}

}  // namespace airtruth::aircraft
