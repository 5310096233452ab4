// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "aircraft/fleet/fleet.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/environment_variable.h"
#include "support/error_of.h"

namespace airtruth::model_reader {
namespace {

class Formats : public testing::Test {
 protected:
  Formats()
      : folder_(fs::temp_directory_path() / ("airtruth_formats_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Formats() override { fs::remove_all(folder_); }

  fleet::Aircraft load(const std::string& name, const std::string& bytes) {
    write_file(folder_ / name, bytes);
    model::LoadOptions options;
    options.axes = model::ModelAxes{"x", "z", 1};
    return fleet::load_aircraft((folder_ / name).string(),
                                options,
                                [&](const std::string& warning) { warnings_ += warning; });
  }
  std::string fault(const std::string& name, const std::string& bytes) {
    return test_support::error_of([&] { load(name, bytes); });
  }
  fs::path folder_;
  const test_support::EnvironmentVariable cache_{"XDG_CACHE_HOME", folder_ / "cache"};
  std::string warnings_;
};

// x forward 3, y left 2, z up 1: the body's y is right and its z down.
void expect_size(const fleet::Aircraft& loaded) {
  const model::Extents size = model::extents(loaded.mesh);
  EXPECT_TRUE(size.high_in_body.isApprox(Vector3(3, 0, 0))) << size.high_in_body.transpose();
  EXPECT_TRUE(size.low_in_body.isApprox(Vector3(0, -2, -1))) << size.low_in_body.transpose();
}

TEST_F(Formats, AnObjWithItsMaterialIsReadAndAMissingOneIsNamed) {
  write_file(folder_ / "a.mtl", "newmtl m\nKd 1 0 0\nd 0.5\n");
  const std::string shape = "v 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nusemtl m\nf 1 2 3\nf 1 3 4\n";
  const fleet::Aircraft loaded = load("a.obj", "mtllib a.mtl\n" + shape);
  expect_size(loaded);
  EXPECT_EQ(loaded.mesh.materials.at(0).diffuse, (std::array<float, 3>{1, 0, 0}));
  EXPECT_FLOAT_EQ(loaded.mesh.materials.at(0).opacity, 0.5f);
  EXPECT_EQ(loaded.sources.size(), 2u);
  EXPECT_EQ(warnings_, "");
  load("b.obj", "mtllib ../../etc/gone.mtl\n" + shape);
  EXPECT_THAT(warnings_, testing::HasSubstr("gone.mtl"));
}

// Names are FlightGear's in its own files alone: a Disco is no disc, a Shadow no shadow.
TEST_F(Formats, APartsNameSaysNothing) {
  for (const char* name : {"Discus-2b", "disk", "prop_disc", "RQ-7_Shadow", "tail_beam", "smoke"}) {
    const fleet::Aircraft loaded =
        load(std::string(name) + ".obj",
             std::string("g ") + name + "\nv 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n");
    expect_size(loaded);
    EXPECT_EQ(loaded.mesh.materials.at(0).opacity, 1) << name;
  }
}

TEST_F(Formats, ANumberOfAnObjMayBeginWithItsDot) {
  // The last vertex is spare.
  const auto loaded = load(
      "a.obj",
      "v .0 0 0\n\tv 3 .0 .0\nv 0 2 .0\nv 0 .0 1\nv 9 9 9\nvt .1 .5\nf 1 2 3\nf 1/1 3/1 4/1\n");
  expect_size(loaded);
  EXPECT_EQ(loaded.mesh.triangle_count(), 2U);
}

TEST_F(Formats, WhatOfAnMtlIsNotReadIsSaid) {
  const auto warnings = [&](const std::string& lines) {
    // A white texel.
    write_file(folder_ / "t.tga",
               std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0", 18) + "\xff\xff\xff");
    write_file(folder_ / "a.mtl", "newmtl m\n" + lines + "\n");
    warnings_.clear();
    load("a.obj", "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 3 0 0\nv 0 2 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    return warnings_;
  };
  EXPECT_THAT(warnings("map_d t.tga"), testing::HasSubstr("map_d of OBJ) is not read"));
  EXPECT_THAT(warnings("map_Kd -s 2 t.tga"), testing::HasSubstr("the options -s, -o and -t"));
  EXPECT_THAT(warnings("map_Kd\t-o 0.5 0 0 t.tga"),
              testing::HasSubstr("the options -s, -o and -t"));
  EXPECT_EQ(warnings("map_Kd t.tga\nmap_d t.tga\nmap_Bump -s 2 2 2 t.tga"), "");
}

// Editors of Windows write a byte order mark. The last vertex is spare.
TEST_F(Formats, AnObjMayBeginWithAByteOrderMark) {
  const auto loaded =
      load("a.obj", "\xEF\xBB\xBFv 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nv 9 9 9\nf 1 2 3\nf 1 3 4\n");
  expect_size(loaded);
  EXPECT_EQ(loaded.mesh.triangle_count(), 2U);
}

// A picture stands in for the colour that is not stated, and not on a grey. Colours are linear.
TEST_F(Formats, AMaterialOfAPictureAloneIsWhiteBeneathIt) {
  write_file(folder_ / "t.tga",
             std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0", 18) + "\xff\xff\xff");
  write_file(folder_ / "a.mtl",
             "newmtl stated\nmap_Kd t.tga\nKd 0.5 0.5 0.5\nnewmtl none\nmap_Kd\tt.tga\n");
  for (const auto& [name, expected] :
       {std::pair("stated", std::pow((0.5f + 0.055f) / 1.055f, 2.4f)), {"none", 1.0f}}) {
    const auto loaded = load("a.obj",
                             std::string("mtllib a.mtl\nusemtl ") + name +
                                 "\nv 0 0 0\nv 3 0 0\nv 0 2 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    EXPECT_FLOAT_EQ(loaded.mesh.materials.at(0).diffuse[0], expected) << name;
  }
}

// Each vertex of a triangle has the triangle's normal.
void expect_flat(const model::Mesh& mesh) {
  for (const model::Triangle& triangle : mesh.parts.at(0).triangles) {
    const auto at = [&](int corner) { return mesh.positions[triangle.vertex[corner]]; };
    const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (const std::uint32_t vertex : triangle.vertex)
      EXPECT_TRUE(mesh.normals[vertex].isApprox(normal)) << mesh.normals[vertex].transpose();
  }
}

// A chunk of a 3DS file: its number, its length with both, and what it holds.
std::string chunk(int number, const std::string& content) {
  const auto length = static_cast<std::uint32_t>(6 + content.size());
  std::string bytes = {static_cast<char>(number & 0xff), static_cast<char>(number >> 8)};
  return bytes.append(reinterpret_cast<const char*>(&length), 4) + content;
}

template <typename... Numbers>
std::string bytes_of(Numbers... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof(numbers)), ...);
  return bytes;
}

// Two triangles that meet at a right angle, and share the vertices of that edge.
TEST_F(Formats, ASharpEdgeIsNotSmoothedWhereNoNormalsAreStated) {
  using U = std::uint16_t;
  const std::string vertices =
      bytes_of(U{4}, 0.f, 0.f, 0.f, 3.f, 0.f, 0.f, 0.f, 2.f, 0.f, 0.f, 0.f, 1.f);
  const std::string faces = bytes_of(U{2}, U{0}, U{1}, U{2}, U{0}, U{0}, U{2}, U{3}, U{0});
  const std::string mesh = chunk(0x4100, chunk(0x4110, vertices) + chunk(0x4120, faces));
  const std::string object = chunk(0x4000, std::string("a\0", 2) + mesh);
  expect_flat(load("a.3ds", chunk(0x4d4d, chunk(0x3d3d, object))).mesh);
  expect_flat(load("a.obj", "v 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n").mesh);
  expect_flat(load("a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                   "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
                   "end_header\n0 0 0\n3 0 0\n0 2 0\n0 0 1\n3 0 1 2\n3 0 2 3\n")
                  .mesh);
}

// Two triangles of a PLY that meet at 27 degrees: the vertices of their edge have one normal.
TEST_F(Formats, ARoundPlyIsSmooth) {
  const model::Mesh mesh =
      load("a.ply",
           "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
           "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
           "end_header\n0 0 0\n0 2 0\n-2 0 0\n2 0 -1\n3 0 1 2\n3 0 3 1\n")
          .mesh;
  const auto& triangles = mesh.parts.at(0).triangles;
  int shared = 0;
  for (const std::uint32_t one : triangles.at(0).vertex)
    for (const std::uint32_t other : triangles.at(1).vertex) {
      if (mesh.positions[one] != mesh.positions[other]) continue;
      EXPECT_TRUE(mesh.normals[one].isApprox(mesh.normals[other]));
      ++shared;
    }
  EXPECT_EQ(shared, 2);
}

TEST_F(Formats, NamesHaveNoBlanksAroundThemAndOneNumberIsAGrey) {
  write_file(folder_ / "t.tga",
             std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0", 18) + "\xff\xff\xff");
  write_file(folder_ / "a.mtl", "newmtl m\nKd 1\nmap_Kd t.tga \t\n");
  const auto loaded =
      load("a.obj", "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 3 0 0\nv 0 2 0\nvt 0 0\nf 1/1 2/1 3/1\n");
  EXPECT_EQ(loaded.mesh.materials.at(0).diffuse, (std::array<float, 3>{1, 1, 1}));
  EXPECT_EQ(loaded.mesh.textures.size(), 1u);
  EXPECT_EQ(warnings_, "");
}

// A picture is not darkened by the grey of a shape alone.
TEST_F(Formats, ATextureOfAPlyIsShownAsItIs) {
  write_file(folder_ / "t.tga",
             std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0", 18) + "\xff\xff\xff");
  const auto loaded =
      load("a.ply",
           "ply\nformat ascii 1.0\ncomment TextureFile t.tga\nelement vertex 4\nproperty float x\n"
           "property float y\nproperty float z\nproperty float s\nproperty float t\n"
           "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0 0 0\n3 0 0 1 0\n0 2 0 0 1\n0 0 1 1 1\n3 0 1 2\n3 0 2 3\n");
  EXPECT_EQ(loaded.mesh.textures.size(), 1u);
  EXPECT_EQ(loaded.mesh.materials.at(0).diffuse, (std::array<float, 3>{1, 1, 1}));
}

TEST_F(Formats, StlAndPlyAreRead) {
  const auto facet = [](const std::string& a, const std::string& b, const std::string& c) {
    return "facet normal 0 0 0\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c +
           "\nendloop\nendfacet\n";
  };
  const auto stl = load("a.stl",
                        "solid a\n" + facet("0 0 0", "3 0 0", "0 2 0") +
                            facet("0 0 0", "0 2 0", "0 0 1") + "endsolid a\n");
  expect_size(stl);
  // Grey, in linear light.
  EXPECT_FLOAT_EQ(stl.mesh.materials.at(0).diffuse[0], std::pow((0.6f + 0.055f) / 1.055f, 2.4f));
  expect_size(load("a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                   "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
                   "end_header\n0 0 0\n3 0 0\n0 2 0\n0 0 1\n3 0 1 2\n3 0 2 3\n"));
}

// A normal 0 0 0 stands for that of the triangle: the wall of x and z faces right, -y of the file.
TEST_F(Formats, ANormalWithoutLengthIsThatOfItsTriangle) {
  const std::string corners = "0 0 0 0 0 0\n3 0 0 0 0 0\n0 0 1 0 0 0\n";
  const std::string properties =
      "property float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n";
  for (const fleet::Aircraft& loaded :
       {load("a.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\n" + properties +
                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + corners +
                 "3 0 1 2\n"),
        load("a.stl",
             "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 3 0 0\n"
             "vertex 0 0 1\nendloop\nendfacet\nendsolid a\n"),
        load("a.obj", "v 0 0 0\nv 3 0 0\nv 0 0 1\nvn 0 0 0\nf 1//1 2//1 3//1\n")}) {
    ASSERT_EQ(loaded.mesh.positions.size(), 3U) << loaded.name;
    for (const Eigen::Vector3f& normal : loaded.mesh.normals)
      EXPECT_TRUE(normal.isApprox(Eigen::Vector3f(0, 1, 0))) << normal.transpose();
  }
}

// Two triangles that share the edge from the origin along x, and whose planes differ by 27 degrees.
std::string gltf_of(const std::string& material) {
  // The positions (0, 0, 0), (3, 0, 0), (0, 2, 0), (0, 0, 1), then the indices 0 1 2, 0 1 3,
  // base64.
  const std::string data =
      "AAAAAAAAAAAAAAAAAABAQAAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAMAAAIA/AAABAAIAAAADAAEA";
  // Two grey texels with the alphas 64 and 200.
  const std::string png =
      "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAQAAABeK7cBAAAADUlEQVR4nGM44XDiBAAGPQKZRUmNFgAAAABJRU5ErkJg"
      "gg==";
  return R"({"asset": {"version": "2.0"}, "scene": 0,
    "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
    "materials": [{)" +
         material + R"(}], "textures": [{"source": 0}],
    "images": [{"uri": "data:image/png;base64,)" +
         png + R"("}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                   "min": [0, -2, 0], "max": [3, 2, 1]},
                  {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48},
                    {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
    "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64,)" +
         data + "\"}]}";
}

// The specification asks for flat normals (glTF 2.0, section 3.7.2.1): those of the planes, which
// no vertex mixes.
TEST_F(Formats, AGltfWithoutNormalsIsFlat) {
  const fleet::Aircraft loaded = load("a.gltf", gltf_of(""));
  const model::Mesh& mesh = loaded.mesh;
  ASSERT_EQ(mesh.triangle_count(), 2u);
  // In body axes z is down and y right.
  const Eigen::Vector3f expected[] = {{0, 0, -1}, {0, -std::sqrt(0.2f), -std::sqrt(0.8f)}};
  for (std::size_t i = 0; i < 2; ++i)
    for (const std::uint32_t vertex : mesh.parts.at(0).triangles.at(i).vertex)
      EXPECT_TRUE(mesh.normals.at(vertex).isApprox(expected[i]))
          << mesh.normals[vertex].transpose();
}

TEST_F(Formats, WhatOfAGltfIsNotReadIsSaid) {
  const std::string textured =
      gltf_of(R"("pbrMetallicRoughness": {"baseColorTexture": {"index": 0}})");
  const auto warnings = [&](const std::string& from, const std::string& to) {
    std::string text = textured;
    text.replace(text.find(from), from.size(), to);
    warnings_.clear();
    load("a.gltf", text);
    return warnings_;
  };
  EXPECT_EQ(warnings("\"scene\"", "\"scene\""), "");
  EXPECT_THAT(warnings("[{\"source\": 0}]",
                       R"([{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33648}])"),
              testing::HasSubstr("mirrored beyond its edges"));
  EXPECT_THAT(
      warnings("{\"mesh\": 0}", R"({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {}}})"),
      testing::HasSubstr("EXT_mesh_gpu_instancing of glTF is not read"));
}

// Exporters write blanks of a URI as %20 (glTF 2.0, section 2.8).
TEST_F(Formats, AUriOfAGltfNamesItsFile) {
  const float points[] = {0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0, 1};
  const std::uint16_t indices[] = {0, 1, 2, 0, 3, 1};
  write_file(folder_ / "my data.bin",
             std::string(reinterpret_cast<const char*>(points), sizeof(points)) +
                 std::string(reinterpret_cast<const char*>(indices), sizeof(indices)));
  write_file(folder_ / "my picture.tga",
             std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0", 18) + "\xff\xff\xff");
  std::string text = gltf_of(R"("pbrMetallicRoughness": {"baseColorTexture": {"index": 0}})");
  const auto name = [&](const std::string& data, const std::string& file) {
    const std::size_t begin = text.find(data);
    text.replace(begin, text.find('"', begin) - begin, file);
  };
  name("data:application", "my%20data.bin");
  name("data:image", "my%20picture.tga");
  const fleet::Aircraft loaded = load("a.gltf", text);
  EXPECT_EQ(loaded.mesh.triangle_count(), 2u);
  EXPECT_NE(loaded.mesh.texture_of(loaded.mesh.materials.at(0)), nullptr);
  EXPECT_EQ(warnings_, "");
}

// glTF 2.0, section 3.9.4: alpha is opacity in the mode BLEND alone.
TEST_F(Formats, TheAlphaModeOfAGltfSaysWhatAlphaIs) {
  struct Case {
    const char* mode;
    const char* factor;
    float opacity;
    std::array<int, 2> alphas;
  };
  for (const Case& c :
       {Case{"", "0.25", 1.0f, {255, 255}},
        Case{R"("alphaMode": "OPAQUE",)", "1", 1.0f, {255, 255}},
        Case{R"("alphaMode": "BLEND",)", "0.25", 0.25f, {64, 200}},
        Case{R"("alphaMode": "MASK",)", "1", 1.0f, {0, 255}},
        Case{R"("alphaMode": "MASK", "alphaCutoff": 0.2,)", "1", 1.0f, {255, 255}},
        Case{R"("alphaMode": "MASK", "alphaCutoff": 0.2,)", "0.6", 1.0f, {0, 255}}}) {
    const fleet::Aircraft loaded = load(
        "a.gltf",
        gltf_of(std::string(c.mode) + R"("pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, )" +
                c.factor + R"(], "baseColorTexture": {"index": 0}})"));
    const model::Material& material = loaded.mesh.materials.at(0);
    EXPECT_FLOAT_EQ(material.opacity, c.opacity) << c.mode;
    const model::Texture* texture = loaded.mesh.texture_of(material);
    ASSERT_NE(texture, nullptr) << c.mode;
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_EQ(texture->finest.rgba.at(4 * i + 3), c.alphas[i]) << c.mode << c.factor;
  }
}

TEST_F(Formats, WhatIsWhollyTransparentIsRefused) {
  write_file(folder_ / "g.mtl", "newmtl m\nKd 1 0 0\nd 0\n");
  EXPECT_THAT(fault("g.obj", "mtllib g.mtl\nusemtl m\nv 0 0 0\nv 3 0 0\nv 0 2 0\nf 1 2 3\n"),
              testing::HasSubstr("g.obj: is wholly transparent"));
  // So is a model by its texture: one texel of 32 bits, of which 8 are an alpha of 0.
  write_file(folder_ / "t.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\40\10\1\2\3\0", 22));
  write_file(folder_ / "t.mtl", "newmtl m\nmap_Kd t.tga\n");
  EXPECT_THAT(
      fault("t.obj", "mtllib t.mtl\nusemtl m\nv 0 0 0\nv 3 0 0\nv 0 2 0\nvt 0 0\nf 1/1 2/1 3/1\n"),
      testing::HasSubstr("t.obj: is wholly transparent"));
}

TEST_F(Formats, ASizeOrAPlaceThatNoAircraftHasIsSaid) {
  load("mm.obj", "v 0 0 0\nv 9700 0 0\nv 0 2840 0\nf 1 2 3\n");
  EXPECT_THAT(warnings_, testing::HasSubstr("mm.obj: is 9700 m long and 2840 m wide"));
  EXPECT_THAT(warnings_, testing::HasSubstr("model_scale"));
  warnings_.clear();
  load("far.obj", "v 5000 0 0\nv 5040 0 0\nv 5000 36 0\nf 1 2 3\n");
  EXPECT_THAT(warnings_, testing::HasSubstr("far.obj: its middle lies 5020 m from its origin"));
  EXPECT_THAT(warnings_, testing::Not(testing::HasSubstr("model_scale")));
}

TEST_F(Formats, FaultsAreOneLine) {
  EXPECT_THAT(fault("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967295\n"),
              testing::HasSubstr("a.obj: cannot be read as a 3D model"));
  EXPECT_THAT(fault("a.3ds", "MM"), testing::HasSubstr("a.3ds: "));
  EXPECT_THAT(fault("a.glb", std::string("glTF\x02\0\0\0\xff\xff\xff\xff", 12)),
              testing::HasSubstr("a.glb: "));
  EXPECT_THAT(fault("a.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n"),
              testing::HasSubstr("1,000 km"));
  EXPECT_THAT(fault("a.stl", "ply\n"), testing::HasSubstr("a.stl: "));
}

}  // namespace
}  // namespace airtruth::model_reader
