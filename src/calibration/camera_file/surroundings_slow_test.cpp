// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>

#include "calibration/own_aircraft/own_aircraft.h"
#include "camera/horizon/horizon.h"
#include "foundation/base/files.h"
#include "foundation/base/median.h"
#include "picture/video/still.h"
#include "scene/synthetic/sky.h"
#include "support/flight_clip.h"
#include "support/shared_folder.h"

// The surroundings of a camera are found from its clip: sun, air, horizon and the own aircraft.
namespace airtruth::camera_file {
namespace {

// Calibrates an unchanged flight with its own lens.
Calibration calibrate_flight(const synthetic::FlightOptions& o, Options options) {
  const synthetic::Flight flight(o);
  Clip clip;
  clip.write(o, [&](int k) { return flight.frame(k); });
  options.lens = o.lens;
  return calibrate(clip.path(), options);
}

TEST(Calibrate, FindsTheSun) {
  for (const auto& [azimuth, elevation] : {std::pair(20.0, 25.0), std::pair(-35.0, 40.0)}) {
    synthetic::FlightOptions o = ideal(8);
    o.width = 640, o.height = 480;
    o.lens = lens::fisheye_from_vertical_fov(110, {o.width, o.height});
    o.sun_azimuth_deg = azimuth;
    o.sun_elevation_deg = elevation;
    o.cloud_cover = 0.3;
    o.own_aircraft = false;
    o.frame_count = 24;
    const Calibration c = calibrate_flight(o, {});
    ASSERT_TRUE(c.quantities.at("light.sun_azimuth_deg").is_measured())
        << c.quantities.at("light.sun_azimuth_deg").missing;
    const double off =
        degrees(std::acos(-unit_vector(c.quantities.at("light.sun_azimuth_deg").value().value,
                                       c.quantities.at("light.sun_elevation_deg").value().value)
                               .dot(-unit_vector(azimuth, elevation))));
    std::printf("sun off by %.1f degrees\n", off);
    EXPECT_LT(off, 10);
  }
}

// With the sun out of the picture, the bright edge of a bank of clouds is not taken for it.
TEST(Calibrate, TakesNoCloudForTheSun) {
  for (const std::uint64_t seed : {1, 2, 3, 4})
    for (const double azimuth : {120.0, -60.0}) {
      synthetic::FlightOptions o = ideal(seed);
      o.width = 640, o.height = 480;
      o.lens = lens::pinhole_from_vertical_fov(75, {o.width, o.height});
      o.sun_azimuth_deg = azimuth;
      o.sun_elevation_deg = 40;
      o.cloud_cover = 0.5;
      o.own_aircraft = false;
      o.frame_count = 24;
      const Quantity sun = calibrate_flight(o, {}).quantities.at("light.sun_azimuth_deg");
      EXPECT_FALSE(sun.is_measured()) << seed << ", " << azimuth;
    }
}

// Flights over two kilometres, so that the ground consists of many fields, with the sun aside and
// ahead.
TEST(Calibrate, MeasuresTheAir) {
  struct Case {
    std::uint64_t seed;
    double extinction_per_km, sun_azimuth_deg;
  };
  for (const auto& [seed, extinction_per_km, sun_azimuth_deg] :
       {Case{9, 0.12, 120}, Case{9, 0.3, 120}, Case{6, 0.3, 120}, Case{12, 0.12, 10}}) {
    synthetic::FlightOptions o = ideal(seed);
    o.sun_azimuth_deg = sun_azimuth_deg;
    o.lens = lens::fisheye_from_vertical_fov(110, {o.width, o.height});
    o.cloud_cover = 0.3;
    o.own_aircraft = false;
    o.frame_rate_hz = 2;
    o.frame_count = 80;
    o.speed_mps = 50;
    o.shake_deg = 0.1;
    o.extinction_per_km = extinction_per_km;
    o.linear_light = true;
    Options options;
    options.altitude_m = o.altitude_m;
    const Calibration c = calibrate_flight(o, options);
    EXPECT_EQ(c.quantities.at("air.extinction_per_km").note, "")
        << c.quantities.at("air.extinction_per_km").note;
    expect_within(c, "air.extinction_per_km", extinction_per_km, 0.1);
    // The sky at the horizon, over the azimuths that the lens sees.
    const synthetic::Sky sky(unit_vector(o.sun_azimuth_deg, o.sun_elevation_deg));
    synthetic::LinearRgb airlight = synthetic::LinearRgb::Zero();
    for (int degree = -60; degree <= 60; degree += 10)
      airlight += sky.haze({std::cos(radians(degree)), std::sin(radians(degree)), 0}) / 13;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const double found = c.quantities.at("air.airlight").values[channel].value;
      const double extinction = c.quantities.at("air.extinction_per_km").values[channel].value;
      const double truth = double(airlight[static_cast<int>(channel)]);
      std::printf("channel %zu: airlight %.3f, put in %.3f; extinction %.3f +- %.3f\n",
                  channel,
                  found,
                  truth,
                  extinction,
                  c.quantities.at("air.extinction_per_km").values[channel].sigma);
      EXPECT_NEAR(found, truth, 0.1 * truth) << channel;
      EXPECT_NEAR(extinction, extinction_per_km, 0.1 * extinction_per_km) << channel;
    }
  }
}

double overlap(const image::Mask& a, const image::Mask& b) {
  double both = 0, either = 0;
  for (std::size_t i = 0; i < a.free.size(); ++i) {
    const bool x = a.free[i] < 128, y = b.free[i] < 128;
    both += x && y ? 1 : 0;
    either += x || y ? 1 : 0;
  }
  return both / either;
}

TEST(OwnAircraft, IsFoundToTheBorder) {
  for (const std::uint64_t seed : {4u}) {
    synthetic::FlightOptions o;
    o.seed = seed;
    o.frame_count = 180;
    o.width = 960, o.height = 720;
    const synthetic::Flight flight(o);
    Clip clip;
    clip.write(
        o, [&](int k) { return flight.frame(k); }, video::Format::kMp4);
    const double iou =
        overlap(own_aircraft::find_own_aircraft(clip.path(), {}), flight.own_aircraft());
    std::printf("own aircraft, flight %d: IoU %.3f\n", static_cast<int>(seed), iou);
    EXPECT_GE(iou, 0.95) << seed;
  }
}

// Hand-marked horizons of a real onboard video through a wide lens. Sky and ground are painted
// along each of them, and the plane that is found must lie along it.
TEST(Horizon, LiesAlongHandMarkedOnes) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is not set";
  std::istringstream lines(
      read_file(std::string(shared) + "/evision/horizon/HorizonLineData_1.txt"));
  const lens::ImageSize size{1280, 720};
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, size);
  const horizon::HorizonFinder finder(lens, nullptr);
  std::vector<double> off_px;
  int frames = 0, found = 0, line_number = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line_number++ % 20 != 0) continue;
    std::istringstream cells(line);
    std::string cell;
    std::getline(cells, cell, ',');
    std::vector<double> numbers;
    while (std::getline(cells, cell, ',')) numbers.push_back(std::atof(cell.c_str()));
    std::vector<double> horizon(1280, 0);
    for (std::size_t i = 0; i + 3 < numbers.size(); i += 2)
      for (int x = static_cast<int>(numbers[i]); x <= static_cast<int>(numbers[i + 2]) && x < 1280;
           ++x)
        horizon[static_cast<std::size_t>(x)] =
            numbers[i + 1] + (numbers[i + 3] - numbers[i + 1]) * (x - numbers[i]) /
                                 std::max(1.0, numbers[i + 2] - numbers[i]);
    image::Picture picture = image::make_picture(1280, 720, image::Colour{});
    for (int y = 0; y < 720; ++y)
      for (int x = 0; x < 1280; ++x) {
        const bool sky = y < horizon[static_cast<std::size_t>(x)];
        const auto grain = static_cast<int>((x * 7919u ^ y * 104729u) % 37u);
        picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(sky ? 190 - y / 20 : 80 + grain);
        picture.planes[1].row(y / 2)[x / 2] = static_cast<std::uint8_t>(sky ? 140 : 112);
        picture.planes[2].row(y / 2)[x / 2] = static_cast<std::uint8_t>(sky ? 116 : 126);
      }
    ++frames;
    const auto plane = finder.find(picture);
    if (!plane) continue;
    ++found;
    EXPECT_LT(plane->up_in_cam.y(), 0);
    double sum = 0;
    int count = 0;
    for (int x = 40; x < 1280; x += 40)
      for (int y = 1; y < 720; ++y) {
        const double above = lens.ray_from_pixel({x + 0.5, y - 0.5})->dot(plane->up_in_cam);
        const double below = lens.ray_from_pixel({x + 0.5, y + 0.5})->dot(plane->up_in_cam);
        if (above > 0 && below <= 0) {
          sum += std::abs(y - horizon[static_cast<std::size_t>(x)]);
          ++count;
        }
      }
    off_px.push_back(sum / std::max(1, count));
  }
  const double median_px = median_or_0(off_px);
  std::printf(
      "horizons: %d of %d found, median %.1f px off (a fisheye's bent line against a plane)\n",
      found,
      frames,
      median_px);
  EXPECT_EQ(found, frames);
  EXPECT_LT(median_px, 15);
}

