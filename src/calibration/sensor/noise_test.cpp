// SPDX-License-Identifier: Apache-2.0
#include "calibration/sensor/noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "foundation/base/seed.h"
#include "picture/composite/sensor.h"

// Noise that is added to still stripes is measured from them.
namespace airtruth::sensor {
namespace {

constexpr float kCodesPerUnit = 219;

// Stripes of each coded luma, side by side, with noise in linear light. The noise is computed
// independently of composite::noise_sigma.
image::Picture stripes(const std::vector<double>& lumas,
                       const composite::Sensor& sensor,
                       Random& random) {
  constexpr int kStripePx = 96;
  image::Picture picture =
      image::make_picture(kStripePx * static_cast<int>(lumas.size()), 480, {image::Chroma::kNone});
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double light =
          sensor.tone.linear_from_coded(lumas[static_cast<std::size_t>(x / kStripePx)]);
      const double noise =
          std::sqrt(sensor.noise_gain * light + sensor.noise_floor) * random.normal();
      const double coded = sensor.tone.coded_from_linear(std::clamp(light + noise, 0.0, 1.0));
      picture.planes[0].row(y)[x] =
          static_cast<std::uint8_t>(std::lround(16 + double(kCodesPerUnit) * coded));
    }
  return picture;
}

NoiseMeter metered(const std::vector<double>& lumas, const composite::Sensor& sensor) {
  NoiseMeter meter(nullptr, sensor.tone);
  Random random = Seed(5).stream("noise");
  for (int pair = 0; pair < 4; ++pair) {
    const image::Picture frame = stripes(lumas, sensor, random);
    meter.add(frame, stripes(lumas, sensor, random));
  }
  return meter;
}

void expect_sigma(double codes, double luma, const composite::Sensor& truth) {
  const auto sigma = double(composite::noise_sigma(static_cast<float>(luma), kCodesPerUnit, truth));
  EXPECT_NEAR(codes, sigma, 0.1 * sigma) << "at luma " << luma;
}

TEST(NoiseMeter, MeasuresTheCurve) {
  // Middles of the meter's bins.
  const std::vector<double> lumas{4.5 / 24, 8.5 / 24, 11.5 / 24, 14.5 / 24, 17.5 / 24, 20.5 / 24};
  for (const double gamma : {0.0, 1.8}) {
    composite::Sensor truth{.noise_gain = 2e-4, .noise_floor = 1e-5};
    truth.tone.gamma = gamma;
    const NoiseMeter meter = metered(lumas, truth);
    const std::vector<NoisePoint> points = meter.points();
    ASSERT_EQ(points.size(), lumas.size());
    const auto fitted = meter.result();
    ASSERT_TRUE(fitted) << fitted.why();
    composite::Sensor found = truth;
    found.noise_gain = fitted->gain.value;
    found.noise_floor = fitted->floor.value;
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(points[i].luma, lumas[i], 1e-9);
      EXPECT_GT(points[i].blocks, 0);
      expect_sigma(points[i].sigma_codes, lumas[i], truth);
      expect_sigma(composite::noise_sigma(static_cast<float>(lumas[i]), kCodesPerUnit, found),
                   lumas[i],
                   truth);
    }
  }
}

// Noise of its own in each of red, green and blue is less in luma, by the root of the sum of the
// squares of their weights.
TEST(NoiseMeter, OfRedGreenAndBlueItMeasuresLuma) {
  const std::vector<double> lumas{8.5 / 24, 14.5 / 24, 20.5 / 24};
  const composite::Sensor truth{.noise_gain = 4e-4, .noise_floor = 1e-4};
  NoiseMeter meter(nullptr, truth.tone);
  Random random = Seed(5).stream("noise");
  const auto colour = [&] {
    image::Picture first = stripes(lumas, truth, random);
    image::Picture picture =
        image::make_picture(first.width,
                            first.height,
                            {image::Chroma::k444, image::Matrix::kRgb, image::Range::kLimited});
    picture.planes[0] = std::move(first.planes[0]);
    for (const std::size_t p : {1U, 2U})
      picture.planes[p] = std::move(stripes(lumas, truth, random).planes[0]);
    return picture;
  };
  for (int pair = 0; pair < 4; ++pair) {
    const image::Picture frame = colour();
    meter.add(frame, colour());
  }
  const std::vector<NoisePoint> points = meter.points();
  ASSERT_EQ(points.size(), lumas.size());
  const double share = std::hypot(0.299, 0.587, 0.114);
  for (std::size_t i = 0; i < points.size(); ++i)
    expect_sigma(points[i].sigma_codes / share, lumas[i], truth);
}

// Black and white of 16 to 235 cut the noise of the first and of the last.
TEST(NoiseMeter, ClippedStripesAreLeftOut) {
  const std::vector<double> lumas{0.2 / 24, 8.5 / 24, 14.5 / 24, 23.9 / 24};
  const auto points = metered(lumas, {.noise_gain = 2e-4, .noise_floor = 1e-5}).points();
  ASSERT_EQ(points.size(), 2U);
  EXPECT_NEAR(points[0].luma, lumas[1], 1e-9);
  EXPECT_NEAR(points[1].luma, lumas[2], 1e-9);
}

// A line goes through two points, whatever they are off by.
TEST(NoiseMeter, TwoBrightnessesHaveTheErrorOfChance) {
  const auto fitted =
      metered({8.5 / 24, 14.5 / 24}, {.noise_gain = 2e-4, .noise_floor = 1e-5}).result();
  ASSERT_TRUE(fitted) << fitted.why();
  EXPECT_LT(std::abs(fitted->gain.value - 2e-4), 4 * fitted->gain.sigma);
  EXPECT_LT(std::abs(fitted->floor.value - 1e-5), 4 * fitted->floor.sigma);
  EXPECT_LT(fitted->gain.sigma, 0.2 * 2e-4);
}

TEST(NoiseMeter, OneBrightnessIsNoCurve) {
  const NoiseMeter meter = metered({12.5 / 24}, {.noise_gain = 2e-4, .noise_floor = 1e-5});
  EXPECT_EQ(meter.result().why(),
            "the clip has flat parts of 1 brightnesses; a noise curve takes two");
}

}  // namespace
}  // namespace airtruth::sensor
