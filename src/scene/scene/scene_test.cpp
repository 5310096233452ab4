// SPDX-License-Identifier: Apache-2.0
#include "scene/scene/scene.h"

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "scene/scene/camera_keys.h"
#include "scene/scene/table_reader.h"
#include "support/error_of.h"
#include "support/source_folder.h"

namespace airtruth::scene {
namespace {

// The scene of the E-Vision paper's sequence 1LRB737, as a user writes it.
constexpr std::string_view kPaper = R"(
name = "1LRB737"
seed = 7
[background]
video = "flight.mp4"
mask = "../own.png"
first_frame = 10
frame_count = 322
[lens]
model = "pinhole"
vertical_fov_deg = 90
[camera]
position_ned_m = [0, 0.5, -150]
velocity_ned_mps = [40, 0, 0]
attitude_yaw_pitch_roll_deg = [1, 2, 3]
[motion]
model = "homography"
reference = "smoothed"
[light]
sun_azimuth_deg = 120
sun_elevation_deg = 40
[[intruder]]
id = "b737"
aircraft = "738/738-Ryanair"
waypoints_ned_m = [[700, -900, -350], [760, -300, -355.25], [800, 500, -360]]
speed_mps = 140
[[intruder]]
aircraft = "models/plane.OBJ"
model_forward = "-x"
model_up = "z"
model_scale = 0.3048
spin_time_s = 0.25
waypoints_ned_m = [[1, 2, 3], [4, 5, 6]]
times_s = [0.1, 1e-3e]
)";

std::string paper() {
  std::string text(kPaper);
  return text.replace(text.find("1e-3e"), 5, "12.5");
}

TEST(Scene, EveryValueArrives) {
  const Scene scene = parse_scene(paper(), "/data/scenes/a.toml");
  EXPECT_EQ(scene.name, "1LRB737");
  EXPECT_EQ(scene.seed, 7u);
  EXPECT_EQ(scene.background.video, "/data/scenes/flight.mp4");
  EXPECT_EQ(scene.background.mask, "/data/own.png");
  EXPECT_EQ(scene.background.first_frame, 10);
  EXPECT_EQ(scene.background.frame_count, 322);
  EXPECT_EQ(scene.lens.vertical_fov_deg, 90.0);
  EXPECT_EQ(scene.camera.position_ned_m, Vector3(0, 0.5, -150));
  EXPECT_EQ(scene.camera.attitude_yaw_pitch_roll_deg->pitch_deg, 2);
  EXPECT_EQ(scene.motion.reference, MotionReference::kSmoothed);
  EXPECT_EQ(scene.light.sun_azimuth_deg, 120);
  ASSERT_EQ(scene.intruders.size(), 2u);
  EXPECT_EQ(scene.intruders[0].waypoints_ned_m.at(1), Vector3(760, -300, -355.25));
  EXPECT_EQ(scene.intruders[0].speed_mps, 140.0);
  EXPECT_EQ(scene.intruders[0].aircraft, "738/738-Ryanair");
  EXPECT_EQ(scene.intruders[1].aircraft, "/data/scenes/models/plane.OBJ");
  EXPECT_EQ(scene.intruders[1].times_s, (std::vector<double>{0.1, 12.5}));
}

TEST(Scene, WhatIsNotSaidHasItsDefault) {
  const Scene scene = parse_scene(paper(), "a.toml");
  EXPECT_EQ(scene.intruders[1].id, "intruder-2");
  EXPECT_EQ(scene.composite.method, CompositeMethod::kMatte);
  EXPECT_EQ(scene.output.video, image::VideoFormat::kMp4);
  EXPECT_EQ(scene.output.quality, 18);
  EXPECT_EQ(scene.output.encoder, image::VideoEncoder::kX264);
  EXPECT_EQ(scene.render.quality, 3);
  EXPECT_FALSE(scene.light.exposure);
  std::string unnamed = paper();
  unnamed.erase(unnamed.find("name"), std::string("name = \"1LRB737\"").size());
  EXPECT_EQ(parse_scene(unnamed, "far/away/my flight.toml").name, "my flight");
}

TEST(Scene, TablesKnowWhereTheyStand) {
  const Scene scene = parse_scene(paper(), "a.toml");
  EXPECT_EQ(to_string(scene.lens.where), "a.toml:9:1");
  EXPECT_EQ(to_string(scene.intruders[1].where), "a.toml:27:1");
}

TEST(Scene, EffectiveSceneReadsBackTheSame) {
  const Scene scene = parse_scene(paper(), "/data/scenes/a.toml");
  const std::string text = toml_from_scene(scene);
  const Scene again = parse_scene(text, "/elsewhere/b.toml");
  EXPECT_EQ(toml_from_scene(again), text);
  EXPECT_EQ(again.name, scene.name);
  EXPECT_EQ(again.background.mask, scene.background.mask);
  EXPECT_EQ(again.intruders[1].aircraft, scene.intruders[1].aircraft);
  EXPECT_EQ(again.intruders[1].times_s, scene.intruders[1].times_s);
  EXPECT_EQ(again.intruders[0].waypoints_ned_m, scene.intruders[0].waypoints_ned_m);
  EXPECT_EQ(again.camera.position_ned_m, scene.camera.position_ned_m);
}

TEST(Scene, AwkwardTextsAndNumbersReadBackTheSame) {
  Scene scene = parse_scene(paper(), "/data/a.toml");
  scene.name = "quote \" back \\ \xc3\xa9 #";
  scene.background.video = "/data/it's \"here\".mp4";
  scene.light.exposure = 1e4;
  scene.light.sky_colour = {0.1, 1.0 / 3.0, 1e-17};
  scene.light.ground_albedo = 0.7;
  scene.lens = Lens{};
  scene.lens.model = lens::ModelKind::kBrownConrady;
  scene.lens.focal_px = {480.25, 1e6};
  scene.lens.principal_point_px = {-0.5, 1e-16};
  scene.lens.distortion = {-0.3, 0.1, 0.0, 1e-9, 5};
  scene.camera.path_file = "/data/own.csv";
  scene.intruders[0].yaw_deg = -179.9999999999;
  scene.intruders[1].path_file = "/data/p.csv";
  const Scene again = parse_scene(toml_from_scene(scene), "/elsewhere/b.toml");
  EXPECT_EQ(again.name, scene.name);
  EXPECT_EQ(again.background.video, scene.background.video);
  EXPECT_EQ(again.light.exposure, scene.light.exposure);
  EXPECT_EQ(again.light.sky_colour, scene.light.sky_colour);
  EXPECT_EQ(again.light.ground_albedo, scene.light.ground_albedo);
  EXPECT_EQ(again.lens.focal_px, scene.lens.focal_px);
  EXPECT_EQ(again.lens.principal_point_px, scene.lens.principal_point_px);
  EXPECT_EQ(again.lens.distortion, scene.lens.distortion);
  EXPECT_EQ(again.camera.path_file, scene.camera.path_file);
  EXPECT_EQ(again.intruders[0].yaw_deg, scene.intruders[0].yaw_deg);
  EXPECT_EQ(again.intruders[1].path_file, scene.intruders[1].path_file);
  EXPECT_TRUE(again.intruders[1].waypoints_ned_m.empty());
  EXPECT_EQ(toml_from_scene(again), toml_from_scene(scene));
}

TEST(Scene, WeatherIsReadAndWrittenAgain) {
  const Scene scene = parse_scene(
      "[background]\nvideo = \"a.mp4\"\n[lens]\nvertical_fov_deg = 60\n[air]\nextinction_per_km = "
      "[0.4, 0.5, 0.6]\n[weather]\nexposure = 1.2\nsun_share = 0\n",
      "/s.toml");
  EXPECT_EQ(scene.weather.exposure, 1.2);
  EXPECT_EQ(scene.weather.sun_share, 0);
  EXPECT_FALSE(scene.weather.blur);
  const Scene again = parse_scene(toml_from_scene(scene), "/s.toml");
  EXPECT_EQ(weather_facts(again), weather_facts(scene));
  // Of green: ln 50 / 0.5 km.
  EXPECT_NEAR(weather_facts(scene).at("visibility_m"), 7824.05, 0.01);
}

TEST(Scene, OccludersReadBackTheSame) {
  const Scene scene = parse_scene(paper() +
                                      "[[occluder]]\nrange_m = 800\nmask = \"hill/%05d.png\"\n"
                                      "[[occluder]]\nrange_m = 4e3\nbeyond_horizon = true\n",
                                  "/data/a.toml");
  const Scene again = parse_scene(toml_from_scene(scene), "/elsewhere/b.toml");
  ASSERT_EQ(again.occluders.size(), 2u);
  EXPECT_EQ(again.occluders[0].range_m, 800);
  EXPECT_EQ(again.occluders[0].mask, fs::path("/data/hill/%05d.png"));
  EXPECT_FALSE(again.occluders[0].beyond_horizon);
  EXPECT_EQ(again.occluders[1].range_m, 4000);
  EXPECT_TRUE(again.occluders[1].beyond_horizon && !again.occluders[1].mask);
  const std::vector<StatedFile> files = stated_files(scene);
  const auto mask = std::ranges::find(files, fs::path("/data/hill/%05d.png"), &StatedFile::path);
  ASSERT_NE(mask, files.end());
  EXPECT_EQ(to_string(mask->where), to_string(scene.occluders[0].where));
}

// The shipped examples are valid scenes, and the first names every key that exists.
TEST(Scene, ExamplesAreGood) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(test_support::source_folder() / "examples")) {
    if (entry.path().extension() != ".toml") continue;
    const Scene scene = read_scene(entry.path());
    EXPECT_EQ(toml_from_scene(parse_scene(toml_from_scene(scene), "/x.toml")),
              toml_from_scene(scene));
    ++count;
  }
  EXPECT_GE(count, 4);
}

