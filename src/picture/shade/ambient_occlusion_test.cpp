// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/ambient_occlusion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/base/files.h"
#include "picture/shade/model_impl.h"

namespace airtruth::shade {
namespace {

// Two squares that meet along y, at a right angle.
std::shared_ptr<const model::Mesh> corner() {
  auto mesh = std::make_shared<model::Mesh>();
  mesh->positions = {{0, -1, 0}, {0, 1, 0}, {1, -1, 0}, {1, 1, 0}, {0, -1, -1}, {0, 1, -1}};
  mesh->normals.assign(6, Eigen::Vector3f(0, 0, -1));
  mesh->uvs.assign(6, Eigen::Vector2f(0, 0));
  mesh->materials.emplace_back();
  mesh->parts.push_back({.name = "all"});
  for (const auto& vertex :
       {std::array<std::uint32_t, 3>{0, 1, 2}, {1, 3, 2}, {0, 4, 1}, {1, 4, 5}})
    mesh->parts[0].triangles.push_back({vertex, 0});
  return mesh;
}

class OcclusionCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("airtruth-occlusion-" + std::to_string(::getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path only_entry() const {
    std::vector<fs::path> entries;
    for (const auto& entry : fs::directory_iterator(folder_)) entries.push_back(entry.path());
    EXPECT_EQ(entries.size(), 1u);
    return entries.at(0);
  }

  fs::path folder_;
};

bool are_equal(const SideOcclusion& a, const SideOcclusion& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (a.corner[k].open_share != b.corner[k].open_share ||
        a.corner[k].towards != b.corner[k].towards ||
        a.corner[k].given_back != b.corner[k].given_back)
      return false;
  return true;
}

bool are_equal(const ModelOcclusion& a, const ModelOcclusion& b) {
  const auto same = [](const TriangleOcclusion& p, const TriangleOcclusion& q) {
    return are_equal(p.front, q.front) && are_equal(p.back, q.back);
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const auto& p, const auto& q) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(), same);
  });
}

TEST_F(OcclusionCacheTest, KeepsEveryBit) {
  const auto mesh = corner();
  const Model computed(*mesh);
  const Model written(mesh, folder_);
  const Model read(mesh, folder_);
  (void)only_entry();
  EXPECT_TRUE(are_equal(computed.impl().occlusion, written.impl().occlusion));
  EXPECT_TRUE(are_equal(computed.impl().occlusion, read.impl().occlusion));
  // The squares hide a part of each other's light on their inner sides.
  const TriangleOcclusion& first = read.impl().occlusion[0][0];
  EXPECT_LT(std::min(first.front.corner[0].open_share, first.back.corner[0].open_share), 1);
}

TEST_F(OcclusionCacheTest, AnEntryIsReadRatherThanComputed) {
  const auto mesh = corner();
  ModelOcclusion known = Model(*mesh).impl().occlusion;
  known[0][2].back.corner[1].open_share = 0.125f;
  (void)Model(mesh, folder_);
  const std::string body = stored(known);
  write_file(only_entry(), sha256_of(body) + body);
  EXPECT_TRUE(are_equal(known, Model(mesh, folder_).impl().occlusion));
}

TEST_F(OcclusionCacheTest, ADamagedEntryIsComputedAgain) {
  const auto mesh = corner();
  const ModelOcclusion sound = Model(mesh, folder_).impl().occlusion;
  const fs::path entry = only_entry();
  const std::string bytes = read_file(entry);
  std::string flipped = bytes;
  flipped[bytes.size() / 2] ^= 1;
  for (const std::string& damaged : {std::string(),
                                     bytes.substr(0, 30),
                                     bytes.substr(0, 100),
                                     bytes.substr(0, bytes.size() - 1),
                                     bytes + "x",
                                     flipped}) {
    write_file(entry, damaged);
    EXPECT_TRUE(are_equal(sound, Model(mesh, folder_).impl().occlusion));
    EXPECT_EQ(read_file(entry), bytes) << "the entry is written anew";
  }
}

TEST_F(OcclusionCacheTest, AValueOutOfRangeIsRefused) {
  const auto mesh = corner();
  const ModelOcclusion sound = Model(*mesh).impl().occlusion;
  for (const float value : {-0.5f, 1.5f, std::numeric_limits<float>::quiet_NaN()}) {
    ModelOcclusion wrong = sound;
    wrong[0][1].front.corner[2].open_share = value;
    EXPECT_THROW(occlusion_from(stored(wrong), *mesh), Error) << value;
  }
  ModelOcclusion wrong = sound;
  wrong[0][1].back.corner[0].given_back = {0, 2, 0};
  EXPECT_THROW(occlusion_from(stored(wrong), *mesh), Error);
}

TEST_F(OcclusionCacheTest, TheNameFollowsWhatTheOcclusionDependsOn) {
  const model::Mesh mesh = *corner();
  const std::string name = occlusion_key(mesh, "tracer").name();
  model::Mesh other = mesh;
  other.materials[0].diffuse = {0, 0, 0};
  EXPECT_EQ(occlusion_key(other, "tracer").name(), name) << "another livery";
  EXPECT_NE(occlusion_key(mesh, "another tracer").name(), name);
  other.positions[3].x() = std::nextafter(other.positions[3].x(), 2.0f);
  EXPECT_NE(occlusion_key(other, "tracer").name(), name);
  other = mesh;
  other.parts[0].spins = true;
  EXPECT_NE(occlusion_key(other, "tracer").name(), name);
  other = mesh;
  std::swap(other.parts[0].triangles[0], other.parts[0].triangles[1]);
  EXPECT_NE(occlusion_key(other, "tracer").name(), name);
}

TEST_F(OcclusionCacheTest, AFolderThatCannotBeWrittenIsNoError) {
  const auto mesh = corner();
  write_file(folder_, "a file where the folder should be");
  EXPECT_TRUE(are_equal(Model(*mesh).impl().occlusion, Model(mesh, folder_).impl().occlusion));
}

TEST(Models, AreNotBoundedByTheKeysOfThreadLocalMemory) {
  std::vector<Model> models;
  for (int i = 0; i < 1200; ++i) models.emplace_back(corner());  // a process has 1024 keys
  EXPECT_EQ(models.back().impl().occlusion.size(), 1u);
}

TEST(Models, TakeTheAmbientOcclusionOfTheirShape) {
  const Model small(corner());
  auto mesh = std::make_shared<model::Mesh>(*corner());
  for (Eigen::Vector3f& position : mesh->positions) position *= 3;
  const Model large(mesh, small);
  EXPECT_TRUE(are_equal(large.impl().occlusion, small.impl().occlusion));
  EXPECT_NEAR(large.impl().radius_m, 3 * small.impl().radius_m, 0.05);
}

}  // namespace

}  // namespace airtruth::shade
