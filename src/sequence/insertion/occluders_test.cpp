// SPDX-License-Identifier: Apache-2.0
// What stands before intruders, through the whole way from a scene's masks to a frame's truth.
#include "sequence/insertion/occluders.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "foundation/base/files.h"
#include "picture/video/still.h"
#include "sequence/insertion/frame_truth.h"
#include "sequence/insertion/masks.h"
#include "sequence/insertion/paint.h"
#include "sequence/setup/world.h"
#include "support/error_of.h"

namespace airtruth::insertion {
namespace {

constexpr lens::ImageSize kFrame{320, 240};

// A balloon of a given size in the middle of the picture, and one beside it.
std::string balloon(double range_m, double right_m, double size_m) {
  return fmt::format(
      "[[distractor]]\nkind = \"balloon\"\nposition_ned_m = [{}, {}, -150]\nsize_m = {}\n",
      range_m,
      right_m,
      size_m);
}

class BehindAHill : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  scene::Scene scene_of(const std::string& text) const {
    return scene::parse_scene(
        "[background]\nvideo = \"none.mp4\"\n[lens]\nvertical_fov_deg = 50\n[optics]\n"
        "point_spread_px = 0.8\n" +
            text,
        folder_ / "s.toml");
  }

  // A slope from black at x = 140 to white at x = 180.
  static int hill(int x) { return std::clamp((x - 140) * 255 / 40, 0, 255); }
  void write_hill(const std::string& name, int shift = 0) const {
    video::Grey grey{kFrame.width, kFrame.height, {}};
    for (int y = 0; y < kFrame.height; ++y)
      for (int x = 0; x < kFrame.width; ++x)
        grey.samples.push_back(static_cast<std::uint8_t>(hill(x - shift)));
    write_file(folder_ / name, video::png_of(grey));
  }

  struct Made {
    image::Picture picture;
    annotation::Frame truth;
    image::Layer layer;
    bool horizon_is_assumed = false;
  };
  // Level sky over ground, the horizon `down_px` below the middle.
  static image::Picture land(double down_px) {
    image::Colour colour;
    colour.chroma = image::Chroma::k444;
    colour.range = image::Range::kFull;
    image::Picture picture = image::make_picture(kFrame.width, kFrame.height, colour);
    for (int y = 0; y < kFrame.height; ++y) {
      const bool is_sky = y + 0.5 < kFrame.height / 2.0 + down_px;
      std::fill_n(picture.planes[0].row(y), kFrame.width, std::uint8_t(is_sky ? 190 : 90));
      std::fill_n(picture.planes[1].row(y), kFrame.width, std::uint8_t(is_sky ? 142 : 112));
      std::fill_n(picture.planes[2].row(y), kFrame.width, std::uint8_t(is_sky ? 116 : 126));
    }
    return picture;
  }
  Made made(const std::string& text, std::int64_t frame = 0, double down_px = 1000) const {
    const scene::Scene scene = scene_of(text);
    const setup::World world = setup::load_world(scene, kFrame, {});
    const setup::Moment moment = setup::moment_at(world, frame, 0, {});
    video::Frame shown;
    shown.picture = land(down_px);
    shown.index = frame;
    Painter painter(scene, world, Occluders(scene, world.lens, nullptr, frame + 1));
    Painted painted = painter.paint(shown.picture, moment, Ambient{});
    Made result;
    result.truth = frame_truth(world, shown, "none", {}, moment, painted);
    result.picture = std::move(shown.picture);
    result.layer = std::move(painted.layer);
    result.horizon_is_assumed = painted.horizon_is_assumed;
    return result;
  }