// The keys that scenes have, as "intruder.encounter.speed_mps". Every array of tables is in the
// text.
std::set<std::string> keys_of_scenes() {
  std::set<std::string> keys;
  call_on_key_use([&](const std::string& path, const KeyUse& use) {
    if (std::holds_alternative<KnownKey>(use))
      keys.insert(std::regex_replace(path, std::regex(R"(\[\d+\])"), ""));
  });
  parse_scene(R"(
[background]
video = "a.mp4"
[lens]
vertical_fov_deg = 60
[[intruder]]
aircraft = "c172/news"
encounter = { cpa_time_s = 1, course_deg = 180, speed_mps = 40 }
[[intruder]]
aircraft = "c172/news"
seen = [{ time_s = 0, pixel = [9, 9], range_m = 80 }, { time_s = 1, pixel = [1, 9], range_m = 80 }]
[[distractor]]
kind = "dirt"
pixel = [9, 9]
[[occluder]]
range_m = 800
beyond_horizon = true
[[truth.volume]]
name = "mine"
horizontal_m = 300
vertical_m = 60
tau_s = 0
coaltitude_s = 0
)",
              "/s.toml");
  call_on_key_use({});
  return keys;
}

// The same of a text, with the tables and keys that are commented out.
std::set<std::string> keys_in_text(const std::string& text) {
  static const std::regex kHeading(R"((?:# )?\[+([a-z_.]+)\].*)");
  static const std::regex kKey(R"((?:# )?([a-z_]+) = .*)");
  std::set<std::string> keys;
  std::string table;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kHeading)) {
      keys.insert(match[1]);
      table = match[1].str() + ".";
    } else if (std::regex_match(line, match, kKey)) {
      keys.insert(table + match[1].str());
    }
  }
  return keys;
}

