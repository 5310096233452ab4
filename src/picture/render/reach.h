// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "picture/render/tracer.h"

// The pixels of a patch that a triangle can touch: a box about its picture, through any lens, at an
// instant or during an exposure.
namespace airtruth::render {

// A range of the patch's pixels, [x0, x1) by [y0, y1).
struct Reach {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  // Of a range that is not empty.
  std::uint64_t pixels() const {
    return static_cast<std::uint64_t>(x1 - x0) * static_cast<std::uint64_t>(y1 - y0);
  }
};

// A vertex at one moment.
struct Seen {
  // The vector from the eye.
  Vector3 in_world;
  // The point in the frame; not finite where the lens has none.
  Pixel pixel;
  // The reciprocal of the depth, in units in which it is linear over the picture of a plane under a
  // pinhole; 0 where the point is not in front of the camera.
  double nearness = 0;
};

// The corners of a triangle at one moment.
using Corners = std::array<const Seen*, 3>;

// The view at one moment, as the projection of a point uses it.
struct Eye {
  View view;
  Matrix3 world_from_body;
  Vector3 eye_in_body;
  Homography frame_from_nominal;
  Quaternion cam_from_world;

  // The point in the frame. Empty where the lens has none.
  std::optional<Pixel> pixel(const Vector3& from_eye_in_world) const;
  Seen look_at(const Vector3& from_eye_in_world) const;
  bool is_pinhole() const;
  double depth(const Vector3& in_world) const { return (cam_from_world * in_world).z(); }
};

// The views of a patch's span: three where the actor moves in it, else the middle one.
std::vector<Eye> eyes_of(const TracedIntruder& actor, const View& view, const RayGrid& grid);

// A box about the triangle's picture. Under a wide lens the sides may bend by at most twice the
// deviation of their middles.
Reach reach_of(const PixelBox& patch, const Corners& corners, const Eye& eye);

// The union of the reaches at each moment. Between moments the corners follow parabolas, which
// deviate from their chords by an eighth of the second difference. corners, eyes: at three moments.
Reach reach_over_time(const PixelBox& patch,
                      const std::vector<Corners>& corners,
                      const std::vector<Eye>& eyes);

// The reach of a spinning part at any angle: that of an octahedron about a sphere about its hub.
Reach reach_of_disc(const PixelBox& patch,
                    const aircraft::Mesh& mesh,
                    const aircraft::Part& part,
                    const std::vector<Eye>& eyes);

// How far in the frame a point of a part that swings on hinges can be from the parabola through its
// places at the three moments of a span. Empty for a part that spins, and where the span is so long
// that the parabola tells little.
std::optional<int> swing_margin_px(const aircraft::Mesh& mesh,
                                   const aircraft::Part& part,
                                   const std::vector<Eye>& eyes,
                                   double span_s);

// A reach with a margin, within the patch.
Reach wider(const Reach& reach, int more, const PixelBox& patch);

// The indices of reaches by their number of pixels, to a power of two: large triangles cover a
// pixel early.
std::vector<std::uint32_t> largest_first(const std::vector<Reach>& reaches);

}  // namespace airtruth::render
