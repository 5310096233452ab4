// SPDX-License-Identifier: Apache-2.0
#include "picture/render/sorted_samples.h"

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

// Compares the marks of sorted samples with an inside test of every sample in double precision.
namespace airtruth::render {
namespace {

constexpr int kSamples = 1024;

struct Triangle {
  std::array<Pixel, 3> corner;  // in the middle of the exposure, in a frame whose pixel is (7, 5)
  std::array<Pixel, 3> drift;   // of each corner to the end of the exposure
};

// The triangle's picture at the beginning, the middle and the end of a span of which a pixel's
// exposure is the half.
MovingTriangle moving(const Triangle& triangle) {
  const lens::Lens lens(lens::Pinhole{{100, 100}, {8, 8}}, {16, 16});
  std::vector<Eye> eyes(3);
  for (Eye& eye : eyes) eye.view.lens = &lens;
  std::array<std::array<Seen, 3>, 3> seen;
  std::vector<Corners> corners(3);
  for (std::size_t moment = 0; moment < 3; ++moment)
    for (std::size_t k = 0; k < 3; ++k) {
      const double exposures = 2 * (static_cast<double>(moment) - 1);
      seen[moment][k] = {Vector3::Zero(), triangle.corner[k] + exposures * triangle.drift[k], 0.01};
      corners[moment][k] = &seen[moment][k];
    }
  return *MovingTriangle::of(corners, eyes, 0.5, kNearlyStraight);
}

double across(const Pixel& a, const Pixel& b) { return a.x() * b.y() - a.y() * b.x(); }

// The distance of a place from the nearest side's line, in pixels; positive inside.
double depth_inside(const Triangle& triangle, const Pixel& place, double time) {
  std::array<Pixel, 3> p = triangle.corner;
  for (std::size_t k = 0; k < 3; ++k) p[k] += (2 * time - 1) * triangle.drift[k];
  if (across(p[1] - p[0], p[2] - p[0]) < 0) std::swap(p[1], p[2]);
  double least = 1e9;
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel side = p[(k + 1) % 3] - p[k];
    least = std::min(least, across(side, place - p[k]) / side.norm());
  }
  return least;
}

// turns_px: the most that one corner moves more than another, along one axis, from the middle of
// the exposure to its end.
void expect_marks_of_what_is_inside(double turns_px) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.7, 1.7);
  std::uniform_real_distribution<double> size(-0.6, 0.6);
  std::uniform_real_distribution<double> motion(-3, 3);
  std::uniform_real_distribution<double> differs(-0.05, 0.05);
  std::uniform_real_distribution<double> turns(-turns_px / 2, turns_px / 2 + 1e-9);
  // A side that turns is off by half of this at its ends, and by more beyond them.
  const double unsure_px = 1e-5 + 2 * turns_px;
  const PixelSamples pixel(7, 5);
  int marked = 0;
  for (int i = 0; i < 400; ++i) {
    const Pixel drift(motion(random), motion(random));
    SortedSamples samples;
    std::vector<std::uint16_t> order;
    samples.fill(pixel, kSamples, drift, order);
    const Pixel middle(7 + place(random), 5 + place(random));
    const Pixel of_triangle = drift + Pixel(differs(random), differs(random));
    Triangle triangle;
    for (Pixel& corner : triangle.corner) corner = middle + Pixel(size(random), size(random));
    for (Pixel& of : triangle.drift) of = of_triangle + Pixel(turns(random), turns(random));
    const RowTriangle row = moving(triangle).over_row(5, 0);
    std::vector<std::int32_t> covered(kSamples, 0);
    if (!row.is_outside) {
      const PixelSides sides = row.over(7, nullptr);
      // Without a side that crosses the pixel every sample is inside.
      if (!sides.is_outside && sides.crossing == 0) std::fill(covered.begin(), covered.end(), -1);
      if (!sides.is_outside && sides.crossing > 0) {
        samples.mark(row, 7, sides.side, covered.data());
        EXPECT_EQ(samples.open(), std::count(covered.begin(), covered.end(), 0));
      }
    }
    for (int s = 0; s < kSamples; ++s) {
      const auto [x, y] = pixel.at(s);
      const double inside = depth_inside(triangle, Pixel(7 + x, 5 + y), pixel.time(s));
      if (std::abs(inside) < unsure_px) continue;
      const bool is_marked = covered[order[static_cast<std::size_t>(s)]] != 0;
      ASSERT_EQ(is_marked, inside > 0) << "triangle " << i << ", sample " << s;
      marked += is_marked;
    }
  }
  EXPECT_GT(marked, 1000);
}

