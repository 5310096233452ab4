// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dataset/build/build.h"
#include "dataset/build/inputs.h"
#include "dataset/build/plan.h"
#include "dataset/build/verify.h"
#include "dataset/catalogue/folder.h"
#include "dataset/labelled/import.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "sequence/demo/demo.h"
#include "sequence/replay/recorded_inputs.h"
#include "support/error_of.h"
#include "support/small_catalogue.h"
#include "support/temporary_folder.h"

namespace airtruth::build {
namespace {

using testing::HasSubstr;

std::string error_of(const std::string& text) {
  return test_support::error_of([&] { catalogue::parse_catalogue(text, "c.toml"); });
}

TEST(Catalogue, AProductMakesEveryCombinationOnce) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml");
  const catalogue::Expansion expansion(catalogue);
  ASSERT_EQ(expansion.size(), 4);
  std::set<std::string> names;
  for (std::int64_t i = 0; i < 4; ++i) names.insert(expansion.at(i).name);
  EXPECT_EQ(names,
            (std::set<std::string>{
                "sky-across-b737", "sky-across-c172", "more-across-b737", "more-across-c172"}));
  EXPECT_EQ(expansion.at(0).frame_count, 8);  // the flight's
}

TEST(Catalogue, WhatItNamesMustBeThere) {
  std::string text = test_support::kCatalogue;
  const auto with = [&](const std::string& more) { return error_of(text + more); };
  EXPECT_THAT(with("[[sequence]]\nname = \"a\"\nbackground = \"sjy\"\ntrajectory = "
                   "\"across\"\naircraft = \"b737\"\n"),
              HasSubstr("did you mean 'sky'?"));
  EXPECT_THAT(with("[[sequence]]\nname = \"a\"\nbackground = \"sky\"\ntrajectory = "
                   "\"across\"\naircraft = \"b737\"\n"
                   "[[sequence]]\nname = \"a\"\nbackground = \"sky\"\ntrajectory = "
                   "\"across\"\naircraft = \"c172\"\n"),
              HasSubstr("two sequences are named 'a'"));
  EXPECT_THAT(with("[[aircraft]]\nname = \"c172\"\naircraft = \"c172/news\"\n"),
              HasSubstr("c.toml:28:8: two tables [[aircraft]] are named 'c172'"));
  EXPECT_THAT(with("[[background]]\nname = \"bare\"\nvideo = \"a.mp4\"\n"),
              testing::MatchesRegex("c.toml:27:.*: .lens. has no focal length.*"));
  EXPECT_THAT(with("[[sequense]]\n"), HasSubstr("sequence"));
  EXPECT_THAT(with("[[random]]\naircraft = [\"nosuch/*\"]\n"),
              HasSubstr("no aircraft fits 'nosuch/*'"));
  EXPECT_THAT(with("[[random]]\nname = \"same\"\naircraft = [\"738/*\"]\n"), HasSubstr("{index}"));
  EXPECT_THAT(error_of("name = \"empty\"\n"), HasSubstr("makes no sequence"));
}

TEST(Catalogue, AFlightThatCannotBeMadeIsRefusedAtItsLine) {
  const auto with = [](const std::string& flight, const std::string& light) {
    std::string text = test_support::kCatalogue;
    const std::string size = "height = 120 }\n";
    text.replace(text.find(size), size.size(), flight + " }\n" + light);
    return error_of(text);
  };
  EXPECT_THAT(with("height = 121", ""),
              HasSubstr("c.toml:5:61: height is 121; expected an even number of pixels"));
  EXPECT_THAT(with("altitude_m = 5000", ""),
              HasSubstr("altitude_m is 5000; expected metres from 20 to 900, below the clouds"));
  EXPECT_THAT(with("altitude_m = 5000", ""), HasSubstr("c.toml:5:"));
  EXPECT_THAT(with("speed_mps = 401", ""),
              HasSubstr("speed_mps is 401; expected metres a second from 0 to 400"));
  EXPECT_THAT(
      with("height = 120", "light = { sun_elevation_deg = 1 }\n"),
      HasSubstr("c.toml:6:9: sun_elevation_deg is 1; expected degrees from 2 to 90 over a flight"));
}

// A camera that is stated, as that of the other background, stays as it is.
TEST(Catalogue, TheCameraOfAFlightFliesAsTheFlightDoes) {
  std::string text = test_support::kCatalogue;
  const std::string stated =
      "height = 120 }\nlens = { vertical_fov_deg = 75 }\ncamera = { "
      "position_ned_m = [0, 0, -150] }\n";
  text.replace(text.find(stated),
               stated.size(),
               "height = 120, altitude_m = 300, speed_mps = 40 }\nlens = { vertical_fov_deg = 75 "
               "}\n");
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(text, "c.toml");
  const scene::Camera& flown = catalogue.backgrounds.at(0).camera;
  EXPECT_EQ(flown.position_ned_m, Vector3(0, 0, -300));
  EXPECT_EQ(flown.velocity_ned_mps, Vector3(40, 0, 0));
  EXPECT_EQ(catalogue.backgrounds.at(1).camera.position_ned_m, Vector3(0, 0, -150));
  EXPECT_EQ(catalogue.backgrounds.at(1).camera.velocity_ned_mps, Vector3(0, 0, 0));
}

TEST(Catalogue, ARateOfAVideoIsRefusedAtItsBackground) {
  std::string text = test_support::kCatalogue;
  text.replace(text.find("[[aircraft]]"), 0, "frame_rate_hz = 60\n");
  EXPECT_THAT(
      test_support::error_of([&] { check_sources(catalogue::parse_catalogue(text, "c.toml")); }),
      testing::AllOf(HasSubstr("c.toml:8:"),
                     HasSubstr("frame_rate_hz is 60, and the background is a video")));
}

TEST(Catalogue, AMaskOfAFlightIsRefusedAtItsBackground) {
  std::string text = test_support::kCatalogue;
  text.replace(text.find("[[aircraft]]"), 0, "mask = \"own.png\"\n");
  EXPECT_EQ(
      test_support::error_of([&] { check_sources(catalogue::parse_catalogue(text, "c.toml")); }),
      "c.toml:8:1: mask has no effect with flight, which has a mask of its own");
}

TEST(Catalogue, AMillionSequencesCostNoMoreThanOne) {
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(
      std::string(test_support::kCatalogue) +
          "[[random]]\ncount = 999996\nframe_count = 30\naircraft = [\"738/*\", \"c172/*\"]\n",
      "c.toml");
  const catalogue::Expansion expansion(catalogue);
  EXPECT_EQ(expansion.size(), 1000000);
  const catalogue::Item last = expansion.at(999999);
  EXPECT_EQ(last.name, "r999995");
  // The items do not depend on the order of the calls.
  const catalogue::Item again = catalogue::Expansion(catalogue).at(999999);
  EXPECT_EQ(again.scene.intruders[0].waypoints_ned_m, last.scene.intruders[0].waypoints_ned_m);
}

TEST(Catalogue, AVideoTakesThePlaceOfABackgroundByItsName) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml");
  const catalogue::Catalogue changed = build::with_videos(catalogue, {{"sky", "/clips/own.mp4"}});
  EXPECT_EQ(std::get<fs::path>(changed.backgrounds.at(0).source), "/clips/own.mp4");
  EXPECT_FALSE(changed.backgrounds.at(0).mask);
  EXPECT_THROW(build::with_videos(catalogue, {{"sjy", "/clips/own.mp4"}}), Error);
}