TEST(Scene, EveryKeyIsDocumentedAndInTheCompleteExample) {
  const fs::path root = test_support::source_folder();
  const std::string manual = read_file(root / "docs/formats/scene.md");
  const std::set<std::string> example = keys_in_text(read_file(root / "examples/render.toml"));
  const std::set<std::string> known = keys_of_scenes();
  for (const std::string& key : example) EXPECT_TRUE(known.contains(key)) << key;
  for (const std::string& key : known) {
    const std::string name = key.substr(key.rfind('.') + 1);
    EXPECT_TRUE(manual.find("`" + name + "`") != std::string::npos ||
                manual.find(name + "]") != std::string::npos)
        << key;
    // A distractor has an id and a path as an intruder has them.
    const std::string prefix = "distractor.";
    EXPECT_TRUE(
        example.contains(key) ||
        (key.starts_with(prefix) && example.contains("intruder." + key.substr(prefix.size()))))
        << key;
  }
}

TEST(CameraModel, IsReadAndWrittenBackTheSame) {
  const std::string text =
      "[background]\nvideo = \"a.mp4\"\n[lens]\nvertical_fov_deg = 60\n"
      "[shutter]\nexposure_s = \"auto\"\nreadout_s = 0.016\nreadout = \"up\"\n"
      "[air]\nextinction_per_km = [0.1, 0.2, 0.3]\nairlight = \"auto\"\n"
      "[optics]\npoint_spread_px = 0.7\n[sensor]\nnoise_gain = 4e-4\nchroma_spread_px = "
      "2.5\ncodec_step = 8\ngamma = 2.2\n"
      "[realism]\nfile = \"c.toml\"\nauto = true\nprofile = \"gopro-karma\"\nfallback = "
      "true\n"
      "[[intruder]]\naircraft = \"c172/news\"\nwaypoints_ned_m = [[1, 2, 3], [4, 5, 6]]\nspeed_mps "
      "= 5\n";
  const Scene scene = parse_scene(text, "/f/s.toml");
  EXPECT_EQ(scene.camera_model.automatic,
            (std::vector<std::string>{"shutter.exposure_s", "air.airlight"}));
  EXPECT_FALSE(scene.camera_model.exposure_s);
  EXPECT_EQ(scene.camera_model.readout_s, 0.016);
  EXPECT_EQ(scene.camera_model.gamma, 2.2);
  EXPECT_EQ(scene.realism.file, fs::path("/f/c.toml"));
  EXPECT_EQ(scene.realism.profile, "gopro-karma");
  const std::string written = toml_from_scene(scene);
  EXPECT_EQ(toml_from_scene(parse_scene(written, "/f/s.toml")), written);
}