  fs::path folder_ =
      fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

const std::string kHill = "[[occluder]]\nrange_m = 50\nmask = \"hill.png\"\n";

// Alpha in the whole frame, 0..1.
double alpha_at(const image::Layer& layer, int x, int y) {
  if (layer.empty() || !layer.patch.contains(x, y)) return 0;
  const std::size_t i = layer.index(x, y);
  return layer.is_open(i) ? layer.pixels[i].alpha : 0;
}

TEST_F(BehindAHill, AlphaIsWhatTheMaskLeavesOfTheAlphaWithoutIt) {
  write_hill("hill.png");
  const std::string far = balloon(60, 0, 12);
  const Made alone = made(far);
  const Made behind = made(far + kHill);
  double area = 0, shown = 0;
  PixelBox box{kFrame.width, kFrame.height, 0, 0};
  int right = 0, bottom = 0;
  for (int y = 0; y < kFrame.height; ++y)
    for (int x = 0; x < kFrame.width; ++x) {
      const double before = alpha_at(alone.layer, x, y);
      const double expected = (1 - hill(x) / 255.0) * before;
      ASSERT_NEAR(alpha_at(behind.layer, x, y), expected, 1e-6) << x << ' ' << y;
      area += before, shown += expected;
      if (std::lround(255 * expected) < composite::kCoveredAlpha) continue;
      box.x = std::min(box.x, x), box.y = std::min(box.y, y);
      right = std::max(right, x + 1), bottom = std::max(bottom, y + 1);
    }
  const annotation::Intruder& one = behind.truth.intruders.at(0);
  EXPECT_EQ(one.covered_box_px, (PixelBox{box.x, box.y, right - box.x, bottom - box.y}));
  EXPECT_LT(right, 180);
  EXPECT_NEAR(one.alpha_sum_px, shown, 1e-3);
  EXPECT_NEAR(*one.hidden_by_occluder, 1 - shown / area, 2e-3);
  EXPECT_EQ(one.hidden_by_own_aircraft, 0);
  EXPECT_FALSE(alone.truth.intruders.at(0).hidden_by_occluder);
  // Where the mask is white, and left of all light, the picture keeps its bits.
  const image::Picture before = land(1000);
  for (int y = 0; y < kFrame.height; ++y)
    for (int x = 180; x < kFrame.width; ++x)
      ASSERT_EQ(behind.picture.planes[0].row(y)[x], before.planes[0].row(y)[x]);
  // The mask that is written is the alpha that was drawn.
  const auto masks = mask_files(behind.truth, behind.layer, kFrame);
  ASSERT_EQ(masks.size(), 1U);
  write_file(folder_ / "alpha.png", masks[0].png);
  const video::Grey alpha = video::read_grey(folder_ / "alpha.png");
  for (int x = 0; x < kFrame.width; ++x)
    EXPECT_EQ(alpha.samples[static_cast<std::size_t>(120 * kFrame.width + x)],
              std::lround(255 * std::min(1.0, alpha_at(behind.layer, x, 120))));
}

TEST_F(BehindAHill, WhatIsNearerKeepsItsBits) {
  write_hill("hill.png");
  const std::string near = balloon(40, 2, 8);
  const Made without = made(near);
  const Made with = made(near + kHill);
  EXPECT_TRUE(image::identical(without.picture, with.picture));
  EXPECT_EQ(with.truth.intruders.at(0).hidden_by_occluder, 0.0);
  // Beside one that the hill hides, it is the same.
  const Made both = made(balloon(60, 14, 4) + near + kHill);
  EXPECT_EQ(both.truth.intruders.at(0).state, annotation::State::kHidden);
  EXPECT_NEAR(*both.truth.intruders.at(0).hidden_by_occluder, 1, 1e-6);
  EXPECT_TRUE(image::identical(without.picture, both.picture));
}

TEST_F(BehindAHill, ASeriesHasAMaskForEachFrameOfTheClip) {
  for (int k = 0; k < 4; ++k) write_hill(fmt::format("hill{}.png", k), k % 2 == 0 ? 0 : 100);
  const std::string text =
      balloon(60, 0, 12) + "[[occluder]]\nrange_m = 50\nmask = \"hill%d.png\"\n";
  EXPECT_NEAR(alpha_at(made(text, 2).layer, 175, 120), 1 - hill(175) / 255.0, 1e-6);
  EXPECT_NEAR(alpha_at(made(text, 3).layer, 175, 120), 1, 1e-6);
  try {
    made(text, 4);
    FAIL() << "a scene beyond the masks";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("mask has 4 pictures, and the scene goes to frame 4"),
              std::string::npos)
        << error.what();
  }
}

// The horizon of the picture, not that of the stated attitude, hides: it is 3 px lower.
TEST_F(BehindAHill, WhatIsBelowTheHorizonIsHidden) {
  const std::string text =
      balloon(60, 0, 12) + "[[occluder]]\nrange_m = 50\nbeyond_horizon = true\n";
  const Made alone = made(balloon(60, 0, 12));
  const Made sunk = made(text, 0, 3);
  EXPECT_FALSE(sunk.horizon_is_assumed);
  for (int y = 0; y < kFrame.height; ++y)
    EXPECT_NEAR(alpha_at(sunk.layer, 150, y),
                y < 123 ? alpha_at(alone.layer, 150, y) : 0,
                y == 122 || y == 123 ? 0.5 : 1e-6)
        << y;
  // A picture without one: where the camera's attitude puts it, 0.393 degrees below the middle of a
  // level camera 150 m high, at 120 + 120 / tan(25 deg) tan(0.393 deg) = 121.77 px.
  const Made sky = made(text);
  EXPECT_TRUE(sky.horizon_is_assumed);
  EXPECT_NEAR(alpha_at(sky.layer, 150, 122), 0, 1e-4);
  EXPECT_NEAR(alpha_at(sky.layer, 150, 121), 0.77 * alpha_at(alone.layer, 150, 121), 0.01);
  EXPECT_NEAR(alpha_at(sky.layer, 150, 120), alpha_at(alone.layer, 150, 120), 1e-4);
}

TEST_F(BehindAHill, MasksThatCannotBeRight) {
  const auto message_of = [&](const std::string& mask) -> std::string {
    return test_support::error_of([&] {
      made(balloon(60, 0, 12) + fmt::format("[[occluder]]\nrange_m = 50\nmask = \"{}\"\n", mask));
    });
  };
  video::Grey grey{kFrame.width, kFrame.height, std::vector<std::uint8_t>(320 * 240, 0)};
  write_file(folder_ / "black.png", video::png_of(grey));
  EXPECT_NE(message_of("black.png").find("black all over"), std::string::npos);
  grey = {4, 4, std::vector<std::uint8_t>(16, 255)};
  write_file(folder_ / "small.png", video::png_of(grey));
  EXPECT_NE(message_of("small.png").find("is 4x4; expected the video's 320x240"),
            std::string::npos);
  video::write_still(folder_ / "colours.png", image::make_rgb8(320, 240));
  EXPECT_NE(message_of("colours.png").find("is no grey picture"), std::string::npos);
  EXPECT_NE(message_of("none.png").find("none.png"), std::string::npos);
}

TEST_F(BehindAHill, AMaskWhoseBlackIsThatOfVideoIsNamed) {
  std::vector<std::string> warnings;
  const auto read = [&](int black) {
    video::Grey grey{kFrame.width, kFrame.height, std::vector<std::uint8_t>(320 * 240, 255)};
    grey.samples[7] = static_cast<std::uint8_t>(black);
    write_file(folder_ / "hill.png", video::png_of(grey));
    const scene::Scene scene = scene_of(balloon(60, 0, 12) + kHill);
    const setup::World world = setup::load_world(scene, kFrame, {});
    Occluders(scene, world.lens, nullptr, 1, [&](const std::string& w) { warnings.push_back(w); });
  };
  read(0);
  read(17);
  EXPECT_TRUE(warnings.empty());
  read(16);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("is nowhere darker than 16 of 255, and so hides 6 % everywhere"),
            std::string::npos)
      << warnings[0];
}

}  // namespace
}  // namespace airtruth::insertion
