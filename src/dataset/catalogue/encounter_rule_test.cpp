// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/encounter_rule.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dataset/build/plan.h"
#include "dataset/catalogue/expand.h"
#include "dataset/catalogue/folder.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "sequence/setup/flyable.h"
#include "sequence/setup/from_scene.h"
#include "support/error_of.h"
#include "support/small_encounter_model.h"
#include "support/temporary_folder.h"

namespace airtruth::catalogue {
namespace {

using testing::HasSubstr;

constexpr const char* kBackground = R"(
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 240, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -900], velocity_ned_mps = [40, 10, -1] }
[[encounter_model]]
aircraft = ["c172/*", "738/738-Ryanair", "Cub/*"]
)";

class EncounterModel : public testing::Test {
 protected:
  void SetUp() override { write_file(folder_ / "small.txt", test_support::kSmallModel); }

  Catalogue with(const std::string& keys) const {
    return parse_catalogue(kBackground + keys, folder_ / "c.toml");
  }
  std::string fault_of(const std::string& keys) const {
    return test_support::error_of([&] { with(keys); });
  }
  test_support::TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
};

// A sequence with the intruders that are drawn first, in view or not.
Item first_drawn(const Catalogue& catalogue, std::int64_t index) {
  Item item = Expansion(catalogue).at(index);
  EncounterRule rule = *item.encounter_rule;
  rule.in_view = false;
  add_encounter(item.scene, rule, index, {setup::lens_of(item.scene.lens, {160, 120}), 240, 30});
  return item;
}

constexpr const char* kBayes = "kind = \"bayes\"\nmodel = \"small.txt\"\n";

struct Closest {
  double time_s = 0, distance_m = HUGE_VAL, above_m = 0;
};
// The horizontal closest approach of the two paths as the renderer has them, in steps of 1 ms.
Closest closest_of(const scene::Scene& scene, const scene::Intruder& intruder, double end_s) {
  const trajectory::Path own = setup::camera_path(scene.camera);
  const trajectory::Path path = setup::path_of(intruder, setup::camera_path(scene.camera));
  Closest closest;
  for (double t = 0; t <= end_s; t += 1e-3) {
    const Vector3 apart = path.at(t)->position_in_world - own.at(t)->position_in_world;
    if (apart.head<2>().norm() < closest.distance_m)
      closest = {t, apart.head<2>().norm(), -apart.z()};
  }
  return closest;
}

TEST_F(EncounterModel, AStatedGeometryPassesWithinATenthOfAMetre) {
  const Catalogue catalogue = with(
      "kind = \"geometric\"\ncount = 12\ncpa_time_s = 4.3\nhmd_m = 120\nvmd_m = [-60, 60]\n"
      "speed_mps = [40, 60]\nturn_rate_dps = [-3, 3]\nclimb_mps = [-2, 2]\n");
  ASSERT_EQ(Expansion(catalogue).size(), 12);
  for (std::int64_t i = 0; i < 12; ++i) {
    const Item item = first_drawn(catalogue, i);
    ASSERT_EQ(item.scene.intruders.size(), 1u);
    EXPECT_FALSE(item.scene.weight.has_value());
    const Closest closest = closest_of(item.scene, item.scene.intruders[0], 8);
    EXPECT_NEAR(closest.distance_m, 120, 0.1) << i;
    EXPECT_NEAR(closest.time_s, 4.3, 0.1) << i;
    EXPECT_LE(std::abs(closest.above_m), 60.1) << i;
  }
}

// A weight is a speed, and a product of two would be 60 times a single one's.
TEST_F(EncounterModel, PairsAreTheShareOfTheWeightsThatTheyAreOfTheSequences) {
  const Catalogue catalogue =
      with(std::string(kBayes) + "count = 120\ntwo_intruders = 0.5\nhmd_m = [0, 500]\n");
  double single = 0, pairs = 0;
  for (std::int64_t i = 0; i < 120; ++i) {
    const Item item = first_drawn(catalogue, i);
    (item.scene.intruders.size() == 2 ? pairs : single) += item.scene.weight.value();
  }
  EXPECT_NEAR(pairs / (single + pairs), 0.5, 0.08);
}

