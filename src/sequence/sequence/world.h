// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "aircraft/fleet/fleet.h"
#include "camera/lens/lens.h"
#include "foundation/base/log.h"
#include "picture/composite/matte.h"
#include "picture/render/renderer.h"
#include "picture/video/reader.h"
#include "truth/annotation/exact_box.h"
#include "truth/annotation/truth.h"
#include "world/scene/scene.h"
#include "world/trajectory/path.h"

// A scene with everything it names loaded: lens, paths, aircraft.
namespace airtruth::sequence {

struct Actor {
  std::string id;
  std::string aircraft;
  trajectory::Path path;
  std::shared_ptr<const aircraft::Aircraft> type;
  std::shared_ptr<const render::Model> model;
  annotation::Silhouette silhouette;
};

struct World {
  lens::Lens lens;
  trajectory::Path camera;
  std::vector<Actor> actors;
  Shutter shutter;
};

// An intruder's aircraft as it flies at the beginning of its path: the airspeed and the height
// there decide on gear and flaps.
std::shared_ptr<const aircraft::Aircraft> aircraft_of(const scene::Intruder& intruder,
                                                      const trajectory::Path& path,
                                                      const Warn& warn,
                                                      const std::stop_token& stop = {});

// The scene has no "auto" keys left (resolve.h). Throws Interrupted on stop.
World load_world(const scene::Scene& scene,
                 lens::ImageSize size,
                 const Warn& warn,
                 const std::stop_token& stop = {});

// Error where the camera's path begins after the clip, or ends before it by more than the clip's
// stated length may be wrong.
void check_camera_path(const trajectory::Path& camera, const video::StreamInfo& info);

// The same for a scene that is not loaded, with the intruders' paths and aircraft: Error where one
// cannot be read or is not there.
void check_paths(const scene::Scene& scene, const video::StreamInfo& info);

// Where everything is in one frame, from geometry alone.
struct Moment {
  std::int64_t frame = 0;
  double time_s = 0;
  trajectory::State camera;
  annotation::Sight sight;
  std::vector<std::optional<trajectory::State>> states;  // per actor; empty: not in the world
  std::vector<Twist> twists;                             // per actor: how it goes on
  std::vector<annotation::ExactBox> boxes;
  std::vector<std::optional<Box>>
      search;  // where to look for pixels: boxes with a margin, if in view
};

// Around all the places to look.
std::optional<PixelBox> search_bounds(const Moment& moment);

// Error where the camera's path does not reach that time.
Moment moment_at(const World& world, std::int64_t frame, double time_s, const Shake& shake);

// Where an actor comes nearest to being in view: for the warning about an intruder that never is.
struct NearestApproach {
  double time_s = 0;
  double off_view_deg = 0;  // angle from the nearest edge of the view
  double range_m = 0;
};
std::optional<NearestApproach> nearest_approach(const World& world,
                                                std::size_t actor,
                                                double end_s);

}  // namespace airtruth::sequence
