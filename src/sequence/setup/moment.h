// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/geometry/within_frame.h"
#include "foundation/image/spot.h"
#include "labels/projection/exact_box.h"
#include "scene/scene/distractor.h"
#include "scene/trajectory/path.h"

// Where everything is at one time of a clip.
namespace airtruth::setup {

struct World;

// Where a camera with the given shake stands, looks and moves at a time of its nominal path.
// `camera` is the path's state at that time. The lens must outlive the result.
projection::Sight sight_of(const lens::Lens& lens,
                           const Shutter& shutter,
                           const trajectory::Path& path,
                           const trajectory::State& camera,
                           double time_s,
                           const Shake& shake);

// The motion of an object on its path at that time; none if the shutter is instant.
Twist twist_of(const trajectory::Path& path,
               const trajectory::State& state,
               double time_s,
               const Shutter& shutter);

// True where a part of the box is in the picture.
bool meets_frame(const Box& box, const lens::ImageSize& size);

// The spot that a mark on the lens draws at a time of the clip; empty before its beginning and
// after its end. A glint that follows the sun has its place in each frame from the sun's pixel; it
// is empty where the sun is behind the camera or beyond the lens's field. `seed` is that of the
// scene: with the mark's id it gives dirt its shape.
std::optional<image::Spot> spot_of(const scene::LensMark& mark,
                                   const projection::Sight& sight,
                                   const Vector3& to_sun_in_world,
                                   double time_s,
                                   std::uint64_t seed);

// True from the mark's beginning to its end.
bool is_there(const scene::LensMark& mark, double time_s);

// The geometry of one frame, without its pixels.
struct Moment {
  std::int64_t frame = 0;
  double time_s = 0;
  trajectory::State camera;
  projection::Sight sight;
  // By actor; empty: the actor is not in the world at this time.
  std::vector<std::optional<trajectory::State>> states;
  // By actor: its motion after this moment.
  std::vector<Twist> twists;
  std::vector<projection::ExactBox> boxes;
  // By actor: the box in which its pixels are searched (its box with a margin); empty: it is not
  // in view.
  std::vector<std::optional<Box>> search;
  // By mark on the lens; empty: it is not there, or its sun is not in the lens's field.
  std::vector<std::optional<image::Spot>> spots;
};

// The bounding box of all the search boxes.
std::optional<PixelBox> search_bounds(const Moment& moment);

// Throws Error where the camera's path does not reach that time.
Moment moment_at(const World& world, std::int64_t frame, double time_s, const Shake& shake);

// The moment at which an actor is nearest to being in view, for the warning about an intruder that
// is never visible.
struct NearestApproach {
  double time_s = 0;
  double off_view_deg = 0;  // angle from the nearest edge of the view; 0 within it
  double range_m = 0;
};
std::optional<NearestApproach> nearest_approach(const World& world,
                                                std::size_t actor,
                                                double end_s);

}  // namespace airtruth::setup
