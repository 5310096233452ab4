// SPDX-License-Identifier: Apache-2.0
#include "dataset/sequences/labels_of_truth.h"

#include <gtest/gtest.h>

namespace airtruth::sequences {
namespace {

annotation::Intruder seen(const std::string& aircraft, const std::string& object_class) {
  annotation::Intruder intruder;
  intruder.id = intruder.aircraft = aircraft;
  intruder.object_class = object_class;
  intruder.state = annotation::State::kVisible;
  intruder.exact_box_px = Box{10, 20, 30, 40};
  intruder.covered_box_px = intruder.visible_box_px = PixelBox{10, 20, 30, 40};
  return intruder;
}

TEST(LabelsOfTruth, CarryTheClassAndADistractorsCategoryIsItsClass) {
  annotation::Frame frame;
  frame.intruders = {
      seen("738/738-Ryanair", "aircraft"), seen("bird", "bird"), seen("dirt", "dirt")};
  frame.intruders[1].range_m = 60;
  frame.intruders[1].position_ned_m = {60, 0, -160};
  const exchange::LabelledFrame labelled = labels_of(frame, dataset::Boxes::kCovered, 640, 480);
  ASSERT_EQ(labelled.labels.size(), 3U);
  EXPECT_EQ(labelled.labels[0].category, "738");
  EXPECT_EQ(labelled.labels[0].object_class, "aircraft");
  EXPECT_EQ(labelled.labels[1].category, "bird");
  EXPECT_EQ(labelled.labels[1].object_class, "bird");
  EXPECT_EQ(labelled.labels[1].range_m, 60);
  EXPECT_EQ(labelled.labels[2].object_class, "dirt");
  EXPECT_EQ(labelled.labels[2].track, 3);
  EXPECT_FALSE(labelled.labels[2].range_m);
  EXPECT_FALSE(labelled.labels[2].above_horizon);
}

}  // namespace
}  // namespace airtruth::sequences