TEST(SortedSamples, MarkWhatIsInsideWhereverTheTriangleIsAndHoweverItMoves) {
  expect_marks_of_what_is_inside(0);
}

TEST(SortedSamples, MarkWhatIsInsideOfATriangleThatTurns) { expect_marks_of_what_is_inside(0.02); }

// The side that two triangles share moves as its own middle does, whatever the third corners do.
TEST(SortedSamples, NoGapOpensBetweenTwoTrianglesThatTurn) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.2, 1.2);
  std::uniform_real_distribution<double> motion(-2, 2);
  std::uniform_real_distribution<double> turns(-0.02, 0.02);
  const PixelSamples pixel(7, 5);
  for (int i = 0; i < 200; ++i) {
    const Pixel drift(motion(random), motion(random));
    const auto near_drift = [&] { return Pixel(drift + Pixel(turns(random), turns(random))); };
    const std::array<Pixel, 2> shared = {Pixel(7 + place(random), 4), Pixel(7 + place(random), 7)};
    const std::array<Pixel, 2> of_shared = {near_drift(), near_drift()};
    std::vector<std::int32_t> covered(kSamples, 0);
    SortedSamples samples;
    std::vector<std::uint16_t> order;
    samples.fill(pixel, kSamples, drift, order);
    for (const double side : {-12.0, 12.0}) {
      const Triangle triangle{{shared[0], shared[1], Pixel(7 + side, 5)},
                              {of_shared[0], of_shared[1], near_drift()}};
      const RowTriangle row = moving(triangle).over_row(5, 0);
      const PixelSides sides = row.over(7, nullptr);
      if (row.is_outside || sides.is_outside) continue;
      if (sides.crossing == 0) std::fill(covered.begin(), covered.end(), -1);
      if (sides.crossing > 0) samples.mark(row, 7, sides.side, covered.data());
    }
    // Both triangles together reach well beyond the pixel but at the ends of the shared side.
    for (int s = 0; s < kSamples; ++s) {
      const auto [x, y] = pixel.at(s);
      const double seen_y = 5 + y - (2 * pixel.time(s) - 1) * drift.y();
      if (seen_y < 4.6 || seen_y > 6.4) continue;
      ASSERT_NE(covered[order[static_cast<std::size_t>(s)]], 0) << "pair " << i << ", sample " << s;
    }
  }
}

TEST(SortedSamples, HoldEachSampleOnce) {
  const PixelSamples pixel(7, 5);
  SortedSamples samples;
  std::vector<std::uint16_t> order;
  samples.fill(pixel, kSamples, {0.4, -1.5}, order);
  EXPECT_EQ(std::set<std::uint16_t>(order.begin(), order.end()).size(), std::size_t{kSamples});
  EXPECT_EQ(samples.open(), kSamples);
  for (int s = 0; s < kSamples; ++s) {
    const std::size_t at = order[static_cast<std::size_t>(s)];
    EXPECT_NEAR(static_cast<double>(samples.places().x[at]), pixel.at(s)[0], 1e-6);
    EXPECT_NEAR(static_cast<double>(samples.places().y[at]), pixel.at(s)[1], 1e-6);
    EXPECT_NEAR(static_cast<double>(samples.places().t[at]), pixel.time(s), 1e-6);
  }
}

}  // namespace
}  // namespace airtruth::render