TEST_F(EncounterModel, AGeometryThatTurnsComesNoNearerAtAnotherTime) {
  const Catalogue catalogue = with(
      "kind = \"geometric\"\ncount = 20\nhmd_m = [200, 300]\nspeed_mps = [40, 60]\n"
      "turn_rate_dps = [-40, 40]\n");
  for (std::int64_t i = 0; i < 20; ++i) {
    const Item item = first_drawn(catalogue, i);
    // The path is a spline through samples that the draw joins by straight lines.
    EXPECT_GE(closest_of(item.scene, item.scene.intruders.at(0), 8).distance_m, 185) << i;
  }
}

// The own aircraft flies north, turns after 20 s of its log, and flies east: an encounter that is
// drawn for another part of the log misses it by hundreds of metres.
TEST_F(EncounterModel, OverALogTheyPassTheCameraAsItFliesFromTheFirstFrameOn) {
  std::string log = "time_s,latitude_deg,longitude_deg,altitude_m\n";
  constexpr double kDegreesOfAMetre = 1 / 111'320.0;  // on the equator
  for (int s = 0; s <= 40; ++s)
    log += fmt::format("{},{:.9f},{:.9f},900\n",
                       s,
                       1 + kDegreesOfAMetre * 40 * std::min(s, 20),
                       1 + kDegreesOfAMetre * 40 * std::max(s - 20, 0));
  write_file(folder_ / "flight.csv", log);
  const Catalogue catalogue = parse_catalogue(
      "[[background]]\nname = \"sky\"\nvideo = \"v.mp4\"\nfirst_frame = 600\n"
      "lens = { vertical_fov_deg = 75 }\ncamera = { log = \"flight.csv\", log_offset_s = 0, "
      "position_ned_m = [0, 0, -900] }\n[[encounter_model]]\naircraft = [\"c172/*\"]\n"
      "kind = \"geometric\"\ncount = 5\nhmd_m = [0, 50]\nvmd_m = [-20, 20]\n"
      "cpa_time_s = [3, 5]\nin_view = false\n",
      folder_ / "c.toml");
  const Expansion expansion(catalogue);
  for (std::int64_t i = 0; i < 5; ++i) {
    Item item = expansion.at(i);
    scene::Camera camera = item.scene.camera;
    camera.clip_start_s = 18;  // as render finds it in the video
    place(item,
          catalogue,
          {.video = "v.mp4",
           .width = 160,
           .height = 120,
           .frame_rate_hz = 30,
           .frames = 1000,
           .camera = camera});
    const Closest closest = closest_of(item.scene, item.scene.intruders.at(0), 8);
    EXPECT_LE(closest.distance_m, 51) << i;
  }
}

TEST_F(EncounterModel, TracksOfAModelPassInTheRangeAndCarryTheirWeight) {
  const Catalogue catalogue =
      with(std::string(kBayes) +
           "count = 20\nhmd_m = [-90, 90]\nvmd_m = [-40, 40]\ncpa_time_s = [3, 5]\n");
  const Expansion expansion(catalogue);
  std::set<double> weights;
  for (std::int64_t i = 0; i < 20; ++i) {
    Item item = expansion.at(i), again = expansion.at(i);
    for (Item* each : {&item, &again}) place(*each, catalogue, {"v.mp4", {}, 160, 120, 30, 240});
    ASSERT_TRUE(item.scene.weight.has_value());
    weights.insert(*item.scene.weight);
    const scene::Intruder& intruder = item.scene.intruders.at(0);
    EXPECT_EQ(intruder.id, "intruder");
    const Closest closest = closest_of(item.scene, intruder, 8);
    EXPECT_LE(closest.distance_m, 90.1) << i;
    EXPECT_LE(std::abs(closest.above_m), 40 + 5) << i;  // climbs in what the approach is off
    // The aircraft flies its track.
    EXPECT_EQ(
        setup::words_beyond_limits(intruder.aircraft,
                                   setup::path_of(intruder, setup::camera_path(item.scene.camera)),
                                   0,
                                   8),
        "")
        << i;
    EXPECT_EQ(scene::toml_from_scene(again.scene), scene::toml_from_scene(item.scene));
    EXPECT_THAT(scene::toml_from_scene(item.scene), HasSubstr("\nweight = "));
  }
  EXPECT_GT(weights.size(), 15u);
}

