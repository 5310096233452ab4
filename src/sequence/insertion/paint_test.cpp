// SPDX-License-Identifier: Apache-2.0
// Distractors through the whole way from a scene to a frame's truth: geometry against pixels.
#include "sequence/insertion/paint.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "aircraft/shapes/shapes.h"
#include "camera/lens/lens.h"
#include "labels/annotation/truth.h"
#include "picture/composite/cover.h"
#include "picture/composite/matte.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/frame_truth.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"

namespace airtruth::insertion {
namespace {

constexpr lens::ImageSize kSize{640, 480};

scene::Scene scene_with(const std::string& text) {
  return scene::parse_scene(
      "[background]\nvideo = \"none.mp4\"\n[lens]\nvertical_fov_deg = 50\n[light]\n"
      "sun_azimuth_deg = 20\nsun_elevation_deg = 30\n" +
          text,
      "s.toml");
}

// A grey picture of full-range 4:4:4 samples.
image::Picture grey_picture() {
  image::Colour colour;
  colour.chroma = image::Chroma::k444;
  colour.range = image::Range::kFull;
  image::Picture picture = image::make_picture(kSize.width, kSize.height, colour);
  for (int p = 0; p < picture.plane_count; ++p)
    for (int y = 0; y < picture.planes[p].height; ++y)
      std::fill_n(picture.planes[p].row(y), picture.planes[p].width, p == 0 ? 150 : 128);
  return picture;
}

struct Drawn {
  annotation::Frame truth;
  image::Picture before, after;
};

Drawn drawn(const scene::Scene& scene, double time_s, const image::Mask* own = nullptr) {
  setup::World world = setup::load_world(scene, kSize, {});
  const setup::Moment moment = setup::moment_at(world, 0, time_s, {});
  Drawn result;
  result.before = grey_picture();
  video::Frame frame;
  frame.picture = result.before.clone();
  frame.time_s = time_s;
  Painter painter(
      scene, world, Occluders(own), open_backdrop(scene, world.lens, {.software = true}));
  const Painted painted = painter.paint(frame.picture, moment, Ambient{});
  result.truth = frame_truth(world, frame, "none", {}, moment, painted);
  result.after = std::move(frame.picture);
  // What the writer refuses fails here.
  annotation::jsonl_line(result.truth, lens::facts_of(world.lens));
  return result;
}

Box floating(const PixelBox& b) {
  return {double(b.x), double(b.y), double(b.width), double(b.height)};
}

// The covered box never reaches beyond the exact one by a pixel, and loses no more than `lost_px`
// of each side: tips that cover less than 0.08 of a pixel.
void expect_boxes_agree(const annotation::Intruder& one, double lost_px) {
  ASSERT_EQ(one.state, annotation::State::kVisible) << one.id;
  ASSERT_TRUE(one.exact_box_px && one.covered_box_px) << one.id;
  const Box exact = *one.exact_box_px;
  const Box covered = floating(*one.covered_box_px);
  EXPECT_GE(covered.x, exact.x - 1);
  EXPECT_GE(covered.y, exact.y - 1);
  EXPECT_LE(covered.right(), exact.right() + 1);
  EXPECT_LE(covered.bottom(), exact.bottom() + 1);
  EXPECT_GE(covered.width, exact.width - 2 * lost_px) << one.id;
  EXPECT_GE(covered.height, exact.height - 2 * lost_px) << one.id;
}

TEST(Distractors, BoxesOfBirdsAgreeByGeometryAndByPixels) {
  for (const char* shutter : {"", "[shutter]\nexposure_s = 0.008\nreadout_s = 0.02\n"})
    for (const double time_s : {0.2, 0.31, 0.47})
      for (const double range_m : {15.0, 40.0}) {
        const Drawn made = drawn(
            scene_with(fmt::format("[[distractor]]\nkind = \"bird\"\nglide = 0\nwaypoints_ned_m = "
                                   "[[{0}, -6, -152], [{0}, 6, -149]]\nspeed_mps = 12\n{1}",
                                   range_m,
                                   shutter)),
            time_s);
        ASSERT_EQ(made.truth.intruders.size(), 1U);
        EXPECT_EQ(made.truth.intruders[0].object_class, "bird");
        EXPECT_NEAR(*made.truth.intruders[0].range_m, range_m, 2.5);
        expect_boxes_agree(made.truth.intruders[0], 1.75);
      }
}

TEST(Distractors, BoxesOfMultirotorsAndBalloonsAgree) {
  for (const char* shutter : {"", "[shutter]\nexposure_s = 0.004\n"}) {
    const Drawn made =
        drawn(scene_with(
                  std::string("[[distractor]]\nkind = \"multirotor\"\nsize_m = 0.8\nposition_ned_m "
                              "= [8, -2, -151]\nvelocity_ned_mps = [0, 4, 0]\n[[distractor]]\nkind "
                              "= \"balloon\"\nposition_ned_m = [6, 1.5, -150]\nvelocity_ned_mps = "
                              "[0, 1, -2]\n") +
                  shutter),
              0.1);
    ASSERT_EQ(made.truth.intruders.size(), 2U);
    // Turning blades are thin: where they sweep during the exposure, little is covered.
    expect_boxes_agree(made.truth.intruders[0], *shutter ? 6 : 1);
    expect_boxes_agree(made.truth.intruders[1], 1);
    // It hangs upright although it rises.
    EXPECT_NEAR(made.truth.intruders[1].attitude_yaw_pitch_roll_deg->at(1), 0, 1e-9);
    EXPECT_NEAR(made.truth.intruders[0].attitude_yaw_pitch_roll_deg->at(1), -6.4, 1e-6);
  }
}

// OpenGL turns a rotor to where it is in the truth.
TEST(ChromaKey, ARotorIsDrawnWhereItsBoxHasIt) {
  for (const double spin_s : {0.0, 0.01, 0.03}) {
    const Drawn made = drawn(
        scene_with(fmt::format("[composite]\nmethod = \"chroma-key\"\n[[intruder]]\naircraft = "
                               "\"helicopter-light/red\"\nspin_time_s = {}\nwaypoints_ned_m = "
                               "[[24, 2, -151], [15, 2, -151]]\nspeed_mps = 20\n",
                               spin_s)),
        0);
    ASSERT_EQ(made.truth.intruders.size(), 1U);
    const annotation::Intruder& helicopter = made.truth.intruders[0];
    ASSERT_TRUE(helicopter.visible_box_px && helicopter.exact_box_px);
    // The kernel spreads an edge, and thin blade tips change nothing.
    EXPECT_LE(helicopter.visible_box_px->width, helicopter.exact_box_px->width + 10) << spin_s;
    EXPECT_GE(helicopter.visible_box_px->width, helicopter.exact_box_px->width - 10) << spin_s;
    ASSERT_TRUE(helicopter.covered_box_px && helicopter.centroid_px);
    const auto [x, y] = *helicopter.centroid_px;
    EXPECT_TRUE(helicopter.covered_box_px->contains(static_cast<int>(x), static_cast<int>(y)));
  }
}

// A small one between the wings of a large one changes its own pixels alone.
TEST(ChromaKey, AChangedPixelIsOfTheNearestIntruder) {
  const auto at = [](double range_m, double right_m, double down_m) {
    return fmt::format(
        "[[intruder]]\naircraft = \"c172/g-boix\"\nwaypoints_ned_m = [[{}, {}, {}], [{}, {}, "
        "{}]]\nspeed_mps = 30\n",
        range_m,
        right_m,
        -150 + down_m,
        range_m - 60,
        right_m,
        -150 + down_m);
  };
  const Drawn made = drawn(
      scene_with("[composite]\nmethod = \"chroma-key\"\n" + at(60, 0, 0) + at(600, 25, -7)), 0);
  ASSERT_EQ(made.truth.intruders.size(), 2U);
  const annotation::Intruder &near = made.truth.intruders[0], &far = made.truth.intruders[1];
  ASSERT_TRUE(far.visible_box_px && far.exact_box_px && near.exact_box_px);
  ASSERT_TRUE(intersection(wider(*near.exact_box_px, 5), *far.exact_box_px));
  const Box spread = wider(*far.exact_box_px, 5), seen = floating(*far.visible_box_px);
  EXPECT_GE(seen.x, spread.x);
  EXPECT_GE(seen.y, spread.y);
  EXPECT_LE(seen.right(), spread.right());
  EXPECT_LE(seen.bottom(), spread.bottom());
}

// The bird as a rigid mesh in the pose of one moment.
model::Mesh posed(const model::Mesh& bird, double time_s) {
  model::Mesh mesh = bird;
  for (const model::Part& part : bird.parts) {
    const Eigen::Affine3f pose = model::body_from_part(part, time_s);
    std::vector<bool> is_moved(mesh.positions.size(), false);
    for (const model::Triangle& triangle : part.triangles)
      for (const std::uint32_t v : triangle.vertex) {
        if (is_moved[v]) continue;
        is_moved[v] = true;
        mesh.positions[v] = pose * bird.positions[v];
        mesh.normals[v] = pose.linear() * bird.normals[v];
      }
  }
  for (model::Part& part : mesh.parts) part.hinges.clear();
  return mesh;
}

std::vector<double> coverage_of_rows(const shade::Model& model,
                                     const render::View& view,
                                     double time_s) {
  const render::Instance instance{&model, {Quaternion::Identity(), {12, 0, 0}}, time_s, {}};
  const image::Layer layer =
      render::render(view, {}, {instance}, {Box{200, 140, 240, 200}}, {.quality = 4});
  std::vector<double> rows(kSize.height, 0);
  for (int y = layer.patch.y; y < layer.patch.bottom(); ++y)
    for (int x = layer.patch.x; x < layer.patch.right(); ++x)
      rows[static_cast<std::size_t>(y)] += double(layer.coverage[0].at(x, y));
  return rows;
}

// 0.8 m at 0.1 m: its arms reach behind the camera, and what lies ahead of it has bounds at
// infinity. It is out of view, 1 m beside the camera.
TEST(Distractors, WhatReachesThroughTheCamerasPlaneOutOfViewHasNoExactBox) {
  for (const double ahead_m : {0.1, 3.0}) {
    const Drawn made = drawn(
        scene_with(fmt::format("[[distractor]]\nkind = \"multirotor\"\nsize_m = 0.8\n"
                               "position_ned_m = [{}, 1, -150.3]\nvelocity_ned_mps = [0, 1, 0]\n",
                               ahead_m)),
        0);
    ASSERT_EQ(made.truth.intruders.size(), 1U);
    EXPECT_EQ(made.truth.intruders[0].exact_box_px.has_value(), ahead_m > 1);
  }
}

// The fuselage, 4 m high and 12 m aside, goes from 31 m ahead to 9 m behind. Right of the middle it
// is u / 3 high: from 199 px on, of which 320 px are in the picture and four times its width counts
// beyond, the picture holds (320^2 - 199^2) / 2880^2 of it, 0.8 %; a wing is in it, too.
TEST(Truth, TheFrameCutsWhatReachesBehindTheCamera) {
  const Drawn made =
      drawn(scene_with("[[intruder]]\naircraft = \"738/738-Ryanair\"\nwaypoints_ned_m = [[11, 12, "
                       "-152], [-49, 12, -152]]\nspeed_mps = 60\n"),
            0);
  ASSERT_EQ(made.truth.intruders.size(), 1U);
  EXPECT_EQ(made.truth.intruders[0].state, annotation::State::kVisible);
  EXPECT_GT(made.truth.intruders[0].cut_by_frame, 0.9);
  EXPECT_LT(made.truth.intruders[0].cut_by_frame, 1);
}

// Its silhouette, below a hundredth of a pixel, lies between the renderer's samples.
TEST(Distractors, ABirdTooFarForAnySampleIsHiddenInViewAndOutsideBesideIt) {
  for (const double right_m : {3.0, 20000.0}) {
    const Drawn made = drawn(
        scene_with(fmt::format(
            "[[distractor]]\nkind = \"bird\"\nposition_ned_m = [20000, {}, -153]\n", right_m)),
        0);
    ASSERT_EQ(made.truth.intruders.size(), 1U);
    EXPECT_EQ(made.truth.intruders[0].state,
              right_m < 100 ? annotation::State::kHidden : annotation::State::kOutside);
    EXPECT_TRUE(made.truth.intruders[0].exact_box_px);
    EXPECT_EQ(made.truth.intruders[0].cut_by_frame, right_m < 100 ? 0 : 1);
  }
}

TEST(Distractors, EachRowSeesItsOwnMomentOfTheStroke) {
  const model::Mesh bird = shapes::bird({.span_m = 2, .strokes_per_s = 5, .glide = 0});
  const lens::Lens lens = lens::pinhole_from_vertical_fov(50, kSize);
  render::View view;
  view.lens = &lens;
  view.world_from_cam = Rigid{cam_from_body().conjugate(), Vector3::Zero()};
  view.width = kSize.width;
  view.height = kSize.height;
  const double time_s = 0.43;
  render::View rolling = view;
  rolling.shutter = {.exposure_s = 0, .readout_s = 0.03};
  const std::vector<double> seen = coverage_of_rows(shade::Model(bird), rolling, time_s);
  for (const int y : {215, 228, 236, 240, 244, 252, 265}) {
    const double row_s = rolling.shutter.middle_s({320.5, y + 0.5}, kSize.width, kSize.height);
    const std::vector<double> still =
        coverage_of_rows(shade::Model(posed(bird, time_s + row_s)), view, time_s);
    const auto row = static_cast<std::size_t>(y);
    EXPECT_NEAR(seen[row], still[row], 0.15 + 0.02 * still[row]) << "row " << y;
  }
}

TEST(Distractors, WhatIsOnTheLensHasBoxesAloneAndTheyAgree) {
  const Drawn made =
      drawn(scene_with("[[distractor]]\nkind = \"dirt\"\npixel = [200, 120]\nsize_px = "
                       "80\nopacity = 0.5\n[[distractor]]\nkind = \"insect\"\npixel = "
                       "[400, 100]\n[[distractor]]\nkind = \"glint\"\n"),
            0);
  ASSERT_EQ(made.truth.intruders.size(), 3U);
  for (const annotation::Intruder& one : made.truth.intruders) {
    ASSERT_EQ(one.state, annotation::State::kVisible) << one.id;
    EXPECT_FALSE(one.range_m);
    EXPECT_FALSE(one.position_ned_m);
    EXPECT_FALSE(one.encounter);
    // The exact box is at half of the opacity, the covered one at an alpha of 0.08, below that.
    const Box exact = *one.exact_box_px;
    const Box covered = floating(*one.covered_box_px);
    EXPECT_LE(covered.x, exact.x + 1) << one.id;
    EXPECT_GE(covered.right(), exact.right() - 1) << one.id;
    EXPECT_NEAR(covered.x + covered.width / 2, exact.x + exact.width / 2, 2) << one.id;
    EXPECT_NEAR(covered.y + covered.height / 2, exact.y + exact.height / 2, 2) << one.id;
    EXPECT_LE(covered.width, 1.7 * exact.width) << one.id;
  }
}

TEST(Distractors, PixelsThatNothingTouchesKeepTheirBits) {
  const Drawn made = drawn(
      scene_with(
          "[[distractor]]\nkind = \"bird\"\ncount = 5\nspread_m = 4\nwaypoints_ned_m = [[30, "
          "-6, -152], [30, 6, -149]]\nspeed_mps = 12\n[[distractor]]\nkind = \"dirt\"\npixel = "
          "[200, 120]\n"),
      0.4);
  std::vector<PixelBox> touched;
  for (const annotation::Intruder& one : made.truth.intruders)
    if (one.visible_box_px) touched.push_back(*one.visible_box_px);
  EXPECT_EQ(touched.size(), 6U);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const bool is_inside = std::any_of(
          touched.begin(), touched.end(), [&](const PixelBox& box) { return box.contains(x, y); });
      for (int p = 0; p < 3 && !is_inside; ++p)
        ASSERT_EQ(made.after.planes[p].row(y)[x], made.before.planes[p].row(y)[x]) << x << ' ' << y;
    }
}

TEST(Distractors, DirtHidesABirdAndLiesOverTheOwnAircraft) {
  const std::string bird =
      "[[distractor]]\nkind = \"bird\"\nglide = 1\nposition_ned_m = [15, 0, -150]\n";
  const std::string dirt =
      "[[distractor]]\nkind = \"dirt\"\npixel = [320, 240]\nsize_px = 400\nsoftness = 0\nopacity = "
      "0.6\n";
  const Drawn alone = drawn(scene_with(bird), 0);
  image::Mask own{kSize.width, kSize.height, std::vector<unsigned char>(640 * 480, 255)};
  for (int y = 300; y < 480; ++y) std::fill_n(&own.free[static_cast<std::size_t>(y * 640)], 640, 0);
  const Drawn both = drawn(scene_with(bird + dirt), 0, &own);
  const annotation::Intruder& hidden = both.truth.intruders[0];
  EXPECT_NEAR(hidden.hidden_by_intruder, 0.6, 1e-3);
  EXPECT_NEAR(hidden.alpha_sum_px, 0.4 * alone.truth.intruders[0].alpha_sum_px, 0.5);
  // The dirt darkens the own aircraft, too.
  const PixelBox changed = *both.truth.intruders[1].visible_box_px;
  EXPECT_GT(changed.bottom(), 400);
  EXPECT_LT(both.after.planes[0].row(420)[320], both.before.planes[0].row(420)[320]);
  EXPECT_EQ(both.truth.intruders[1].hidden_by_own_aircraft, 0);
}

TEST(Distractors, ANearerBalloonHidesABird) {
  const Drawn made = drawn(
      scene_with("[[distractor]]\nkind = \"bird\"\nglide = 1\nposition_ned_m = [15, 0, "
                 "-150]\n[[distractor]]\nkind = \"balloon\"\nposition_ned_m = [8, 0, -150]\n"),
      0);
  EXPECT_GT(made.truth.intruders[0].hidden_by_intruder, 0.1);
  EXPECT_EQ(made.truth.intruders[1].hidden_by_intruder, 0);
}

// A balloon of 40 px in the light of a sun and of a sky that is even.
image::Layer layer_in(const std::string& weather, const std::array<float, 3>& sun) {
  const scene::Scene scene = scene_with(
      "[[distractor]]\nkind = \"balloon\"\nsize_m = 0.6\ncolour = [0.5, 0.5, 0.5]\n"
      "position_ned_m = [8, 0, -150]\n" +
      weather);
  const setup::World world = setup::load_world(scene, kSize, {});
  Ambient ambient;
  ambient.sun = sun;
  ambient.surroundings = shade::Environment::of([](const Vector3&) {
    return image::Rgb{0.2f, 0.3f, 0.4f};
  });
  return render_layer(scene, world, setup::moment_at(world, 0, 0, {}), ambient);
}

std::array<double, 3> sums_of(const image::Layer& layer) {
  std::array<double, 3> sums{};
  for (const image::LayerPixel& pixel : layer.pixels) {
    sums[0] += double{pixel.red};
    sums[1] += double{pixel.green};
    sums[2] += double{pixel.blue};
  }
  return sums;
}

// Light is linear: each factor of [weather] is that of the light that leaves the intruder.
TEST(Weather, ChangesTheLightOnWhatIsInserted) {
  const std::array<float, 3> sun = {0.5f, 0.5f, 0.5f};
  const auto plain = sums_of(layer_in("", sun));
  const auto bright = sums_of(layer_in("[weather]\nexposure = 2\n", sun));
  const auto warm = sums_of(layer_in("[weather]\nwhite_balance = 1.44\n", sun));
  const auto clouded = sums_of(layer_in("[weather]\nsun_share = 0\n", sun));
  const auto sunless = sums_of(layer_in("", {}));
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_GT(plain[c], 100);
    EXPECT_NEAR(bright[c] / plain[c], 2, 1e-4) << c;
    EXPECT_NEAR(warm[c] / plain[c], std::pow(1.2, 1 - static_cast<int>(c)), 1e-4) << c;
    EXPECT_NEAR(clouded[c], sunless[c], 1e-4 * sunless[c]) << c;
    EXPECT_LT(clouded[c], 0.95 * plain[c]) << c;
  }
}

