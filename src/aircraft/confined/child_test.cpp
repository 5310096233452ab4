// SPDX-License-Identifier: Apache-2.0
// Untrusted models, read in the child process airtruth-model-reader.
#include "aircraft/confined/child.h"

#include <chrono>
#include <cmath>
#include <stop_token>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "aircraft/confined/protocol.h"
#include "aircraft/fleet/fleet.h"
#include "aircraft/wrapper/model_files.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/environment_variable.h"
#include "support/error_of.h"

namespace airtruth::confined {
namespace {

using model::RawModel;

const std::string kPlainAc =
    "AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 0 trans 0\n"
    "OBJECT world\nkids 1\nOBJECT poly\nnumvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x20\n"
    "mat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 0\nkids 0\n";

std::string with_texture(const std::string& name) {
  std::string text = kPlainAc;
  return text.insert(text.find("numvert"), "texture \"" + name + "\"\n");
}

class Strangers : public testing::Test {
 protected:
  Strangers()
      : outside_(fs::temp_directory_path() / ("airtruth_strangers_" + std::to_string(::getpid()))),
        folder_(outside_ / "model") {
    fs::create_directories(folder_ / "below");
  }
  ~Strangers() override { fs::remove_all(outside_); }

  // The message of the Error; the number of triangles where loading succeeds.
  std::string said(const std::string& file, const model::LoadOptions& options = {}) const {
    try {
      return std::to_string(
          fleet::load_aircraft((folder_ / file).string(), options).mesh.triangle_count());
    } catch (const Interrupted&) {
      return "interrupted";
    } catch (const Error& error) {
      return error.what();
    }
  }

  fs::path outside_;
  fs::path folder_;
  const test_support::EnvironmentVariable cache_{"XDG_CACHE_HOME", outside_ / "cache"};
};

TEST_F(Strangers, NothingIsRunAndNoPluginIsChosenByAName) {
  const fs::path lua = folder_ / "e.lua";
  const fs::path sign = outside_ / "pwned";
  write_file(lua, "os.execute(\"touch " + sign.string() + "\")");
  write_file(folder_ / "tex.ac", with_texture("e.lua"));
  EXPECT_THAT(said("tex.ac"), testing::HasSubstr("tex.ac:6: wants the texture"));
  EXPECT_THAT(said("tex.ac"), testing::HasSubstr("expected PNG, JPEG, WebP, BMP, SGI or TGA"));
  write_file(folder_ / "w.xml", "<PropertyList><path>e.lua</path></PropertyList>");
  EXPECT_THAT(said("w.xml"), testing::HasSubstr("e.lua: is no 3D model that can be read"));
  for (const char* scene : {"p.osgt", "p.osgb", "p.ive", "p.OSG"}) {
    write_file(folder_ / scene, "#Ascii Scene\nosg::Group { Children 1 { } }\n");
    EXPECT_THAT(said(scene), testing::HasSubstr("is a scene of OpenSceneGraph")) << scene;
  }
  EXPECT_FALSE(fs::exists(sign));
}

TEST_F(Strangers, PathsStayBelowTheModelsFolder) {
  write_file(outside_ / "secret.ac", kPlainAc);
  write_file(outside_ / "secret.xml", "<PropertyList><path>a.ac</path></PropertyList>");
  write_file(folder_ / "below/a.ac", kPlainAc);
  const auto wrapper = [&](const std::string& path, const std::string& attribute = "") {
    write_file(folder_ / "w.xml",
               "<PropertyList" + attribute + "><path>" + path + "</path></PropertyList>");
    return said("w.xml");
  };
  EXPECT_EQ(wrapper("below/a.ac"), "1");
  EXPECT_EQ(wrapper("below/../below/a.ac"), "1");
  EXPECT_THAT(wrapper("../secret.ac"), testing::HasSubstr("names the model ../secret.ac, which"));
  EXPECT_THAT(wrapper((outside_ / "secret.ac").string()),
              testing::HasSubstr("which does not exist"));
  EXPECT_THAT(wrapper("below/a.ac", " include=\"../secret.xml\""),
              testing::HasSubstr("lies outside the folder"));
  fs::create_symlink(outside_ / "secret.ac", folder_ / "link.ac");
  EXPECT_THAT(wrapper("link.ac"), testing::HasSubstr("which does not exist"));
  EXPECT_THAT(said("link.ac"), testing::HasSubstr("through a symbolic link"));
  fs::create_symlink("below/a.ac", folder_ / "inner.ac");
  EXPECT_EQ(said("inner.ac"), "1");
  ASSERT_EQ(::mkfifo((folder_ / "fifo.ac").c_str(), 0600), 0);
  EXPECT_THAT(said("fifo.ac"), testing::HasSubstr("no regular file"));
}

TEST_F(Strangers, AReaderThatBreaksLiesOrHangsIsOneLine) {
  write_file(folder_ / "a.ac", kPlainAc);
  const fs::path program = outside_ / "reader";
  const test_support::EnvironmentVariable reader("AIRTRUTH_MODEL_READER", program);
  const auto with_reader = [&](const std::string& script) {
    write_file(program, "#!/bin/sh\n" + script + "\n");
    fs::permissions(program, fs::perms::owner_all);
  };
  with_reader("exit 3");
  EXPECT_THAT(said("a.ac"), testing::HasSubstr("a.ac: cannot be read as a 3D model: its reader"));
  with_reader("kill -SEGV $$");
  EXPECT_THAT(said("a.ac"), testing::HasSubstr("broke on it"));
  with_reader("printf '\\006\\377\\377\\377\\377\\377\\377\\377\\377' >&0");
  EXPECT_THAT(said("a.ac"), testing::HasSubstr("too long"));
  with_reader("printf '\\006\\003\\0\\0\\0\\0\\0\\0\\0abc' >&0");
  EXPECT_THAT(said("a.ac"), testing::HasSubstr("handed back too few bytes"));
  with_reader("printf '\\077\\0\\0\\0\\0\\0\\0\\0\\0' >&0");
  EXPECT_THAT(said("a.ac"), testing::HasSubstr("say what it should not"));
  {
    const test_support::EnvironmentVariable none("AIRTRUTH_MODEL_READER", outside_ / "none");
    EXPECT_THAT(said("a.ac"), testing::HasSubstr("AIRTRUTH_MODEL_READER"));
  }
  with_reader("exec sleep 60");
  std::stop_source stop;
  model::LoadOptions options;
  options.stop = stop.get_token();
  std::jthread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    stop.request_stop();
  });
  EXPECT_EQ(said("a.ac", options), "interrupted");
}