TEST_F(EncounterModel, TheAircraftFitsTheSpeed) {
  for (const auto& [speed, type] :
       {std::pair("150", "738"), std::pair("50", "c172"), std::pair("28", "Cub")}) {
    const Catalogue catalogue =
        with(std::string("kind = \"geometric\"\ncount = 8\nspeed_mps = ") + speed + "\n");
    for (std::int64_t i = 0; i < 8; ++i)
      EXPECT_THAT(first_drawn(catalogue, i).scene.intruders.at(0).aircraft,
                  testing::StartsWith(std::string(type) + "/"));
  }
  // No aircraft of the rule flies 400 m/s: the fastest comes nearest, and the plan says so.
  const Catalogue fast = with("kind = \"geometric\"\ncount = 2\nspeed_mps = 400\n");
  EXPECT_THAT(first_drawn(fast, 0).scene.intruders.at(0).aircraft, testing::StartsWith("738/"));
  EXPECT_EQ(build::plan_of(fast, {}, {}).not_flyable, 2);
}

TEST_F(EncounterModel, NegativesAndSecondIntrudersAreTheSharesThatWereAskedFor) {
  const Catalogue catalogue = with(
      "kind = \"geometric\"\ncount = 200\nnegatives = 0.05\ntwo_intruders = 0.1\nvmd_m = [0, "
      "100]\n");
  int of[3] = {0, 0, 0};
  for (std::int64_t i = 0; i < 200; ++i) {
    const scene::Scene scene = first_drawn(catalogue, i).scene;
    ++of[scene.intruders.size()];
    if (scene.intruders.empty()) continue;
    EXPECT_EQ(scene.intruders[0].id, "intruder-1");
  }
  EXPECT_NEAR(of[0], 10, 1);
  EXPECT_NEAR(of[2], 19, 3);
}

TEST_F(EncounterModel, ADataSetKeepsItsModel) {
  const Catalogue catalogue = with(std::string(kBayes) + "count = 3\n");
  const fs::path root = folder_ / "set";
  open_folder(catalogue, root);
  EXPECT_EQ(read_file(root / "models" / "small.txt"), test_support::kSmallModel);
  fs::remove(folder_ / "small.txt");
  const Catalogue copy = read_catalogue(root / "catalogue.toml");
  EXPECT_EQ(first_drawn(copy, 2).scene.intruders.at(0).waypoints_ned_m,
            first_drawn(catalogue, 2).scene.intruders.at(0).waypoints_ned_m);
  open_folder(copy, root);
  write_file(folder_ / "small.txt", std::string(test_support::kSmallModel) + "\n");
  EXPECT_THROW(open_folder(catalogue, root), Error);
}

TEST_F(EncounterModel, AClipLongerThanItsTracksIsAnError) {
  const Catalogue catalogue = with("kind = \"geometric\"\ncount = 1\nframe_count = 240\n");
  Item item = Expansion(catalogue).at(0);
  BackgroundFiles files{
      .video = "v.mp4", .width = 160, .height = 120, .frame_rate_hz = 25, .frames = 240};
  EXPECT_NO_THROW(place(item, catalogue, files));
  files.frame_rate_hz = 10;
  EXPECT_THROW(place(item, catalogue, files), Error);
}

TEST_F(EncounterModel, EachFaultNamesItsLine) {
  EXPECT_THAT(fault_of("count = 3\n"), HasSubstr("c.toml:7:1: has no kind"));
  EXPECT_THAT(fault_of("kind = \"bayes\"\n"), HasSubstr("c.toml:7:1: has no model"));
  EXPECT_THAT(fault_of("kind = \"bayes\"\nmodel = \"none.txt\"\n"), HasSubstr("c.toml:10:9: "));
  EXPECT_THAT(fault_of("kind = \"markov\"\n"), HasSubstr("c.toml:9:8: kind"));
  EXPECT_THAT(fault_of(std::string(kBayes) + "speed_mps = 30\n"),
              HasSubstr("c.toml:11:13: speed_mps has no effect with kind = \"bayes\""));
  EXPECT_THAT(fault_of("kind = \"geometric\"\nmodel = \"small.txt\"\n"),
              HasSubstr("model has no effect with kind = \"geometric\""));
  EXPECT_THAT(fault_of(std::string(kBayes) + "airspaces = [4]\n"),
              HasSubstr("has no airspace class; expected no cut by it"));
  EXPECT_THAT(fault_of(std::string(kBayes) + "domains = [1.5]\n"),
              HasSubstr("expected whole numbers"));
  EXPECT_THAT(fault_of(std::string(kBayes) + "hmd_m = 50\n"), HasSubstr("expected a range"));
  EXPECT_THAT(fault_of("kind = \"geometric\"\nhmd_m = [9, 3]\n"),
              HasSubstr("c.toml:10:9: hmd_m is 9 3; expected one number, or the increasing edges"));
  EXPECT_THAT(fault_of("kind = \"geometric\"\nhmd_shares = [1]\n"),
              HasSubstr("hmd_shares is for hmd_m"));
  EXPECT_THAT(fault_of("kind = \"geometric\"\ncpa_time_s = 99\n"),
              HasSubstr("outside of the clip"));
  EXPECT_THAT(fault_of("kind = \"geometric\"\nspeed_mps = 0\n"),
              HasSubstr("speed_mps is 0; expected metres a second from 0.001"));
  EXPECT_THAT(fault_of("kind = \"geometric\"\nnegatives = 2\n"), HasSubstr("a share from 0 to 1"));
  EXPECT_THAT(fault_of("kind = \"geometric\"\nname = \"e\"\n"), HasSubstr("name has no {index}"));
  EXPECT_THAT(fault_of("kind = \"geometric\"\nname = \"{background}-{index}\"\n"),
              HasSubstr("name has the part '{background}'; expected {index}"));
  EXPECT_THAT(fault_of("kind = \"geometric\"\nspeed = 2\n"), HasSubstr("unknown key 'speed'"));
}

