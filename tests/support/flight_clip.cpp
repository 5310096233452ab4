// SPDX-License-Identifier: Apache-2.0
#include "support/flight_clip.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/image/colour.h"
#include "picture/composite/spread.h"

namespace airtruth::camera_file {
namespace {

// The means of the squares of `finer` x `finer` samples of a plane.
std::vector<float> in_larger_pixels(const std::vector<float>& fine, int width, int finer) {
  const auto n = static_cast<std::size_t>(finer), w = static_cast<std::size_t>(width);
  const std::size_t columns = w / n, rows = fine.size() / w / n;
  std::vector<float> means(columns * rows, 0.0F);
  for (std::size_t y = 0; y < rows * n; ++y)
    for (std::size_t x = 0; x < columns * n; ++x)
      means[y / n * columns + x / n] += fine[y * w + x] / static_cast<float>(n * n);
  return means;
}

std::vector<float> samples_of(const image::Plane& plane) {
  std::vector<float> samples;
  for (int y = 0; y < plane.height; ++y)
    samples.insert(samples.end(), plane.row(y), plane.row(y) + plane.width);
  return samples;
}

void put(const std::vector<float>& samples, image::Plane& plane) {
  auto sample = samples.begin();
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x)
      plane.row(y)[x] = static_cast<std::uint8_t>(std::clamp(*sample++ + 0.5F, 0.0F, 255.0F));
}

// The spread in fine pixels. The lens spreads light before it is sampled, which the fine pixels
// represent. The variance of the pixels of light and of spread is compensated.
double spread_of_finer(const Injected& what) {
  const double n = what.finer;
  return n * std::hypot(what.point_spread_px, std::sqrt((1 - 1 / (n * n)) / 12));
}

// Coded luma, 0 to 1: the light is blurred, averaged over larger pixels and tone-mapped.
std::vector<float> coded_of(std::vector<float> luma, int width, const Injected& what) {
  const image::ToneCurve& tone = what.sensor.tone;
  for (float& v : luma) v = tone.linear_from_coded_clamped(v);
  const int height = static_cast<int>(luma.size()) / width;
  const auto kernel = composite::gaussian(spread_of_finer(what));
  if (what.point_spread_px > 0) composite::blur(luma, width, height, kernel, kernel);
  luma = in_larger_pixels(luma, width, what.finer);
  for (float& v : luma) v = static_cast<float>(tone.coded_from_linear(double(v)));
  return luma;
}

// The picture after lens and sensor; it is smaller by the factor `what.finer`.
image::Picture taken(const image::Picture& fine, const Injected& what, std::int64_t frame) {
  const int width = fine.width / what.finer, height = fine.height / what.finer;
  image::Picture picture = image::make_picture(width, height, fine.colour);
  for (const std::size_t p : {1U, 2U}) {
    image::Plane& plane = picture.planes[p];
    auto samples = in_larger_pixels(samples_of(fine.planes[p]), fine.planes[p].width, what.finer);
    // In chroma samples of two luma pixels. The spread of luma also applies to chroma.
    const double spread_px = std::hypot(what.sensor.chroma_spread_px, what.point_spread_px);
    const auto kernel = composite::gaussian(spread_px / 2);
    if (what.sensor.chroma_spread_px > 0)
      composite::blur(samples, plane.width, plane.height, kernel, kernel);
    put(samples, plane);
  }
  const image::ColourCode code(picture.colour);
  const float dark = code.ycc_from_rgb({0, 0, 0}).y;
  const float unit = code.ycc_from_rgb({1, 1, 1}).y - dark;
  std::vector<float> luma = samples_of(fine.planes[0]);
  for (float& v : luma) v = (v - dark) / unit;
  luma = coded_of(std::move(luma), fine.width, what);
  for (float& v : luma) v *= unit;
  const PixelBox all{0, 0, width, height};
  composite::sharpen(luma, all, all, what.sensor);
  const auto noise = composite::noise_field(all, 7, frame, what.sensor.noise_correlation_px);
  for (std::size_t i = 0; i < luma.size(); ++i) {
    const float sigma =
        what.sensor.has_noise() ? composite::noise_sigma(luma[i] / unit, unit, what.sensor) : 0;
    luma[i] += dark + sigma * noise[i];
  }
  put(luma, picture.planes[0]);
  return picture;
}

// Paints square panels with a rotated bright square on each; every pixel is the mean light of 8x8
// places. In a picture of finer pixels the panels are larger by the same factor.
void paint_panels(image::Picture& picture, int finer) {
  constexpr int kPlaces = 8;
  const int side = 96 * finer;
  const double dark = double(image::linear_from_srgb(0.25F));
  const double bright = double(image::linear_from_srgb(0.7F));
  for (int panel = 0; panel < 20; ++panel) {
    const int left = (80 + panel % 5 * 170) * finer, top = (40 + panel / 5 * 170) * finer;
    const double c = std::cos(0.2 + 0.4 * panel), s = std::sin(0.2 + 0.4 * panel);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        int inside = 0;
        for (int i = 0; i < kPlaces * kPlaces; ++i) {
          const int column = i % kPlaces, row = i / kPlaces;  // of the places in a pixel
          const double u = x + (column + 0.5) / kPlaces - 0.5 * side;
          const double v = y + (row + 0.5) / kPlaces - 0.5 * side;
          inside +=
              std::abs(c * u + s * v) < 26 * finer && std::abs(c * v - s * u) < 26 * finer ? 1 : 0;
        }
        const double light = dark + (bright - dark) * inside / (kPlaces * kPlaces);
        picture.planes[0].row(top + y)[left + x] = static_cast<std::uint8_t>(
            16.5F + 219 * image::srgb_from_linear(static_cast<float>(light)));
      }
  }
}

}  // namespace

Clip::Clip()
    : path_(fs::temp_directory_path() / ("calibration_" + std::to_string(::getpid()) + "_" +
                                         std::to_string(made_++) + ".mkv")) {}

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

void Clip::write(const synthetic::Flight& flight,
                 const Injected& what,
                 bool panels,
                 int first_frame,
                 std::optional<int> frame_count) {
  synthetic::FlightOptions o = flight.options();
  o.width /= what.finer, o.height /= what.finer;
  o.frame_count = frame_count.value_or(o.frame_count);
  write(o, [&](int k) {
    image::Picture picture = flight.frame(first_frame + k);
    if (panels) paint_panels(picture, what.finer);
    return taken(picture, what, first_frame + k);
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
  ASSERT_TRUE(c.quantities.at(key).is_measured()) << key << ": " << c.quantities.at(key).missing;
  const double value = c.quantities.at(key).value().value;
  std::printf("%s: %.4g, put in %.4g\n", key.c_str(), value, truth);
  EXPECT_NEAR(value, truth, share * truth) << key;
}

}  // namespace airtruth::camera_file
