// SPDX-License-Identifier: Apache-2.0
#include "picture/backdrop/osg_mesh.h"

#include <algorithm>
#include <cstring>
#include <map>

#include <osg/Image>

#include "aircraft/model/texture.h"
#include "picture/backdrop/osg_adapter.h"
#include "picture/backdrop/shading.h"

namespace airtruth::backdrop {
namespace {

osg::ref_ptr<osg::Texture2D> osg_texture(const model::Texture& texture) {
  constexpr float kAnisotropy = 16;
  const texture_file::Picture& finest = texture.finest;
  osg::ref_ptr<osg::Image> image = new osg::Image;
  image->allocateImage(finest.width, finest.height, 1, GL_RGBA, GL_FLOAT);
  unsigned char* target = image->data();
  for (std::size_t i = 0; i < finest.rgba.size(); i += 4, target += sizeof(model::Texel)) {
    const model::Texel texel = model::kDecoding.texel(&finest.rgba[i]);
    std::memcpy(target, texel.data(), sizeof(texel));
  }
  image->setInternalTextureFormat(GL_RGBA16F_ARB);
  osg::ref_ptr<osg::Texture2D> result = new osg::Texture2D(image);
  result->setInternalFormat(GL_RGBA16F_ARB);
  result->setResizeNonPowerOfTwoHint(false);
  result->setUnRefImageDataAfterApply(true);
  result->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR_MIPMAP_LINEAR);
  result->setFilter(osg::Texture::MAG_FILTER, osg::Texture::LINEAR);
  result->setMaxAnisotropy(kAnisotropy);
  result->setWrap(osg::Texture::WRAP_S,
                  texture.repeat_u ? osg::Texture::REPEAT : osg::Texture::CLAMP_TO_EDGE);
  result->setWrap(osg::Texture::WRAP_T,
                  texture.repeat_v ? osg::Texture::REPEAT : osg::Texture::CLAMP_TO_EDGE);
  return result;
}

// The triangles of one material of one part, with only the vertices that they use: OpenSceneGraph
// sorts drawables by the middle of their vertices.
osg::ref_ptr<osg::Geometry> osg_geometry(const model::Mesh& mesh,
                                         const model::Part& part,
                                         std::uint32_t material) {
  osg::ref_ptr<osg::Vec3Array> positions = new osg::Vec3Array(osg::Array::BIND_PER_VERTEX);
  osg::ref_ptr<osg::Vec3Array> normals = new osg::Vec3Array(osg::Array::BIND_PER_VERTEX);
  osg::ref_ptr<osg::Vec2Array> uvs = new osg::Vec2Array(osg::Array::BIND_PER_VERTEX);
  osg::ref_ptr<osg::DrawElementsUInt> indices = new osg::DrawElementsUInt(GL_TRIANGLES);
  std::map<std::uint32_t, unsigned> index_of_vertex;
  for (const model::Triangle& triangle : part.triangles) {
    if (triangle.material != material) continue;
    for (std::uint32_t vertex : triangle.vertex) {
      const auto [place, is_new] =
          index_of_vertex.try_emplace(vertex, static_cast<unsigned>(positions->size()));
      indices->push_back(place->second);
      if (!is_new) continue;
      positions->push_back(osg_from_vector(mesh.positions[vertex]));
      normals->push_back(osg_from_vector(mesh.normals[vertex]));
      const bool has_uv = vertex < mesh.uvs.size();
      uvs->push_back(has_uv ? osg::Vec2(mesh.uvs[vertex].x(), mesh.uvs[vertex].y()) : osg::Vec2());
    }
  }
  osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
  geometry->setUseDisplayList(false);
  geometry->setUseVertexBufferObjects(true);
  geometry->setVertexArray(positions);
  geometry->setNormalArray(normals);
  geometry->setTexCoordArray(0, uvs);
  geometry->addPrimitiveSet(indices);
  return geometry;
}

// Sorts the farthest first, as seen from eye_in_part.
void sort_triangles(osg::Geometry& geometry, const osg::Vec3f& eye_in_part) {
  const auto& positions = static_cast<const osg::Vec3Array&>(*geometry.getVertexArray());
  auto& indices = static_cast<osg::DrawElementsUInt&>(*geometry.getPrimitiveSet(0));
  struct Entry {
    float distance2;
    std::array<unsigned, 3> vertex;
  };
  std::vector<Entry> entries;
  entries.reserve(indices.size() / 3);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const osg::Vec3f centre =
        (positions[indices[i]] + positions[indices[i + 1]] + positions[indices[i + 2]]) / 3.0f;
    entries.push_back(
        {(centre - eye_in_part).length2(), {indices[i], indices[i + 1], indices[i + 2]}});
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.distance2 > b.distance2;
  });
  std::size_t i = 0;
  for (const Entry& entry : entries) {
    for (unsigned vertex : entry.vertex) indices[i++] = vertex;
  }
  indices.dirty();
}

