// SPDX-License-Identifier: Apache-2.0
#include "picture/render/swing.h"

#include <gtest/gtest.h>

#include "aircraft/shapes/shapes.h"

namespace airtruth::render {
namespace {

// A hand of a beating wing, at times that are none of the table's: its tip is within two hundredths
// of a millimetre of its exact place.
TEST(SwingTable, ATipIsWhereItsExactPoseHasIt) {
  const aircraft::Mesh gull = aircraft::bird({.span_m = 1.34, .strokes_per_s = 3, .glide = 0});
  for (const aircraft::Part& part : gull.parts) {
    const SwingTable table = SwingTable::of(part, 0.4, {-0.011, 0.017});
    EXPECT_EQ(table.empty(), part.hinges.empty()) << part.name;
    if (table.empty()) continue;
    for (double dt_s = -0.011; dt_s <= 0.017; dt_s += 0.00037) {
      const Eigen::Affine3f exact = aircraft::body_from_part(part, 0.4 + dt_s);
      for (const aircraft::Triangle& triangle : part.triangles) {
        const Eigen::Vector3f point = gull.positions[triangle.vertex[0]];
        EXPECT_NEAR((table.at(dt_s) * (exact * point) - point).norm(), 0, 2e-5);
      }
    }
  }
}

TEST(SwingTable, WhatDoesNotSwingAndAnInstantHaveNone) {
  const aircraft::Mesh quad = aircraft::multirotor({});
  for (const aircraft::Part& part : quad.parts)
    EXPECT_TRUE(SwingTable::of(part, 0, {0, 0.01}).empty());
  const aircraft::Mesh gull = aircraft::bird({});
  for (const aircraft::Part& part : gull.parts)
    EXPECT_TRUE(SwingTable::of(part, 0, {0, 0}).empty());
}

}  // namespace
}  // namespace airtruth::render