// At some moment of the clip a random intruder is at the requested range in the requested
// direction.
TEST(Catalogue, DrawnIntrudersComeIntoTheRangesThatWereAskedFor) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(std::string(test_support::kCatalogue) +
                                     "[[random]]\ncount = 200\nframe_count = 90\naircraft = "
                                     "[\"738/*\"]\nrange_m = [300, 500]\nazimuth_deg = [-10, 10]\n"
                                     "elevation_deg = [2, 8]\nspeed_mps = [50, 60]\n",
                                 "c.toml");
  const catalogue::Expansion expansion(catalogue);
  for (std::int64_t i = 4; i < expansion.size(); ++i) {
    const catalogue::Item item = expansion.at(i);
    const auto& points = item.scene.intruders[0].waypoints_ned_m;
    const double speed = *item.scene.intruders[0].speed_mps;
    EXPECT_GE(speed, 50);
    EXPECT_LT(speed, 60);
    const Vector3 along = (points[1] - points[0]).normalized();
    bool met = false;
    for (double t = 0; t <= 3 && !met; t += 0.002) {
      const Vector3 at = points[0] + t * speed * along - Vector3(0, 0, -150);
      const double azimuth = degrees(std::atan2(at.y(), at.x()));
      const double elevation = degrees(std::asin(-at.z() / at.norm()));
      met = at.norm() > 299 && at.norm() < 501 && std::abs(azimuth) < 10.1 && elevation > 1.9 &&
            elevation < 8.1;
    }
    EXPECT_TRUE(met) << item.name;
  }
}

