// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "calibration/camera_file/join.h"
#include "calibration/camera_file/profile.h"
#include "picture/video/reader.h"
#include "support/flight_clip.h"

// Virtual flights whose clips do not determine a value, or determine it several times.
namespace airtruth::camera_file {
namespace {

// The sky of a flight's picture, as a camera that looks up sees it. It has the noise of the
// flight's camera and no edge.
image::Picture sky_of(const synthetic::Flight& flight, int k) {
  const image::Picture whole = flight.frame(k);
  image::Picture sky = image::make_picture(whole.width, whole.height / 4, whole.colour);
  for (std::size_t p = 0; p < 3; ++p)
    for (int y = 0; y < sky.planes[p].height; ++y)
      std::copy_n(whole.planes[p].row(y), sky.planes[p].width, sky.planes[p].row(y));
  return sky;
}

TEST(CalibrateWithProfile, AFlightOfSkyAloneHasTheProfileAndSaysSo) {
  synthetic::FlightOptions o = ideal(11);
  o.own_aircraft = false;
  o.cloud_cover = 0;
  o.shake_deg = 0, o.roll_deg = 0;
  const synthetic::Flight flight(o);
  synthetic::FlightOptions part = o;
  part.height = o.height / 4;
  Clip clip;
  clip.write(part, [&](int k) { return sky_of(flight, k); });
  Calibration own = calibrate(clip.path(), {});
  EXPECT_NE(own.quantities.at("optics.point_spread_px").missing, "");
  CameraProfile profile;
  profile.name = "one";
  profile.values["optics.point_spread_px"] = {0.44, 0.05};
  profile.values["optics.sharpening"] = {0.2, 0.1};
  const Calibration c = with_profile(std::move(own), profile);
  EXPECT_EQ(c.quantities.at("optics.point_spread_px").value().value, 0.44);
  EXPECT_EQ(c.quantities.at("optics.sharpening").value().value, 0.2);
  EXPECT_EQ(c.quantities.at("optics.point_spread_px").source,
            "of the profile one; the clip does not show it");
  EXPECT_EQ(c.quantities.at("sensor.noise_floor").source, "");
  const Calibration usual = with_profile(calibrate(clip.path(), {}), usual_camera());
  EXPECT_EQ(usual.quantities.point_spread.value().value,
            usual_camera().values.at("optics.point_spread_px").value);
  EXPECT_NE(toml_from(usual).find("of the median over"), std::string::npos);
}

// One object before the sky is softer in the world than the camera's spread. Many frames of it give
// many edges but no smaller error, so the profile determines the value.
TEST(CalibrateWithProfile, ManySightsOfOneSoftEdgeGiveWayToTheProfile) {
  synthetic::FlightOptions o;
  o.width = 320, o.height = 240, o.frame_count = 60;
  constexpr double kSoft = 1.2;  // px: of the object, a bar
  Clip clip;
  clip.write(o, [&](int k) {
    image::Picture picture = image::make_picture(o.width, o.height, {});
    for (std::size_t p = 1; p < 3; ++p)
      for (int y = 0; y < picture.planes[p].height; ++y)
        std::fill_n(picture.planes[p].row(y), picture.planes[p].width, std::uint8_t{128});
    const double c = std::cos(0.15), s = std::sin(0.15);
    for (int y = 0; y < o.height; ++y)
      for (int x = 0; x < o.width; ++x) {
        const double u = x - 60.0 - 3 * k, v = y - 60.0 - k;
        const auto soft = [&](double place) {
          return 0.5 * (1 + std::erf(place / (kSoft * std::sqrt(2.0))));
        };
        const double inside =
            soft(16 - std::abs(c * u + s * v)) * soft(10 - std::abs(c * v - s * u));
        picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(180.5 - 100 * inside);
      }
    return picture;
  });
  const Calibration own = calibrate(clip.path(), {});
  ASSERT_TRUE(own.quantities.at("optics.point_spread_px").is_measured())
      << own.quantities.at("optics.point_spread_px").missing;
  const Estimate seen = own.quantities.at("optics.point_spread_px").value();
  std::printf(
      "one soft object: %.3f +- %.3f px, %d edges\n", seen.value, seen.sigma, own.edge.edges);
  EXPECT_GT(seen.value, 0.9 * kSoft);
  EXPECT_GT(seen.sigma, 0.15 * seen.value);
  // The camera's own 0.4 px lies within three errors, which without the few edges it would not.
  const Estimate with = combined(seen, {0.4, 0.1});
  EXPECT_LT(with.value, 0.75);
}

// Two flights of one camera in one clip: no measurement crosses the cut, and the result agrees with
// those of the two flights alone.
TEST(CalibrateWithProfile, ACutIsSeenAndASplicedClipTellsWhatItsPartsDo) {
  synthetic::FlightOptions o = ideal(13);
  o.width = 640, o.height = 480;
  o.frame_count = 70;
  o.shake_deg = 0.5;
  synthetic::FlightOptions brighter = o;
  brighter.seed = 14;
  brighter.sun_elevation_deg = 70, brighter.cloud_cover = 0.9, brighter.heading_deg = 150;
  brighter.altitude_m = 60;
  const synthetic::Flight first(o), second(brighter);
  Clip alone, other, spliced;
  Injected what;
  what.point_spread_px = 0.8;
  what.sensor.noise_gain = 4e-4;
  what.sensor.noise_floor = 3e-5;
  alone.write(first, what);
  other.write(second, what);
  synthetic::FlightOptions twice = o;
  twice.frame_count = 2 * o.frame_count;
  video::Reader one(alone.path()), two(other.path());
  spliced.write(twice,
                [&](int k) { return (k < o.frame_count ? one : two).next()->picture.clone(); });
  std::vector<std::string> warnings;
  Options options;
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  const Calibration c = calibrate(spliced.path(), options);
  ASSERT_EQ(c.cuts, std::vector<std::int64_t>{o.frame_count});
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& text) {
    return text.find("is cut at frame 70; nothing is measured across") != std::string::npos;
  }));
  std::vector<Calibration> parts;
  parts.push_back(calibrate(alone.path(), {}));
  parts.push_back(calibrate(other.path(), {}));
  ASSERT_TRUE(parts[0].cuts.empty());
  const Calibration both = joined(std::move(parts));
  for (const char* key : {"optics.point_spread_px",
                          "sensor.noise_gain",
                          "sensor.noise_floor",
                          "sensor.noise_correlation_px",
                          "shutter.readout_s"}) {
    ASSERT_TRUE(both.quantities.at(key).is_measured() && c.quantities.at(key).is_measured()) << key;
    const bool is_readout = std::string(key) == "shutter.readout_s";
    const Estimate a = is_readout ? *c.downwards_s : c.quantities.at(key).value();
    const Estimate b = is_readout ? *both.downwards_s : both.quantities.at(key).value();
    std::printf("%s: %.4g +- %.2g spliced, %.4g +- %.2g of the parts\n",
                key,
                a.value,
                a.sigma,
                b.value,
                b.sigma);
    EXPECT_NEAR(a.value, b.value, 3 * std::hypot(a.sigma, b.sigma)) << key;
  }
}

