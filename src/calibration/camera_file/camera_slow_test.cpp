// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>

#include <gtest/gtest.h>

#include "calibration/optics/step_response.h"
#include "foundation/image/colour.h"
#include "picture/composite/sensor.h"
#include "support/flight_clip.h"

// Camera effects that are applied to a virtual flight are measured from its clip.
namespace airtruth::camera_file {
namespace {

TEST(Calibrate, MeasuresTheNoiseThatWasInjected) {
  for (const std::uint64_t seed : {1u, 2u}) {
    const synthetic::Flight flight(ideal(seed));
    Injected what;
    what.point_spread_px = seed == 1 ? 0.9 : 1.3;
    what.sensor.noise_gain = 4e-4;
    what.sensor.noise_floor = 3e-5;
    what.sensor.noise_correlation_px = seed == 1 ? 0.5 : 0.7;
    what.sensor.tone.gamma = seed == 1 ? 0 : 1.8;
    Options options;
    options.tone = what.sensor.tone;
    Clip clip;
    clip.write(flight, what);
    const Calibration c = calibrate(clip.path(), options);
    expect_within(c, "sensor.noise_correlation_px", what.sensor.noise_correlation_px, 0.1);
    // The curve as a whole: gain and floor trade against one another where little is dark.
    for (const sensor::NoisePoint& p : c.noise) {
      composite::Sensor fitted = what.sensor;
      fitted.noise_gain = c.quantities.at("sensor.noise_gain").value().value;
      fitted.noise_floor = c.quantities.at("sensor.noise_floor").value().value;
      const double truth =
          double(composite::noise_sigma(static_cast<float>(p.luma), 219, what.sensor));
      const double found = double(composite::noise_sigma(static_cast<float>(p.luma), 219, fitted));
      std::printf("noise at %.2f: point %.3f, fitted %.3f, put in %.3f\n",
                  p.luma,
                  p.sigma_codes,
                  found,
                  truth);
      EXPECT_NEAR(found, truth, 0.1 * truth) << "at luma " << p.luma;
    }
  }
}

TEST(Calibrate, MeasuresTheEdgesThatWereInjected) {
  synthetic::FlightOptions o = ideal(3);
  o.frame_count = 6;
  o.shake_deg = 0;
  o.own_aircraft = false;
  o.width *= 2, o.height *= 2;
  const synthetic::Flight flight(o);
  Clip clip;
  // Over painted panels, as airfields have them.
  Injected what;
  what.finer = 2;
  what.point_spread_px = 1.3;
  what.sensor.noise_gain = 1e-4;
  clip.write(flight, what, true);
  expect_within(calibrate(clip.path(), {}), "optics.point_spread_px", 1.3, 0.1);
  what = {};
  what.finer = 2;
  what.point_spread_px = 0.8;
  what.sensor.sharpening = 0.8;
  what.sensor.sharpening_px = 1.2;
  clip.write(flight, what, true);
  Calibration c = calibrate(clip.path(), {});
  expect_within(c, "optics.point_spread_px", 0.8, 0.1);
  expect_within(c, "optics.sharpening", 0.8, 0.1);
  expect_within(c, "optics.sharpening_px", 1.2, 0.1);
}

// Fields, woods and the own aircraft are softer than a step, and hedges run along their edges. The
// response to an edge is therefore measured better than spread, amount and radius, whose errors
// compensate one another.
TEST(Calibrate, MeasuresWhatBecomesOfEdgesOverTheGroundAlone) {
  struct Case {
    std::uint64_t seed;
    double spread_px, amount, radius_px;
  };
  for (const Case& put_in : {Case{3, 0.8, 0, 1}, Case{5, 1.3, 0, 1}, Case{6, 0.8, 0.8, 1.2}}) {
    synthetic::FlightOptions o = ideal(put_in.seed);
    o.width *= 2, o.height *= 2;
    o.frame_count = 16;
    Injected what;
    what.finer = 2;
    what.point_spread_px = put_in.spread_px;
    what.sensor.noise_gain = 1e-4;
    what.sensor.sharpening = put_in.amount;
    what.sensor.sharpening_px = put_in.radius_px;
    Clip clip;
    clip.write(synthetic::Flight(o), what);
    const Calibration c = calibrate(clip.path(), {});
    const optics::StepResponse truth{
        {put_in.spread_px, 0}, {put_in.amount, 0}, {put_in.radius_px, 0}};
    const optics::StepResponse found{c.quantities.at("optics.point_spread_px").value(),
                                     c.quantities.at("optics.sharpening").value(),
                                     c.quantities.at("optics.sharpening_px").value()};
    const double truth_px = optics::edge_spread_px(truth, 0.4, 0.6, {});
    const double found_px = optics::edge_spread_px(found, 0.4, 0.6, {});
    std::printf("edge %.2f px (%.2f); spread %.3f (%.2f), sharpening %.3f (%.2f), %.2f px (%.2f)\n",
                found_px,
                truth_px,
                found.point_spread_px.value,
                put_in.spread_px,
                found.sharpening.value,
                put_in.amount,
                found.sharpening_px.value,
                put_in.radius_px);
    EXPECT_NEAR(found_px, truth_px, 0.1 * truth_px);
    EXPECT_NEAR(found.point_spread_px.value, put_in.spread_px, 0.1 * put_in.spread_px);
    EXPECT_NEAR(found.sharpening.value, put_in.amount, 0.2 * put_in.amount);
    if (put_in.amount > 0) {
      EXPECT_NEAR(found.sharpening_px.value, put_in.radius_px, 0.2 * put_in.radius_px);
    }
  }
}

// Fields, woods and roads have colours of their own, whose edges are where luma's are.
TEST(Calibrate, MeasuresHowSoftChromaIs) {
  for (const double spread_px : {1.5, 3.0}) {
    synthetic::FlightOptions o = ideal(7);
    o.width *= 2, o.height *= 2;
    o.frame_count = 16;
    Injected what;
    what.finer = 2;
    what.point_spread_px = 0.8;
    what.sensor.noise_gain = 1e-4;
    what.sensor.chroma_spread_px = spread_px;
    Clip clip;
    clip.write(synthetic::Flight(o), what);
    expect_within(calibrate(clip.path(), {}), "sensor.chroma_spread_px", spread_px, 0.15);
  }
}

TEST(Calibrate, ReadsTheCodecsStep) {
  synthetic::FlightOptions o = ideal(4);
  o.width = 320, o.height = 240, o.frame_count = 24;
  const synthetic::Flight flight(o);
  Clip clip;
  const auto step_at = [&](int quality) {
    clip.write(
        o, [&](int k) { return flight.frame(k); }, video::Format::kMp4, quality);
    const Calibration c = calibrate(clip.path(), {});
    return c.quantities.at("sensor.codec_step").value().value;
  };
  // Six of x264's quality steps are a doubling of the quantiser's.
  EXPECT_NEAR(step_at(30) / step_at(24), 2, 0.2);
}

TEST(Calibrate, MeasuresExposureFromBlur) {
  synthetic::FlightOptions o = ideal(5);
  constexpr int kPerFrame = 10;
  constexpr int kOpen = 5;  // of 10: half of the interval
  o.width = 640, o.height = 480;
  o.shake_deg = 0.6;
  o.own_aircraft = false;
  o.frame_rate_hz = 30 * kPerFrame;
  o.frame_count = 50 * kPerFrame;
  const synthetic::Flight flight(o);
  synthetic::FlightOptions slow = o;
  slow.frame_rate_hz = 30;
  slow.frame_count = 50;
  Clip clip;
  clip.write(slow, [&](int k) {
    std::vector<float> sum(static_cast<std::size_t>(o.width) * static_cast<std::size_t>(o.height),
                           0.0F);
    image::Picture picture;
    for (int i = 0; i < kOpen; ++i) {
      picture = flight.frame(k * kPerFrame + i);
      for (int y = 0; y < o.height; ++y)
        for (int x = 0; x < o.width; ++x)
          sum[static_cast<std::size_t>(y) * static_cast<std::size_t>(o.width) +
              static_cast<std::size_t>(x)] +=
              image::linear_from_srgb((picture.planes[0].row(y)[x] - 16) / 219.0F);
    }
    for (int y = 0; y < o.height; ++y)
      for (int x = 0; x < o.width; ++x)
        picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(
            16.5F + 219 * image::srgb_from_linear(
                              sum[static_cast<std::size_t>(y) * static_cast<std::size_t>(o.width) +
                                  static_cast<std::size_t>(x)] /
                              kOpen));
    return picture;
  });
  const Calibration c = calibrate(clip.path(), {});
  expect_within(c, "shutter.exposure_s", 0.5 / 30, 0.08);
}

TEST(Calibrate, MeasuresTheReadoutOfARollingShutter) {
  synthetic::FlightOptions o = ideal(6);
  constexpr int kBands = 16;
  o.width = 480, o.height = 360;
  o.own_aircraft = false;
  o.frame_rate_hz = 30 * kBands;
  o.frame_count = 80 * kBands;
  o.shake_deg = 0.5;
  const synthetic::Flight flight(o);
  synthetic::FlightOptions slow = o;
  slow.frame_rate_hz = 30;
  slow.frame_count = 80;
  Clip clip;
  constexpr int kUsed = 12;  // of 16: the readout takes three quarters of the interval
  clip.write(slow, [&](int k) {
    image::Picture picture = flight.frame(k * kBands);
    for (int band = 1; band < kUsed; ++band) {
      const image::Picture then = flight.frame(k * kBands + band);
      for (int p = 0; p < 3; ++p) {
        image::Plane& to = picture.planes[static_cast<std::size_t>(p)];
        for (int y = to.height * band / kUsed; y < to.height * (band + 1) / kUsed; ++y)
          std::copy_n(then.planes[static_cast<std::size_t>(p)].row(y), to.width, to.row(y));
      }
    }
    return picture;
  });
  const Calibration c = calibrate(clip.path(), {});
  expect_within(c, "shutter.readout_s", 0.75 / 30, 0.1);
  EXPECT_EQ(c.readout_direction, "down");
}

}  // namespace
}  // namespace airtruth::camera_file