class Build : public testing::Test {
 protected:
  // The SHA-256 of every file of the sequences and the manifest, by name.
  static std::map<std::string, std::string> bytes_of(const fs::path& folder) {
    std::map<std::string, std::string> result;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string name = fs::relative(entry.path(), folder).string();
      if (entry.is_regular_file() &&
          (name.starts_with("sequences/") || name.starts_with("manifest/")) &&
          !name.ends_with("sequence.json"))
        result[name] = sha256_of_file(entry.path());
    }
    return result;
  }

  // A build of one sequence of the catalogue.
  static BuildOptions one_alone() {
    BuildOptions options;
    options.only = "sky-across-c172";
    return options;
  }

  test_support::TemporaryFolder temporary_;
  fs::path root_ = temporary_.path();
};

TEST_F(Build, WhatItsFormatCannotHoldIsRefusedAtTheBackground) {
  synthetic::FlightOptions odd;
  odd.width = 161;
  odd.height = 121;
  odd.frame_count = 1;
  demo::write_flight(
      synthetic::Flight(odd), root_ / "odd.mkv", {.format = image::VideoFormat::kMkv});
  catalogue::Catalogue catalogue = build::with_videos(
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml"), {{"sky", root_ / "odd.mkv"}});
  catalogue.output.video = image::VideoFormat::kMp4;
  EXPECT_THAT(test_support::error_of([&] { check_sources(catalogue); }),
              testing::AllOf(HasSubstr("c.toml:3"), HasSubstr("an odd size")));
}

TEST_F(Build, AFolderOfAnotherCatalogueSaysWhetherItHoldsAnything) {
  const std::string text = test_support::kCatalogue;
  const catalogue::Folder begun =
      catalogue::open_folder(catalogue::parse_catalogue(text, "c.toml"), root_);
  const catalogue::Catalogue mended = catalogue::parse_catalogue(text + "# mended\n", "c.toml");
  const auto error = [&] {
    return test_support::error_of([&] { catalogue::open_folder(mended, root_); });
  };
  EXPECT_THAT(error(), HasSubstr("holds no sequence; remove it to begin anew"));
  fs::create_directory(begun.sequences() / "one");
  write_file(begun.sequences() / "one" / "sequence.json", "{}");
  EXPECT_THAT(error(), HasSubstr("; expected a new folder, or that catalogue"));
}

TEST_F(Build, GoesOnWhereItWasAndGivesTheSameBytesForAnyNumberOfJobs) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml");
  BuildOptions options;
  options.jobs = 1;
  const BuildSummary first = build_set(catalogue, root_ / "one", options);
  EXPECT_EQ(first.made, 4);
  EXPECT_TRUE(first.complete);
  options.jobs = 2;
  options.only = "sky*";
  const BuildSummary part = build_set(catalogue, root_ / "two", options);
  EXPECT_EQ(part.made, 2);
  EXPECT_FALSE(part.complete);
  EXPECT_EQ(build::status(root_ / "two").missing.size(), 2u);
  options.only = "*";
  write_file(root_ / "two" / "failed-0.jsonl", "{\"name\":\"more-across-c172\"}\n");
  const BuildSummary rest = build_set(catalogue, root_ / "two", options);
  EXPECT_EQ(rest.made, 2);
  EXPECT_EQ(rest.kept, 2);
  EXPECT_TRUE(rest.complete);
  EXPECT_FALSE(fs::exists(root_ / "two" / "failed-0.jsonl"));
  EXPECT_EQ(bytes_of(root_ / "one").size(), 4u * 4u + 1u);
  const auto one = bytes_of(root_ / "one");
  for (const auto& [name, hash] : bytes_of(root_ / "two"))
    if (name.ends_with(".xml") || name.ends_with(".jsonl") || name.ends_with(".mkv")) {
      if (!name.starts_with("manifest/")) {
        EXPECT_EQ(hash, one.at(name)) << name;
      }
    }
  EXPECT_TRUE(verify(root_ / "two", {}).faults.empty());
}

