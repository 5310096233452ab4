// SPDX-License-Identifier: Apache-2.0
#include "picture/render/openness_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/base/files.h"
#include "picture/render/model.h"

namespace airtruth::render {
namespace {

// Two squares that meet along y, at a right angle.
std::shared_ptr<const aircraft::Mesh> corner() {
  auto mesh = std::make_shared<aircraft::Mesh>();
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

class OpennessCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("airtruth-openness-" + std::to_string(::getpid()));
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

bool are_equal(const SideOpenness& a, const SideOpenness& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (a.corner[k].share != b.corner[k].share || a.corner[k].towards != b.corner[k].towards ||
        a.corner[k].given_back != b.corner[k].given_back)
      return false;
  return true;
}

bool are_equal(const ModelOpenness& a, const ModelOpenness& b) {
  const auto same = [](const TriangleOpenness& p, const TriangleOpenness& q) {
    return are_equal(p.front, q.front) && are_equal(p.back, q.back);
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const auto& p, const auto& q) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(), same);
  });
}

TEST_F(OpennessCacheTest, KeepsEveryBitOfTheOpenness) {
  const auto mesh = corner();
  const Model computed(*mesh);
  const Model written(mesh, folder_);
  const Model read(mesh, folder_);
  (void)only_entry();
  EXPECT_TRUE(are_equal(computed.impl().openness, written.impl().openness));
  EXPECT_TRUE(are_equal(computed.impl().openness, read.impl().openness));
  // The squares hide a part of each other's light on their inner sides.
  const TriangleOpenness& first = read.impl().openness[0][0];
  EXPECT_LT(std::min(first.front.corner[0].share, first.back.corner[0].share), 1);
}

TEST_F(OpennessCacheTest, AnEntryIsReadRatherThanComputed) {
  const auto mesh = corner();
  ModelOpenness known = Model(*mesh).impl().openness;
  known[0][2].back.corner[1].share = 0.125f;
  keep_openness(openness_cache(folder_, *mesh, "tracer"), known);
  const auto read = cached_openness(openness_cache(folder_, *mesh, "tracer"), *mesh);
  ASSERT_TRUE(read);
  EXPECT_TRUE(are_equal(known, *read));
}

TEST_F(OpennessCacheTest, ADamagedEntryIsComputedAgain) {
  const auto mesh = corner();
  const ModelOpenness sound = Model(mesh, folder_).impl().openness;
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
    EXPECT_TRUE(are_equal(sound, Model(mesh, folder_).impl().openness));
    EXPECT_EQ(read_file(entry), bytes) << "the entry is written anew";
  }
}

TEST_F(OpennessCacheTest, AValueOutOfRangeIsRefused) {
  const auto mesh = corner();
  const ModelOpenness sound = Model(*mesh).impl().openness;
  const OpennessCache cache = openness_cache(folder_, *mesh, "tracer");
  for (const float value : {-0.5f, 1.5f, std::numeric_limits<float>::quiet_NaN()}) {
    ModelOpenness wrong = sound;
    wrong[0][1].front.corner[2].share = value;
    keep_openness(cache, wrong);
    EXPECT_FALSE(cached_openness(cache, *mesh)) << value;
  }
  ModelOpenness wrong = sound;
  wrong[0][1].back.corner[0].given_back = {0, 2, 0};
  keep_openness(cache, wrong);
  EXPECT_FALSE(cached_openness(cache, *mesh));
}

TEST_F(OpennessCacheTest, TheNameFollowsWhatTheOpennessDependsOn) {
  const aircraft::Mesh mesh = *corner();
  const std::string name = openness_cache(folder_, mesh, "tracer").name;
  aircraft::Mesh other = mesh;
  other.materials[0].diffuse = {0, 0, 0};
  EXPECT_EQ(openness_cache(folder_, other, "tracer").name, name) << "another livery";
  EXPECT_NE(openness_cache(folder_, mesh, "another tracer").name, name);
  other.positions[3].x() = std::nextafter(other.positions[3].x(), 2.0f);
  EXPECT_NE(openness_cache(folder_, other, "tracer").name, name);
  other = mesh;
  other.parts[0].spins = true;
  EXPECT_NE(openness_cache(folder_, other, "tracer").name, name);
  other = mesh;
  std::swap(other.parts[0].triangles[0], other.parts[0].triangles[1]);
  EXPECT_NE(openness_cache(folder_, other, "tracer").name, name);
}

TEST_F(OpennessCacheTest, AFolderThatCannotBeWrittenIsNoError) {
  const auto mesh = corner();
  write_file(folder_, "a file where the folder should be");
  EXPECT_TRUE(are_equal(Model(*mesh).impl().openness, Model(mesh, folder_).impl().openness));
}

}  // namespace
}  // namespace airtruth::render
