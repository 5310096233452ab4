// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "foundation/image/colour.h"
#include "picture/render/renderer.h"

// Compares the windows, cheat lines and titles of a small livery with the mean of 64 pixels drawn
// in the place of each. In the reference a sample is 1/32 of a pixel, and textures are read at full
// resolution.
namespace airtruth::render {
namespace {

constexpr int kTextureSide = 120;
constexpr int kFiner = 8;

image::Layer textured_layer(const fleet::Aircraft& aircraft,
                            const shade::Model& model,
                            double size_px,
                            int finer,
                            const YawPitchRoll& attitude,
                            int quality) {
  const model::Extents extents = model::extents(aircraft.mesh);
  const double longest_m = std::max(extents.length_m(), extents.span_m());
  const int side = finer * kTextureSide;
  const double focal_px = 2000.0 * finer;
  const lens::Lens lens(lens::Pinhole{{focal_px, focal_px}, {side / 2.0, side / 2.0}},
                        {side, side});
  const View view{&lens,
                  Rigid{cam_from_body().conjugate(), Vector3::Zero()},
                  Homography::Identity(),
                  side,
                  side};
  shade::Light light;
  light.to_sun_in_world = unit_vector(160, 40);
  light.sun = {0.6f, 0.58f, 0.55f};
  light.surroundings = shade::Environment::of([](const Vector3& d) {
    return d.z() > 0 ? image::Rgb{0.05f, 0.05f, 0.04f} : image::Rgb{0.15f, 0.2f, 0.26f};
  });
  const Rigid world_from_body{airtruth::world_from_body(attitude),
                              Vector3(2000 * longest_m / size_px, 0.3, -0.2)};
  // The size of the box determines the number of samples.
  const double half_px = finer * (0.6 * size_px + 3);
  return render(view,
                light,
                {{&model, world_from_body, 0}},
                {Box{side / 2.0 - half_px, side / 2.0 - half_px, 2 * half_px, 2 * half_px}},
                {.quality = quality});
}

struct TextureError {
  // Over the pixels that the aircraft covers by half or more, in sRGB code values.
  double mean_codes = 0;
  double rms_codes = 0;
  // The mean over the tenth of the pixels that is darkest in the reference.
  double dark_codes = 0;
};

double code_of(double linear) {
  return 255 * static_cast<double>(image::srgb_from_linear(static_cast<float>(linear)));
}

TextureError texture_error(const fleet::Aircraft& aircraft,
                           const shade::Model& model,
                           double size_px,
                           const YawPitchRoll& attitude) {
  const image::Layer got = textured_layer(aircraft, model, size_px, 1, attitude, 3);
  const image::Layer fine = textured_layer(aircraft, model, size_px, kFiner, attitude, 4);
  // Reference and rendered value.
  std::vector<std::pair<double, double>> pairs;
  for (int y = 0; y < kTextureSide; ++y)
    for (int x = 0; x < kTextureSide; ++x) {
      double truth = 0;
      double alpha = 0;
      for (int j = 0; j < kFiner; ++j)
        for (int i = 0; i < kFiner; ++i) {
          if (!fine.patch.contains(kFiner * x + i, kFiner * y + j)) continue;
          const auto& p = fine.pixels[fine.index(kFiner * x + i, kFiner * y + j)];
          truth += static_cast<double>(p.green) / (kFiner * kFiner);
          alpha += static_cast<double>(p.alpha) / (kFiner * kFiner);
        }
      if (!got.patch.contains(x, y)) continue;
      const auto& here = got.pixels[got.index(x, y)];
      if (alpha < 0.5 || here.alpha < 0.5f) continue;
      pairs.emplace_back(truth / alpha, static_cast<double>(here.green / here.alpha));
    }
  TextureError error;
  for (const auto& [truth, here] : pairs) {
    const double off = code_of(here) - code_of(truth);
    error.mean_codes += off / static_cast<double>(pairs.size());
    error.rms_codes += off * off / static_cast<double>(pairs.size());
  }
  error.rms_codes = std::sqrt(error.rms_codes);
  std::sort(pairs.begin(), pairs.end());
  const std::size_t darkest = std::max<std::size_t>(1, pairs.size() / 10);
  for (std::size_t i = 0; i < darkest; ++i)
    error.dark_codes +=
        (code_of(pairs[i].second) - code_of(pairs[i].first)) / static_cast<double>(darkest);
  return error;
}

TEST(Texture, IsNotWashedOutWhereAnAircraftIsSmall) {
  for (const char* name : {"738/738-Ryanair", "c172/news"}) {
    const fleet::Aircraft aircraft = fleet::load_aircraft(name);
    const shade::Model model(aircraft.mesh);
    for (const double size_px : {12.0, 30.0, 100.0})
      for (const YawPitchRoll& attitude :
           {YawPitchRoll{90, 0, 0}, YawPitchRoll{40, 5, 12}, YawPitchRoll{10, 3, 0}}) {
        const TextureError error = texture_error(aircraft, model, size_px, attitude);
        const auto where = ::testing::Message()
                           << name << " of " << size_px << " px, yaw " << attitude.yaw_deg;
        EXPECT_LT(std::abs(error.mean_codes), 2) << where;
        EXPECT_LT(error.rms_codes, 4) << where;
        // At 12 px the darkest tenth is only one or two pixels.
        if (size_px >= 30) {
          EXPECT_LT(std::abs(error.dark_codes), 3) << where;
        }
      }
  }
}

// The reference traces 4,096 rays through a pixel and shades what they meet.
TEST(Texture, HasTheReferencesColours) {
  for (const char* name : {"738/738-Ryanair", "c172/news"}) {
    const fleet::Aircraft aircraft = fleet::load_aircraft(name);
    const shade::Model model(aircraft.mesh);
    const image::Layer got = textured_layer(aircraft, model, 30, 1, {40, 5, 12}, 3);
    const image::Layer reference = textured_layer(aircraft, model, 30, 1, {40, 5, 12}, 5);
    double squares = 0;
    int pixels = 0;
    for (int y = 0; y < kTextureSide; ++y)
      for (int x = 0; x < kTextureSide; ++x) {
        if (!got.patch.contains(x, y) || !reference.patch.contains(x, y)) continue;
        const image::LayerPixel& a = got.pixels[got.index(x, y)];
        const image::LayerPixel& b = reference.pixels[reference.index(x, y)];
        if (a.alpha < 0.5f || b.alpha < 0.5f) continue;
        const double off = code_of(static_cast<double>(a.green / a.alpha)) -
                           code_of(static_cast<double>(b.green / b.alpha));
        squares += off * off;
        ++pixels;
      }
    EXPECT_GT(pixels, 50) << name;
    EXPECT_LT(std::sqrt(squares / pixels), 4) << name;
  }
}

}  // namespace
}  // namespace airtruth::render
