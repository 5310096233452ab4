// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/within_frame.h"
#include "foundation/image/layer.h"
#include "picture/shade/light.h"
#include "picture/shade/model.h"

// Traces rays through exactly the pixels that an intruder can touch (design: docs/architecture.md):
//
//   ray_in_world(pixel) = world_from_cam * lens.ray_from_pixel(nominal_from_frame * pixel)
//
// Each ray is transformed into the aircraft's own frame, where its BVH (Embree) never moves. With a
// shutter each sample has its own time: the time of its row plus the sample's place in the
// exposure. Camera, aircraft and propellers take their poses of that time.
//
// Example: in a frame of 1280 x 960 pixels a pinhole with a vertical view of 75 degrees has a focal
// length of 480 / tan(37.5 deg) = 625.5 px, and a wing of 11 m, viewed square-on from 500 m, spans
// 625.5 * 11 / 500 = 13.8 px. For a sun in the east, 30 degrees high, unit_vector(90, 30) is (0,
// 0.866, -0.5).
namespace airtruth::render {

// The camera of one frame.
struct View {
  const lens::Lens* lens = nullptr;
  Rigid world_from_cam;
  Homography nominal_from_frame = Homography::Identity();
  int width = 0;  // of the frame
  int height = 0;
  // Motion within the frame (foundation/geometry/within_frame.h).
  Shutter shutter;
  // The motion of world_from_cam.
  Twist camera;
  Homography frame_from_nominal_per_s = Homography::Zero();

  // The same view, dt_s after the frame's time.
  View at(double dt_s) const;
};

// One aircraft in a frame.
struct Instance {
  const shade::Model* model = nullptr;
  Rigid world_from_body;
  // The time that sets the propellers' angles.
  double time_s = 0;
  // The motion of the body within the frame.
  Twist twist;
};

struct Options {
  // The number of samples, from 1 (draft) to 5 (4,096 rays for every pixel, the reference of the
  // tests). The default 3 holds alpha within 1/64 of 4,096 rays in the worst pixel up to 50 px of
  // size and within 1/40 above. Error outside 1..5.
  int quality = 3;
  // After a stop request render() returns soon. Its result is then unfinished and must be dropped.
  std::stop_token stop = {};
};

// Renders the instances into a layer. `search` holds one box for each instance, in frame pixels and
// not clipped, which contains every pixel that the instance can touch: it comes from projected
// geometry with a margin. An empty box means that the instance is not in view. Pixels outside every
// box are never touched. The result has the same bytes for any number of threads (rows of tiles run
// on oneTBB).
image::Layer render(const View& view,
                    const shade::Light& light,
                    const std::vector<Instance>& instances,
                    const std::vector<std::optional<Box>>& search,
                    const Options& options = {});

}  // namespace airtruth::render
