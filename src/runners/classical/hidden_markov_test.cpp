// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "runners/classical/bearing_grid.h"
#include "runners/classical/classical.h"
#include "runners/classical/filter_bank.h"
#include "support/classical_flights.h"

namespace airtruth::classical {
namespace {

// The table of docs/detection.md: at a contrast of 2.5 times the noise of a pixel, single frames
// find the target in some frames and track before detect finds it in nearly all, with a camera that
// stands and with one that turns and shakes by up to 4 px a frame.
TEST(HiddenMarkov, FindsWhatSingleFramesDoNot) {
  for (const double turn_deg : {0.0, 0.5}) {
    EXPECT_LT(score_of("cmo", -5, turn_deg).hit, 0.5) << turn_deg;
    EXPECT_GT(score_of("cmo-hmm", -5, turn_deg).hit, 0.85) << turn_deg;
    EXPECT_GT(score_of("cmo-hmm", 20, turn_deg).hit, 0.9) << turn_deg;
    EXPECT_GT(score_of("cmo", 20, turn_deg).hit, 0.9) << turn_deg;
  }
}

TEST(HiddenMarkov, IsLostWithoutTheCamerasTurn) {
  const auto detector = make_classical("cmo-hmm");
  Flight flight(-5, 2, 0.5);
  detector->begin(flight.sequence());
  int hit = 0;
  for (int k = 0; k < 80; ++k) {
    detector::FrameInput frame = flight.next();
    frame.turn = detector::CameraTurn{};  // as if the camera stood still
    const auto found = detector->detect(frame);
    hit += k >= 20 && !found.empty() && hits(found.front(), flight.target_px()) ? 1 : 0;
  }
  EXPECT_LT(hit, 20);
}

// Where the grid says a cell is seen, against a chain of single turns through the lens.
TEST(BearingGrid, KeepsACellsBearing) {
  const lens::Lens lens = lens::fisheye_from_vertical_fov(120, {640, 480});
  BearingGrid grid(lens, 2);
  const Quaternion step(Eigen::AngleAxisd(radians(0.3), Vector3(0.2, 1, 0.5).normalized()));
  const cv::Point cell{100, 60};
  Pixel expected = *grid.pixel_of(cell);
  EXPECT_NEAR(expected.x(), 201, 1e-6);
  bool was_anchored_anew = false;
  for (int k = 0; k < 12 && !was_anchored_anew; ++k) {
    was_anchored_anew = !grid.turn(step).empty();
    if (was_anchored_anew) break;
    expected = *pixel_after_turn(lens, step, expected);
    EXPECT_LT((*grid.pixel_of(cell) - expected).norm(), 1e-6);
    // A bright sample where the camera has the bearing is seen by the cell.
    cv::Mat samples(grid.size(), CV_8U, cv::Scalar(0));
    samples.at<std::uint8_t>(static_cast<int>(expected.y() / 2),
                             static_cast<int>(expected.x() / 2)) = 255;
    const cv::Mat seen = grid.seen_by_cells(samples);
    EXPECT_GT(cv::countNonZero(seen({cell.x - 1, cell.y - 1, 3, 3})), 0) << k;
  }
  EXPECT_TRUE(was_anchored_anew);
}

TEST(FilterBank, ForgetsAndFollows) {
  // A constant ratio leads to its limit.
  FilterBank bank({64, 48});
  const cv::Mat ratio(48, 64, CV_32F, cv::Scalar(3));
  for (int k = 0; k < 200; ++k) bank.update(ratio);
  // The fixed point of l = ln 3 + kRemembers (l + ln kStays), but for the error of the power.
  const double limit = (std::log(3) + FilterBank::kRemembers * std::log(FilterBank::kStays)) /
                       (1 - FilterBank::kRemembers);
  EXPECT_NEAR(std::log(bank.odds().at<float>(24, 32)), limit, 0.06 * limit);
  // Odds follow a target that moves along a filter's diagonal, one cell a frame.
  FilterBank other({64, 48});
  for (int k = 0; k < 20; ++k) {
    cv::Mat now(48, 64, CV_32F, cv::Scalar(0.5));
    now.at<float>(10 + k, 20 + k) = 50;
    other.update(now);
  }
  cv::Point at;
  cv::minMaxLoc(other.odds(), nullptr, nullptr, nullptr, &at);
  EXPECT_EQ(at, cv::Point(39, 29));
}

}  // namespace
}  // namespace airtruth::classical
