// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/spots.h"

#include <gtest/gtest.h>

namespace airtruth::composite {
namespace {

image::Spot circle(double x, double y, double radius_px) {
  image::Spot spot;
  spot.centre = {x, y};
  spot.radius_px = radius_px;
  return spot;
}

Spots in_frame(const image::Spot& spot) { return {{spot}, {}, 64, 48}; }

TEST(Spots, AlphaFallsFromTheMiddleToTheRim) {
  image::Spot spot = circle(30, 20, 20);
  spot.softness = 0.5;
  spot.opacity = 0.4;
  EXPECT_NEAR(spot_alpha(spot, {30, 20}, 0), 0.4, 1e-12);
  EXPECT_NEAR(spot_alpha(spot, {39.9, 20}, 0), 0.4, 1e-3);
  EXPECT_NEAR(spot_alpha(spot, {30, 35}, 0), 0.2, 1e-12);
  EXPECT_EQ(spot_alpha(spot, {50, 20}, 0), 0);
}

image::Layer over(image::Layer layer, std::size_t intruders, const Spots& all, int margin_px = 0) {
  return with_spots(std::move(layer), intruders, all, covers_of(all), margin_px);
}

// In the middle of a wing the cubic fade is 1, half a radius beside it 1/2; where body and wings
// meet, light passes both.
TEST(Spots, WingsLieAcrossTheBody) {
  image::Spot spot;
  spot.radius_px = 4;
  spot.half_length_px = 10;
  spot.opacity = 0.5;
  spot.wing_px = 30;
  spot.wing_radius_px = 8;
  spot.wing_share = 0.4;
  EXPECT_NEAR(spot_alpha(spot, {0, 25}, 0), 0.2, 1e-12);
  EXPECT_NEAR(spot_alpha(spot, {4, -25}, 0), 0.1, 1e-12);
  EXPECT_EQ(spot_alpha(spot, {0, 38}, 0), 0);
  EXPECT_NEAR(spot_alpha(spot, {0, 0}, 0), 1 - 0.5 * 0.8, 1e-12);
  EXPECT_NEAR(spot_alpha(spot, {12, 0}, 0), 0.5, 1e-12);
}

TEST(Spots, ASharpDiscCoversItsArea) {
  const image::Layer layer = over({}, 0, in_frame(circle(30.3, 20.7, 10)));
  double sum = 0;
  for (const image::LayerPixel& pixel : layer.pixels) sum += double(pixel.alpha);
  EXPECT_NEAR(sum, kPi * 100, 1.5);
  EXPECT_NEAR(layer.areas[0].alone_px, kPi * 100, 2);
  EXPECT_NEAR(layer.areas[0].alone_in_frame_px, layer.areas[0].alone_px, 1e-9);
}

TEST(Spots, TheFrameCutsHalfOfASpotOnItsEdge) {
  const image::Layer layer = over({}, 0, in_frame(circle(0, 20, 10)), 3);
  EXPECT_NEAR(layer.areas[0].alone_in_frame_px / layer.areas[0].alone_px, 0.5, 0.01);
  EXPECT_GE(layer.patch.x, 0);
}

// The first row is read 10 ms before the frame's time, when the spot was 6 px higher: its centre
// was on the edge.
TEST(Spots, TheFrameCutsAFallingSpotWhereARollingShutterSeesIt) {
  Spots all = in_frame(circle(30, 6, 10));
  all.spots[0]->velocity_px_s = {0, 600};
  all.shutter.readout_s = 0.02;
  const image::Layer layer = over({}, 0, all);
  EXPECT_NEAR(layer.areas[0].alone_in_frame_px / layer.areas[0].alone_px, 0.5, 0.02);
}

TEST(Spots, AMovingSpotIsAStreakOfTheSameSum) {
  image::Spot spot = circle(30, 20, 3);
  Spots all = in_frame(spot);
  const auto sum_and_most = [](const image::Layer& layer) {
    std::pair<double, double> result;
    for (const float a : layer.coverage[0].alpha) {
      result.first += double(a);
      result.second = std::max(result.second, double(a));
    }
    return result;
  };
  const auto [still, most_still] = sum_and_most(over({}, 0, all));
  all.spots[0]->velocity_px_s = {2000, 0};
  all.shutter.exposure_s = 0.01;  // 20 px
  const auto [moved, most_moved] = sum_and_most(over({}, 0, all));
  EXPECT_NEAR(moved, still, 0.02 * still);
  EXPECT_NEAR(most_still, 1, 1e-6);
  EXPECT_NEAR(most_moved, 6.0 / 20, 0.05);
}

// A layer of one grey intruder that covers x from 20 to 39, of alpha 1.
image::Layer grey_square() {
  image::Layer layer;
  layer.patch = {20, 10, 20, 20};
  layer.pixels.assign(400, {0.5F, 0.5F, 0.5F, 1});
  layer.depth_m.assign(400, 100);
  layer.coverage = {image::Coverage(layer.patch, 1)};
  layer.areas = {{400, 400, 400, 400, 400}};
  return layer;
}

TEST(Spots, ASpotHidesItsShareOfAnIntruder) {
  image::Spot spot = circle(20, 20, 200);  // even over the whole picture
  spot.opacity = 0.25;
  spot.colour = {0.1F, 0.1F, 0.1F};
  image::Layer layer = grey_square();
  hide_behind(layer, covers_of(in_frame(spot)), {});
  EXPECT_NEAR(layer.areas[0].seen_px, 300, 1e-3);
  EXPECT_NEAR(layer.areas[0].free_px, 300, 1e-3);
  const image::Layer both = over(std::move(layer), 1, in_frame(spot));
  ASSERT_EQ(both.coverage.size(), 2U);
  const std::size_t i = both.index(25, 15);
  EXPECT_NEAR(both.pixels[i].red, 0.25 * 0.1 + 0.75 * 0.5, 1e-6);
  EXPECT_NEAR(both.pixels[i].alpha, 1, 1e-6);
  EXPECT_NEAR(both.coverage[0].at(25, 15), 0.75, 1e-6);
  EXPECT_NEAR(both.coverage[1].at(25, 15), 0.25, 1e-6);
  EXPECT_NEAR(both.pixels[both.index(0, 0)].alpha, 0.25, 1e-6);
}

TEST(Spots, ALaterSpotHidesItsShareOfAnEarlierOne) {
  Spots all = in_frame(circle(30, 20, 5));
  image::Spot over_all = circle(30, 20, 200);
  over_all.opacity = 0.25;
  all.spots.emplace_back(over_all);
  const std::vector<image::Areas> areas = over({}, 0, all).areas;
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_NEAR(areas[0].seen_px, 0.75 * areas[0].alone_in_frame_px, 1e-3);
  EXPECT_EQ(areas[0].clear_px, areas[0].seen_px);
  EXPECT_EQ(areas[1].seen_px, areas[1].alone_in_frame_px);
}

TEST(Spots, TheOwnAircraftIsBehindTheLensAndBeforeTheIntruder) {
  image::Mask own{64, 48, std::vector<unsigned char>(64 * 48, 255)};
  for (int y = 0; y < 48; ++y)
    for (int x = 30; x < 64; ++x) own.free[static_cast<std::size_t>(y * 64 + x)] = 0;
  image::Spot spot = circle(20, 20, 200);
  spot.opacity = 0.5;
  const Occlusion occlusion{{own_aircraft(own)}, {500}};
  image::Layer layer = grey_square();
  find_areas(layer, occlusion);
  EXPECT_NEAR(layer.areas[0].free_px, 200, 1e-3);
  hide_behind(layer, covers_of(in_frame(spot)), occlusion);
  EXPECT_NEAR(layer.areas[0].seen_px, 200, 1e-3);
  EXPECT_NEAR(layer.areas[0].free_px, 100, 1e-3);
  EXPECT_NEAR(layer.areas[0].clear_px, 100, 1e-3);
  hide(layer, occlusion);
  const image::Layer both = over(std::move(layer), 1, in_frame(spot));
  EXPECT_TRUE(both.closed.empty());
  EXPECT_NEAR(both.coverage[0].at(25, 15), 0.5, 1e-6);
  EXPECT_EQ(both.coverage[0].at(35, 15), 0);
  EXPECT_NEAR(both.coverage[1].at(35, 15), 0.5, 1e-6);
}

TEST(Spots, OneOutsideTheFrameIsOutOfView) {
  EXPECT_TRUE(are_out_of_view(covers_of(in_frame(circle(-30, 20, 10)))));
  EXPECT_FALSE(are_out_of_view(covers_of(in_frame(circle(-5, 20, 10)))));
  EXPECT_TRUE(are_out_of_view(covers_of({{std::nullopt}, {}, 64, 48})));
}

TEST(Spots, ASoftSpotNeedsOneSampleOfAPixel) {
  image::Spot spot = circle(30, 20, 20);
  spot.softness = 0.8;
  spot.opacity = 0.9;
  for (int y = 0; y < 40; y += 3)
    for (int x = 0; x < 60; x += 3) {
      double mean = 0;
      for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 16; ++i)
          mean += spot_alpha(spot, {x + (i + 0.5) / 16, y + (j + 0.5) / 16}, 0) / 256;
      EXPECT_NEAR(pixel_alpha(spot, x, y, in_frame(spot)), mean, 1.5e-3);
    }
}

}  // namespace
}  // namespace airtruth::composite
