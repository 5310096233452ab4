// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/shared_inputs.h"

#include <array>
#include <set>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/geometry/units.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"
#include "support/temporary_folder.h"

namespace airtruth::setup {
namespace {

scene::Intruder intruder_of(const std::string& aircraft) {
  scene::Intruder intruder;
  intruder.id = "a";
  intruder.aircraft = aircraft;
  return intruder;
}

trajectory::Path straight_at(double speed_mps) {
  scene::Intruder intruder;
  intruder.waypoints_ned_m = {{100, 0, -1000}, {400, 0, -1000}};
  intruder.speed_mps = speed_mps;
  return path_of(intruder, camera_path({}));
}

class SharedInputsTest : public testing::Test {
 protected:
  // A triangle in FlightGear's axes, `span_m` wide.
  std::string triangle(double span_m) const {
    const std::string side = std::to_string(span_m / 2);
    write_file(root_ / "t.ac",
               "AC3Db\nMATERIAL \"w\" rgb 1 1 1 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 0 trans 0\n"
               "OBJECT world\nkids 1\nOBJECT poly\nname \"t\"\nnumvert 3\n0 0 -" +
                   side + "\n0 0 " + side +
                   "\n-4 0 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 1 0\n2 0 1\nkids 0\n");
    return (root_ / "t.ac").string();
  }