// The joined measurement of two halves of a clip agrees with that of the whole clip.
TEST(CalibrateWithProfile, JoinedClipsAgreeWithOneLongClip) {
  synthetic::FlightOptions o = ideal(12);
  o.frame_count = 24;
  const synthetic::Flight flight(o);
  synthetic::FlightOptions half = o;
  half.frame_count = 12;
  Injected what;
  what.point_spread_px = 0.9;
  what.sensor.noise_gain = 4e-4;
  what.sensor.noise_floor = 3e-5;
  what.sensor.noise_correlation_px = 0.6;
  Clip clip;
  clip.write(flight, what, true);
  const Calibration whole = calibrate(clip.path(), {});
  std::vector<Calibration> halves;
  for (const int first : {0, 12}) {
    Clip part;
    part.write(flight, what, true, first, half.frame_count);
    halves.push_back(calibrate(part.path(), {}));
  }
  const Calibration both = joined(std::move(halves));
  EXPECT_EQ(both.frames, whole.frames);
  for (const char* key : {"optics.point_spread_px",
                          "optics.sharpening",
                          "sensor.noise_gain",
                          "sensor.noise_floor",
                          "sensor.noise_correlation_px"}) {
    const Estimate a = whole.quantities.at(key).value(), b = both.quantities.at(key).value();
    std::printf("%s: %.4g +- %.2g whole, %.4g +- %.2g of halves\n",
                key,
                a.value,
                a.sigma,
                b.value,
                b.sigma);
    EXPECT_NEAR(b.value, a.value, 3 * std::hypot(a.sigma, b.sigma)) << key;
    EXPECT_LT(b.sigma, 2.5 * a.sigma + 1e-9) << key;
  }
  expect_within(both, "optics.point_spread_px", 0.9, 0.1);
  expect_within(both, "sensor.noise_correlation_px", 0.6, 0.12);
}

}  // namespace
}  // namespace airtruth::camera_file
