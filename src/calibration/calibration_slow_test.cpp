// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/files.h"
#include "base/median.h"
#include "calibration/calibration.h"
#include "calibration/own_aircraft.h"
#include "composite/sensor.h"
#include "composite/spread.h"
#include "image/colour.h"
#include "motion/horizon.h"
#include "synthetic/flight.h"
#include "synthetic/sky.h"
#include "video/still.h"
#include "video/writer.h"

// What is put into a virtual flight is measured out of it again.
namespace airtruth::calibration {
namespace {

struct Injected {
  double point_spread_px = 0;
  composite::Sensor sensor;
};

// Blur in linear light, then what a sensor does, over the whole luma plane.
void inject(image::Picture& picture, const Injected& what, std::int64_t frame) {
  const int width = picture.width;
  const int height = picture.height;
  const image::ColourCode code(picture.colour);
  const float dark = code.ycc_from_rgb({0, 0, 0}).y;
  const float unit = code.ycc_from_rgb({1, 1, 1}).y - dark;
  std::vector<float> luma;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) luma.push_back((picture.planes[0].row(y)[x] - dark) / unit);
  if (what.point_spread_px > 0) {
    const image::ToneCurve& tone = what.sensor.tone;
    for (float& v : luma) v = tone.linear_from_coded_clamped(v);
    composite::blur(luma, width, height, composite::gaussian(what.point_spread_px));
    for (float& v : luma) v = static_cast<float>(tone.coded_from_linear(double(v)));
  }
  for (float& v : luma) v *= unit;
  composite::sharpen(luma, width, height, what.sensor);
  const auto noise =
      composite::noise_field({0, 0, width, height}, 7, frame, what.sensor.noise_correlation_px);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x);
      const float sigma =
          what.sensor.has_noise() ? composite::noise_sigma(luma[i] / unit, unit, what.sensor) : 0;
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(
          std::clamp(luma[i] + dark + sigma * noise[i] + 0.5F, 0.0F, 255.0F));
    }
}

// Square panels with a bright square turned on each, every pixel by the light of 8x8 places.
void paint_panels(image::Picture& picture) {
  constexpr int kPanel = 96, kPlaces = 8;
  const double dark = double(image::linear_from_srgb(0.25F));
  const double bright = double(image::linear_from_srgb(0.7F));
  for (int panel = 0; panel < 20; ++panel) {
    const int left = 80 + panel % 5 * 170, top = 40 + panel / 5 * 170;
    const double c = std::cos(0.2 + 0.4 * panel), s = std::sin(0.2 + 0.4 * panel);
    for (int y = 0; y < kPanel; ++y)
      for (int x = 0; x < kPanel; ++x) {
        int inside = 0;
        for (int i = 0; i < kPlaces * kPlaces; ++i) {
          const double u = x + (i % kPlaces + 0.5) / kPlaces - 0.5 * kPanel;
          const double v = y + (i / kPlaces + 0.5) / kPlaces - 0.5 * kPanel;
          inside += std::abs(c * u + s * v) < 26 && std::abs(c * v - s * u) < 26 ? 1 : 0;
        }
        const double light = dark + (bright - dark) * inside / (kPlaces * kPlaces);
        picture.planes[0].row(top + y)[left + x] = static_cast<std::uint8_t>(
            16.5F + 219 * image::srgb_from_linear(static_cast<float>(light)));
      }
  }
}

class Clip {
 public:
  Clip()
      : path_(fs::temp_directory_path() / ("calibration_" + std::to_string(::getpid()) + ".mkv")) {}
  ~Clip() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  const fs::path& path() const { return path_; }

  void write(const synthetic::Flight& flight,
             const std::function<image::Picture(int)>& frame,
             int count,
             video::Format format = video::Format::kMkv,
             int quality = 18) {
    const synthetic::FlightOptions& o = flight.options();
    video::StreamInfo info;
    info.width = o.width;
    info.height = o.height;
    info.frame_rate = {static_cast<int>(std::lround(1000 * o.frame_rate_hz)), 1000};
    info.time_base = {1, 90000};
    video::WriterOptions options;
    options.format = format;
    options.quality = quality;
    fs::remove(path_);
    path_.replace_extension(video::extension(format));
    video::Writer writer(path_, info, options);
    for (int k = 0; k < count; ++k) {
      video::Frame one;
      one.index = k;
      one.time_s = k / o.frame_rate_hz;
      one.pts = std::lround(one.time_s * 90000);
      one.picture = frame(k);
      writer.write(one);
    }
    writer.finish();
  }

