// SPDX-License-Identifier: Apache-2.0
#include "aircraft/ac3d/ac_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <osg/Geode>
#include <osg/Geometry>
#include <osg/Image>
#include <osg/NodeVisitor>
#include <osg/Notify>
#include <osg/TriangleIndexFunctor>
#include <osgDB/ReadFile>
#include <osgDB/Registry>

#include "aircraft/ac3d/ac_mesh.h"
#include "aircraft/fleet/fleet.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/error_of.h"

namespace airtruth::ac3d {
namespace {

constexpr const char* kMaterialLine =
    "MATERIAL \"m\" rgb 1 0.5 0 amb 1 1 1 emis 0 0 0 spec 0.1 0.2 0.3 shi 64 trans 0.25\n";

std::string ac(const std::string& objects) {
  return std::string("AC3Db\n") + kMaterialLine + "OBJECT world\n" + objects;
}

std::string ac_fault(const std::string& text) {
  return test_support::error_of([&] { parse_ac(text, "a.ac"); });
}

const std::string kTriangle =
    "OBJECT poly\nnumvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n"
    "0 0 0\n1 1 0\n2 0 1\nkids 0\n";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

TEST(AcFile, PlacesTexturesAndNamesFollowTheTree) {
  // The inner object is turned by a quarter about z and shifted by the outer's place. The rows of
  // rot are where x, y and z go, as OpenSceneGraph 3.6.5 reads them: x goes to y.
  const AcFile file = parse_ac(
      ac("kids 1\nOBJECT group\nname \"wing\"\nloc 10 0 0\nrot 0 1 0 -1 0 0 0 0 1\n"
         "texture \"a b.rgb\"\nkids 1\n" +
         replaced(
             kTriangle, "numvert", "name \"tip\"\ntexrep 2 3\ntexoff 0.5 0\nloc 1 0 0\nnumvert")),
      "a.ac");
  const AcObject& tip = file.objects.back();
  EXPECT_EQ(names_of(file, file.objects.size() - 1),
            (std::vector<std::string>{"World", "wing", "tip"}));
  // Local (1, 0, 0) is (2, 0, 0) in the group, (0, 2, 0) turned, (10, 2, 0) in the file.
  EXPECT_EQ(tip.vertices[1], Eigen::Vector3f(10, 2, 0));
  EXPECT_EQ(tip.texture, "a b.rgb");
  EXPECT_FLOAT_EQ(tip.corners[1].u, 2.5f);
  EXPECT_FLOAT_EQ(tip.corners[2].v, 3);
  EXPECT_FLOAT_EQ(file.materials[0].shininess, 64);
  EXPECT_FLOAT_EQ(file.materials[0].opacity, 0.75f);
}

TEST(AcFile, EachFaultIsOneLineWithItsPlace) {
  const std::vector<std::array<std::string, 3>> faults = {
      {"refs 3", "refs 4294967295", "a.ac:13: refs is '4294967295'"},
      {"refs 3", "refs 9000", "a.ac:13: refs is 9000, but the rest of the file can hold"},
      {"numvert 3", "numvert 99999999", "a.ac:6: numvert is '99999999'"},
      {"numvert 3", "numvert 100", "a.ac:6: numvert is 100, but"},
      {"numvert 3", "numvert -1", "a.ac:6: numvert is '-1'"},
      {"numsurf 1", "numsurf 90", "a.ac:10: numsurf is 90, but"},
      {"1 0 0\n0 1", "nan 0 0\n0 1", "a.ac:8: a coordinate is 'nan'"},
      {"1 0 0\n0 1", "inf 0 0\n0 1", "a.ac:8: a coordinate is 'inf'"},
      {"1 0 0\n0 1", "1e38 0 0\n0 1", "a.ac:8: a coordinate is '1e38'"},
      {"1 0 0\n0 1", "1e999 0 0\n0 1", "a.ac:8: a coordinate is '1e999'"},
      {"mat 0", "mat 1", "a.ac:12: mat is 1, but the file has 1 materials"},
      {"SURF 0x20", "SURF 1e39x20", "a.ac:11: SURF is '1e39x20'"},
      {"1 1 0\n2", "3 1 0\n2", "a.ac:15: names the vertex 3, but its object has 3"},
      {"1 1 0\n2", "1 1e30 0\n2", "a.ac:15: a texture coordinate is '1e30'"},
      {"numvert 3", "rot 1e5 0 0 0 1 0 0 0 1\nloc 1e6 0 0\nnumvert 3", "a.ac:10: rot and loc put"},
      {"kids 0", "kids", "a.ac:18: kids is the end of the file"},
      {"numvert 3", "name \"abc\nnumvert 3", "a.ac:6: has a quoted name"},
  };
  EXPECT_EQ(ac_fault(ac("kids 1\n" + kTriangle)), "no error");
  for (const auto& [what, with, expected] : faults)
    EXPECT_THAT(ac_fault(ac("kids 1\n" + replaced(kTriangle, what, with))),
                testing::StartsWith(expected))
        << with;
  EXPECT_THAT(ac_fault("AC3Db\nMATERIAL \"m\" rgb 1 1\n"), testing::StartsWith("a.ac:"));
  EXPECT_THAT(ac_fault(""), testing::HasSubstr("is empty"));
}

TEST(AcFile, WhereItIsCutShortIsAFaultButForKidsThatNeverBegin) {
  const std::string whole = ac("kids 2\n" + kTriangle);  // as c172p.ac of FlightGear
  EXPECT_EQ(parse_ac(whole, "a.ac").objects.size(), 2u);
  EXPECT_THAT(ac_fault(whole.substr(0, whole.size() - 8)), testing::HasSubstr("a.ac:"));
}

TEST(AcFile, DepthIsLimited) {
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "kids 1\nOBJECT group\n";
  EXPECT_THAT(ac_fault(ac(deep)), testing::HasSubstr("more than 64 deep"));
}

TEST(AcMesh, ConcavePolygonsKeepTheirArea) {
  // An L of three unit squares, and the same with a spike that folds back on itself.
  const std::vector<Eigen::Vector3f> corners = {
      {0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  ASSERT_TRUE(is_concave(corners));
  double area = 0;
  const auto triangles = ear_clipped(corners, area_normal(corners));
  for (const auto& [a, b, c] : triangles) {
    const double doubled = (corners[b] - corners[a]).cross(corners[c] - corners[a]).z();
    EXPECT_GT(doubled, 0);  // none is turned over
    area += doubled / 2;
  }
  EXPECT_EQ(triangles.size(), 4u);
  EXPECT_NEAR(area, 3, 1e-6);
  const std::vector<Eigen::Vector3f> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_FALSE(is_concave(square));
}

// Two squares that meet in an edge along y, the second bent up by the angle.
Eigen::Vector3f normal_at_edge(double bend_deg, const std::string& flags) {
  const double x = 1 + std::cos(bend_deg * 3.14159265358979 / 180);
  const double z = std::sin(bend_deg * 3.14159265358979 / 180);
  const std::string far = std::to_string(x) + " ";
  const AcFile file = parse_ac(
      ac("kids 1\nOBJECT poly\ncrease 45\nnumvert 6\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + far + "0 " +
         std::to_string(z) + "\n" + far + "1 " + std::to_string(z) + "\nnumsurf 2\nSURF " + flags +
         "\nmat 0\nrefs 4\n0 0 0\n1 0 0\n2 0 0\n3 0 0\nSURF " + flags +
         "\nmat 0\nrefs 4\n1 0 0\n4 0 0\n5 0 0\n2 0 0\nkids 0\n"),
      "a.ac");
  const Batch batch = batches_of(file, file.objects.back()).at(0);
  for (std::size_t i = 0; i < batch.positions.size(); ++i)
    if (batch.positions[i] == Eigen::Vector3f(1, 0, 0)) return batch.normals[i];
  return Eigen::Vector3f::Zero();
}

TEST(AcMesh, NormalsAreAveragedBelowTheCreaseOfSmoothSurfaces) {
  // Two equal squares: the mean leans back by half the bend.
  const double half = 15 * 3.14159265358979 / 180;
  const Eigen::Vector3f smooth = normal_at_edge(30, "0x30");
  EXPECT_NEAR(smooth.x(), -std::sin(half), 1e-5);
  EXPECT_NEAR(smooth.z(), std::cos(half), 1e-5);
  EXPECT_TRUE(normal_at_edge(60, "0x30").isApprox(Eigen::Vector3f(0, 0, 1)));  // above the crease
  EXPECT_TRUE(normal_at_edge(30, "0x20").isApprox(Eigen::Vector3f(0, 0, 1)));  // flat surfaces
}

// OpenSceneGraph's own reader, which the models are drawn for.
using Corner = std::array<long, 8>;
using CornerTriangle = std::array<Corner, 3>;

Corner rounded(const double* p, const double* n, const double* uv) {
  return {std::lround(p[0] * 1e4),
          std::lround(p[1] * 1e4),
          std::lround(p[2] * 1e4),
          std::lround(n[0] * 50),
          std::lround(n[1] * 50),
          std::lround(n[2] * 50),
          std::lround(uv[0] * 1e3),
          std::lround(uv[1] * 1e3)};
}

struct IndexTriangles {
  std::vector<std::array<unsigned, 3>> list;
  void operator()(unsigned a, unsigned b, unsigned c) { list.push_back({a, b, c}); }
};

class OsgTriangles : public osg::NodeVisitor {
 public:
  OsgTriangles() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
  void apply(osg::Geode& geode) override {
    for (unsigned i = 0; i < geode.getNumDrawables(); ++i)
      if (osg::Geometry* geometry = geode.getDrawable(i)->asGeometry()) add(*geometry);
  }
  std::map<CornerTriangle, int> triangles;
  int count = 0;
  double area_m2 = 0;

 private:
  void add(osg::Geometry& geometry) {
    const auto* vertices = dynamic_cast<const osg::Vec3Array*>(geometry.getVertexArray());
    const auto* normals = dynamic_cast<const osg::Vec3Array*>(geometry.getNormalArray());
    const auto* uvs = dynamic_cast<const osg::Vec2Array*>(geometry.getTexCoordArray(0));
    if (vertices == nullptr || normals == nullptr) return;
    osg::TriangleIndexFunctor<IndexTriangles> functor;
    geometry.accept(functor);
    for (const auto& triangle : functor.list) {
      CornerTriangle corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const osg::Vec3d p = (*vertices)[triangle[k]];
        const osg::Vec3d n = (*normals)[triangle[k]];
        const osg::Vec2d uv = uvs != nullptr ? osg::Vec2d((*uvs)[triangle[k]]) : osg::Vec2d();
        corners[k] = rounded(p.ptr(), n.ptr(), uv.ptr());
      }
      std::sort(corners.begin(), corners.end());
      ++triangles[corners];
      ++count;
      const osg::Vec3d a = (*vertices)[triangle[0]];
      area_m2 += 0.5 * ((osg::Vec3d((*vertices)[triangle[1]]) - a) ^
                        (osg::Vec3d((*vertices)[triangle[2]]) - a))
                           .length();
    }
  }
};

// Every texture is there, with one texel.
class AnyImage : public osgDB::ReadFileCallback {
 public:
  osgDB::ReaderWriter::ReadResult readImage(const std::string&, const osgDB::Options*) override {
    const osg::ref_ptr<osg::Image> image = new osg::Image;
    image->allocateImage(1, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE);
    return image.get();
  }
};
class AnyFile : public osgDB::FindFileCallback {
 public:
  std::string findDataFile(const std::string& name,
                           const osgDB::Options*,
                           osgDB::CaseSensitivity) override {
    return name;
  }
};

class AcOracle : public testing::TestWithParam<const char*> {};

// Models whose crease angles are at most 60 degrees, which OpenSceneGraph does not lower. All but
// the triangles of concave polygons, whose diagonals are another's choice.
TEST_P(AcOracle, TrianglesNormalsAndTexturesAreOpenSceneGraphs) {
  const fs::path path = fs::path(fleet::kDebianAircraft) / GetParam();
  if (!fs::is_regular_file(path)) GTEST_SKIP() << path << " is not installed";
  osg::setNotifyLevel(osg::ALWAYS);
  const osg::ref_ptr<osgDB::Options> options = new osgDB::Options;
  const osg::ref_ptr<AnyImage> any_image = new AnyImage;
  const osg::ref_ptr<AnyFile> any_file = new AnyFile;
  options->setReadFileCallback(any_image.get());
  options->setFindFileCallback(any_file.get());
  osgDB::ReaderWriter* reader = osgDB::Registry::instance()->getReaderWriterForExtension("ac");
  ASSERT_NE(reader, nullptr) << "package libopenscenegraph161";
  std::ifstream stream(path);
  const osg::ref_ptr<osg::Node> node = reader->readNode(stream, options.get()).takeNode();
  ASSERT_TRUE(node.valid());
  OsgTriangles theirs;
  node->accept(theirs);
  const AcFile file = parse_ac(read_file(path), path);
  int ours = 0;
  int matched = 0;
  double area_m2 = 0;
  for (const AcObject& object : file.objects) {
    for (const Batch& batch : batches_of(file, object)) {
      for (const auto& triangle : batch.triangles) {
        CornerTriangle corners;
        for (std::size_t k = 0; k < 3; ++k) {
          const Eigen::Vector3d p = batch.positions[triangle[k]].cast<double>();
          const Eigen::Vector3d n = batch.normals[triangle[k]].cast<double>();
          const Eigen::Vector2d uv = batch.uvs[triangle[k]].cast<double>();
          corners[k] = rounded(p.data(), n.data(), uv.data());
        }
        std::sort(corners.begin(), corners.end());
        ++ours;
        const Eigen::Vector3d a = batch.positions[triangle[0]].cast<double>();
        area_m2 += 0.5 * (batch.positions[triangle[1]].cast<double>() - a)
                             .cross(batch.positions[triangle[2]].cast<double>() - a)
                             .norm();
        const auto found = theirs.triangles.find(corners);
        if (found == theirs.triangles.end() || found->second == 0) continue;
        --found->second;
        ++matched;
      }
    }
  }
  EXPECT_NEAR(ours, theirs.count, 0.01 * theirs.count);
  EXPECT_GT(matched, 0.85 * theirs.count) << ours << " against " << theirs.count;
  EXPECT_NEAR(area_m2, theirs.area_m2, 0.002 * theirs.area_m2);
}

INSTANTIATE_TEST_SUITE_P(Debian,
                         AcOracle,
                         testing::Values("c172/Models/c172p.ac",
                                         "A380/Models/388.ac",
                                         "SF3/Models/SF3.ac",
                                         "JA37/Models/JA-37-lowpoly.ac"));

}  // namespace
}  // namespace airtruth::ac3d