TEST_F(EncounterModel, ATrackBelowTheGroundIsRefusedOrDrawnAgain) {
  const std::string low = "vmd_m = [-890, -880]\n";
  const Catalogue stated = with("kind = \"geometric\"\n" + low);
  EXPECT_THROW(first_drawn(stated, 0), Error);
  const Catalogue drawn = with(std::string(kBayes) + low);
  EXPECT_THROW(first_drawn(drawn, 0), Error);
  for (const std::string& kind : {std::string(kBayes), std::string("kind = \"geometric\"\n")}) {
    const Catalogue some = with(kind + "count = 10\nvmd_m = [-1800, 0]\n");
    for (std::int64_t i = 0; i < 10; ++i) {
      const Item item = first_drawn(some, i);
      for (const Vector3& position : item.scene.intruders.at(0).waypoints_ned_m)
        EXPECT_LE(position.z(), -30) << kind;
    }
  }
}

const BackgroundFiles kFilesOfSky = {
    .video = "sky.mkv", .width = 160, .height = 120, .frame_rate_hz = 30, .frames = 240};

// The pinhole of kBackground by its angles: tan of half of 75 degrees upright, 4/3 of it across.
double in_view_s(const Item& item, int within = 240) {
  const trajectory::Path own = setup::camera_path(item.scene.camera);
  const trajectory::Path path = setup::path_of(item.scene.intruders[0], own);
  const double up = std::tan(radians(37.5));
  int frames = 0;
  for (int i = 0; i < within; ++i) {
    const auto camera = own.at(i / 30.0);
    const Vector3 p = camera->world_from_body.conjugate() *
                      (path.at(i / 30.0)->position_in_world - camera->position_in_world);
    frames += p.x() > 0 && std::abs(p.z()) < up * p.x() && std::abs(p.y()) < up * 4 / 3 * p.x();
  }
  return frames / 30.0;
}

TEST_F(EncounterModel, AnIntruderIsDrawnUntilTheCameraSeesIt) {
  for (const std::string keys : {"kind = \"geometric\"\ncount = 30\n",
                                 "kind = \"bayes\"\nmodel = \"small.txt\"\ncount = 8\n"}) {
    const Catalogue seen = with(keys + "seen_s = 2.5\n");
    const Catalogue any = with(keys + "in_view = false\n");
    std::int64_t draws = 0, unseen_of_any = 0;
    for (std::int64_t i = 0; i < Expansion(seen).size(); ++i) {
      Item item = Expansion(seen).at(i);
      const Draws of_one = draw_in_view(item, seen, kFilesOfSky);
      draws += of_one.drawn;
      EXPECT_EQ(of_one.unseen, 0);
      EXPECT_GE(in_view_s(item), 2.5 - 1e-9) << i;
      Item placed = Expansion(seen).at(i);
      place(placed, seen, kFilesOfSky);
      EXPECT_EQ(placed.scene.intruders[0].waypoints_ned_m, item.scene.intruders[0].waypoints_ned_m);
      Item first = Expansion(any).at(i);
      EXPECT_EQ(draw_in_view(first, any, kFilesOfSky).drawn, 0);
      unseen_of_any += in_view_s(first) < 2.5 ? 1 : 0;
    }
    EXPECT_GT(unseen_of_any, 0);
    EXPECT_GE(draws, Expansion(seen).size() + unseen_of_any);
  }
}

