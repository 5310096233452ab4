// SPDX-License-Identifier: Apache-2.0
#include "render/model.h"

#include <cmath>
#include <cstring>

#include "base/error.h"

namespace airtruth::render {
namespace {

// No "threads=1" here: Embree would hold all of oneTBB, and so the whole pipeline, to one thread.
// One instruction set for all machines, so that a frame has the same bytes on each: AVX2 (2013 and
// later), or SSE4.2 where there is no AVX2.
RTCDevice new_device() {
  for (const char* settings : {"isa=avx2", "isa=sse4.2"}) {
    if (std::strstr(settings, "avx2") != nullptr && !__builtin_cpu_supports("avx2")) continue;
    if (RTCDevice device = rtcNewDevice(settings)) return device;
  }
  RTCDevice device = rtcNewDevice(nullptr);
  check(device != nullptr, "Embree has a device");
  return device;
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

// Texels per metre over a triangle: the square root of the ratio of its areas.
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

}  // namespace

Model::Model(const aircraft::Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  impl_->mesh = mesh;
  impl_->device.reset(new_device());
  Eigen::AlignedBox3f bounds;
  for (const aircraft::Part& part : mesh.parts) {
    impl_->scenes.emplace_back(scene_of(impl_->device.get(), mesh, part));
    std::vector<float> densities;
    for (const aircraft::Triangle& triangle : part.triangles) {
      densities.push_back(density(mesh, triangle));
      for (std::uint32_t v : triangle.vertex) bounds.extend(mesh.positions[v]);
    }
    impl_->texels_per_m.push_back(std::move(densities));
  }
  if (bounds.isEmpty()) bounds.extend(Eigen::Vector3f::Zero());
  impl_->centre_in_body = bounds.center().cast<double>();
  for (const aircraft::Part& part : mesh.parts) {
    for (const aircraft::Triangle& triangle : part.triangles) {
      for (std::uint32_t v : triangle.vertex) {
        const Eigen::Vector3d p = mesh.positions[v].cast<double>();
        double reach = (p - impl_->centre_in_body).norm();
        if (part.spins) {
          const Eigen::Vector3d hub = part.centre_in_body.cast<double>();
          reach = (hub - impl_->centre_in_body).norm() + (p - hub).norm();
        }
        impl_->radius_m = std::max(impl_->radius_m, reach);
      }
    }
  }
  impl_->radius_m = impl_->radius_m * 1.01 + 0.01;
}
Model::~Model() = default;
Model::Model(Model&&) noexcept = default;

}  // namespace airtruth::render