TEST_F(Build, OfManyMissingSequencesTenAreNamedAndTheOthersCounted) {
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(
      std::string(test_support::kCatalogue) +
          "[[random]]\ncount = 12\nframe_count = 8\naircraft = [\"c172/news\"]\n",
      "c.toml");
  BuildOptions options;
  options.only = "sky-across-b737";
  EXPECT_EQ(build_set(catalogue, root_, options).made, 1);
  EXPECT_EQ(build::status(root_).not_there, 15);
  const VerifyResult found = verify(root_, {});
  EXPECT_EQ(found.sequences, 16);
  EXPECT_EQ(found.not_there, 15);
  ASSERT_EQ(found.faults.size(), 12u);
  EXPECT_THAT(found.faults[9], HasSubstr(": is not there"));
  EXPECT_THAT(found.faults[10], HasSubstr("5 more sequences of the catalogue are not there"));
}

// 160x120 at 30 frames a second.
void write_small_clip(const fs::path& video, int frames) {
  synthetic::FlightOptions options;
  options.width = 160;
  options.height = 120;
  options.frame_count = frames;
  demo::write_flight(synthetic::Flight(options), video, {.format = video::Format::kMkv});
}

// Beside the copy of the catalogue in the set there is no own.csv.
TEST_F(Build, ASetOfEncountersIsFinishedWithoutTheCamerasPathFile) {
  write_file(root_ / "own.csv", "time_s,north_m,east_m,down_m\n0,0,0,-300\n20,500,0,-300\n");
  write_small_clip(root_ / "sky.mkv", 24);
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(
      "[[background]]\nname = \"sky\"\nvideo = \"sky.mkv\"\nlens = { vertical_fov_deg = 60 }\n"
      "camera = { path_file = \"own.csv\" }\nmotion = { model = \"none\" }\n[[encounter_model]]\n"
      "kind = \"geometric\"\nframe_count = 8\naircraft = [\"c172/news\"]\nin_view = false\n",
      root_ / "c.toml");
  const fs::path set = root_ / "set";
  ASSERT_EQ(build_set(catalogue, set, {}).made, 1);
  EXPECT_EQ(build::status(set).whole, 1);
  EXPECT_THAT(verify(set, {}).faults, testing::IsEmpty());
  EXPECT_TRUE(finish(set));
}

// A receiver that has its fix after 1.6 of the video's 2 s.
TEST_F(Build, ALogMayBeginAfterItsVideoAndBeforeTheFirstFrame) {
  write_file(root_ / "late.srt",
             "1\n00:00:01,600 --> 00:00:01,700\n[latitude: 47.0000] [longitude: 8] [rel_alt: 300 "
             "abs_alt: 300]\n\n2\n00:00:02,300 --> 00:00:02,400\n[latitude: 47.0001] "
             "[longitude: 8] [rel_alt: 300 abs_alt: 300]\n");
  write_small_clip(root_ / "sky.mkv", 60);
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(
      "[[background]]\nname = \"sky\"\nvideo = \"sky.mkv\"\nfirst_frame = 54\n"
      "lens = { vertical_fov_deg = 60 }\ncamera = { log = \"late.srt\" }\n"
      "motion = { model = \"none\" }\n[[random]]\nframe_count = 2\naircraft = [\"c172/news\"]\n"
      "[[encounter_model]]\nkind = \"geometric\"\nframe_count = 2\naircraft = [\"c172/news\"]\n"
      "in_view = false\n",
      root_ / "c.toml");
  EXPECT_EQ(plan_of(catalogue, {}, {}).sequences, 2);
  EXPECT_EQ(build_set(catalogue, root_ / "set", {}).made, 2);
}