  // All of a flight, with that put into it.
  void write(const synthetic::Flight& flight, const Injected& what, bool panels = false) {
    write(
        flight,
        [&](int k) {
          image::Picture picture = flight.frame(k);
          if (panels) paint_panels(picture);
          inject(picture, what, k);
          return picture;
        },
        flight.options().frame_count);
  }

 private:
  fs::path path_;
};

synthetic::FlightOptions ideal(std::uint64_t seed) {
  synthetic::FlightOptions o;
  o.seed = seed;
  o.width = 960;
  o.height = 720;
  o.frame_count = 30;
  o.vertical_fov_deg = 60;
  o.ideal_sensor = true;
  return o;
}

void expect_within(const Calibration& c, const std::string& key, double truth, double share) {
  ASSERT_TRUE(c.values.contains(key))
      << key << ": " << (c.missing.contains(key) ? c.missing.at(key) : "");
  const double value = c.values.at(key)[0].value;
  std::printf("%s: %.4g, put in %.4g\n", key.c_str(), value, truth);
  EXPECT_NEAR(value, truth, share * truth) << key;
}

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
    for (const NoisePoint& p : c.noise) {
      composite::Sensor fitted = what.sensor;
      fitted.noise_gain = c.values.at("sensor.noise_gain")[0].value;
      fitted.noise_floor = c.values.at("sensor.noise_floor")[0].value;
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
  o.frame_count = 12;
  o.shake_deg = 0;
  o.own_aircraft = false;
  const synthetic::Flight flight(o);
  Clip clip;
  // Over painted panels, as airfields have them.
  Injected what;
  what.point_spread_px = 1.3;
  what.sensor.noise_gain = 1e-4;
  clip.write(flight, what, true);
  expect_within(calibrate(clip.path(), {}), "optics.point_spread_px", 1.3, 0.1);
  what = {};
  what.point_spread_px = 0.8;
  what.sensor.sharpening = 0.8;
  what.sensor.sharpening_px = 1.2;
  clip.write(flight, what, true);
  Calibration c = calibrate(clip.path(), {});
  expect_within(c, "optics.point_spread_px", 0.8, 0.1);
  expect_within(c, "optics.sharpening", 0.8, 0.1);
  expect_within(c, "optics.sharpening_px", 1.2, 0.1);

  // The ground and the own aircraft alone are no ideal steps: amount and radius stand in for one
  // another, and their errors say so.
  clip.write(flight, what);
  c = calibrate(clip.path(), {});
  expect_within(c, "optics.point_spread_px", 0.8, 0.1);
  for (const auto& [key, truth] :
       {std::pair("optics.sharpening", 0.8), std::pair("optics.sharpening_px", 1.2)}) {
    const Estimate& found = c.values.at(key)[0];
    std::printf("%s: %.3f +- %.3f, put in %.3f\n", key, found.value, found.sigma, truth);
    EXPECT_LT(std::abs(found.value - truth), 2.5 * found.sigma) << key;
    EXPECT_LT(found.sigma, 0.6 * truth) << key;
  }
}

TEST(Calibrate, ReadsTheCodecsStep) {
  synthetic::FlightOptions o = ideal(4);
  o.width = 320, o.height = 240, o.frame_count = 24;
  const synthetic::Flight flight(o);
  Clip clip;
  const auto step_at = [&](int quality) {
    clip.write(
        flight, [&](int k) { return flight.frame(k); }, 24, video::Format::kMp4, quality);
    const Calibration c = calibrate(clip.path(), {});
    return c.values.at("sensor.codec_step")[0].value;
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
  const synthetic::Flight stated(slow);
  Clip clip;
  clip.write(
      stated,
      [&](int k) {
        std::vector<float> sum(
            static_cast<std::size_t>(o.width) * static_cast<std::size_t>(o.height), 0.0F);
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
                16.5F +
                219 * image::srgb_from_linear(
                          sum[static_cast<std::size_t>(y) * static_cast<std::size_t>(o.width) +
                              static_cast<std::size_t>(x)] /
                          kOpen));
        return picture;
      },
      50);
  const Calibration c = calibrate(clip.path(), {});
  expect_within(c, "shutter.exposure_s", 0.5 / 30, 0.1);
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
  const synthetic::Flight stated(slow);
  Clip clip;
  constexpr int kUsed = 12;  // of 16: the readout takes three quarters of the interval
  clip.write(
      stated,
      [&](int k) {
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
      },
      80);
  const Calibration c = calibrate(clip.path(), {});
  expect_within(c, "shutter.readout_s", 0.75 / 30, 0.1);
  EXPECT_EQ(c.notes.at("shutter.readout"), "down");
}

