// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <mutex>

#include "foundation/base/error.h"
#include "picture/shade/ambient_occlusion.h"
#include "picture/shade/model_impl.h"
#include "picture/shade/opaque.h"
#include "picture/shade/outer_sides.h"
#include "picture/shade/shade.h"

namespace airtruth::shade {
namespace {

// The settings omit "threads=1": with it Embree would limit all of oneTBB, and so the whole
// pipeline, to one thread. All machines use one instruction set, so that a frame has the same bytes
// on each: AVX2 (2013 and later), or SSE4.2 where AVX2 is missing.
std::shared_ptr<const Device> new_device() {
  for (const char* settings : {"isa=avx2", "isa=sse4.2", ""}) {
    if (std::strstr(settings, "avx2") != nullptr && !__builtin_cpu_supports("avx2")) continue;
    if (RTCDevice device = rtcNewDevice(settings)) {
      const ssize_t version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
      return std::make_shared<const Device>(device, std::to_string(version) + ' ' + settings);
    }
  }
  throw Error("Embree has no device");
}

// The device of all models that are alive: each device takes a key of thread-local memory, of which
// a process has 1024 (PTHREAD_KEYS_MAX).
std::shared_ptr<const Device> shared_device() {
  static std::mutex mutex;
  static std::weak_ptr<const Device> known;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const Device> device = known.lock();
  if (!device) known = device = new_device();
  return device;
}

RTCScene scene_of(RTCDevice device, const model::Mesh& mesh, const model::Part& part) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  if (!part.triangles.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto new_buffer = [&](RTCBufferType type, RTCFormat format, std::size_t count) {
      return rtcSetNewGeometryBuffer(geometry, type, 0, format, 3 * sizeof(float), count);
    };
    auto* vertices = static_cast<Eigen::Vector3f*>(
        new_buffer(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.positions.size()));
    std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
    auto* indices = static_cast<std::array<std::uint32_t, 3>*>(
        new_buffer(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, part.triangles.size()));
    for (const model::Triangle& triangle : part.triangles) *indices++ = triangle.vertex;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene);
  return scene;
}

// Texels per metre over a triangle: the square root of the ratio of its area in the texture to that
// in space.
float density(const model::Mesh& mesh, const model::Triangle& triangle) {
  const model::Texture* texture = mesh.texture_of(mesh.materials[triangle.material]);
  if (texture == nullptr) return 0;
  const auto& finest = texture->finest;
  const auto& [a, b, c] = triangle.vertex;
  const Eigen::Vector2f p = mesh.uvs[b] - mesh.uvs[a];
  const Eigen::Vector2f q = mesh.uvs[c] - mesh.uvs[a];
  const float in_texels = std::abs(p.x() * q.y() - p.y() * q.x()) *
                          static_cast<float>(finest.width) * static_cast<float>(finest.height);
  const float in_m2 =
      (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm();
  return in_m2 > 1e-12f ? std::sqrt(in_texels / in_m2) : 0;
}

PartGeometry geometry_of(const model::Mesh& mesh, const model::Part& part) {
  // In place of an index: a vertex that the part has not used yet.
  constexpr std::uint32_t kNone = 0xffffffff;
  PartGeometry geometry;
  std::vector<std::uint32_t> of_vertex(mesh.positions.size(), kNone);
  for (const model::Triangle& triangle : part.triangles) {
    PartGeometry::Triangle& result = geometry.triangles.emplace_back();
    std::array<Eigen::Vector3d, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = mesh.positions[triangle.vertex[k]].cast<double>();
      std::uint32_t& own = of_vertex[triangle.vertex[k]];
      if (own == kNone) {
        own = static_cast<std::uint32_t>(geometry.positions.size());
        geometry.positions.push_back(mesh.positions[triangle.vertex[k]]);
      }
      result.vertex[k] = own;
    }
    const Eigen::Vector3d ab = corner[1] - corner[0];
    const Eigen::Vector3d ac = corner[2] - corner[0];
    result.front_m2 = ab.cross(ac);
    result.front_length_m2 = result.front_m2.norm();
    result.longest_m = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
  }
  return geometry;
}

Facet facet_of(const model::Mesh& mesh, const model::Triangle& triangle, Opacity opacity) {
  Facet facet;
  for (std::size_t k = 0; k < 3; ++k) {
    facet.corner[k] = mesh.positions[triangle.vertex[k]];
    facet.normal[k] = mesh.normals[triangle.vertex[k]];
    facet.uv[k] = mesh.uvs[triangle.vertex[k]];
  }
  facet.face = (facet.corner[1] - facet.corner[0]).cross(facet.corner[2] - facet.corner[0]);
  facet.face.normalize();
  facet.texels_per_m = density(mesh, triangle);
  facet.material = triangle.material;
  facet.is_opaque = opacity == Opacity::kOpaque;
  facet.is_even = opacity != Opacity::kVaries;
  if (facet.is_even)
    facet.even_opacity =
        opacity_at(mesh, facet, mesh.materials[triangle.material], 1.0f / 3, 1.0f / 3, 0);
  return facet;
}

ModelOcclusion known_occlusion(const Model::Impl& model, const disk_cache::Cache& cache) {
  if (!cache.keeps()) return model_occlusion(model);
  const disk_cache::Key key = occlusion_key(model.mesh, model.device->name);
  const auto read = [&](const std::string& body) { return occlusion_from(body, model.mesh); };
  if (auto known = cache.find(key, read)) return *std::move(known);
  ModelOcclusion occlusion = model_occlusion(model);
  cache.keep(key, stored(occlusion));
  return occlusion;
}

std::unique_ptr<Model::Impl> prepared(
    std::shared_ptr<const model::Mesh> shared,
    const std::function<ModelOcclusion(const Model::Impl&)>& occlusion_of) {
  auto impl = std::make_unique<Model::Impl>(std::move(shared));
  const model::Mesh& mesh = impl->mesh;
  impl->device = shared_device();
  const auto opacity = opacities(mesh);
  for (const model::Part& part : mesh.parts) {
    impl->scenes.emplace_back(scene_of(impl->device->embree, mesh, part));
    std::vector<Facet>& facets = impl->facets.emplace_back();
    const std::size_t p = impl->facets.size() - 1;
    std::vector<std::uint8_t>& opaque = impl->opaque.emplace_back();
    for (std::size_t i = 0; i < part.triangles.size(); ++i) {
      facets.push_back(facet_of(mesh, part.triangles[i], opacity[p][i]));
      opaque.push_back(facets.back().is_opaque ? 1 : 0);
    }
    impl->geometry.push_back(geometry_of(mesh, part));
  }
  impl->find_sphere();
  impl->occlusion = occlusion_of(*impl);
  impl->outer_sides = outer_sides(*impl);
  return impl;
}

// The ambient occlusion of a model whose mesh has the same triangles.
ModelOcclusion occlusion_of_shape(const Model::Impl& known, const model::Mesh& mesh) {
  bool has_same = known.mesh.parts.size() == mesh.parts.size();
  for (std::size_t p = 0; has_same && p < mesh.parts.size(); ++p)
    has_same = known.mesh.parts[p].triangles == mesh.parts[p].triangles;
  check(has_same, "models that share their ambient occlusion have the same triangles");
  return known.occlusion;
}

}  // namespace