TEST_F(Strangers, AModelIsReadOnceAndAgainWhenAnyFileChanges) {
  write_file(folder_ / "below/b.ac", kPlainAc);
  write_file(folder_ / "w.xml", "<PropertyList><path>below/b.ac</path></PropertyList>");
  // A reader that is the same program throughout, and breaks where it is told to.
  const fs::path reader = outside_ / "reader";
  const fs::path broken = outside_ / "broken";
  write_file(reader,
             "#!/bin/sh\n[ -e " + broken.string() + " ] && exit 3\nexec " +
                 model_reader_program().string() + " \"$@\"\n");
  fs::permissions(reader, fs::perms::owner_all);
  const test_support::EnvironmentVariable used("AIRTRUTH_MODEL_READER", reader);
  EXPECT_EQ(said("w.xml"), "1");
  write_file(broken, "");
  EXPECT_EQ(said("w.xml"), "1");  // from the cache: no reader is started
  EXPECT_EQ(fleet::load_aircraft((folder_ / "w.xml").string()).sources.size(), 2u);
  EXPECT_THAT(said("w.xml", {.airspeed_kt = 100}), testing::HasSubstr("code 3"));
  // A file that the model includes has changed, and a texture that was missing now exists.
  write_file(folder_ / "below/b.ac", kPlainAc + "\n");
  EXPECT_THAT(said("w.xml"), testing::HasSubstr("code 3"));
  write_file(folder_ / "below/b.ac", kPlainAc);
  EXPECT_EQ(said("w.xml"), "1");
  // An incomplete or modified entry is not used.
  const fs::path models = outside_ / "cache/airtruth/models";
  ASSERT_TRUE(fs::is_directory(models));
  for (const auto& entry : fs::directory_iterator(models)) {
    std::string bytes = read_file(entry.path());
    bytes.back() = static_cast<char>(bytes.back() ^ 1);
    write_file(entry.path(), bytes);
  }
  EXPECT_THAT(said("w.xml"), testing::HasSubstr("code 3"));
}

RawModel small_model() {
  RawModel model;
  model.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  model.mesh.normals.assign(3, Eigen::Vector3f(0, 0, 1));
  model.mesh.uvs.assign(3, Eigen::Vector2f(0, 0));
  model.mesh.materials.emplace_back().texture = 0;
  model.mesh.parts.push_back({.name = "airframe"});
  model.mesh.parts[0].triangles.push_back({{0, 1, 2}, 0});
  model.pictures.push_back({{1, 1, {1, 2, 3, 4}}, true, false});
  model.warnings = {"a warning"};
  return model;
}

TEST(ModelWire, ComesBackAsItWas) {
  const RawModel model = small_model();
  const RawModel back = model_from_bytes(bytes_of(model));
  EXPECT_EQ(back.mesh.positions, model.mesh.positions);
  EXPECT_EQ(back.mesh.parts[0].triangles[0].vertex, model.mesh.parts[0].triangles[0].vertex);
  EXPECT_EQ(back.pictures[0].picture.rgba, model.pictures[0].picture.rgba);
  EXPECT_FALSE(back.pictures[0].repeat_v);
  EXPECT_EQ(back.warnings, model.warnings);
}

TEST(ModelWire, WhatDoesNotHoldIsRefused) {
  const auto refused = [](const auto& spoil) {
    RawModel model = small_model();
    spoil(model);
    return test_support::error_of([&] { model_from_bytes(bytes_of(model)); });
  };
  EXPECT_EQ(refused([](RawModel&) {}), "no error");
  const float nan = std::nanf("");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.positions[1].y() = nan; }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.positions[1].y() = 1e7f; }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.normals[1] *= 2; }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.uvs[1].x() = nan; }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.normals.pop_back(); }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.materials[0].texture = 1; }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.materials[0].opacity = 2; }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.parts[0].triangles[0].vertex[2] = 3; }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.parts[0].triangles[0].material = 1; }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.pictures[0].picture.width = 2; }), "no error");
  EXPECT_NE(refused([&](RawModel& m) { m.mesh.parts.clear(); }), "no error");
}

// With any byte changed and at any length, the result is an Error or a valid model.
TEST(ModelWire, AnyBytesAreAnErrorOrAModel) {
  const std::string bytes = bytes_of(small_model());
  int refused = 0;
  const auto try_bytes = [&](const std::string& given) {
    try {
      model::check_model(model_from_bytes(given));
    } catch (const Error&) {
      ++refused;
    }
  };
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    try_bytes(bytes.substr(0, i));
    for (const char c : {'\x00', '\x01', '\x7f', '\xff'}) {
      std::string changed = bytes;
      changed[i] = c;
      try_bytes(changed);
    }
  }
  EXPECT_GT(refused, static_cast<int>(bytes.size()));
}

}  // namespace
}  // namespace airtruth::confined
