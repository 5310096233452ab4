// SPDX-License-Identifier: Apache-2.0
// Compares two independent renderers: the ray tracer and OpenGL share only the triangles, the
// textures and the model of the light.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>

#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/model/texture.h"
#include "foundation/base/error.h"
#include "picture/backdrop/backdrop.h"
#include "picture/render/renderer.h"

namespace airtruth {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 128;
constexpr double kFocalPx = 900;
constexpr double kTime = 0.37;
const lens::Pinhole kLens{{kFocalPx, kFocalPx}, {80.3, 63.6}};

const shade::Light kSunny{
    unit_vector(130, 40), {0.9f, 0.85f, 0.8f}, {0.25f, 0.3f, 0.4f}, {0.1f, 0.09f, 0.06f}};
const shade::Light kOvercast{{0, 0, -1}, {0, 0, 0}, {0.8f, 0.9f, 1}, {0.3f, 0.25f, 0.2f}};

struct Precision {
  // Of the ray tracer.
  int quality = 4;
  // Of OpenGL.
  int supersampling = 32;
};

struct Comparison {
  double worst_alpha = 0;
  // Of the ray tracer.
  double alpha_sum = 0;
  double gl_alpha_sum = 0;
  // Premultiplied and linear.
  double worst_colour = 0;
  double colour_bias = 0;  // mean of the three channels' sums, relative to their sum
};

// North is the optical axis: x_cam = east, y_cam = down, z_cam = north.
Rigid cam_from_world() { return {cam_from_body(), Vector3::Zero()}; }

backdrop::Options software() {
  backdrop::Options options;
  options.software = true;
  return options;
}

image::Layer traced(const model::Mesh& mesh,
                    const Rigid& world_from_body,
                    const shade::Light& light,
                    int quality) {
  const lens::Lens lens(kLens, {kWidth, kHeight});
  render::View view;
  view.lens = &lens;
  view.world_from_cam = cam_from_world().inverse();
  view.width = kWidth;
  view.height = kHeight;
  const shade::Model model(mesh);
  return render::render(view,
                        light,
                        {{&model, world_from_body, kTime}},
                        {Box{0, 0, kWidth, kHeight}},
                        {.quality = quality});
}

Comparison compare(const model::Mesh& mesh,
                   const Rigid& world_from_body,
                   const shade::Light& light,
                   const Precision& precision = {}) {
  const image::Layer layer = traced(mesh, world_from_body, light, precision.quality);
  const auto gl = backdrop::open_backdrop(kWidth, kHeight, software());
  const auto drawn = gl->render_alpha(
      kLens, cam_from_world(), light, {{&mesh, world_from_body, kTime}}, precision.supersampling);
  Comparison result;
  double difference = 0;
  double total = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image::LayerPixel ray;
      if (!layer.empty() && layer.patch.contains(x, y)) ray = layer.pixels[layer.index(x, y)];
      const auto& pixel = drawn[static_cast<std::size_t>(y * kWidth + x)];
      const std::array<float, 4> traced_pixel = {ray.red, ray.green, ray.blue, ray.alpha};
      result.alpha_sum += static_cast<double>(ray.alpha);
      result.gl_alpha_sum += static_cast<double>(pixel[3]);
      result.worst_alpha =
          std::max(result.worst_alpha, static_cast<double>(std::abs(ray.alpha - pixel[3])));
      for (std::size_t c = 0; c < 3; ++c) {
        const auto off = static_cast<double>(pixel[c] - traced_pixel[c]);
        result.worst_colour = std::max(result.worst_colour, std::abs(off));
        difference += off;
        total += static_cast<double>(traced_pixel[c]);
      }
    }
  }
  result.colour_bias = difference / std::max(total, 1e-9);
  return result;
}

std::ostream& operator<<(std::ostream& out, const Comparison& c) {
  return out << "worst alpha " << c.worst_alpha << ", sums " << c.alpha_sum << " (rays) and "
             << c.gl_alpha_sum << " (OpenGL), worst colour " << c.worst_colour << ", colour bias "
             << c.colour_bias;
}

model::Material plain(float r, float g, float b, float opacity = 1) {
  model::Material material;
  material.diffuse = {r, g, b};
  material.opacity = opacity;
  return material;
}

model::Mesh empty_mesh() {
  model::Mesh mesh;
  mesh.parts.push_back({"airframe", {}, false, {1, 0, 0}, {0, 0, 0}, 0});
  return mesh;
}

// A quadrilateral from a corner and two sides, with its normal along their cross product.
void add_plate(model::Mesh& mesh,
               const Eigen::Vector3f& corner,
               const Eigen::Vector3f& u,
               const Eigen::Vector3f& v,
               const model::Material& material) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto index = static_cast<std::uint32_t>(mesh.materials.size());
  mesh.materials.push_back(material);
  for (int i = 0; i < 4; ++i) {
    const float s = i == 1 || i == 2 ? 1.0f : 0.0f;
    const float t = i >= 2 ? 1.0f : 0.0f;
    mesh.positions.push_back(corner + s * u + t * v);
    mesh.normals.push_back(u.cross(v).normalized());
    mesh.uvs.emplace_back(s, t);
  }
  mesh.parts[0].triangles.push_back({{first, first + 1, first + 2}, index});
  mesh.parts[0].triangles.push_back({{first, first + 2, first + 3}, index});
}