// The flight as it is, through its own lens.
Calibration calibrate_flight(const synthetic::FlightOptions& o, Options options) {
  const synthetic::Flight flight(o);
  Clip clip;
  clip.write(
      flight, [&](int k) { return flight.frame(k); }, o.frame_count);
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
    ASSERT_TRUE(c.values.contains("light.sun_azimuth_deg"))
        << c.missing.at("light.sun_azimuth_deg");
    const double off =
        degrees(std::acos(-synthetic::sun_in_world(c.values.at("light.sun_azimuth_deg")[0].value,
                                                   c.values.at("light.sun_elevation_deg")[0].value)
                               .dot(-synthetic::sun_in_world(azimuth, elevation))));
    std::printf("sun off by %.1f degrees\n", off);
    EXPECT_LT(off, 10);
  }
}

// A flight over two kilometres, so that not one field makes the ground.
TEST(Calibrate, MeasuresTheAir) {
  for (const double extinction_per_km : {0.12, 0.3}) {
    synthetic::FlightOptions o = ideal(9);
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
    EXPECT_FALSE(c.notes.contains("air.extinction_per_km")) << c.notes.at("air.extinction_per_km");
    expect_within(c, "air.extinction_per_km", extinction_per_km, 0.1);
    // The sky at the horizon, over the azimuths that the lens sees.
    const synthetic::Sky sky(synthetic::sun_in_world(o.sun_azimuth_deg, o.sun_elevation_deg));
    synthetic::Light airlight = synthetic::Light::Zero();
    for (int degree = -60; degree <= 60; degree += 10)
      airlight += sky.haze({std::cos(radians(degree)), std::sin(radians(degree)), 0}) / 13;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const double found = c.values.at("air.airlight")[channel].value;
      const double extinction = c.values.at("air.extinction_per_km")[channel].value;
      const double truth = double(airlight[static_cast<int>(channel)]);
      std::printf("channel %zu: airlight %.3f, put in %.3f; extinction %.3f +- %.3f\n",
                  channel,
                  found,
                  truth,
                  extinction,
                  c.values.at("air.extinction_per_km")[channel].sigma);
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
        flight, [&](int k) { return flight.frame(k); }, o.frame_count, video::Format::kMp4);
    const double iou = overlap(find_own_aircraft(clip.path(), {}), flight.own_aircraft());
    std::printf("own aircraft, flight %d: IoU %.3f\n", static_cast<int>(seed), iou);
    EXPECT_GE(iou, 0.95) << seed;
  }
}

// Hand-marked horizons of a real onboard video, through a wide lens: sky and ground are painted
// along each, and the plane that is found must lie along it.
TEST(Horizon, LiesAlongHandMarkedOnes) {
  const char* shared = std::getenv("AIRTRUTH_SHARED");
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is not set";
  std::istringstream lines(
      read_file(std::string(shared) + "/evision/horizon/HorizonLineData_1.txt"));
  const lens::ImageSize size{1280, 720};
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, size);
  const motion::HorizonFinder finder(lens, nullptr);
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

// The paper's own masks, each laid over a virtual flight as a real aircraft would stand in it.
TEST(OwnAircraft, RealMasksAreFoundOverAVirtualFlight) {
  const char* shared = std::getenv("AIRTRUTH_SHARED");
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
        flight,
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
        o.frame_count,
        video::Format::kMp4);
    const double iou = overlap(find_own_aircraft(clip.path(), {}), mask);
    std::printf("%s: IoU %.3f\n", name, iou);
    EXPECT_GE(iou, 0.93) << name;
  }
}

}  // namespace
}  // namespace airtruth::calibration
