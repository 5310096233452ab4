// SPDX-License-Identifier: Apache-2.0
#include "sequence/demo/aircraft_sheet.h"

#include <algorithm>
#include <array>
#include <string>

#include "foundation/image/colour.h"
#include "labels/projection/exact_box.h"
#include "picture/composite/matte.h"
#include "picture/render/renderer.h"
#include "show/drawing/pictures.h"

namespace airtruth::demo {
namespace {

// Side of a tile of the sheet: room around an aircraft that is 380 px long.
constexpr int kTilePx = 420;

struct Pose {
  std::string name;
  double azimuth_deg;    // of the eye seen from the aircraft, from its nose towards its right wing
  double elevation_deg;  // of the eye above the aircraft
  int length_px;
};

image::Picture sky_tile(int tile_px) {
  image::Rgb8 rgb = image::make_rgb8(tile_px, tile_px);
  for (int y = 0; y < tile_px; ++y) {
    const double t = static_cast<double>(y) / tile_px;
    for (int x = 0; x < tile_px; ++x) {
      rgb.at(x, y)[0] = static_cast<std::uint8_t>(92 + 70 * t);
      rgb.at(x, y)[1] = static_cast<std::uint8_t>(130 + 55 * t);
      rgb.at(x, y)[2] = static_cast<std::uint8_t>(178 + 30 * t);
    }
  }
  return image::picture_from_rgb8(rgb,
                                  {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
}

image::Rgb8 tile(const fleet::Aircraft& aircraft,
                 const shade::Model& model,
                 const Pose& pose,
                 int tile_px = kTilePx) {
  const model::Extents size = model::extents(aircraft.mesh);
  const double largest_m = std::max({size.length_m(), size.span_m(), size.height_m()});
  const double range_m = 12 * largest_m;
  const double focal_px = pose.length_px * range_m / largest_m;
  const lens::Lens lens = lens::undistorted(false, focal_px, {tile_px, tile_px});
  const Vector3 centre = 0.5 * (size.low_in_body + size.high_in_body);
  const Vector3 to_eye = unit_vector(pose.azimuth_deg, pose.elevation_deg);
  // The aircraft stands level at the origin, nose north; the eye looks back at its middle.
  const Quaternion eye = world_from_body({pose.azimuth_deg + 180, -pose.elevation_deg, 0});
  const Rigid world_from_cam =
      Rigid{eye, centre + range_m * to_eye} * Rigid{cam_from_body().conjugate(), Vector3::Zero()};
  const projection::Sight sight{&lens, world_from_cam.inverse(), Homography::Identity()};
  const projection::SilhouettePoints silhouette{&aircraft.mesh,
                                                model::silhouette_points(aircraft.mesh)};
  const auto box = projection::exact_box(sight, silhouette, {}, 0).box;
  shade::Light light;
  light.to_sun_in_world = unit_vector(pose.azimuth_deg + 35, 45);
  light.sun = {0.62f, 0.6f, 0.56f};
  light.sky = {0.28f, 0.34f, 0.42f};
  light.ground = {0.14f, 0.13f, 0.11f};
  const render::View view{&lens, world_from_cam, Homography::Identity(), tile_px, tile_px};
  const image::Layer layer = render::render(view, light, {{&model, {}, 0}}, {box}, {.quality = 3});
  image::Picture picture = sky_tile(tile_px);
  if (!layer.empty()) composite::composite_matte(picture, layer, {});
  return image::rgb8_from_picture(picture);
}

}  // namespace

image::Rgb8 aircraft_sheet(const fleet::Aircraft& aircraft) {
  const std::array<Pose, 9> poses = {{{"nose", 0, 0, 380},
                                      {"front left, above", -40, 18, 380},
                                      {"left side", -90, 0, 380},
                                      {"above", 0.001, 89.99, 380},
                                      {"tail", 180, 0, 380},
                                      {"rear right, below", 130, -22, 380},
                                      {"right side", 90, 0, 380},
                                      {"right side, 40 px", 90, 5, 40},
                                      {"front left, 10 px", -40, 5, 10}}};
  const shade::Model model(aircraft.mesh);
  std::vector<drawing::NamedPicture> tiles;
  for (const Pose& pose : poses) tiles.push_back({pose.name, tile(aircraft, model, pose)});
  return drawing::tiled(aircraft.name, tiles, 3);
}

image::Rgb8 aircraft_tile(const fleet::Aircraft& aircraft) {
  // Side of the tile: room around an aircraft that is 138 px long.
  constexpr int kSmallTilePx = 150;
  return tile(aircraft, shade::Model(aircraft.mesh), {"", -40, 18, 138}, kSmallTilePx);
}

}  // namespace airtruth::demo