  test_support::TemporaryFolder temporary_;
  fs::path root_ = temporary_.path();
};

TEST_F(SharedInputsTest, OneAircraftInOneConfigurationIsLoadedOnce) {
  SharedInputs shared;
  // Gear up above 180 knots, by the model's own wrapper.
  const scene::Intruder intruder = intruder_of("738/738-Ryanair");
  const auto fast = shared.type_of(intruder, straight_at(250 * kMpsOfKnot), {}, {});
  EXPECT_EQ(shared.type_of(intruder, straight_at(300 * kMpsOfKnot), {}, {}), fast);
  const auto slow = shared.type_of(intruder, straight_at(150 * kMpsOfKnot), {}, {});
  EXPECT_NE(slow, fast);
  EXPECT_GT(slow->aircraft->mesh.triangle_count(), fast->aircraft->mesh.triangle_count());
  EXPECT_EQ(shared.kept(), 2u);
  std::set<const model::Texture*> of_both;
  for (const auto& type : {slow, fast})
    for (const model::SharedTexture& texture : type->aircraft->mesh.textures)
      of_both.insert(texture.get());
  EXPECT_EQ(of_both.size(), slow->aircraft->mesh.textures.size());
  EXPECT_GT(of_both.size(), 0u);
  // The same as loaded alone.
  const auto alone = aircraft_of(intruder, straight_at(300 * kMpsOfKnot), {});
  EXPECT_EQ(alone.mesh, fast->aircraft->mesh);
  EXPECT_EQ(alone.sources, fast->aircraft->sources);
}

TEST_F(SharedInputsTest, SizesThatDifferInTheSeventhDecimalAreTwoAircraft) {
  SharedInputs shared;
  scene::Intruder intruder = intruder_of(triangle(8e5));
  const auto span_m = [&](double scale) {
    intruder.model_scale = scale;
    return model::extents(shared.type_of(intruder, straight_at(50), {}, {})->aircraft->mesh)
        .span_m();
  };
  EXPECT_NEAR(span_m(1.4e-6) / span_m(1.2e-6), 1.4 / 1.2, 1e-6);
}

TEST_F(SharedInputsTest, ThreadsThatWantOneAircraftGetOne) {
  SharedInputs shared;
  const scene::Intruder intruder = intruder_of("c172/news");
  std::array<std::shared_ptr<const Type>, 4> types;
  {
    std::vector<std::jthread> threads;
    for (auto& type : types)
      threads.emplace_back([&] { type = shared.type_of(intruder, straight_at(60), {}, {}); });
  }
  for (const auto& type : types) EXPECT_EQ(type, types[0]);
}

TEST_F(SharedInputsTest, AFileThatHasChangedIsReadAgain) {
  SharedInputs shared;
  const scene::Intruder intruder = intruder_of(triangle(10));
  const auto first = shared.type_of(intruder, straight_at(60), {}, {});
  const std::string before = shared.sha256_of_file(intruder.aircraft);
  EXPECT_EQ(before, airtruth::sha256_of_file(intruder.aircraft));
  triangle(12.5);
  const auto second = shared.type_of(intruder, straight_at(60), {}, {});
  EXPECT_DOUBLE_EQ(model::extents(first->aircraft->mesh).span_m(), 10);
  EXPECT_DOUBLE_EQ(model::extents(second->aircraft->mesh).span_m(), 12.5);
  EXPECT_EQ(shared.sha256_of_file(intruder.aircraft), airtruth::sha256_of_file(intruder.aircraft));
  EXPECT_NE(shared.sha256_of_file(intruder.aircraft), before);
}

TEST_F(SharedInputsTest, WhatNoSequenceUsesIsDroppedBeyondTheLimit) {
  SharedInputs shared({}, 1);
  auto used = shared.type_of(intruder_of("c172/news"), straight_at(60), {}, {});
  EXPECT_EQ(shared.kept(), 1u);  // in use
  shared.type_of(intruder_of(triangle(10)), straight_at(60), {}, {});
  EXPECT_EQ(shared.type_of(intruder_of("c172/news"), straight_at(60), {}, {}), used);
  used.reset();
  shared.type_of(intruder_of(triangle(11)), straight_at(60), {}, {});
  EXPECT_LE(shared.kept(), 1u);
}

TEST_F(SharedInputsTest, WhatIsDroppedIsForgotten) {
  SharedInputs shared({}, 1);
  scene::Intruder bird;
  bird.id = "b";
  bird.distractor.emplace();
  for (int i = 0; i < 20; ++i) {
    bird.distractor->size_m = 1 + 0.01 * i;
    shared.type_of(bird, straight_at(10), {}, {});
  }
  EXPECT_LE(shared.remembered(), 2u);
}

// Distractors of one shape share their ambient occlusion, which is by triangle.
TEST_F(SharedInputsTest, DistractorsOfAnySizeHaveTheTrianglesOfTheirShape) {
  SharedInputs shared;
  scene::Intruder intruder;
  for (const auto kind : {scene::DistractorKind::kBird,
                          scene::DistractorKind::kMultirotor,
                          scene::DistractorKind::kBalloon})
    for (const double size_m : {0.05, 0.3, 0.5, 0.59, 0.6, 1.0, 3.0, 10.0})
      for (const int rotors : {4, 6, 8}) {
        intruder.distractor = scene::usual_distractor(kind, size_m);
        intruder.distractor->rotors = rotors;
        intruder.distractor->colour = {0.3, 0.4, 0.5};
        EXPECT_NO_THROW(shared.type_of(intruder, straight_at(10), {}, {})) << size_m;
      }
}

TEST_F(SharedInputsTest, EveryCallPassesTheWarnings) {
  std::vector<std::string> first, second;
  SharedInputs shared;
  const scene::Intruder intruder = intruder_of("738/738-Ryanair");
  const auto into = [](std::vector<std::string>& list) {
    return [&list](const std::string& text) { list.push_back(text); };
  };
  shared.type_of(intruder, straight_at(120), into(first), {});
  shared.type_of(intruder, straight_at(130), into(second), {});
  EXPECT_EQ(first, second);
}

TEST_F(SharedInputsTest, AnAircraftThatIsMissingIsAnErrorEachTime) {
  SharedInputs shared;
  for (int i = 0; i < 2; ++i)
    EXPECT_THROW(shared.type_of(intruder_of("738/none"), straight_at(60), {}, {}), Error);
}

// The text is the same exactly where the loaded aircraft is.
TEST(Configuration, FollowsTheLimitsOfTheWrapper) {
  const auto at = [](double airspeed_kt, double altitude_agl_ft = 3000) {
    model::LoadOptions options;
    options.airspeed_kt = airspeed_kt;
    options.altitude_agl_ft = altitude_agl_ft;
    return fleet::configuration_of("738/738-Ryanair", options);
  };
  EXPECT_EQ(at(250), at(251.5));
  EXPECT_EQ(at(250), at(250, 30'000));
  EXPECT_NE(at(170), at(190));  // gear
  EXPECT_NE(at(75), at(80));    // the nose, which is turned by a table between 70 and 90
}

// The wheels of most wrappers turn with the airspeed, and those of no model do.
TEST(Configuration, IsThatOfWhatTheModelShows) {
  // The airspeed blends the discs of these propellers, and a disc is as faint whatever blends it.
  std::set<std::string> types = {"c182", "c182rg"};
  for (const fleet::Entry& entry : fleet::list_aircraft()) {
    if (!types.insert(entry.name.substr(0, entry.name.find('/'))).second) continue;
    model::LoadOptions slower;
    slower.airspeed_kt = 250;
    slower.altitude_agl_ft = 3000;
    model::LoadOptions faster = slower;
    faster.airspeed_kt = 251.5;
    if (fleet::configuration_of(entry.name, slower) == fleet::configuration_of(entry.name, faster))
      continue;
    EXPECT_FALSE(fleet::load_aircraft(entry.name, slower).mesh ==
                 fleet::load_aircraft(entry.name, faster).mesh)
        << entry.name;
  }
}

TEST(Configuration, OfABareModelFileIsEmpty) {
  EXPECT_EQ(fleet::configuration_of("some/file.obj", {}), "");
  EXPECT_NE(fleet::configuration_of("some/file.xml", {}), "");
}

}  // namespace
}  // namespace airtruth::setup
