// SPDX-License-Identifier: Apache-2.0
// One aircraft of every kind in the catalogue, near and far: the box of its projected outline
// against the box of the pixels that its rendering touches.
#include <set>

#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "labels/projection/exact_box.h"
#include "picture/render/renderer.h"

namespace airtruth::pipeline {
namespace {

constexpr int kSide = 480;
constexpr double kFocalPx = 2000;
constexpr float kShows = 1.0f / 512;  // less changes no 8-bit sample

const lens::Lens& pinhole() {
  static const lens::Lens lens(lens::Pinhole{{kFocalPx, kFocalPx}, {kSide / 2.0, kSide / 2.0}},
                               {kSide, kSide});
  return lens;
}

struct Boxes {
  Box exact;
  std::optional<PixelBox> touched;  // pixels in which it shows
  bool outside = false;             // something was drawn outside the exact box
};

Boxes boxes_of(const fleet::Aircraft& aircraft,
               const shade::Model& model,
               const projection::SilhouettePoints& silhouette,
               double size_px) {
  const model::Extents extents = model::extents(aircraft.mesh);
  const double largest_m = std::max({extents.length_m(), extents.span_m(), extents.height_m()});
  const Vector3 middle = 0.5 * (extents.low_in_body + extents.high_in_body);
  const Quaternion world_from_body = airtruth::world_from_body({37, 8, 14});
  const Vector3 at =
      Vector3(kFocalPx * largest_m / size_px, 0.13, -0.07) - world_from_body * middle;
  const Rigid pose{world_from_body, at};
  const Rigid cam_from_world{cam_from_body(), Vector3::Zero()};
  Boxes boxes;
  boxes.exact = *projection::exact_box({&pinhole(), cam_from_world}, silhouette, pose, 0.3).box;
  const Box& e = boxes.exact;
  const render::View view{
      &pinhole(), cam_from_world.inverse(), Homography::Identity(), kSide, kSide};
  const image::Layer layer = render::render(view,
                                            {},
                                            {{&model, pose, 0.3}},
                                            {Box{e.x - 4, e.y - 4, e.width + 8, e.height + 8}},
                                            {.quality = 4});
  for (int y = layer.patch.y; y < layer.patch.bottom(); ++y) {
    for (int x = layer.patch.x; x < layer.patch.right(); ++x) {
      if (layer.pixels[layer.index(x, y)].alpha < kShows) continue;
      const PixelBox pixel{x, y, 1, 1};
      boxes.touched = boxes.touched ? bounds(*boxes.touched, pixel) : pixel;
      boxes.outside =
          boxes.outside || x + 1 <= e.x || y + 1 <= e.y || x >= e.right() || y >= e.bottom();
    }
  }
  return boxes;
}

// The widest gap, over the four sides, between the exact box and what was drawn.
double widest_gap(const Boxes& boxes) {
  const PixelBox& t = *boxes.touched;
  return std::max({t.x - boxes.exact.x,
                   t.y - boxes.exact.y,
                   boxes.exact.right() - t.right(),
                   boxes.exact.bottom() - t.bottom()});
}

TEST(EveryAircraft, HasItsTwoBoxesTogetherNearAndFar) {
  std::set<std::string> kinds;
  int checked = 0;
  for (const fleet::Entry& entry : fleet::list_aircraft()) {
    const std::string kind = entry.name.substr(0, entry.name.find('/'));
    if (kinds.contains(kind)) continue;
    SCOPED_TRACE(entry.name);
    kinds.insert(kind);
    const fleet::Aircraft aircraft = fleet::load_aircraft(entry.name);
    const shade::Model model(aircraft.mesh);
    const projection::SilhouettePoints silhouette{&aircraft.mesh,
                                                  model::silhouette_points(aircraft.mesh)};
    for (const double size_px : {8.0, 60.0, 300.0}) {
      const Boxes boxes = boxes_of(aircraft, model, silhouette, size_px);
      ASSERT_TRUE(boxes.touched) << size_px << " px";
      EXPECT_FALSE(boxes.outside) << size_px << " px";
      EXPECT_LT(widest_gap(boxes), 1.0) << size_px << " px";
      ++checked;
    }
  }
  EXPECT_GT(kinds.size(), 90u);
  EXPECT_EQ(checked, static_cast<int>(3 * kinds.size()));
}

}  // namespace
}  // namespace airtruth::pipeline
