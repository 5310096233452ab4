// SPDX-License-Identifier: Apache-2.0
#include "runners/network/network_output.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "foundation/base/error.h"

namespace airtruth::network {
namespace {

ModelDescription heat_map(int classes) {
  ModelDescription description;
  description.output = HeatMapOutput{"heat", "offset", "size"};
  for (int i = 0; i < classes; ++i) description.classes.push_back("c" + std::to_string(i));
  return description;
}

Tensor zeros(int channels, int rows, int columns) {
  return {{1, channels, rows, columns},
          std::vector<float>(static_cast<std::size_t>(channels * rows * columns), 0.0f)};
}

float& at(Tensor& tensor, int channel, int row, int column) {
  return tensor.values[static_cast<std::size_t>(
      (channel * tensor.shape[2] + row) * tensor.shape[3] + column)];
}

TEST(HeatMap, TheExampleOfTheHeader) {
  Tensor heat = zeros(1, 12, 16);
  Tensor offset = zeros(2, 12, 16);
  Tensor size = zeros(2, 12, 16);
  at(heat, 0, 5, 10) = 0.8f;
  at(heat, 0, 5, 11) = 0.7f;  // no peak
  at(offset, 0, 5, 10) = 0.25f;
  at(offset, 1, 5, 10) = 0.5f;
  at(size, 0, 5, 10) = 12;
  at(size, 1, 5, 10) = 6;
  const auto found = decoded({heat, offset, size}, heat_map(1), 64, 48);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].box_px, (Box{35, 19, 12, 6}));
  EXPECT_FLOAT_EQ(static_cast<float>(found[0].score), 0.8f);
}

TEST(HeatMap, APlateauIsOnePeakAndClassesAreApart) {
  Tensor heat = zeros(2, 4, 4);
  for (int column = 0; column < 3; ++column) at(heat, 1, 2, column) = 0.5f;
  at(heat, 0, 2, 1) = 0.9f;
  Tensor size = zeros(2, 4, 4);
  std::ranges::fill(size.values, 3.0f);
  const auto found = decoded({heat, zeros(2, 4, 4), size}, heat_map(2), 16, 16);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].category, "c0");
  EXPECT_EQ(found[1].category, "c1");
}

TEST(HeatMap, CellsThatDoNotDivideTheInputAreRefused) {
  EXPECT_THROW(decoded({zeros(1, 12, 15), zeros(2, 12, 15), zeros(2, 12, 15)}, heat_map(1), 64, 48),
               Error);
  EXPECT_THROW(decoded({zeros(1, 12, 16), zeros(2, 12, 15), zeros(2, 12, 16)}, heat_map(1), 64, 48),
               Error);
}

ModelDescription yolov8(int classes, YoloOutput::Order order = YoloOutput::Order::kFromShape) {
  ModelDescription description = heat_map(classes);
  description.output = YoloOutput{"output0", order};
  return description;
}

// Two boxes: (10, 20) of 4 x 6 px with probabilities 0.1, 0.7, 0.2, and one below the threshold.
const Tensor kValuesFirst{{1, 7, 2}, {10, 5, 20, 5, 4, 2, 6, 2, 0.1f, 0, 0.7f, 0, 0.2f, 0}};
const Tensor kBoxesFirst{{1, 2, 7}, {10, 20, 4, 6, 0.1f, 0.7f, 0.2f, 5, 5, 2, 2, 0, 0, 0}};

TEST(Yolov8, BothOrdersGiveTheSameBox) {
  for (const Tensor& tensor : {kValuesFirst, kBoxesFirst}) {
    const auto found = decoded({tensor}, yolov8(3), 64, 64);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].box_px, (Box{8, 17, 4, 6}));
    EXPECT_FLOAT_EQ(static_cast<float>(found[0].score), 0.7f);
    EXPECT_EQ(found[0].category, "c1");
  }
}

std::string fault_of(const Tensor& tensor, const ModelDescription& description) {
  try {
    decoded({tensor}, description, 64, 64);
  } catch (const Error& error) {
    return error.message();
  }
  return "";
}

TEST(Yolov8, AShapeThatFitsTwiceIsAsked) {
  using Order = YoloOutput::Order;
  const Tensor square{{1, 5, 5}, std::vector<float>(25, 0.5f)};
  EXPECT_NE(fault_of(square, yolov8(1)).find("expected \"order\""), std::string::npos);
  EXPECT_EQ(fault_of(square, yolov8(1, Order::kValuesFirst)), "");
  EXPECT_EQ(fault_of(square, yolov8(1, Order::kBoxesFirst)), "");
  // Two corners, score and class have the shape of two classes' boxes.
  const Tensor six{{1, 300, 6}, std::vector<float>(1800, 0.5f)};
  EXPECT_NE(fault_of(six, yolov8(2)).find("expected \"order\""), std::string::npos);
  EXPECT_EQ(fault_of(six, yolov8(2, Order::kBoxesFirst)), "");
}

TEST(Yolov8, AnotherNumberOfClassesIsAnError) {
  EXPECT_NE(fault_of(kValuesFirst, yolov8(4)).find("expected 1 x 8 x boxes or 1 x boxes x 8"),
            std::string::npos);
  ModelDescription yolov5 = yolov8(3);
  yolov5.output = YoloOutput{"output0", YoloOutput::Order::kYolov5};
  EXPECT_NE(fault_of(kBoxesFirst, yolov5).find("kind \"yolov8\""), std::string::npos);
}

PieceDetection in_piece(int piece, const Box& box, double score, bool cut = false) {
  return {{box, score, "aircraft", {}}, piece, cut};
}

TEST(Duplicates, TheWeakerOfTwoThatOverlapIsLeftOut) {
  // They share 8 of 12 columns: 2/3.
  const auto found =
      without_duplicates({in_piece(0, {0, 0, 10, 10}, 0.5), in_piece(0, {2, 0, 10, 10}, 0.9)}, 0.5);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].score, 0.9);
  EXPECT_EQ(
      without_duplicates({in_piece(0, {0, 0, 10, 10}, 0.5), in_piece(0, {2, 0, 10, 10}, 0.9)}, 0.7)
          .size(),
      2u);
}

TEST(Duplicates, AWholeBoxIsKeptBeforeTheCutPartOfIt) {
  const auto found = without_duplicates(
      {in_piece(0, {50, 0, 14, 10}, 0.9, true), in_piece(1, {50, 0, 60, 10}, 0.6)}, 0.5);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].box_px, (Box{50, 0, 60, 10}));
}

TEST(Duplicates, ASmallOneWithinALargeOneOfTheSamePieceStays) {
  EXPECT_EQ(without_duplicates(
                {in_piece(0, {0, 0, 100, 100}, 0.9), in_piece(0, {40, 40, 6, 6}, 0.8)}, 0.5)
                .size(),
            2u);
}

}  // namespace
}  // namespace airtruth::network