// The masks of the paper, each laid over a virtual flight like a real aircraft in the picture.
TEST(OwnAircraft, RealMasksAreFoundOverAVirtualFlight) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is not set";
  for (const char* name : {"mask1"}) {
    const image::Mask mask =
        video::read_mask(std::string(shared) + "/evision/masks/" + name + ".png", 1280, 960);
    synthetic::FlightOptions o;
    o.seed = 11;
    o.frame_count = 120;
    o.own_aircraft = false;
    const synthetic::Flight flight(o);
    Clip clip;
    clip.write(
        o,
        [&](int k) {
          image::Picture picture = flight.frame(k);
          for (int y = 0; y < 960; ++y)
            for (int x = 0; x < 1280; ++x) {
              if (mask.is_free(x, y)) continue;
              picture.planes[0].row(y)[x] =
                  static_cast<std::uint8_t>(170 - y / 16 + (x / 90 % 2) * 20);
              picture.planes[1].row(y / 2)[x / 2] = 126;
              picture.planes[2].row(y / 2)[x / 2] = 132;
            }
          return picture;
        },
        video::Format::kMp4);
    const double iou = overlap(own_aircraft::find_own_aircraft(clip.path(), {}), mask);
    std::printf("%s: IoU %.3f\n", name, iou);
    EXPECT_GE(iou, 0.93) << name;
  }
}

}  // namespace
}  // namespace airtruth::camera_file