Model::Model(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Model::Model(const model::Mesh& mesh) : Model(std::make_shared<const model::Mesh>(mesh)) {}

Model::Model(std::shared_ptr<const model::Mesh> mesh, const std::filesystem::path& folder)
    : Model(prepared(std::move(mesh), [&](const Impl& impl) {
        return known_occlusion(impl, disk_cache::Cache(folder));
      })) {}

Model::Model(std::shared_ptr<const model::Mesh> mesh, const Model& same_shape)
    : Model(prepared(std::move(mesh), [&](const Impl& impl) {
        return occlusion_of_shape(same_shape.impl(), impl.mesh);
      })) {}

void Model::Impl::find_sphere() {
  Eigen::AlignedBox3f bounds;
  for (const model::Part& part : mesh.parts)
    for (const model::Triangle& triangle : part.triangles)
      for (std::uint32_t v : triangle.vertex) bounds.extend(mesh.positions[v]);
  if (bounds.isEmpty()) bounds.extend(Eigen::Vector3f::Zero());
  centre_in_body = bounds.center().cast<double>();
  for (const model::Part& part : mesh.parts) {
    const Eigen::Vector3d hub = part.centre_in_body.cast<double>();
    if (!part.hinges.empty())
      radius_m =
          std::max(radius_m, (hub - centre_in_body).norm() + double(model::reach_m(mesh, part)));
    for (const model::Triangle& triangle : part.triangles) {
      for (std::uint32_t v : triangle.vertex) {
        const Eigen::Vector3d p = mesh.positions[v].cast<double>();
        double far_m = (p - centre_in_body).norm();
        if (part.spins) far_m = (hub - centre_in_body).norm() + (p - hub).norm();
        radius_m = std::max(radius_m, far_m);
      }
    }
  }
  radius_m = radius_m * 1.01 + 0.01;
}

Model::~Model() = default;
Model::Model(Model&&) noexcept = default;

}  // namespace airtruth::shade
