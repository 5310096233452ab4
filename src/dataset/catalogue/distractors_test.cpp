// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/distractors.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "dataset/catalogue/expand.h"
#include "scene/scene/scene.h"
#include "sequence/setup/from_scene.h"

namespace airtruth::catalogue {
namespace {

// A catalogue of 200 sequences over one virtual flight.
Catalogue catalogue_with(const std::string& more, const std::string& top = "") {
  return parse_catalogue(
      "name = \"set\"\nseed = 3\n" + top +
          "[[background]]\nname = \"sky\"\nflight = { seed = 1, frame_count = 60 "
          "}\nlens = { vertical_fov_deg = 60 }\n[[random]]\ncount = "
          "200\nframe_count = 30\naircraft = [\"c172/*\"]\n" +
          more,
      "/data/catalogue.toml");
}

std::string message_of(const std::string& more) {
  try {
    catalogue_with(more);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::int64_t aircraft_in(const scene::Scene& scene) {
  return std::count_if(scene.intruders.begin(), scene.intruders.end(), scene::is_aircraft);
}

TEST(DistractorRules, TheirSharesHoldAndAreIndependentOfTheNegatives) {
  const Catalogue catalogue = catalogue_with(
      "[[distractor]]\nkind = \"bird\"\nshare = 0.5\n[[distractor]]\nkind = \"dirt\"\nshare = "
      "0.2\n",
      "negatives = 0.5\n");
  const Expansion expansion(catalogue);
  int negatives = 0, birds = 0, dirt = 0, birds_in_negatives = 0;
  for (std::int64_t i = 0; i < expansion.size(); ++i) {
    const scene::Scene scene = expansion.at(i).scene;
    const bool is_negative = aircraft_in(scene) == 0;
    const bool has_bird = std::ssize(scene.intruders) > aircraft_in(scene);
    negatives += is_negative;
    birds += has_bird;
    birds_in_negatives += is_negative && has_bird;
    dirt += !scene.lens_marks.empty();
  }
  EXPECT_NEAR(negatives, 100, 1);
  EXPECT_NEAR(birds, 100, 4);
  EXPECT_NEAR(dirt, 40, 4);
  EXPECT_NEAR(birds_in_negatives, 50, 6);
}

// A bird in half of the sequences and a balloon in half of them meet in a quarter, whatever stands
// between their tables.
TEST(DistractorRules, TheNinthTableIsIndependentOfTheFirst) {
  std::string tables = "[[distractor]]\nkind = \"bird\"\nshare = 0.5\n";
  for (int i = 0; i < 7; ++i) tables += "[[distractor]]\nkind = \"dirt\"\nshare = 0\n";
  const Catalogue catalogue =
      catalogue_with(tables + "[[distractor]]\nkind = \"balloon\"\nshare = 0.5\n");
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    std::int64_t both = 0;
    for (std::int64_t i = 0; i < 200; ++i)
      both += draw_distractors(catalogue.distractors, seed, i).flocks.size() == 2 ? 1 : 0;
    EXPECT_NEAR(static_cast<double>(both), 50, 8) << seed;
  }
}

TEST(DistractorRules, AFlockIsPlacedWhereTheRuleSays) {
  const Catalogue catalogue = catalogue_with(
      "[[distractor]]\nkind = \"bird\"\nflock = [4, 9]\nspread_m = [2, 3]\nrange_m = [60, "
      "60]\nazimuth_deg = [5, 5]\nelevation_deg = [3, 3]\nplumage = [\"dark\"]\n");
  const Expansion expansion(catalogue);
  BackgroundFiles files;
  files.video = "sky.mkv";
  files.width = 640;
  files.height = 480;
  files.frame_rate_hz = 30;
  files.frames = 60;
  for (std::int64_t i = 0; i < 5; ++i) {
    Item item = expansion.at(i);
    const std::size_t planned = item.scene.intruders.size();
    place(item, catalogue, files);
    ASSERT_EQ(item.scene.intruders.size(), planned);
    EXPECT_GE(planned, 5U);
    EXPECT_TRUE(is_aircraft(item.scene.intruders[0]));
    const trajectory::Path camera = setup::camera_path(item.scene.camera);
    const double meets_s = item.distractors.flocks[0].encounter.meeting_share * 1.0;
    const Vector3 own = camera.at(meets_s)->position_in_world;
    for (std::size_t k = 1; k < planned; ++k) {
      const scene::Intruder& bird = item.scene.intruders[k];
      EXPECT_EQ(bird.distractor->plumage, shapes::Plumage::kDark);
      const Vector3 at = setup::path_of(bird, camera).at(meets_s)->position_in_world;
      EXPECT_NEAR((at - own).norm(), 60, 3.2);
    }
    // The same sequence comes out the same, whatever was placed before.
    Item again = expansion.at(i);
    place(again, catalogue, files);
    EXPECT_EQ(scene::toml_from_scene(again.scene), scene::toml_from_scene(item.scene));
  }
}

// An insect is three times as long as it is wide, but no longer than a scene's mark may be.
TEST(DistractorRules, TheLargestInsectsAreThoseOfAScene) {
  const Catalogue catalogue =
      catalogue_with("[[distractor]]\nkind = \"insect\"\nspot_px = [1000, 5000]\n");
  double longest_px = 0;
  for (std::int64_t i = 0; i < 20; ++i)
    for (const DrawnMark& drawn : draw_distractors(catalogue.distractors, 1, i).marks) {
      EXPECT_GE(drawn.mark.length_px, drawn.mark.size_px);
      longest_px = std::max(longest_px, drawn.mark.length_px);
    }
  EXPECT_EQ(longest_px, 5000);
}

TEST(DistractorRules, AnInsectCrossesThePicture) {
  const Catalogue catalogue = catalogue_with("[[distractor]]\nkind = \"insect\"\n");
  const Expansion expansion(catalogue);
  BackgroundFiles files;
  files.video = "sky.mkv";
  files.width = 640;
  files.height = 480;
  files.frame_rate_hz = 30;
  files.frames = 60;
  Item item = expansion.at(7);
  place(item, catalogue, files);
  ASSERT_EQ(item.scene.lens_marks.size(), 1U);
  const scene::LensMark& insect = item.scene.lens_marks[0];
  const Pixel middle = *insect.pixel + (*insect.end_s - insect.begin_s) / 2 * insect.velocity_px_s;
  EXPECT_TRUE(middle.x() >= 0 && middle.x() < 640 && middle.y() >= 0 && middle.y() < 480);
  EXPECT_GT((*insect.pixel - middle).norm(), std::hypot(640, 480));
}

TEST(DistractorRules, ProductsHaveNegativesToo) {
  const std::string text =
      "name = \"set\"\nnegatives = 0.25\n[[background]]\nname = \"sky\"\nflight = { seed = 1, "
      "frame_count = 60 }\nlens = { vertical_fov_deg = 60 }\n[[aircraft]]\nname = \"a\"\naircraft "
      "= "
      "\"c172/news\"\n[[aircraft]]\nname = \"b\"\naircraft = \"738/738-Ryanair\"\n";
  std::string trajectories;
  for (int i = 0; i < 10; ++i)
    trajectories += "[[trajectory]]\nname = \"t" + std::to_string(i) +
                    "\"\nwaypoints_ned_m = [[100, 0, -150], [100, 10, -150]]\nspeed_mps = 30\n";
  const Catalogue catalogue = parse_catalogue(
      text + trajectories + "[[product]]\nname = \"{trajectory}-{aircraft}\"\n", "/data/c.toml");
  const Expansion expansion(catalogue);
  int negatives = 0;
  for (std::int64_t i = 0; i < expansion.size(); ++i)
    negatives += expansion.at(i).scene.intruders.empty();
  EXPECT_NEAR(negatives, 5, 1);
}

TEST(DistractorRules, WrongKeysAreNamed) {
  EXPECT_NE(message_of("[[distractor]]\nkind = \"bird\"\nopacity = [0.1, 0.2]\n")
                .find("opacity has no effect with kind = \"bird\""),
            std::string::npos);
  EXPECT_NE(message_of("[[distractor]]\nkind = \"dirt\"\nsize_m = [1, 2]\n")
                .find("size_m has no effect with kind = \"dirt\""),
            std::string::npos);
  EXPECT_NE(message_of("[[distractor]]\nkind = \"bird\"\nplumage = [\"pink\"]\n")
                .find("plumage[0] is 'pink'; expected gull, dark, brown or grey"),
            std::string::npos);
  EXPECT_NE(message_of("[[distractor]]\nkind = \"bird\"\nsize_m = [2, 1]\n")
                .find("size_m falls; expected [low, high]"),
            std::string::npos);
  EXPECT_NE(message_of("[[distractor]]\nkind = \"bird\"\nshare = 1.5\n").find("share is 1.5"),
            std::string::npos);
  EXPECT_NE(message_of("[[distractor]]\nsize_m = [1, 2]\n").find("has no kind"), std::string::npos);
}

}  // namespace
}  // namespace airtruth::catalogue