// That the background states the frames is as if the product did.
TEST_F(Build, MotionIsMeasuredOfTheFramesThatABackgroundUses) {
  write_small_clip(root_ / "sky.mkv", 24);
  const auto bytes_of_motion = [&](const std::string& of_background,
                                   const std::string& of_product) {
    const fs::path set = root_ / (of_background.empty() ? "product" : "background");
    const std::string text =
        "[[background]]\nname = \"sky\"\nvideo = \"sky.mkv\"\n" + of_background +
        "lens = { vertical_fov_deg = 60 }\ncamera = { position_ned_m = [0, 0, -150] }\n"
        "[[aircraft]]\nname = \"c172\"\naircraft = \"c172/news\"\n[[trajectory]]\n"
        "name = \"across\"\nwaypoints_ned_m = [[150, -20, -160], [150, 60, -160]]\n"
        "speed_mps = 60\n[[product]]\n" +
        of_product;
    EXPECT_EQ(build_set(catalogue::parse_catalogue(text, root_ / "c.toml"), set, {}).made, 1);
    std::uintmax_t bytes = 0;
    for (const auto& entry : fs::directory_iterator(set / ".cache" / "motion"))
      bytes += entry.file_size();
    return bytes;
  };
  EXPECT_EQ(bytes_of_motion("frame_count = 3\n", ""), bytes_of_motion("", "frame_count = 3\n"));
}

// What the clip of a background does not tell is said for the first sequence over it alone.
TEST_F(Build, AWarningIsSaidOnceForABackground) {
  std::string text = test_support::kCatalogue;
  const std::string camera = "camera = {";
  for (auto at = text.find(camera); at != text.npos; at = text.find(camera, at + 60))
    text.insert(at, "realism = { auto = true, fallback = true }\n");
  std::vector<std::string> warnings;
  BuildOptions options;
  options.jobs = 1;
  options.warn = [&](const std::string& message) { warnings.push_back(message); };
  EXPECT_EQ(build_set(catalogue::parse_catalogue(text, "c.toml"), root_, options).made, 4);
  const auto about_sharpness = std::count_if(warnings.begin(), warnings.end(), [](const auto& w) {
    return w.find("optics.point_spread_px cannot be measured") != w.npos;
  });
  EXPECT_EQ(about_sharpness, 2) << warnings.size();
  ASSERT_FALSE(warnings.empty());
  EXPECT_THAT(warnings.back(), HasSubstr("more warnings say the same"));
}

TEST_F(Build, WhatIsNotAtHandIsSaidBeforeAnythingIsMade) {
  const auto error = [&](const std::string& text) -> std::string {
    return test_support::error_of(
        [&] { build_set(catalogue::parse_catalogue(text, "c.toml"), root_ / "never", {}); });
  };
  const std::string text = test_support::kCatalogue;
  EXPECT_THAT(error(text + "[[aircraft]]\nname = \"none\"\naircraft = \"738/738-Ryanaair\"\n"),
              testing::MatchesRegex(
                  "c.toml:[0-9]+:12: unknown aircraft '738/738-Ryanaair'.*738-Ryanair.*"));
  EXPECT_THAT(error(text + "[[background]]\nname = \"gone\"\nvideo = \"nowhere.mp4\"\nlens = { "
                           "vertical_fov_deg = 60 }\n"),
              HasSubstr("the video of background 'gone', nowhere.mp4, does not exist"));
  EXPECT_THAT(error(text + "[[sequence]]\nname = \"sky-across-b737\"\nbackground = "
                           "\"sky\"\ntrajectory = \"across\"\naircraft = \"b737\"\n"),
              testing::MatchesRegex("c.toml:23:.*two sequences are named 'sky-across-b737'.*"));
  EXPECT_THAT(error(text + "[[random]]\naircraft = [\"738/*\"]\n[[random]]\naircraft = "
                           "[\"c172/*\"]\n"),
              testing::MatchesRegex("c.toml:29:.*two sequences are named 'r000000'.*"));
  // Of one product: sky with over-across, sky-over with across.
  const std::string over =
      "[[background]]\nname = \"sky-over\"\nflight = { seed = 5, frame_count = "
      "8, width = 160, height = 120 }\nlens = { vertical_fov_deg = 75 }\n"
      "camera = { position_ned_m = [0, 0, -150] }\n[[trajectory]]\nname = "
      "\"over-across\"\nwaypoints_ned_m = [[150, -20, -160], [150, 60, "
      "-160]]\nspeed_mps = 60\n";
  EXPECT_THAT(error(text + over),
              testing::MatchesRegex("c.toml:23:.*two sequences are named 'sky-over-across-.*"));
  EXPECT_FALSE(fs::exists(root_ / "never"));
}

