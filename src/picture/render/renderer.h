// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "aircraft/model/mesh.h"
#include "camera/lens/lens.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/within_frame.h"
#include "foundation/image/layer.h"
#include "picture/render/environment.h"

// Rays over exactly the pixels that an intruder can touch (design: docs/architecture.md):
//
//   ray_in_world(pixel) = world_from_cam * lens.ray_from_pixel(nominal_from_frame * pixel)
//
// carried into each aircraft's own frame, where its BVH (Embree) never moves. With a shutter every
// sample has its own time: that of its row plus its own place in the exposure; camera, aircraft and
// propellers stand where they are then.
namespace airtruth::render {

struct Light {
  Vector3 to_sun_in_world{0, 0, -1};     // unit
  std::array<float, 3> sun = {1, 1, 1};  // linear; irradiance/pi on a surface facing the sun
  std::array<float, 3> sky = {0.3f, 0.3f, 0.3f};     // linear; from straight above
  std::array<float, 3> ground = {0.1f, 0.1f, 0.1f};  // linear; from straight below
  // In place of sky and ground: light by direction, of which the aircraft hides a part from itself,
  // and paint with a clear coat that mirrors it. Empty: sky and ground as the OpenGL of `backdrop`
  // has them.
  std::optional<Environment> surroundings = {};
};

// to_sun_in_world from azimuth (north towards east) and elevation.
Vector3 to_sun(double azimuth_deg, double elevation_deg);

struct View {
  const lens::Lens* lens = nullptr;
  Rigid world_from_cam;
  Homography nominal_from_frame = Homography::Identity();
  int width = 0;  // of the frame
  int height = 0;
  // What goes on within the frame (foundation/geometry/within_frame.h).
  Shutter shutter;
  Twist camera;  // of world_from_cam
  Homography frame_from_nominal_per_s = Homography::Zero();

  View at(double dt_s) const;  // the same, dt_s from the frame's time
};

// One aircraft ready to be hit: its BVH, in body coordinates. Immutable; share one among intruders
// of one type.
class Model {
 public:
  explicit Model(const aircraft::Mesh& mesh);  // copies what it needs
  ~Model();
  Model(Model&&) noexcept;
  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

struct Instance {
  const Model* model = nullptr;
  Rigid world_from_body;
  double time_s = 0;  // turns the propellers
  Twist twist;        // how the body goes on within the frame
};

struct Options {
  // Samples: 1 draft, 2, 3 (default: alpha within 1/64 of 4,096 rays in the worst pixel up to 50 px
  // of size, 1/40 above), 4, 5 (the oracle: 4,096 rays a pixel everywhere).
  int quality = 3;
  // Once asked to stop, render returns soon; what it returns is then unfinished and to be dropped.
  std::stop_token stop = {};
};

// `search` boxes (one per instance, in frame pixels, not clipped; empty: not in view) say where an
// instance can be: from projected geometry with a margin. Pixels outside every box are never
// touched. Same bytes for any number of threads (rows of tiles run on oneTBB).
image::Layer render(const View& view,
                    const Light& light,
                    const std::vector<Instance>& instances,
                    const std::vector<std::optional<Box>>& search,
                    const Options& options = {});

}  // namespace airtruth::render
