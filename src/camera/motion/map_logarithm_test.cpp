// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/map_logarithm.h"

#include <cmath>

#include <gtest/gtest.h>

namespace airtruth::motion {
namespace {

Homography map_of(double a, double b, double c, double d, double e, double f, double g, double h) {
  Homography map;
  map << a, b, c, d, e, f, g, h, 1;
  return map;
}

void expect_equal(const Homography& a, const Homography& b, double tolerance) {
  for (int i = 0; i < 9; ++i)
    EXPECT_NEAR(a(i / 3, i % 3), b(i / 3, i % 3), tolerance) << i / 3 << ", " << i % 3;
}

// A shift has itself less the identity as its logarithm.
TEST(MapLogarithm, OfAShiftIsTheShift) {
  for (const double px : {1e-6, 0.3, 40.0, 3000.0}) {
    const Homography shift = map_of(1, 0, px, 0, 1, -2 * px, 0, 0);
    const Homography expected = shift - Homography::Identity();
    expect_equal(logarithm(shift), expected, 1e-12 * px);
    expect_equal(exponential(expected), shift, 1e-12 * px);
  }
}

// A turn of the picture by an angle has the angle as its logarithm, and a zoom its own.
TEST(MapLogarithm, OfATurnIsTheAngleAndOfAZoomItsLogarithm) {
  for (const double angle : {1e-7, 0.02, 0.7, 2.5, 3.0}) {
    const double c = std::cos(angle), s = std::sin(angle);
    const Homography turn = map_of(c, -s, 0, s, c, 0, 0, 0);
    Homography expected = Homography::Zero();
    expected(1, 0) = angle;
    expected(0, 1) = -angle;
    expect_equal(logarithm(turn), expected, 1e-13);
    expect_equal(exponential(expected), turn, 1e-13);
  }
  const Homography zoom = Vector3(4, 4, 1 / 16.0).asDiagonal();
  const Homography of_zoom = Vector3(std::log(4), std::log(4), -2 * std::log(4)).asDiagonal();
  expect_equal(logarithm(zoom), of_zoom, 1e-13);
  expect_equal(exponential(of_zoom), zoom, 1e-12);
}

// The logarithm of the square is twice that of the map, and the exponential is its inverse.
TEST(MapLogarithm, OfAMapWithPerspective) {
  Homography map = map_of(1.02, -0.05, 31.7, 0.04, 0.97, -12.4, 3e-5, -1e-5);
  map /= std::cbrt(map.determinant());
  const Homography log = logarithm(map);
  EXPECT_NEAR(log.trace(), 0, 1e-13);  // the determinant is 1
  expect_equal(exponential(log), map, 1e-11);
  expect_equal(logarithm(map * map), 2 * log, 1e-10);
}

TEST(MapLogarithm, IsNotFiniteWhereThereIsNone) {
  const Homography mirrored = Vector3(-1, -2, 0.5).asDiagonal();
  EXPECT_FALSE(logarithm(mirrored).allFinite());
  const Homography nan = Homography::Constant(std::nan(""));
  EXPECT_FALSE(logarithm(nan).allFinite());
  EXPECT_FALSE(exponential(nan).allFinite());
}

}  // namespace
}  // namespace airtruth::motion
