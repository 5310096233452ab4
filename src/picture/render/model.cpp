// SPDX-License-Identifier: Apache-2.0
#include "picture/render/model.h"

#include <array>
#include <cmath>
#include <cstring>

#include "foundation/base/error.h"
#include "picture/render/opaque.h"
#include "picture/render/openness.h"
#include "picture/render/openness_cache.h"
#include "picture/render/outer_sides.h"
#include "picture/render/shade.h"

namespace airtruth::render {
namespace {

// The settings omit "threads=1": with it Embree would limit all of oneTBB, and so the whole
// pipeline, to one thread. All machines use one instruction set, so that a frame has the same bytes
// on each: AVX2 (2013 and later), or SSE4.2 where AVX2 is missing.
struct Device {
  RTCDevice device = nullptr;
  // Embree's version and its settings.
  std::string name;
};
Device new_device() {
  for (const char* settings : {"isa=avx2", "isa=sse4.2", ""}) {
    if (std::strstr(settings, "avx2") != nullptr && !__builtin_cpu_supports("avx2")) continue;
    if (RTCDevice device = rtcNewDevice(settings))
      return {device,
              std::to_string(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION)) + ' ' +
                  settings};
  }
  throw Error("Embree has no device");
}

RTCScene scene_of(RTCDevice device, const aircraft::Mesh& mesh, const aircraft::Part& part) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  if (!part.triangles.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry,
                                                                 RTC_BUFFER_TYPE_VERTEX,
                                                                 0,
                                                                 RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float),
                                                                 mesh.positions.size()));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      for (int c = 0; c < 3; ++c)
        vertices[3 * i + static_cast<std::size_t>(c)] = mesh.positions[i][c];
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry,
                                                                   RTC_BUFFER_TYPE_INDEX,
                                                                   0,
                                                                   RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned),
                                                                   part.triangles.size()));
    for (std::size_t i = 0; i < part.triangles.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) indices[3 * i + c] = part.triangles[i].vertex[c];
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene);
  return scene;
}

// Texels per metre over a triangle: the square root of the ratio of its area in the texture to that
// in space.
float density(const aircraft::Mesh& mesh, const aircraft::Triangle& triangle) {
  const int texture = mesh.materials[triangle.material].texture;
  if (texture < 0) return 0;
  const auto& level = mesh.textures[static_cast<std::size_t>(texture)].levels.front();
  const auto& [a, b, c] = triangle.vertex;
  const Eigen::Vector2f p = mesh.uvs[b] - mesh.uvs[a];
  const Eigen::Vector2f q = mesh.uvs[c] - mesh.uvs[a];
  const float in_texels = std::abs(p.x() * q.y() - p.y() * q.x()) *
                          static_cast<float>(level.width) * static_cast<float>(level.height);
  const float in_m2 =
      (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm();
  return in_m2 > 1e-12f ? std::sqrt(in_texels / in_m2) : 0;
}

PartGeometry geometry_of(const aircraft::Mesh& mesh, const aircraft::Part& part) {
  constexpr std::uint32_t kNone = 0xffffffff;
  PartGeometry geometry;
  std::vector<std::uint32_t> of_vertex(mesh.positions.size(), kNone);
  for (const aircraft::Triangle& triangle : part.triangles) {
    auto& vertices = geometry.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& own = of_vertex[triangle.vertex[k]];
      if (own == kNone) {
        own = static_cast<std::uint32_t>(geometry.positions.size());
        geometry.positions.push_back(mesh.positions[triangle.vertex[k]]);
      }
      vertices[k] = own;
    }
  }
  return geometry;
}

Facet facet_of(const aircraft::Mesh& mesh,
               const aircraft::Triangle& triangle,
               bool is_opaque,
               bool is_even) {
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
  facet.is_opaque = is_opaque;
  facet.is_even = is_even;
  if (is_even)
    facet.even_opacity =
        opacity_at(mesh, facet, mesh.materials[triangle.material], 1.0f / 3, 1.0f / 3, 0);
  return facet;
}

}  // namespace