double radius(const model::Mesh& mesh) {
  float result = 0;
  for (const model::Part& part : mesh.parts)
    result = std::max(result, part.centre_in_body.norm() + model::reach_m(mesh, part));
  return static_cast<double>(result) * 1.0001;
}

}  // namespace

std::vector<osg::ref_ptr<osg::Texture2D>> osg_textures(const model::Mesh& mesh) {
  std::vector<osg::ref_ptr<osg::Texture2D>> textures;
  for (const model::SharedTexture& texture : mesh.textures)
    textures.push_back(osg_texture(*texture));
  return textures;
}

OsgMesh::OsgMesh(const model::Mesh& mesh, const std::vector<osg::ref_ptr<osg::Texture2D>>& textures)
    : mesh_(mesh), body_(new osg::MatrixTransform), radius_m_(radius(mesh)) {
  for (std::size_t part = 0; part < mesh.parts.size(); ++part) add_part(part, textures);
}

void OsgMesh::add_part(std::size_t part,
                       const std::vector<osg::ref_ptr<osg::Texture2D>>& textures) {
  parts_.push_back(new osg::MatrixTransform);
  body_->addChild(parts_.back());
  std::vector<bool> used(mesh_.materials.size(), false);
  for (const model::Triangle& triangle : mesh_.parts[part].triangles)
    used.at(triangle.material) = true;
  for (std::uint32_t m = 0; m < used.size(); ++m) {
    if (!used[m]) continue;
    const model::Material& material = mesh_.materials[m];
    osg::Texture* texture = material.texture >= 0
                                ? textures.at(static_cast<std::size_t>(material.texture)).get()
                                : nullptr;
    for (Pass pass : {Pass::kOpaque, Pass::kTranslucent}) {
      if (!is_drawn_in(pass, material, mesh_)) continue;
      osg::ref_ptr<osg::Geometry> geometry = osg_geometry(mesh_, mesh_.parts[part], m);
      geometry->setStateSet(material_state(pass, material, texture));
      parts_.back()->addChild(geometry);
      if (pass == Pass::kTranslucent) translucent_.push_back({part, geometry});
    }
  }
}

void OsgMesh::place(const Instance& instance, const Rigid& cam_from_world) {
  const Rigid& world_from_body = instance.world_from_body;
  body_->setMatrix(osg_from_affine(world_from_body.affine()));
  std::vector<Eigen::Affine3f> body_from_parts;
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    body_from_parts.push_back(model::body_from_part(mesh_.parts[part], instance.time_s));
    parts_[part]->setMatrix(osg_from_affine(body_from_parts.back().cast<double>()));
  }
  const Vector3 eye_in_body = world_from_body.inverse() * cam_from_world.inverse().translation;
  for (const Translucent& translucent : translucent_) {
    const Eigen::Vector3f eye_in_part =
        body_from_parts[translucent.part].inverse() * eye_in_body.cast<float>();
    sort_triangles(*translucent.geometry, osg_from_vector(eye_in_part));
  }
}

}  // namespace airtruth::backdrop