// A factor on what the camera does is the same as that number stated; of noise it is the standard
// deviation's, so that the variance takes its square.
TEST(Weather, ChangesTheCameraOfWhatIsInserted) {
  const std::string balloon =
      "[[distractor]]\nkind = \"balloon\"\nsize_m = 0.6\nposition_ned_m = [8, 0, -150]\n";
  const auto luma = [&](const std::string& tables) {
    const Drawn made = drawn(scene_with(balloon + tables), 0);
    std::vector<std::uint8_t> samples;
    for (int y = 0; y < kSize.height; ++y) {
      const auto* row = made.after.planes[0].row(y);
      samples.insert(samples.end(), row, row + kSize.width);
    }
    return samples;
  };
  const auto of = [&](const char* spread, const char* vertical, const std::string& sensor) {
    return luma(std::string("[optics]\npoint_spread_px = ") + spread +
                "\nvertical_spread_px = " + vertical + "\n[sensor]\nnoise_floor = " + sensor);
  };
  const auto with = of("0.8", "0.5", "1e-5\n[weather]\nblur = 2\nnoise = 3\n");
  EXPECT_EQ(with, of("1.6", "1.0", "9e-5\n"));
  EXPECT_NE(with, of("1.6", "0.5", "9e-5\n"));
  EXPECT_NE(with, of("0.8", "0.5", "1e-5\n"));
}

}  // namespace
}  // namespace airtruth::insertion
