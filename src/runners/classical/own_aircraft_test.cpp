// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "runners/classical/classical.h"
#include "runners/classical/free_view.h"
#include "support/classical_flights.h"

namespace airtruth::classical {
namespace {

// A dark wheel and a wing with a gap in it, and a target beyond them.
image::Picture with_own_aircraft(const Pixel& target, image::Mask& mask, std::mt19937& random) {
  image::Picture picture = sky({{target, -40}}, 2, random);
  mask = {kWidth, kHeight, std::vector<unsigned char>(kWidth * kHeight, 255)};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const bool is_wheel = std::hypot(x - 80, y - 200) < 9;
      const bool is_wing = y > 150 && y < 162 && (x < 120 || x > 128);
      if (!is_wheel && !is_wing) continue;
      picture.planes[0].row(y)[x] = is_wheel ? 20 : 240;
      mask.free[static_cast<std::size_t>(y * kWidth + x)] = 0;
    }
  return picture;
}

TEST(Classical, SeesNothingOnTheOwnAircraft) {
  for (const std::string& name : classical_names()) {
    std::array<int, 2> on_own{}, on_target{};
    for (const bool is_masked : {false, true}) {
      const auto detector = make_classical(name);
      detector::SequenceInput sequence = sequence_of();
      std::mt19937 random(6);
      for (int k = 0; k < 15; ++k) {
        const Pixel target(200 + 0.5 * k, 60);
        image::Mask mask;
        const image::Picture picture = with_own_aircraft(target, mask, random);
        if (is_masked) sequence.own_aircraft = std::make_shared<image::Mask>(mask);
        if (k == 0) detector->begin(sequence);
        // The camera turns: the own aircraft stays where it is, and so differs from the turned
        // picture before.
        const Quaternion turn(
            Eigen::AngleAxisd(radians(k % 2 == 0 ? 1.0 : -1.0), Vector3::UnitY()));
        const auto camera = k > 0 ? std::optional(detector::CameraTurn{turn, 0.02}) : std::nullopt;
        for (const results::Detection& one :
             detector->detect({k, k / 30.0, &picture, k == 0, camera})) {
          const Box& box = one.box_px;
          const int x = std::clamp(static_cast<int>(box.x + box.width / 2), 0, kWidth - 1);
          const int y = std::clamp(static_cast<int>(box.y + box.height / 2), 0, kHeight - 1);
          on_own[is_masked] += mask.is_free(x, y) && std::hypot(x - 80, y - 200) > 15 ? 0 : 1;
          on_target[is_masked] += hits(one, target, 6) ? 1 : 0;
        }
      }
    }
    EXPECT_GT(on_own[0], 0) << name;
    EXPECT_EQ(on_own[1], 0) << name;
    // All but the first frame, which some detectors only learn from.
    EXPECT_GE(on_target[0], 14) << name;
    EXPECT_GE(on_target[1], on_target[0]) << name;
  }
}

TEST(FreeView, OfRedGreenAndBlueIsTheirLuma) {
  image::Picture picture =
      image::make_picture(40, 30, {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
  const std::uint8_t green_blue_red[] = {100, 50, 200};
  for (std::size_t p = 0; p < 3; ++p)
    for (int y = 0; y < 30; ++y) std::fill_n(picture.planes[p].row(y), 40, green_blue_red[p]);
  const cv::Mat luma = FreeView(nullptr).luma(picture);
  EXPECT_EQ(luma.at<std::uint8_t>(29, 39), 124);  // 0.299 * 200 + 0.587 * 100 + 0.114 * 50
}

TEST(FreeView, ReplacesTheOwnAircraftByWhatIsAround) {
  std::mt19937 random(8);
  image::Mask mask;
  const image::Picture picture = with_own_aircraft({250, 40}, mask, random);
  const FreeView view(&mask);
  const cv::Mat luma = view.luma(picture);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (mask.is_free(x, y)) continue;
      EXPECT_TRUE(view.hides({x + 0.5, y + 0.5}));
      EXPECT_NEAR(luma.at<std::uint8_t>(y, x), 120 + 0.05 * y, 6) << x << "," << y;
    }
  EXPECT_FALSE(view.hides({200.5, 60.5}));
  EXPECT_EQ(luma.at<std::uint8_t>(60, 200), picture.planes[0].row(60)[200]);
}

}  // namespace
}  // namespace airtruth::classical