// A crate with sides of six colours.
model::Mesh crate(float length, float width, float height) {
  model::Mesh mesh = empty_mesh();
  const Eigen::Vector3f x(length, 0, 0), y(0, width, 0), z(0, 0, height);
  const Eigen::Vector3f low = -(x + y + z) / 2;
  const Eigen::Vector3f high = -low;
  add_plate(mesh, low, y, x, plain(0.8f, 0.2f, 0.2f));
  add_plate(mesh, low, z, y, plain(0.2f, 0.8f, 0.2f));
  add_plate(mesh, low, x, z, plain(0.2f, 0.2f, 0.8f));
  add_plate(mesh, high, -x, -y, plain(0.8f, 0.8f, 0.2f));
  add_plate(mesh, high, -y, -z, plain(0.2f, 0.8f, 0.8f));
  add_plate(mesh, high, -z, -x, plain(0.8f, 0.2f, 0.8f));
  return mesh;
}

Rigid pose(double distance_m, const YawPitchRoll& attitude) {
  return {world_from_body(attitude), {distance_m, 0.013 * distance_m, -0.007 * distance_m}};
}

TEST(TwoRenderers, AgreeOnACrate) {
  const model::Mesh mesh = crate(8, 5, 3);
  for (const YawPitchRoll& attitude : {YawPitchRoll{30, 20, 10}, YawPitchRoll{200, -35, 75}}) {
    const Comparison c = compare(mesh, pose(300, attitude), kSunny);
    EXPECT_GT(c.alpha_sum, 200);
    EXPECT_LT(c.worst_alpha, 0.02) << c;
    EXPECT_NEAR(c.gl_alpha_sum, c.alpha_sum, 2e-3 * c.alpha_sum) << c;
    EXPECT_LT(c.worst_colour, 0.1) << c;  // 16 shaded samples where an edge crosses
    EXPECT_NEAR(c.colour_bias, 0, 2e-3) << c;
  }
}

TEST(TwoRenderers, AgreeOnPanesBehindEachOther) {
  model::Mesh mesh = empty_mesh();
  add_plate(mesh, {0, -4, -3}, {0, 6, 0}, {0, 0, 5}, plain(0.9f, 0.1f, 0.1f, 0.4f));
  add_plate(mesh, {-2, -2, -2}, {0, 6, 0}, {0, 0, 5}, plain(0.1f, 0.1f, 0.9f, 0.6f));
  add_plate(mesh, {2, -3, 0}, {0, 6, 0}, {0, 0, 2}, plain(0.8f, 0.8f, 0.8f));
  const Comparison c = compare(mesh, pose(300, {10, 5, 3}), kOvercast);
  EXPECT_LT(c.worst_alpha, 0.02) << c;
  EXPECT_NEAR(c.gl_alpha_sum, c.alpha_sum, 2e-3 * c.alpha_sum) << c;
  EXPECT_LT(c.worst_colour, 0.03) << c;
}

// A window in a painted plate: texels of 8x8 with a translucent middle.
TEST(TwoRenderers, AgreeOnATextureThatIsTranslucentInPlaces) {
  model::Mesh mesh = empty_mesh();
  texture_file::Picture picture{8, 8, {}};
  for (int i = 0; i < 8 * 8; ++i) {
    const bool middle = i % 8 >= 2 && i % 8 < 6 && i / 8 >= 2 && i / 8 < 6;
    const auto green = static_cast<std::uint8_t>(31 * (i % 8));
    const std::uint8_t alpha = middle ? 64 : 255;
    picture.rgba.insert(picture.rgba.end(), {243, green, 124, alpha});
  }
  mesh.textures.push_back(model::texture_from_picture(picture, false, false));
  model::Material material = plain(1, 1, 1);
  material.texture = 0;
  add_plate(mesh, {0, -4, -3}, {0, 8, 0}, {0, 0, 6}, material);
  const Comparison c = compare(mesh, pose(300, {20, 10, 5}), kSunny);
  EXPECT_LT(c.worst_alpha, 0.04) << c;
  EXPECT_NEAR(c.gl_alpha_sum, c.alpha_sum, 4e-3 * c.alpha_sum) << c;
  EXPECT_LT(c.worst_colour, 0.05) << c;
}

class TwoRenderersOnAircraft : public testing::TestWithParam<const char*> {};

// The sky is even, because OpenGL casts no shadows. The renderer shades some samples of a pixel,
// which affects the colour of single pixels but not their mean. It averages texels over half a
// pixel, and this OpenGL over a 32nd. From far away that half pixel reaches into the neighbours of
// a painted part on its texture, and the colour of the 737 at 20 px changes by 8 %.
TEST_P(TwoRenderersOnAircraft, AgreeAt20And100Pixels) {
  try {
    fleet::find_aircraft(GetParam());
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }
  const fleet::Aircraft plane = fleet::load_aircraft(GetParam());
  const model::Extents extents = model::extents(plane.mesh);
  const double size_m = std::max(extents.length_m(), extents.span_m());
  for (double size_px : {20.0, 100.0}) {
    const Rigid world_from_body = pose(kFocalPx * size_m / size_px, {50, 8, -15});
    const Comparison c =
        compare(plane.mesh, world_from_body, kOvercast, {size_px < 50 ? 4 : 3, 32});
    EXPECT_GT(c.alpha_sum, 0.02 * size_px * size_px) << c;
    EXPECT_LT(c.worst_alpha, size_px < 50 ? 0.03 : 0.04) << c;
    EXPECT_NEAR(c.gl_alpha_sum, c.alpha_sum, 5e-3 * c.alpha_sum) << c;
    EXPECT_LT(c.worst_colour, 0.12) << c;
    EXPECT_NEAR(c.colour_bias, 0, size_px < 50 ? 0.1 : 0.01) << c;
  }
}

INSTANTIATE_TEST_SUITE_P(Liveries,
                         TwoRenderersOnAircraft,
                         testing::Values("738/738-Ryanair", "c172/csna"));

}  // namespace
}  // namespace airtruth