TEST_F(Build, OneBadSequenceDoesNotStopTheOthers) {
  std::string text = test_support::kCatalogue;
  write_file(root_ / "broken.ac", "this is no model");
  text += "[[aircraft]]\nname = \"none\"\naircraft = \"" + (root_ / "broken.ac").string() + "\"\n";
  const BuildSummary summary =
      build_set(catalogue::parse_catalogue(text, "c.toml"), root_ / "bad", {});
  EXPECT_EQ(summary.made, 4);
  ASSERT_EQ(summary.failures.size(), 2u);
  EXPECT_THAT(summary.failures[0].reason, HasSubstr("broken.ac"));
  EXPECT_FALSE(summary.complete);
  // Also after a build that looks at none of them.
  const std::string failed = read_file(root_ / "bad" / "failed.jsonl");
  EXPECT_EQ(std::ranges::count(failed, '\n'), 2);
  build_set(catalogue::parse_catalogue(text, "c.toml"), root_ / "bad", one_alone());
  EXPECT_EQ(read_file(root_ / "bad" / "failed.jsonl"), failed);
}

TEST_F(Build, VerifyFindsWhatWasChanged) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml");
  build_set(catalogue, root_ / "set", {});
  const fs::path truth = root_ / "set" / "sequences" / "sky-across-b737" / "truth.jsonl";
  const std::string text = read_file(truth);
  write_file(truth, text.substr(0, text.size() / 2));
  EXPECT_FALSE(verify(root_ / "set", {}).faults.empty());
  write_file(truth, text);
  EXPECT_TRUE(verify(root_ / "set", {}).faults.empty());
  // An input that was another file when this sequence was made.
  const fs::path record_file = truth.parent_path() / "sequence.json";
  auto record = nlohmann::json::parse(read_file(record_file));
  record["inputs"][0]["sha256"] = std::string(64, '0');
  write_file(record_file, record.dump());
  const std::vector<std::string> faults = verify(root_ / "set", {}).faults;
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_THAT(faults[0], HasSubstr("was made of another"));
  EXPECT_THAT(faults[0], HasSubstr("sky-across-b737"));
  EXPECT_TRUE(build::status(root_ / "set").complete);
  fs::remove_all(truth.parent_path());
  EXPECT_FALSE(build::status(root_ / "set").complete);
}

// Appends an empty box to an MP4: another file with the same frames.
void change(const fs::path& mp4) {
  write_file(mp4,
             read_file(mp4) + std::string("\0\0\0\x08"
                                          "free",
                                          8));
}

TEST_F(Build, ABackgroundThatChangedUnderABuildIsRefusedByName) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml");
  build_set(catalogue, root_ / "set", one_alone());
  change(root_ / "set" / "backgrounds" / "sky.mp4");
  // Also where nothing is left to be made over it.
  for (const BuildOptions& options : {BuildOptions{}, one_alone()}) {
    const std::string error =
        test_support::error_of([&] { build_set(catalogue, root_ / "set", options); });
    EXPECT_THAT(error, HasSubstr("sky.mp4"));
    EXPECT_THAT(error, HasSubstr("is another file than the one that 'sky-across-c172'"));
  }
  EXPECT_FALSE(build::status(root_ / "set").complete);
}

// The same video, which leaves the flight's mask out.
TEST_F(Build, ABackgroundThatLosesItsMaskUnderABuildIsRefused) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml");
  build_set(catalogue, root_ / "set", one_alone());
  BuildOptions options;
  options.videos["sky"] = root_ / "set" / "backgrounds" / "sky.mp4";
  EXPECT_THAT(test_support::error_of([&] { build_set(catalogue, root_ / "set", options); }),
              HasSubstr("sky.mp4: has not the masks with which 'sky-across-c172'"));
}

TEST_F(Build, AFlightThroughTooLongALensIsRefusedAtItsBackground) {
  std::string text = test_support::kCatalogue;
  const std::string stated = "vertical_fov_deg = 75";
  text.replace(text.find(stated), stated.size(), "vertical_fov_deg = 0.01");
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(text, "c.toml");
  const std::string error =
      test_support::error_of([&] { build_set(catalogue, root_ / "set", one_alone()); });
  EXPECT_THAT(error, HasSubstr("c.toml:3:"));
  EXPECT_THAT(error, HasSubstr("virtual flight: the focal length is 687549 px"));
}

