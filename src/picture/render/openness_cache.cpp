// SPDX-License-Identifier: Apache-2.0
#include "picture/render/openness_cache.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::render {
namespace {

// Increase it when model_openness() changes or an entry's layout does.
constexpr int kOpennessVersion = 1;
constexpr std::size_t kShaDigits = 64;
// The largest entry: 400,000 triangles, four times the largest model of flightgear-data-ai.
constexpr std::size_t kMaxKeptBytes = std::size_t{64} << 20;
// Largest deviation of a stored length from its bound by rounding.
constexpr float kRounding = 1e-3f;

// A corner is stored as its share, `towards` and `given_back`.
constexpr std::size_t kFloatsOfCorner = 7;
constexpr std::size_t kFloatsOfTriangle = 2 * 3 * kFloatsOfCorner;
constexpr std::size_t kBytesOfTriangle = kFloatsOfTriangle * sizeof(float);

template <typename Value>
void append(std::string& bytes, const Value* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(Value));
}

std::string geometry_bytes(const aircraft::Mesh& mesh) {
  std::string bytes;
  const std::uint64_t positions = mesh.positions.size();
  append(bytes, &positions, 1);
  for (const Eigen::Vector3f& position : mesh.positions) append(bytes, position.data(), 3);
  for (const aircraft::Part& part : mesh.parts) {
    const std::uint64_t triangles = part.triangles.size();
    append(bytes, &triangles, 1);
    bytes.push_back(part.moves() ? 's' : '-');
    for (const aircraft::Triangle& triangle : part.triangles)
      append(bytes, triangle.vertex.data(), 3);
  }
  return bytes;
}

bool is_sound(const Openness& openness) {
  const auto within = [](const Eigen::Vector3f& v) { return v.norm() <= 1 + kRounding; };
  return openness.share >= 0 && openness.share <= 1 && within(openness.towards) &&
         within(openness.given_back);
}

void append(std::string& bytes, const TriangleOpenness& triangle) {
  std::array<float, kFloatsOfTriangle> values;
  float* to = values.data();
  for (const SideOpenness* side : {&triangle.front, &triangle.back})
    for (const Openness& corner : side->corner) {
      *to++ = corner.share;
      to = std::copy_n(corner.towards.data(), 3, to);
      to = std::copy_n(corner.given_back.data(), 3, to);
    }
  append(bytes, values.data(), values.size());
}

// Empty where a value is out of range. `bytes` has kBytesOfTriangle or more.
std::optional<TriangleOpenness> triangle_from(const char* bytes) {
  std::array<float, kFloatsOfTriangle> values;
  std::memcpy(values.data(), bytes, kBytesOfTriangle);
  const float* from = values.data();
  TriangleOpenness triangle;
  for (SideOpenness* side : {&triangle.front, &triangle.back})
    for (Openness& corner : side->corner) {
      corner = {from[0], {from[1], from[2], from[3]}, {from[4], from[5], from[6]}};
      from += kFloatsOfCorner;
      if (!is_sound(corner)) return std::nullopt;
    }
  return triangle;
}

// Empty where a value is out of range.
std::optional<ModelOpenness> openness_from(std::string_view body, const aircraft::Mesh& mesh) {
  ModelOpenness openness;
  const char* from = body.data();
  for (const aircraft::Part& part : mesh.parts) {
    std::vector<TriangleOpenness>& of_part = openness.emplace_back();
    of_part.reserve(part.triangles.size());
    for (std::size_t i = 0; i < part.triangles.size(); ++i, from += kBytesOfTriangle) {
      const auto triangle = triangle_from(from);
      if (!triangle) return std::nullopt;
      of_part.push_back(*triangle);
    }
  }
  return openness;
}

}  // namespace

OpennessCache openness_cache(const fs::path& folder,
                             const aircraft::Mesh& mesh,
                             std::string_view tracer) {
  if (folder.empty()) return {};
  return {folder,
          sha256_of(std::to_string(kOpennessVersion) + ' ' + std::string(tracer) + '\n' +
                    geometry_bytes(mesh))};
}

std::optional<ModelOpenness> cached_openness(const OpennessCache& cache,
                                             const aircraft::Mesh& mesh) {
  std::error_code ignored;
  const fs::path entry = cache.folder / cache.name;
  if (cache.folder.empty() || !fs::is_regular_file(entry, ignored)) return std::nullopt;
  try {
    const std::string bytes = read_file(entry, kMaxKeptBytes);
    if (bytes.size() != kShaDigits + mesh.triangle_count() * kBytesOfTriangle) return std::nullopt;
    const std::string_view body = std::string_view(bytes).substr(kShaDigits);
    if (sha256_of(body) != bytes.substr(0, kShaDigits)) return std::nullopt;
    return openness_from(body, mesh);
  } catch (const Error&) {  // an unreadable entry: the openness is computed again
    return std::nullopt;
  }
}

void keep_openness(const OpennessCache& cache, const ModelOpenness& openness) {
  if (cache.folder.empty()) return;
  std::string body;
  for (const std::vector<TriangleOpenness>& of_part : openness)
    for (const TriangleOpenness& triangle : of_part) append(body, triangle);
  if (kShaDigits + body.size() > kMaxKeptBytes) return;
  try {
    fs::create_directories(cache.folder);
    write_file(cache.folder / cache.name, sha256_of(body) + body, Flush::kLater);
  } catch (const std::exception&) {  // without a writable disk it is computed again next time
  }
}

}  // namespace airtruth::render
