// SPDX-License-Identifier: Apache-2.0
#include "calibration/flight_clip.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>
#include <unistd.h>

#include "composite/spread.h"
#include "image/colour.h"

namespace airtruth::calibration {
namespace {

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

}  // namespace

Clip::Clip()
    : path_(fs::temp_directory_path() / ("calibration_" + std::to_string(::getpid()) + ".mkv")) {}

Clip::~Clip() {
  std::error_code ignored;
  fs::remove(path_, ignored);
}

void Clip::write(const synthetic::FlightOptions& o,
                 const std::function<image::Picture(int)>& frame,
                 video::Format format,
                 int quality) {
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
  for (int k = 0; k < o.frame_count; ++k) {
    video::Frame one;
    one.index = k;
    one.time_s = k / o.frame_rate_hz;
    one.pts = std::lround(one.time_s * 90000);
    one.picture = frame(k);
    writer.write(one);
  }
  writer.finish();
}

void Clip::write(const synthetic::Flight& flight, const Injected& what, bool panels) {
  write(flight.options(), [&](int k) {
    image::Picture picture = flight.frame(k);
    if (panels) paint_panels(picture);
    inject(picture, what, k);
    return picture;
  });
}

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

}  // namespace airtruth::calibration