TEST(CameraModel, WhatIsOutOfRangeIsSaidAtItsPlace) {
  const auto said = [](const std::string& more) {
    try {
      parse_scene(
          "[background]\nvideo = \"a.mp4\"\n[lens]\nvertical_fov_deg = 60\n" + more +
              "\n[[intruder]]\naircraft = \"c172/news\"\nwaypoints_ned_m = [[1, 2, 3], [4, 5, "
              "6]]\nspeed_mps = 5\n",
          "s.toml");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(said("[shutter]\nexposure_s = 2"),
            "s.toml:6:14: exposure_s is 2; expected seconds from 0 to 1");
  EXPECT_EQ(said("[shutter]\nexposure_s = 0.1\nangle_deg = 90").substr(0, 10), "s.toml:7:1");
  EXPECT_NE(said("[sensor]\nnoise_gian = 1").find("did you mean 'noise_gain'"), std::string::npos);
  EXPECT_EQ(said("[sensor]\ngamma = 1"), "s.toml:6:9: gamma is 1; expected a number from 1.2 to 3");
  EXPECT_NE(said("[optics]\npoint_spread_px = \"much\"").find("is a string"), std::string::npos);
}

TEST(CameraFile, IsReadStrictly) {
  const CameraFile file = parse_camera_file(
      "[clip]\nwidth = 640\nheight = 480\nlens = \"pinhole 500.0 px\"\ngamma = "
      "1.8\n[optics]\npoint_spread_px = "
      "1.2\n[light]\nsun_azimuth_deg = 30\nsun_elevation_deg = 20\n",
      "c.toml");
  EXPECT_EQ(file.width, 640);
  EXPECT_EQ(file.model.point_spread_px, 1.2);
  EXPECT_EQ(file.gamma, 1.8);
  EXPECT_EQ(file.sun_azimuth_deg, 30);
  EXPECT_THROW(parse_camera_file("[optics]\npoint_spread_px = 1\n", "c.toml"), Error);
  EXPECT_EQ(test_support::error_of([] { parse_camera_file("\n[clip]\nwidth = 9\n", "c.toml"); }),
            "c.toml:2:1: [clip] has no width and height; expected a file that airtruth calibrate "
            "wrote");
  const std::string clip = "[clip]\nwidth = 1\nheight = 1\n";
  EXPECT_THROW(parse_camera_file(clip + "[optics]\nspread = 1\n", "c.toml"), Error);
  for (const char* key : {"[shutter]\nangle_deg = 72\n", "[sensor]\ngamma = 2\n"})
    EXPECT_THAT(test_support::error_of([&] { parse_camera_file(clip + key, "c.toml"); }),
                testing::HasSubstr("is not read from a camera file; expected it in the scene"));
}

}  // namespace
}  // namespace airtruth::scene
