// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "aircraft/fleet/fleet.h"
#include "camera/lens/lens.h"
#include "encounter/separation/violation.h"
#include "foundation/base/log.h"
#include "labels/projection/exact_box.h"
#include "picture/render/renderer.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"
#include "sequence/setup/seen.h"

// A scene after everything that it names has been loaded: lens, paths, aircraft.
namespace airtruth::setup {

class SharedInputs;

// An aircraft that is ready to be drawn.
struct Type {
  std::shared_ptr<const fleet::Aircraft> aircraft;
  std::shared_ptr<const shade::Model> model;
  projection::SilhouettePoints silhouette;
  std::vector<std::string> warnings;  // of its reader
};

struct Actor {
  std::string id;
  std::string aircraft;
  // "aircraft", or the kind of a distractor (labels/annotation/object_class.h).
  std::string object_class;
  trajectory::Path path;
  std::shared_ptr<const Type> type;
  double spin_time_s = 0;  // scene::Intruder::spin_time_s

  // The time that sets the angles of its moving parts.
  double turned_s(double time_s) const { return time_s + spin_time_s; }
};

struct World {
  lens::Lens lens;
  trajectory::Path camera;
  std::vector<Actor> actors;
  Shutter shutter;
  // What the truth says of encounters ([truth]).
  std::vector<separation::AskedVolume> volumes;
  double lookahead_s = 180;
  // What is on the lens.
  std::vector<scene::LensMark> lens_marks;
  // For glints that follow the sun: it is known once the scene's values are
  // (pipeline/resolved_scene.h).
  Vector3 to_sun_in_world{0, 0, -1};
  std::uint64_t seed = 1;
  // Where the camera's path is stated.
  Where camera_where = {};
};

// How an intruder's aircraft is loaded: its own keys, and the airspeed and the height at the
// beginning of the clip, or of a path that begins later, to the nearest 20 kt and 100 ft.
model::LoadOptions load_options(const scene::Intruder& intruder,
                                const trajectory::Path& path,
                                const std::stop_token& stop = {});

// Returns an intruder's aircraft in its configuration at that time: the airspeed and the height
// there determine gear and flaps.
fleet::Aircraft aircraft_of(const scene::Intruder& intruder,
                            const trajectory::Path& path,
                            const Warn& warn,
                            const std::stop_token& stop = {});

// Loads a scene without "auto" keys (pipeline/resolved_scene.h). Intruders of [[intruder.seen]] are
// placed as if the camera did not shake; place_seen() puts them right. Throws Interrupted on stop.
// `shared` gives the aircraft where it is not nullptr.
World load_world(const scene::Scene& scene,
                 lens::ImageSize size,
                 const Warn& warn,
                 const std::stop_token& stop = {},
                 SharedInputs* shared = nullptr);

// Places the intruders of [[intruder.seen]] by the frames of the clip: their paths and aircraft in
// the world, and their words in the scene, which then has their waypoints and times.
void place_seen(scene::Scene& scene,
                World& world,
                const FrameNear& frame_near,
                const std::stop_token& stop = {},
                SharedInputs* shared = nullptr);

// Throws Error where the camera's path begins after the clip, or ends earlier than the clip by more
// than the uncertainty of the clip's stated length. Warns of the latter where the length is only
// estimated.
void check_camera_path(const World& world, const video::StreamInfo& info, const Warn& warn);

// Makes the same check for a scene that is not loaded, including the intruders' paths and aircraft.
// Throws Error where one of them is missing or cannot be read.
void check_paths(const scene::Scene& scene, const video::StreamInfo& info);

}  // namespace airtruth::setup