// No sequence is there yet that states what it was made of.
TEST_F(Build, AFlightThroughAnotherLensFileIsRefused) {
  std::string text = test_support::kCatalogue;
  const std::string stated = "vertical_fov_deg = 75";
  text.replace(text.find(stated), stated.size(), "file = \"lens.json\"");
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(text, root_ / "c.toml");
  const auto error_through = [&](const std::string& focal_px) {
    write_file(root_ / "lens.json",
               "{\"calib_dimension\": {\"w\": 160, \"h\": 120}, \"fisheye_params\": {"
               "\"camera_matrix\": [[" +
                   focal_px + ",0,80],[0," + focal_px +
                   ",60],[0,0,1]], \"radial_distortion_limit\": 2.5, \"distortion_coeffs\": "
                   "[0.06, 0.01, -0.01, 0.004]}}");
    return test_support::error_of([&] { build_set(catalogue, root_ / "set", one_alone()); });
  };
  EXPECT_EQ(error_through("80"), "no error");
  fs::remove_all(root_ / "set" / "sequences" / "sky-across-c172");
  EXPECT_THAT(error_through("160"), HasSubstr("sky.mp4: was flown through another lens than"));
  EXPECT_EQ(error_through("80"), "no error");
}

TEST_F(Build, AnInputIsAnotherOneByItsBytesAndNotByItsEnding) {
  setup::SharedInputs inputs;
  const fs::path log = root_ / "log.txt";  // a list of pictures has the same ending
  write_file(log, "time_s,latitude_deg\n");
  const std::string sha256 = sha256_of_file(log);
  EXPECT_FALSE(replay::is_another(log, sha256, inputs));
  write_file(log, "time_s,latitude_deg,longitude_deg\n");
  EXPECT_TRUE(replay::is_another(log, sha256, inputs));
  fs::remove(log);
  EXPECT_FALSE(replay::is_another(log, sha256, inputs));
  EXPECT_FALSE(replay::is_another(root_ / "frames" / "%04d.png", sha256, inputs));
}

TEST_F(Build, DeepVerificationNamesAnInputThatChanged) {
  build_set(catalogue::parse_catalogue(test_support::kCatalogue, "c.toml"), root_ / "set", {});
  VerifyOptions deep;
  deep.deep_every = 30;
  EXPECT_TRUE(verify(root_ / "set", deep).faults.empty());
  const auto record = nlohmann::json::parse(
      read_file(root_ / "set" / "sequences" / "sky-across-c172" / "sequence.json"));
  for (const auto& input : record["inputs"])
    EXPECT_TRUE(fs::path(input["name"].get<std::string>()).is_absolute()) << input["name"];
  change(root_ / "set" / "backgrounds" / "sky.mp4");
  EXPECT_TRUE(verify(root_ / "set", {}).faults.empty());
  const VerifyResult result = verify(root_ / "set", deep);
  EXPECT_EQ(result.faults.size(), 2u);
  EXPECT_EQ(result.recomposed, 2);
  for (const std::string& fault : result.faults) {
    EXPECT_THAT(fault, HasSubstr("was made of another "));
    EXPECT_THAT(fault, HasSubstr("sky.mp4 than is there now"));
  }
}

// In its old place nothing is, and then another set.
TEST_F(Build, ASetThatWasMovedStandsOnItsOwnBackgrounds) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml");
  build_set(catalogue, root_ / "set", {});
  const fs::path moved = root_ / "moved";
  fs::rename(root_ / "set", moved);
  VerifyOptions deep;
  deep.deep_every = 30;
  EXPECT_EQ(verify(moved, deep).faults, std::vector<std::string>{});
  const fs::path elsewhere = root_ / "set" / "backgrounds";
  fs::create_directories(elsewhere);
  for (const char* name : {"sky.mp4", "sky.mask.png"})
    write_file(elsewhere / name, read_file(moved / "backgrounds" / name) + "more");
  EXPECT_EQ(verify(moved, deep).recomposed, 4);
  fs::remove_all(moved / "sequences" / "sky-across-b737");
  EXPECT_EQ(test_support::error_of([&] { build_set(catalogue, moved, {}); }), "no error");
  EXPECT_EQ(verify(moved, deep).faults, std::vector<std::string>{});
  const fs::path sequence = moved / "sequences" / "sky-across-c172";
  setup::SharedInputs inputs;
  EXPECT_EQ(replay::find_input(elsewhere / "sky.mp4", sequence, inputs).value().string(),
            (moved / "backgrounds" / "sky.mp4").string());
  change(moved / "backgrounds" / "sky.mp4");
  EXPECT_FALSE(replay::find_input(elsewhere / "sky.mp4", sequence, inputs));
}

