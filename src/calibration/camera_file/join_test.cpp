// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/join.h"

#include <cmath>

#include <gtest/gtest.h>

#include "foundation/base/seed.h"

namespace airtruth::camera_file {
namespace {

TEST(Join, AgreeingClipsMakeTheirWeightedMean) {
  const Pooled both = pooled({{10, 1}, {11, 0.5}});
  EXPECT_TRUE(both.agree);
  EXPECT_NEAR(both.value.value, (10 + 4 * 11) / 5.0, 1e-12);
  EXPECT_NEAR(both.value.sigma, 1 / std::sqrt(5.0), 1e-12);
}

// Two contradicting measurements: the variance of Paule and Mandel makes chi-square 1, so that with
// equal errors this variance plus that of a measurement is half of the squared difference.
TEST(Join, ContradictingClipsAreWidenedOverBoth) {
  const Pooled both = pooled({{7, 0.5}, {13, 0.5}});
  EXPECT_FALSE(both.agree);
  EXPECT_NEAR(both.value.value, 10, 1e-9);
  const double total = 6 * 6 / 2.0;
  EXPECT_NEAR(both.value.sigma, std::sqrt(total - 0.25 + total / 2), 1e-6);
  EXPECT_GT(both.value.sigma, 3);  // reaches both
}

// A thousand cameras with 5 clips each: the error is that of the mean or, if the clips differ by
// more than their errors, that of one further clip.
TEST(Join, ItsErrorsAreWhatValuesAreOffBy) {
  Random random(3);
  double squares = 0;
  int contradicting = 0, covered = 0;
  constexpr int kCameras = 1000;
  for (int i = 0; i < kCameras; ++i) {
    std::vector<Estimate> near, far;
    for (int k = 0; k < 5; ++k) {
      const double sigma = 0.05 + 0.1 * k;
      const double error = sigma * random.normal();
      near.push_back({2 + error, sigma});
      far.push_back({2 + error + 3 * random.normal(), sigma});
    }
    const Pooled one = pooled(near), other = pooled(far);
    squares += std::pow((one.value.value - 2) / one.value.sigma, 2);
    contradicting += other.agree ? 0 : 1;
    const double one_more = 2 + 3 * random.normal();
    covered += std::abs(other.value.value - one_more) < 2 * other.value.sigma ? 1 : 0;
  }
  EXPECT_NEAR(squares / kCameras, 1, 0.15);
  EXPECT_GT(contradicting, 990);
  // Two standard deviations by a variance of 4 degrees of freedom: 0.88 (Student 1908).
  EXPECT_NEAR(double(covered) / kCameras, 0.88, 0.04);
}

TEST(Join, AnErrorOfNothingIsNotKnown) {
  EXPECT_NEAR(pooled({{5, 0}, {4, 1}, {4, 1}}).value.value, 13.0 / 3, 1e-12);
  EXPECT_EQ(pooled({{5, 0}, {5, 0}}).value.value, 5);
}

Calibration clip(double spread_px, double downwards_s, double readout_error_s) {
  Calibration c;
  c.video = "/somewhere/clip.mp4";
  c.width = 64, c.height = 48, c.frames = 100;
  c.quantities.at("optics.point_spread_px").values = {{spread_px, 0.1}};
  c.downwards_s = Estimate{downwards_s, readout_error_s};
  c.quantities.at("shutter.readout_s").values = {
      {rolls(*c.downwards_s) ? std::abs(downwards_s) : 0, readout_error_s}};
  c.readout_direction = downwards_s < 0 ? "up" : "down";
  c.quantities.at("air.airlight").values = {{0.5, 0.1}, {0.5, 0.1}, {0.5, 0.1}};
  c.quantities.at("shutter.exposure_s").missing = "too still";
  return c;
}

std::vector<Calibration> clips_of(Calibration a, Calibration b) {
  std::vector<Calibration> clips;
  clips.push_back(std::move(a));
  clips.push_back(std::move(b));
  return clips;
}

TEST(Join, KeepsWhatIsTheCamerasAndLeavesOutWhatIsTheFlights) {
  const Calibration both = joined(clips_of(clip(0.5, 0.02, 0.001), clip(0.6, 0.0205, 0.001)));
  EXPECT_EQ(both.clips, 2);
  EXPECT_EQ(both.frames, 200);
  EXPECT_NEAR(both.quantities.at("optics.point_spread_px").value().value, 0.55, 1e-12);
  EXPECT_NEAR(both.quantities.at("shutter.readout_s").value().value, 0.02025, 1e-12);
  EXPECT_EQ(both.readout_direction, "down");
  EXPECT_FALSE(both.quantities.at("air.airlight").is_measured());
  EXPECT_EQ(both.quantities.at("shutter.exposure_s").missing, "in none of 2 clips: too still");
  for (const QuantityKey& key : kQuantityKeys)
    EXPECT_EQ((both.quantities.*key.member).doubt, "") << key.name;
}

// One clip reads from the top and the other from the bottom: neither is accepted, with a message.
TEST(Join, ReadoutsOfBothWaysContradictOneAnother) {
  const Calibration both = joined(clips_of(clip(0.5, 0.01, 0.001), clip(0.5, -0.01, 0.001)));
  const Estimate readout = both.quantities.at("shutter.readout_s").value();
  EXPECT_EQ(readout.value, 0);
  EXPECT_GT(readout.sigma, 0.01);
  EXPECT_NE(both.quantities.at("shutter.readout_s").doubt.find("contradict one another"),
            std::string::npos);
}

}  // namespace
}  // namespace airtruth::camera_file