// What would be seen after the end of the background is not.
TEST_F(EncounterModel, ViewsEndWithTheBackground) {
  const Catalogue catalogue = with("kind = \"geometric\"\ncount = 30\nseen_s = 2.5\n");
  BackgroundFiles files = kFilesOfSky;
  files.frames = 120;
  for (std::int64_t i = 0; i < Expansion(catalogue).size(); ++i) {
    Item item = Expansion(catalogue).at(i);
    const Draws draws = draw_in_view(item, catalogue, files);
    if (draws.unseen == 0) {
      EXPECT_GE(in_view_s(item, 120), 2.5 - 1e-9) << i;
    }
  }
}

// 120 frames at 60 a second and 120 at five, which the average of the rate does not tell.
TEST_F(EncounterModel, AClipOfAVariableRateIsAsLongAsItsFramesSay) {
  const Catalogue catalogue = with("kind = \"geometric\"\ncount = 1\n");
  BackgroundFiles files = kFilesOfSky;
  for (int k = 0; k < 240; ++k) files.times_s.push_back(k < 120 ? k / 60.0 : 2 + (k - 120) / 5.0);
  Item item = Expansion(catalogue).at(0);
  EXPECT_THAT(test_support::error_of([&] { place(item, catalogue, files); }),
              HasSubstr("240 frames at 9.29 a second are 25.8 s"));
}

TEST_F(EncounterModel, WhatIsNeverInViewIsCounted) {
  const Catalogue catalogue = with("kind = \"geometric\"\ncount = 3\nvmd_m = 50000\n");
  const build::Plan plan = build::plan_of(catalogue, {}, {});
  EXPECT_EQ(plan.never_in_view, 3);
  EXPECT_EQ(plan.draws, 3 * static_cast<std::int64_t>(kMostDraws));
  EXPECT_THAT(fault_of("kind = \"geometric\"\nin_view = false\nseen_s = 3\n"),
              HasSubstr("seen_s is for in_view = true"));
}

// The camera turns from north to east in ten seconds, and no motion is measured yet.
TEST_F(EncounterModel, WhatIsInViewFollowsTheAttitudeOfAPathFile) {
  std::string path = "time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg\n";
  for (int i = 0; i <= 10; ++i) path += fmt::format("{},{},0,-100,{},0,0\n", i, i, 9 * i);
  write_file(folder_ / "own.csv", path);
  scene::Camera camera;
  camera.path_file = folder_ / "own.csv";
  scene::Intruder intruder;
  intruder.aircraft = "c172/c-fgfs";
  intruder.position_ned_m = Vector3(0, 1000, -100);
  const lens::Lens lens(lens::Pinhole{{100, 100}, {100, 100}}, {200, 200});  // 90 degrees wide
  const auto frames = frames_in_view(intruder, camera, {lens, 241, 24});
  ASSERT_FALSE(frames.empty());
  EXPECT_NEAR(static_cast<double>(frames.front()), 120, 3);  // at 45 degrees
  EXPECT_EQ(frames.back(), 240);
}

// 9 sequences of three types, and of backgrounds whose weights are 1 and 2.
TEST_F(EncounterModel, TypesAndBackgroundsComeInTheirShares) {
  const std::string second = R"([[background]]
name = "other"
weight = 2
flight = { seed = 4, frame_count = 240, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -900], velocity_ned_mps = [40, 10, -1] }
)";
  const Catalogue catalogue = parse_catalogue(
      second + kBackground + "kind = \"geometric\"\ncount = 9\n", folder_ / "c.toml");
  std::map<std::string, int> types;
  std::map<std::size_t, int> backgrounds;
  for (std::int64_t i = 0; i < 9; ++i) {
    Item item = Expansion(catalogue).at(i);
    ++backgrounds[item.background];
    draw_in_view(item, catalogue, kFilesOfSky);
    const std::string name = item.scene.intruders[0].aircraft;
    ++types[name.substr(0, name.find('/'))];
  }
  EXPECT_THAT(types,
              testing::ElementsAre(
                  testing::Pair("738", 3), testing::Pair("Cub", 3), testing::Pair("c172", 3)));
  EXPECT_THAT(backgrounds, testing::ElementsAre(testing::Pair(0, 6), testing::Pair(1, 3)));
}

}  // namespace
}  // namespace airtruth::catalogue