TEST_F(Build, AnImportedSetIsVerifiedByItsPicturesAndBoxes) {
  build_set(
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml"), root_ / "set", one_alone());
  const fs::path made = root_ / "set" / "sequences" / "sky-across-c172";
  EXPECT_TRUE(verify(made, {}).faults.empty());
  const fs::path video = root_ / "boxes.mkv";
  fs::copy_file(made / "sky-across-c172.mkv", video);
  write_file(root_ / "boxes.csv", "frame,x,y,w,h\n0,10,20,30,40\n5,11,20,30,40\n");
  labelled::ImportOptions options;
  options.format = exchange::Format::kCsv;
  options.videos[""] = video;
  labelled::import_set(root_ / "boxes.csv", root_ / "imported", options);
  EXPECT_THAT(test_support::error_of([&] { finish(root_ / "imported"); }),
              HasSubstr("holds no catalogue.toml; expected a set that `airtruth dataset build`"));
  const VerifyResult good = verify(root_ / "imported", {});
  EXPECT_EQ(good.sequences, 1);
  EXPECT_EQ(good.faults, std::vector<std::string>{});

  const fs::path labels = root_ / "imported" / "sequences" / "boxes" / "labels.jsonl";
  const std::string text = read_file(labels);
  const std::string box = "\"box_px\":[11";
  ASSERT_NE(text.find(box), std::string::npos) << text;
  write_file(labels, std::string(text).replace(text.find(box), box.size(), "\"box_px\":[911"));
  EXPECT_THAT(
      verify(root_ / "imported", {}).faults,
      testing::ElementsAre(HasSubstr("boxes: frame 5, track 1: its box is empty or outside")));
  write_file(labels, text.substr(0, text.rfind('\n', text.size() - 2) + 1));
  EXPECT_THAT(verify(root_ / "imported", {}).faults,
              testing::ElementsAre(HasSubstr("and sequence.json states")));
  write_file(labels, text);
  fs::remove(video);
  EXPECT_THAT(verify(root_ / "imported", {}).faults, testing::ElementsAre(HasSubstr("boxes.mkv")));
  fs::create_directories(root_ / "empty");
  EXPECT_THAT(test_support::error_of([&] { verify(root_ / "empty", {}); }),
              HasSubstr("holds no finished sequence"));
}

TEST_F(Build, AFolderBelongsToOneCatalogueAndOneBuild) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(test_support::kCatalogue, "c.toml");
  build_set(catalogue, root_ / "set", one_alone());
  const catalogue::Catalogue other = catalogue::parse_catalogue(
      std::string(test_support::kCatalogue) + "quality = 20\n", "c.toml");
  const auto error_of_build = [&](const catalogue::Catalogue& one) -> std::string {
    return test_support::error_of([&] { build_set(one, root_ / "set", one_alone()); });
  };
  EXPECT_THAT(error_of_build(other), HasSubstr("catalogue"));
  EXPECT_EQ(error_of_build(catalogue), "no error");
  // While another process is at work in it: flock() counts two openings of one file as two.
  const catalogue::Folder folder{root_ / "set"};
  for (const Sharing sharing : {Sharing::kAlone, Sharing::kShared}) {
    const RunLock elsewhere = catalogue::lock_of(folder, sharing);
    EXPECT_THAT(error_of_build(catalogue), HasSubstr("at work"));
    EXPECT_TRUE(build::status(root_ / "set").at_work);
  }
  EXPECT_FALSE(build::status(root_ / "set").at_work);
  // A lock that cannot be made is nobody's.
  fs::remove(folder.lock());
  fs::create_symlink(root_ / "nowhere" / "lock", folder.lock());
  EXPECT_FALSE(build::status(root_ / "set").at_work);
}

}  // namespace
}  // namespace airtruth::build