bool is_blocked(const Model::Impl& model,
                const Eigen::Vector3f& origin,
                const Eigen::Vector3f& direction,
                float reach_m) {
  for (std::size_t i = 0; i < model.scenes.size(); ++i) {
    if (model.mesh.parts[i].moves()) continue;
    RTCRay ray{};
    ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
    ray.dir_x = direction.x(), ray.dir_y = direction.y(), ray.dir_z = direction.z();
    ray.tnear = 0;
    ray.tfar = reach_m;
    ray.mask = 0xffffffffu;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(model.scenes[i].get(), &context, &ray);
    if (ray.tfar < 0) return true;
  }
  return false;
}

std::optional<Hit> nearest_blocker(const Model::Impl& model,
                                   const Eigen::Vector3f& origin,
                                   const Eigen::Vector3f& direction,
                                   float reach_m) {
  RTCRayHit query{};
  query.ray.org_x = origin.x(), query.ray.org_y = origin.y(), query.ray.org_z = origin.z();
  query.ray.dir_x = direction.x(), query.ray.dir_y = direction.y();
  query.ray.dir_z = direction.z();
  query.ray.tnear = 0;
  // Embree shortens it to the distance of the nearest hit so far.
  query.ray.tfar = reach_m;
  query.ray.mask = 0xffffffffu;
  std::optional<Hit> best;
  for (std::size_t i = 0; i < model.scenes.size(); ++i) {
    if (model.mesh.parts[i].moves()) continue;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(model.scenes[i].get(), &context, &query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID)
      best = Hit{query.ray.tfar, static_cast<int>(i), query.hit.primID, query.hit.u, query.hit.v};
  }
  return best;
}

Model::Model(const aircraft::Mesh& mesh) : Model(std::make_shared<const aircraft::Mesh>(mesh)) {}

Model::Model(std::shared_ptr<const aircraft::Mesh> shared, const std::filesystem::path& cache)
    : impl_(std::make_unique<Impl>(std::move(shared))) {
  const aircraft::Mesh& mesh = impl_->mesh;
  const Device device = new_device();
  impl_->device.reset(device.device);
  impl_->opaque = opaque_triangles(mesh);
  const auto even = even_triangles(mesh, impl_->opaque);
  for (const aircraft::Part& part : mesh.parts) {
    impl_->scenes.emplace_back(scene_of(impl_->device.get(), mesh, part));
    std::vector<Facet>& facets = impl_->facets.emplace_back();
    const std::size_t p = impl_->facets.size() - 1;
    for (std::size_t i = 0; i < part.triangles.size(); ++i)
      facets.push_back(
          facet_of(mesh, part.triangles[i], impl_->opaque[p][i] != 0, even[p][i] != 0));
    impl_->geometry.push_back(geometry_of(mesh, part));
  }
  impl_->find_sphere();
  impl_->find_openness(openness_cache(cache, mesh, device.name));
  impl_->outer_sides = outer_sides(*impl_);
}

void Model::Impl::find_openness(const OpennessCache& cache) {
  if (auto known = cached_openness(cache, mesh)) {
    openness = std::move(*known);
    return;
  }
  openness = model_openness(*this);
  keep_openness(cache, openness);
}

void Model::Impl::find_sphere() {
  Eigen::AlignedBox3f bounds;
  for (const aircraft::Part& part : mesh.parts)
    for (const aircraft::Triangle& triangle : part.triangles)
      for (std::uint32_t v : triangle.vertex) bounds.extend(mesh.positions[v]);
  if (bounds.isEmpty()) bounds.extend(Eigen::Vector3f::Zero());
  centre_in_body = bounds.center().cast<double>();
  for (const aircraft::Part& part : mesh.parts) {
    const Eigen::Vector3d hub = part.centre_in_body.cast<double>();
    if (!part.hinges.empty())
      radius_m =
          std::max(radius_m, (hub - centre_in_body).norm() + double(aircraft::reach_m(mesh, part)));
    for (const aircraft::Triangle& triangle : part.triangles) {
      for (std::uint32_t v : triangle.vertex) {
        const Eigen::Vector3d p = mesh.positions[v].cast<double>();
        double reach = (p - centre_in_body).norm();
        if (part.spins) reach = (hub - centre_in_body).norm() + (p - hub).norm();
        radius_m = std::max(radius_m, reach);
      }
    }
  }
  radius_m = radius_m * 1.01 + 0.01;
}

Model::~Model() = default;
Model::Model(Model&&) noexcept = default;

}  // namespace airtruth::render
