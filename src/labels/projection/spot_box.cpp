// SPDX-License-Identifier: Apache-2.0
#include "labels/projection/spot_box.h"

#include <cmath>
#include <vector>

namespace airtruth::projection {
namespace {

// Points of the outline at half opacity about the spot's centre.
std::vector<Pixel> outline_about_centre(const image::Spot& spot) {
  // Number of directions: one in half a degree.
  constexpr int kPoints = 720;
  // The fade is a cubic that is one half in its middle.
  const double radius_px = spot.radius_px * (1 - 0.5 * spot.softness);
  const Pixel end = spot.half_length_px * spot.direction;
  // The wings' outline is where their own alpha is half of that in their middle.
  const Pixel tip = spot.wing_px * Pixel(-spot.direction.y(), spot.direction.x());
  std::vector<Pixel> points;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * kPi * i / kPoints;
    const Pixel outwards(std::cos(angle), std::sin(angle));
    const Pixel round = spot.half_length_px > 0
                            ? Pixel(radius_px * outwards)
                            : radius_px * spot.lobe(outwards.x(), outwards.y()) * outwards;
    for (const double side : {-1.0, 1.0}) {
      points.emplace_back(round + side * end);
      if (spot.wing_px > 0) points.emplace_back(0.5 * spot.wing_radius_px * outwards + side * tip);
    }
  }
  return points;
}

}  // namespace

Box spot_box(const image::Spot& spot, const Shutter& shutter, int frame_width, int frame_height) {
  const std::vector<Pixel> outline = outline_about_centre(spot);
  BoxBounds bounds;
  for (const double share : {-0.5, 0.5}) {
    const Pixel at = spot.centre + share * shutter.exposure_s * spot.velocity_px_s;
    for (const Pixel& point : outline)
      bounds.add(shutter.seen_at(at + point, spot.velocity_px_s, frame_width, frame_height));
  }
  return *bounds.box();
}

}  // namespace airtruth::projection
